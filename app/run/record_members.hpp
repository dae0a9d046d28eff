#pragma once
// Types of members of described results (core/record.hpp) that JSON files show in a way of their own.

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rodwake::app {

/// A member that is null in a file where there is none.
template<class T>
using OrNull = std::variant<std::monostate, T>;

/// A JSON object with a value for each name.
template<class T>
using Named = std::vector<std::pair<std::string, T>>;

} // namespace rodwake::app
