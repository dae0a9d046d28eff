#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

namespace rodwake::scene {

using Names = std::span<const std::string_view>;

/// Number of single-character edits (insert, delete, replace, swap of neighbours) from one word to the other.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known name nearest to `name`, or empty if none is close (a third of its length, at most 3 edits).
std::string_view nearest(std::string_view name, Names known);

/// ` (did you mean "kappa"?)`, or empty.
std::string did_you_mean(std::string_view name, Names known);

/// `must be one of x, y (did you mean "x"?)`
std::string one_of_text(Names legal, std::string_view found);

/// `[coupling] unknown key "kapa" (did you mean "kappa"?). Known keys: kappa, gamma1`; for the top level the
/// title is empty.
std::string unknown_key_text(const std::string& title, const std::string& name, Names known);

template<class Strings>
bool contains(const Strings& names, std::string_view name) {
    return std::ranges::find(names, name) != std::ranges::end(names);
}

/// "a, b, c"
template<class Strings>
std::string comma_list(const Strings& names) {
    std::string text;
    for (const std::string_view name : names)
        text.append(text.empty() ? "" : ", ").append(name);
    return text;
}

} // namespace rodwake::scene
