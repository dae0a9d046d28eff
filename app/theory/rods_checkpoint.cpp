#include "rods_checkpoint.hpp"

#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/medium/simulate.hpp"
#include "rodwake/rods/form.hpp"
#include "run/record_json.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

namespace rodwake::app {

namespace {

using nlohmann::json;

/// Numbers are written with as many digits as their bits need; JSON has no infinity, null stands for it.
double number(const json& value) {
    return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

/// What must be the same for a checkpoint to be taken up: version, git id, scene, data of the field.
std::string key_of(const scene::Scene& scene, const std::string& field) {
    const BuildInfo build = build_info();
    return build.version + " " + build.git + "\n" + stage_key(scene, Stage::rods) + "\n" + field;
}

json to_json(const rods::SeparationRecord& record) {
    json late = json::array();
    for (const TailWindow& range : record.late)
        late.push_back(
            {finite_or_null(range.min_separation), finite_or_null(range.max_separation), range.max_turning});
    const rods::Separation& pair = record.smallest;
    return {{"smallest", {pair.first, pair.second, finite_or_null(pair.distance), record.smallest_time}},
            {"tail_start", record.tail_start},
            {"late", late},
            {"bodies",
             {finite_or_null(record.bodies.smallest_gap), record.bodies.smallest_gap_time,
              record.bodies.tail_start, record.bodies.touching}}};
}

rods::SeparationRecord record_of(const json& value) {
    rods::SeparationRecord record;
    const json& pair = value.at("smallest");
    record.smallest = {pair.at(0).get<std::size_t>(), pair.at(1).get<std::size_t>(), number(pair.at(2))};
    record.smallest_time = pair.at(3).get<double>();
    record.tail_start = value.at("tail_start").get<double>();
    for (const json& range : value.at("late"))
        record.late.push_back({number(range.at(0)), number(range.at(1)), range.at(2).get<double>()});
    const json& bodies = value.at("bodies");
    record.bodies = {number(bodies.at(0)), bodies.at(1).get<double>(), bodies.at(2).get<double>(),
                     bodies.at(3).get<std::vector<double>>()};
    return record;
}

json to_json(const integrate::Statistics& n) {
    return {n.steps,
            n.rhs_evaluations,
            n.jacobian_evaluations,
            n.error_test_failures,
            n.convergence_failures,
            n.event_evaluations,
            n.drift};
}

integrate::Statistics statistics_of(const json& n) {
    return {n.at(0).get<long>(), n.at(1).get<long>(), n.at(2).get<long>(),  n.at(3).get<long>(),
            n.at(4).get<long>(), n.at(5).get<long>(), n.at(6).get<double>()};
}

} // namespace

std::string checkpoint_json(const rods::RodCheckpoint& checkpoint, const scene::Scene& scene,
                            const std::string& field) {
    return json_text(json{{"key", key_of(scene, field)},
                          {"time", checkpoint.time},
                          {"state", checkpoint.state},
                          {"headings", checkpoint.headings},
                          {"times", checkpoint.times},
                          {"outputs", checkpoint.outputs},
                          {"record", to_json(checkpoint.record)},
                          {"statistics", to_json(checkpoint.statistics)}});
}

std::optional<rods::RodCheckpoint> read_checkpoint(const std::filesystem::path& file,
                                                   const scene::Scene& scene, const std::string& field) try {
    std::ifstream in(file);
    if (!in)
        return std::nullopt;
    const json value = json::parse(in);
    if (value.at("key") != key_of(scene, field))
        return std::nullopt;
    const rods::RodCheckpoint checkpoint{value.at("time").get<double>(),
                                         value.at("state").get<std::vector<double>>(),
                                         value.at("headings").get<std::vector<double>>(),
                                         value.at("times").get<std::vector<double>>(),
                                         value.at("outputs").get<std::vector<std::vector<double>>>(),
                                         record_of(value.at("record")),
                                         statistics_of(value.at("statistics"))};
    const std::size_t rods = scene.rods.size(), size = 3 * rods;
    const bool dynamic = scene.medium && scene.medium->is_dynamic();
    bool good = checkpoint.state.size() == (dynamic ? medium::state_size(scene.medium->memory(), rods)
                                                    : rods::state_size(scene.rods_run->form, rods)) &&
                checkpoint.headings.size() == rods && checkpoint.outputs.size() == checkpoint.times.size() &&
                checkpoint.time >= 0.0 &&
                std::max(checkpoint.record.smallest.first, checkpoint.record.smallest.second) <
                    std::max<std::size_t>(rods, 1);
    for (const auto& output : checkpoint.outputs)
        good = good && output.size() == size;
    return good ? std::optional(checkpoint) : std::nullopt;
} catch (const json::exception&) {
    return std::nullopt;
}

} // namespace rodwake::app
