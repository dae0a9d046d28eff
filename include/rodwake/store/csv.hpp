#pragma once
// Tables of numbers as CSV, maybe gzip's: one header line; commas, semicolons or tabs (the header tells);
// quoted fields, which may hold ends of lines; '#' or '%' starts a comment line; LF, CR LF or CR. Also
// columns without a name in front (an index) or behind the last one, and separators at the end of rows.

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::store {

/// The columns that were asked for, of equal length, in file order.
struct Table {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;
    std::vector<std::size_t> lines; ///< line of the file each row came from, for messages

    std::size_t rows() const { return lines.size(); }
    /// nullptr if there is no such column.
    const std::vector<double>* find(const std::string& name) const;
};

/// Reads the required columns and those of the optional ones that are there; others may hold anything and
/// are passed over; "-" is standard input. Throws InputError with file:line:column for anything that is not a
/// finite number, a wrong number of fields, a missing required column, an empty or unreadable file. Empty
/// fields, NA and the like are NaN in optional columns.
Table read_csv(const std::filesystem::path& path, std::span<const std::string> required,
               std::span<const std::string> optional = {});

/// The names in the header, in order. Throws as read_csv.
std::vector<std::string> csv_names(const std::filesystem::path& path);

/// Shows the header and then each row: its text, and its fields in the columns that have a name (fewer in a
/// short row). Throws as read_csv, but for what the fields hold and for their number.
void for_each_csv_row(const std::filesystem::path& path,
                      const std::function<void(std::string_view, std::span<const std::string>)>& use);

/// Header and rows, 17 significant digits (exact round trip); NaN is an empty field.
std::string to_csv(std::span<const std::string> names, std::span<const std::vector<double>> columns);

} // namespace rodwake::store
