#pragma once

#include "apply_overrides.hpp"
#include "node.hpp"

#include <string>
#include <vector>

namespace rodwake::scene {

/// The entries of a variant's `set` table as overrides. Tables inside it stand for dotted keys.
std::vector<Override> variant_overrides(const Node& set);

/// `set` as a TOML inline table; what variant_overrides would give back as `settings`.
std::string settings_text(const std::vector<std::string>& settings);

} // namespace rodwake::scene
