#include "rodwake/app/describe.hpp"

#include "bed/measure_kind.hpp"
#include "catalogue.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/scene/document.hpp"

#include <nlohmann/json.hpp>

namespace rodwake::app {

std::string schema_json() {
    scene::SchemaList measures{"measures", {}};
    for (const MeasureKind& kind : measure_kinds())
        for (const ColumnInfo& value : kind.values()) {
            nlohmann::ordered_json out = {{"measure", kind.name}, {"key", value.name}};
            if (!value.row.title.empty())
                out["title"] = value.row.title;
            if (!value.unit.empty()) {
                out["unit"] = unit_in_report(value);
                out["factor"] = factor_in_report(value);
            }
            out["meaning"] = value.meaning;
            measures.entries.push_back(json_text(out));
        }
    return scene::schema_json({&measures, 1});
}

} // namespace rodwake::app
