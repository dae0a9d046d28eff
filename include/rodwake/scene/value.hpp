#pragma once

#include <cstdint>
#include <string>
#include <variant>

namespace rodwake::scene {

/// As in TOML: a number may be given as an integer, an integer not as a number.
using Value = std::variant<bool, std::int64_t, double, std::string>;

} // namespace rodwake::scene
