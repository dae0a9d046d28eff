#pragma once
// The known word that a misspelt one most likely stands for: keys and values of scenes, words of the command
// line.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace rodwake {

/// Number of single-character edits (insert, delete, replace, swap of neighbours) from one word to the other.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known name nearest to `name`, or empty if none is close (a third of its length, at most 3 edits).
std::string_view nearest_word(std::string_view name, std::span<const std::string_view> known);

/// ` (did you mean "kappa"?)`, or empty.
std::string did_you_mean(std::string_view name, std::span<const std::string_view> known);

} // namespace rodwake
