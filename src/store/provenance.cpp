#include "rodwake/store/provenance.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/json_text.hpp"

#include <nlohmann/json.hpp>

#include <ctime>

namespace rodwake::store {

std::string provenance_json(const Provenance& provenance) {
    const BuildInfo build = build_info();
    nlohmann::ordered_json json;
    json["program"] = "rodwake";
    json["version"] = build.version;
    json["git"] = build.git;
    json["status"] = provenance.status;
    json["stages"] = provenance.stages;
    json["command"] = provenance.command;
    json["scene"] = provenance.scene;
    json["seed"] = provenance.seed;
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    json["date"] = text;
    json["wall_seconds"] = provenance.wall_seconds;
    json["cpu"] = {{"model", cpu_model()}, {"features", cpu_features()}};
    json["compiler"] = build.compiler;
    json["build"] = build.flags;
    for (const auto& [name, version] : build.libraries)
        json["libraries"][name] = version;
    // File names need not be UTF-8.
    return json_text(json, 2) + "\n";
}

} // namespace rodwake::store
