#pragma once
// What a result file holds, in a page of text, for `rodwake info`.

#include <filesystem>
#include <string>

namespace rodwake::cli {

/// A file by its content and its name: tables with the range of each column, JSON with long lists cut short.
/// Throws InputError for a file that cannot be read or is of no known kind.
std::string file_text(const std::filesystem::path& file);

} // namespace rodwake::cli
