#pragma once
// The field lists as data: what the reference and schema.json are made of.

#include "rodwake/scene/document.hpp"

#include <string>
#include <vector>

namespace rodwake::scene {

struct TableInfo {
    std::string path; ///< as in KeyInfo::table
    std::string meaning;
    std::vector<KeyInfo> keys;
    std::vector<std::string> notes;
};

std::vector<TableInfo> documented();

} // namespace rodwake::scene
