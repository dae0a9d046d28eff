#include "rodwake/app/rods.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/scene/document.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"
#include "stage_kind.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// Units of what a run writes: of its theory, and of the data that were fitted.
struct ManifestUnits {
    OutputUnits output, order;
    std::string scan_length, scan_time;
    std::string data; ///< length_unit of [fit]
    bool si = false;  ///< of the scene's keys
};

ManifestUnits units_of(const fs::path& folder) {
    try {
        const scene::Scene scene = scene::read_scene(folder / "scene.toml");
        const OutputUnits output = output_units(scene);
        const bool beds = scan_subject(scene) == scene::ScanSubject::beds;
        return {output,
                order_units(scene),
                beds ? "a" : output.length_name,
                beds ? "s" : output.time_name,
                scene.fit ? scene.fit->length_unit : "",
                scene.units == scene::UnitSystem::si};
    } catch (const InputError&) { // no scene yet
        return {};
    }
}

std::string unit_of(std::string_view unit, const ManifestUnits& units) {
    const std::pair<std::string_view, std::string> names[] = {{"{length}", units.output.length_name},
                                                              {"{time}", units.output.time_name},
                                                              {"{scan length}", units.scan_length},
                                                              {"{scan time}", units.scan_time},
                                                              {"{order length}", units.order.length_name},
                                                              {"{order time}", units.order.time_name},
                                                              {"{data}", units.data},
                                                              {"{unit}", "of the key unit"}};
    std::string text(unit);
    for (const auto& [place, name] : names)
        if (const auto at = text.find(place); at != std::string::npos)
            text.replace(at, place.size(), name);
    return text;
}

std::vector<ColumnEntry> entries(const fs::path& file, const FileKind* kind, const ManifestUnits& units) {
    std::vector<ColumnEntry> columns;
    std::vector<std::string> names;
    try {
        names = store::csv_names(file);
    } catch (const InputError&) { // a file that only bears the name of one of ours
    }
    for (const std::string& name : names)
        if (const ColumnInfo* column = kind ? column_of(*kind, name) : nullptr)
            columns.push_back({name, unit_of(column->unit, units), std::string(column->meaning), true});
        else if (std::string key = name; kind && kind->stage == Stage::scan) {
            // Columns of the axes of a scan are called as the keys that vary, in cells.csv with an ending.
            for (const std::string ending : {"_from", "_to"})
                if (key.ends_with(ending))
                    key.resize(key.size() - ending.size());
            ColumnEntry& axis = columns.emplace_back(ColumnEntry{name, "", ""});
            if (const auto info = scene::key_info(key)) {
                const std::string unit = units.si ? info->unit_si : info->unit_reduced;
                axis = {name, unit.empty() ? "1" : unit, info->meaning, true};
            }
        } else
            columns.push_back({name, "", ""});
    return columns;
}

ordered_json json_of(const fs::path& file) {
    std::ifstream in(file);
    return ordered_json::parse(in, nullptr, false);
}

/// The numbers of a JSON file that the catalogue knows; a list, or a value with its error, is one.
void add_values(const ordered_json& node, const std::string& name, const FileKind& kind,
                const ManifestUnits& units, ordered_json& values) {
    constexpr std::string_view error = "_error";
    const bool is_error = name.ends_with(error);
    if (const ColumnInfo* info = column_of(kind, name.substr(0, name.size() - (is_error ? error.size() : 0))))
        values.push_back({{"name", name},
                          {"unit", unit_of(info->unit, units)},
                          {"meaning", is_error ? "standard error" : info->meaning}});
    else if (node.is_structured())
        for (const auto& [key, value] : node.items())
            add_values(value, name.empty() ? key : fmt::format("{}.{}", name, key), kind, units, values);
}

ordered_json manifest_of_files(const fs::path& folder) {
    const ManifestUnits units = units_of(folder);
    ordered_json files = ordered_json::object();
    for (const FileEntry& file : files_of_run(folder)) {
        const FileKind* kind = kind_of(fs::path(file.name).filename().string());
        files[file.name] = {{"what", file.what}};
        if (const auto stage = kind ? stage_of(*kind, file.name) : std::nullopt)
            files[file.name]["stage"] = to_string(*stage);
        const bool of_point = file.name.starts_with("points/"); // of a scan there may be very many
        if (kind && !kind->columns.empty() && file.name.ends_with(".json") && !of_point)
            add_values(json_of(folder / file.name), "", *kind, units,
                       files[file.name]["values"] = ordered_json::array());
        else if (kind && !kind->columns.empty() && file.name.ends_with(".csv")) {
            ordered_json& columns = files[file.name]["columns"] = ordered_json::array();
            for (const ColumnEntry& column : entries(folder / file.name, kind, units))
                if (column.known)
                    columns.push_back(
                        {{"name", column.name}, {"unit", column.unit}, {"meaning", column.meaning}});
        }
    }
    files["manifest.json"] = {{"what", kind_of("manifest.json")->what}};
    return {{"schema", 1}, {"files", std::move(files)}};
}

} // namespace

std::vector<ColumnEntry> columns_of(const fs::path& file) {
    // Units are those of the run to which the file belongs, whose folder is the nearest with a
    // provenance.json.
    const fs::path own = fs::absolute(file).parent_path();
    fs::path run = own;
    while (!fs::exists(run / "provenance.json") && run != run.parent_path())
        run = run.parent_path();
    if (!fs::exists(run / "provenance.json"))
        run = own;
    return entries(file, kind_of(file.filename().string()), units_of(run));
}

std::string what_of(const fs::path& file) {
    const FileKind* kind = kind_of(file.filename().string());
    return kind ? std::string(kind->what) : "";
}

std::vector<FileEntry> files_of_run(const fs::path& folder) {
    std::vector<FileEntry> files;
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied)) {
        const std::string name = entry.path().lexically_relative(folder).generic_string();
        const FileKind* kind = kind_of(entry.path().filename().string());
        if (entry.is_regular_file() && name.starts_with("figures/"))
            files.push_back({name, "figure"});
        else if (entry.is_regular_file() && kind && name != "rodwake.lock") // gone when the run ends
            files.push_back({name, std::string(kind->what), kind->lifetime == Lifetime::progress});
    }
    std::ranges::sort(files, {}, &FileEntry::name);
    return files;
}

LostFiles lost_files(const fs::path& folder) {
    const ordered_json manifest = json_of(folder / "manifest.json");
    if (!manifest.is_object() || !manifest.contains("files"))
        return {{"", {"manifest.json"}}};
    LostFiles lost;
    for (const auto& [name, entry] : manifest["files"].items()) {
        const FileKind* kind = kind_of(fs::path(name).filename().string());
        std::error_code none;
        if ((kind && (kind->lifetime == Lifetime::progress || kind->lifetime == Lifetime::record)) ||
            !is_own(name) || fs::exists(folder / name, none))
            continue;
        const bool has_stage = entry.is_object() && entry.contains("stage") && entry["stage"].is_string();
        lost[is_drawn(name) || !has_stage ? "" : entry["stage"].get<std::string>()].push_back(name);
        if (name == "result.h5")
            for (const Stage stage : all_stages())
                if (kind_of(stage).datasets)
                    lost[to_string(stage)].push_back(name);
    }
    return lost;
}

std::string manifest_json(const fs::path& folder) { return json_text(manifest_of_files(folder), 2) + "\n"; }

void write_manifest(const fs::path& folder) {
    ordered_json manifest = manifest_of_files(folder);
    // Entries of files that are gone stay, until the stage that makes them is done again.
    const ordered_json provenance = json_of(folder / "provenance.json"),
                       before = json_of(folder / "manifest.json");
    if (provenance.is_object() && provenance.contains("stages")) {
        const ordered_json& records = provenance["stages"];
        for (const auto& [stage, names] : lost_files(folder))
            if (records.contains(stage) && records[stage] == files_lost)
                for (const std::string& name : names)
                    manifest["files"][name] = before["files"][name];
    }
    store::write_atomically(folder / "manifest.json", json_text(manifest, 2) + "\n");
}

} // namespace rodwake::app
