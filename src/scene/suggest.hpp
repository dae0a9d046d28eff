#pragma once

#include <span>
#include <string>

namespace rodwake::scene {

/// Number of single-character edits (insert, delete, replace, swap of neighbours) from one word to the other.
std::size_t edit_distance(const std::string& a, const std::string& b);

/// The known name nearest to `name`, or empty if none is close (a third of its length, at most 3 edits).
std::string nearest(const std::string& name, std::span<const std::string> known);

/// ` (did you mean "kappa"?)`, or empty.
std::string did_you_mean(const std::string& name, std::span<const std::string> known);

bool contains(std::span<const std::string> names, const std::string& name);

/// "a, b, c"
std::string comma_list(std::span<const std::string> names);

} // namespace rodwake::scene
