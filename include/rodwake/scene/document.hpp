#pragma once
// What a scene may contain, from the same field lists that read and write it.

#include <string>
#include <vector>

namespace rodwake::scene {

struct KeyInfo {
    std::string table;         ///< "medium", "rods[]", "field.cuts[]"; empty: top level
    std::string name;          ///< "eta"
    std::string type;          ///< "number", "2 numbers", "string", ...
    std::string unit;          ///< reduced and SI unit; empty: dimensionless or not a number
    std::string default_value; ///< TOML, "required", or what its absence means
    std::string legal;         ///< "> -1 and <= 1e+12"
    std::string meaning;
    std::string example; ///< TOML value that is legal
};

/// Every key, in the order of the reference.
std::vector<KeyInfo> scene_keys();

/// docs/scene.md: Markdown with a table for each scene table.
std::string scene_reference();

} // namespace rodwake::scene
