#pragma once
// The field lists as data: what the reference and schema.json are made of.

#include "rodwake/scene/document.hpp"

#include <string>
#include <vector>

namespace rodwake::scene {

std::vector<TableInfo> documented();

} // namespace rodwake::scene
