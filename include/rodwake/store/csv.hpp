#pragma once
// Tables of numbers as CSV: one header line, comma-separated, '#' starts a comment line.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace rodwake::store {

/// Columns of equal length under their names, in file order.
struct Table {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;
    std::vector<std::size_t> lines; ///< line of the file each row came from, for messages

    std::size_t rows() const { return lines.size(); }
    /// nullptr if there is no such column.
    const std::vector<double>* find(const std::string& name) const;
};

/// Reads a table. Throws InputError with file:line:column for anything that is not a finite number, a wrong
/// number of fields, a missing required column, an empty or unreadable file. Empty fields are NaN in columns
/// not required.
Table read_csv(const std::filesystem::path& path, std::span<const std::string> required);

/// Header and rows, 17 significant digits (exact round trip).
std::string to_csv(std::span<const std::string> names, std::span<const std::vector<double>> columns);

} // namespace rodwake::store
