#include "figure_kinds.hpp"
#include "fit_parameters.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/scene/document.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rodwake::scene {

namespace {

using Json = nlohmann::ordered_json;

SchemaList list_of(const char* name, const Json& entries) {
    SchemaList list{name, {}};
    for (const Json& entry : entries)
        list.entries.push_back(json_text(entry));
    return list;
}

} // namespace

std::string schema_json(std::span<const SchemaList> more) {
    Json tables = Json::array(), keys = Json::array(), figures = Json::array(), parameters = Json::array();
    for (const TableInfo& table : scene_tables()) {
        if (!table.path.empty())
            tables.push_back({{"table", table.path}, {"meaning", table.meaning}});
        for (const KeyInfo& key : table.keys) {
            Json described = {{"table", key.table}, {"key", key.name}, {"type", key.type}};
            if (!key.unit.empty())
                described["unit"] = {{"reduced", key.unit_reduced}, {"si", key.unit_si}};
            if (!key.symbol.empty())
                described["symbol"] = key.symbol;
            described["meaning"] = key.meaning;
            described["legal"] = key.legal;
            if (key.low && key.high)
                described["range"] = {{key.is_low_legal ? "from" : "above", *key.low}, {"to", *key.high}};
            if (!key.choices.empty())
                described["choices"] = key.choices;
            described["required"] = key.is_required;
            if (!key.is_required)
                described["default"] = key.default_value;
            described["example"] = key.example;
            keys.push_back(described);
        }
    }
    for (const FigureKind& kind : figure_kinds()) {
        Json out = {{"kind", kind.name}, {"meaning", kind.meaning}, {"subject", to_string(kind.subject)}};
        out["needs"] = Json::array();
        for (const FigureNeed& need : kind.needs)
            out["needs"].push_back(need.text);
        for (const auto& [name, need] : kind.quantities)
            out["quantities"][name] = need.text;
        out["files"] = kind.files;
        out["keys"] = kind.keys;
        figures.push_back(out);
    }
    for (const FitParameter& parameter : fit_parameter_list())
        parameters.push_back(
            {{"name", parameter.name}, {"symbol", parameter.symbol}, {"meaning", parameter.meaning}});
    std::vector<SchemaList> lists = {list_of("tables", tables), list_of("keys", keys),
                                     list_of("figures", figures), list_of("fit_parameters", parameters)};
    lists.insert(lists.end(), more.begin(), more.end());
    std::string text = "{\n \"schema\": 1";
    for (const SchemaList& list : lists)
        text += fmt::format(",\n \"{}\": [\n  {}\n ]", list.name, fmt::join(list.entries, ",\n  "));
    return text + "\n}\n";
}

} // namespace rodwake::scene
