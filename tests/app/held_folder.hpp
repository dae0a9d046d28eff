#pragma once
// A folder run/ that holds stages of a scene, and what a command that begins in it leaves there.

#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "store/scratch.hpp"

#include <nlohmann/json.hpp>

#include <set>

namespace app_test {

using namespace rodwake;
using namespace store_test;
using app::RunFolder;
using app::Stage;

using Names = std::set<std::string>;
using Stages = std::vector<Stage>;

inline std::string provenance(const app::StageRecords& records, const std::string& status = "unfinished") {
    return nlohmann::json{{"status", status}, {"stages", records}}.dump();
}

/// Begins, but stops before the record of this number is written, as one that is killed does.
inline void begin(const RunFolder& folder, const scene::Scene& scene, int killed_at = 3) {
    int record = 0;
    folder.begin(
        [&](const app::StageRecords& records) {
            if (++record == killed_at)
                throw RunError("killed");
            return provenance(records);
        },
        scene::to_toml(scene));
}

/// A folder run/ that holds these stages of a scene.
inline void hold(const Scratch& scratch, const scene::Scene& scene, const app::StageRecords& records) {
    scratch.file("run/scene.toml", scene::to_toml(scene));
    scratch.file("run/provenance.json", provenance(records));
    scratch.file("run/manifest.json", R"({"files": {}})");
}

inline std::string refusal(const Scratch& scratch, const scene::Scene& scene, const Stages& stages) {
    return error_of<InputError>([&] { RunFolder(scratch / "run", scene, stages, false); });
}

/// Files in run/, seen from there, without those of the run itself.
inline Names files_of_run(const Scratch& scratch) {
    Names files;
    for (const std::string& name : scratch.entries())
        if (!fs::is_directory(scratch / name))
            files.insert(name.substr(4));
    for (const char* own : {"provenance.json", "scene.toml", "rodwake.lock", "manifest.json"})
        files.erase(own);
    return files;
}

} // namespace app_test
