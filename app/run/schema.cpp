#include "rodwake/app/describe.hpp"

#include "rodwake/app/measure_kind.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/scene/document.hpp"

#include <nlohmann/json.hpp>

namespace rodwake::app {

std::string schema_json() {
    scene::SchemaList measures{"measures", {}};
    for (const MeasureKind& kind : measure_kinds())
        for (const ValueInfo& value : kind.values) {
            nlohmann::ordered_json out = {{"measure", kind.name}, {"key", value.key}};
            if (!value.title.empty())
                out["title"] = value.title;
            if (!value.is_text) {
                out["unit"] = value.unit;
                out["factor"] = value.factor;
            }
            out["meaning"] = value.meaning;
            measures.entries.push_back(json_text(out));
        }
    return scene::schema_json({&measures, 1});
}

} // namespace rodwake::app
