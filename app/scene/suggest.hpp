#pragma once

#include "rodwake/core/spelling.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

namespace rodwake::scene {

using Names = std::span<const std::string_view>;

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
