#pragma once
// Words in messages: the known one that a misspelt one most likely stands for (keys and values of scenes,
// words of the command line), and how words of others are shown.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace rodwake {

/// Number of single-character edits (insert, delete, replace, swap of neighbours) from one word to the other.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known name nearest to `name`, or empty if none is close (a third of its length, at most 3 edits).
std::string_view nearest_word(std::string_view name, std::span<const std::string_view> known);

/// ` (did you mean "eta"?)`, or empty.
std::string did_you_mean(std::string_view name, std::span<const std::string_view> known);

/// Place of the first byte that is part of no character of UTF-8, or npos.
std::size_t first_not_utf8(std::string_view text);

/// Text that can be shown anywhere: control characters but for tabs and ends of lines, which a terminal would
/// obey, and bytes that are not UTF-8 are spelled by their code.
std::string printable(std::string_view text);

/// A word of a file, in a message: printable on one line, and cut after 60 bytes.
std::string shown(std::string_view word);

/// The first line in which two texts differ, as "duration = 30.0 there, duration = 20.0 here".
std::string first_difference(const std::string& there, const std::string& here);

} // namespace rodwake
