#pragma once
// What a scene may contain, from the same field lists that read and write it.

#include <optional>
#include <span>
#include <string>
#include <string_view>
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
    std::string example;                   ///< TOML value that is legal
    std::string symbol{};                  ///< TeX without dollars; empty: none
    std::string unit_reduced{}, unit_si{}; ///< of a plain number, by the scene's `units`
    bool is_required = false;
    std::vector<std::string> choices{};  ///< names that are legal; empty: not among names
    std::optional<double> low{}, high{}; ///< of numbers, in the unit of `legal`
    bool is_low_legal = true;
};

struct TableInfo {
    std::string path; ///< as in KeyInfo::table
    std::string meaning;
    std::vector<KeyInfo> keys;
    std::vector<std::string> notes;
};

/// "[scan]", "[[rods]]" of the path of a table.
std::string table_header(const std::string& path);

/// Every table, in the order of the reference; the top level has no path.
std::vector<TableInfo> scene_tables();
/// Their keys.
std::vector<KeyInfo> scene_keys();

/// The entry of a key as a scan or a setting names it: of "rods.1.position.0" that of position in rods[].
std::optional<KeyInfo> key_info(const std::string& key);

/// docs/scene.md: Markdown with a table for each scene table.
std::string scene_reference();
/// docs/figures.md: the kinds of figures.
std::string figure_reference();

/// Text as a cell of a table in Markdown.
std::string markdown_cell(std::string_view text);

/// A list of the schema; each entry is JSON.
struct SchemaList {
    std::string name;
    std::vector<std::string> entries;
};

/// The same as JSON, for programs: {"schema", "tables": [{"table", "meaning"}], "keys": [...], "figures":
/// [...], "fit_parameters": [...]} and what else is known of (rodwake/app/schema.hpp).
std::string schema_json(std::span<const SchemaList> more = {});

} // namespace rodwake::scene
