#include "granular_summary.hpp"

#include "rodwake/core/estimate.hpp"
#include "rodwake/store/csv.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

namespace rodwake::app {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

/// What was modelled; the same in both files.
ordered_json header(const BedPlan& bed) {
    const granular::GranularProblem& p = bed.problem;
    return {{"beads", p.beads},
            {"phi_b", phi_b(bed)},
            {"beads_fraction", granular::bead_area_fraction(p)},
            {"bead_radius", p.bead_radius},
            {"box", p.box.square() ? ordered_json(p.box.x) : ordered_json{p.box.x, p.box.y}},
            {"time_step", p.time_step},
            {"gamma", p.plates.gamma},
            {"frequency", p.plates.frequency},
            {"gap", p.plates.gap},
            {"orientation", p.orientation},
            {"seed", p.seed}};
}

ordered_json rods_json(const std::vector<RodSummary>& rods) {
    ordered_json list = ordered_json::array();
    for (const RodSummary& rod : rods)
        list.push_back({{"kind", rod.kind},
                        {"mean_speed", rod.mean_speed},
                        {"net_turn", rod.net_turn},
                        {"force", rod.force},
                        {"thrust", rod.thrust}});
    return list;
}

/// N/m; JSON has null for NaN.
constexpr std::array<const char*, 3> pressure_names{"xx", "xy", "yy"};

ordered_json pressure_json(const granular::PlaneTensor& pressure) {
    ordered_json out = {{"mean", granular::isotropic(pressure)}};
    for (std::size_t k = 0; k < pressure.size(); ++k)
        out[pressure_names[k]] = pressure[k];
    return out;
}

/// Unknown in files of earlier versions.
granular::PlaneTensor pressure_of(const json& summary) {
    granular::PlaneTensor pressure;
    pressure.fill(std::nan(""));
    if (summary.contains("pressure"))
        for (std::size_t k = 0; k < pressure.size(); ++k)
            if (const json& part = summary.at("pressure").at(pressure_names[k]); !part.is_null())
                pressure[k] = part;
    return pressure;
}

/// null where there is no pair, or it has not come half a box.
ordered_json pair_json(const granular::PairProgress& pair) {
    const bool there = pair.half_box_time >= 0.0;
    return {
        {"separation_change", pair.change},
        {"half_box_time", there ? ordered_json(pair.half_box_time) : ordered_json(nullptr)},
        {"half_box_separation_change", there ? ordered_json(pair.half_box_change) : ordered_json(nullptr)}};
}

template<class Get>
Estimate mean_over(std::span<const GranularSummary> runs, const Get& get) {
    std::vector<double> values;
    for (const GranularSummary& run : runs)
        values.push_back(get(run));
    return mean_of(values);
}

/// The error is null where one run is all there is.
template<class Get>
void put_mean(ordered_json& out, const std::string& name, std::span<const GranularSummary> runs,
              const Get& get) {
    const Estimate mean = mean_over(runs, get);
    out[name] = mean.value;
    out[name + "_error"] = mean.known() ? ordered_json(mean.error) : ordered_json(nullptr);
}

ordered_json mean_pressure(std::span<const GranularSummary> runs) {
    ordered_json out;
    put_mean(out, "mean", runs, [](const GranularSummary& s) { return granular::isotropic(s.pressure); });
    for (std::size_t k = 0; k < pressure_names.size(); ++k)
        put_mean(out, pressure_names[k], runs, [k](const GranularSummary& s) { return s.pressure[k]; });
    return out;
}

ordered_json mean_rods(const granular::GranularProblem& problem, std::span<const GranularSummary> runs) {
    ordered_json list = ordered_json::array();
    for (std::size_t i = 0; i < problem.rods.size(); ++i) {
        ordered_json rod = {{"kind", runs[0].rods[i].kind}};
        put_mean(rod, "mean_speed", runs, [i](const GranularSummary& s) { return s.rods[i].mean_speed; });
        put_mean(rod, "net_turn", runs, [i](const GranularSummary& s) { return s.rods[i].net_turn; });
        put_mean(rod, "force", runs, [i](const GranularSummary& s) { return s.rods[i].force; });
        put_mean(rod, "thrust", runs, [i](const GranularSummary& s) { return s.rods[i].thrust; });
        list.push_back(rod);
    }
    return list;
}

ordered_json mean_pair(std::span<const GranularSummary> runs) {
    ordered_json pair;
    put_mean(pair, "separation_change", runs, [](const GranularSummary& s) { return s.pair.change; });
    std::vector<GranularSummary> far;
    for (const GranularSummary& run : runs)
        if (run.pair.half_box_time >= 0.0)
            far.push_back(run);
    pair["half_box_runs"] = far.size();
    if (!far.empty()) {
        put_mean(pair, "half_box_time", far, [](const GranularSummary& s) { return s.pair.half_box_time; });
        put_mean(pair, "half_box_separation_change", far,
                 [](const GranularSummary& s) { return s.pair.half_box_change; });
    }
    return pair;
}

/// Seconds of wall clock.
ordered_json cost_json(const RunCost& cost) {
    ordered_json parts;
    for (const CostPart& part : cost_parts)
        parts[part.name] = cost.*part.seconds;
    parts["particle_steps"] = cost.particle_steps;
    parts["particle_steps_per_second"] = cost.particle_steps_per_second();
    return parts;
}

RunCost cost_of(const json& j) {
    RunCost cost;
    for (const CostPart& part : cost_parts)
        cost.*part.seconds = j.at(part.name);
    cost.particle_steps = j.at("particle_steps");
    return cost;
}

GranularSummary summary_of(const json& j, std::uint32_t run) {
    GranularSummary s;
    s.run = run;
    s.simulated_time = j.at("simulated_time");
    s.cpu_seconds = j.at("cpu_seconds");
    s.wall_seconds = j.at("wall_seconds");
    s.T_xy = j.at("T_xy");
    s.T_z = j.at("T_z");
    s.max_overlap = j.at("max_overlap");
    s.psi6 = j.at("psi6");
    s.pressure = pressure_of(j);
    s.absorbing_state = j.at("absorbing_state");
    for (const json& rod : j.at("rods"))
        s.rods.push_back(
            {rod.at("kind"), rod.at("mean_speed"), rod.at("net_turn"), rod.at("force"), rod.at("thrust")});
    s.pair.half_box_time = -1.0;
    if (j.contains("pair")) {
        const json& pair = j.at("pair");
        s.pair.change = pair.at("separation_change");
        if (!pair.at("half_box_time").is_null()) {
            s.pair.half_box_time = pair.at("half_box_time");
            s.pair.half_box_change = pair.at("half_box_separation_change");
        }
    }
    s.state_hash = std::stoull(j.at("state_hash").get<std::string>(), nullptr, 16);
    if (j.contains("cost")) // not in files of earlier versions
        s.cost = cost_of(j.at("cost"));
    return s;
}

} // namespace

RunCost cost_of(std::span<const GranularSummary> runs) {
    RunCost all;
    for (const GranularSummary& run : runs)
        all += run.cost;
    return all;
}

double phi_b(const BedPlan& bed) {
    return bed.of.scene.granular->phi_b.value_or(granular::bead_area_fraction(bed.problem));
}

std::string summary_json(const BedPlan& bed, const GranularSummary& s) {
    ordered_json out = {{"simulated_time", s.simulated_time},
                        {"cpu_seconds", s.cpu_seconds},
                        {"wall_seconds", s.wall_seconds},
                        {"T_xy", s.T_xy},
                        {"T_z", s.T_z},
                        {"max_overlap", s.max_overlap},
                        {"psi6", s.psi6},
                        {"pressure", pressure_json(s.pressure)},
                        {"absorbing_state", s.absorbing_state},
                        {"rods", rods_json(s.rods)}};
    if (bed.problem.rods.size() == 2)
        out["pair"] = pair_json(s.pair);
    out["state_hash"] = hash_text(s.state_hash);
    out["run"] = s.run + 1; // as its folder
    out["runs"] = 1;
    out.update(header(bed));
    out["cost"] = cost_json(s.cost);
    return out.dump(2) + "\n";
}

std::string ensemble_json(const BedPlan& bed, std::span<const GranularSummary> runs, std::size_t asked) {
    ordered_json out;
    put_mean(out, "simulated_time", runs, [](const GranularSummary& s) { return s.simulated_time; });
    const double count = static_cast<double>(runs.size());
    out["cpu_seconds"] =
        mean_over(runs, [](const GranularSummary& s) { return s.cpu_seconds; }).value * count;
    out["wall_seconds"] =
        mean_over(runs, [](const GranularSummary& s) { return s.wall_seconds; }).value * count;
    put_mean(out, "T_xy", runs, [](const GranularSummary& s) { return s.T_xy; });
    put_mean(out, "T_z", runs, [](const GranularSummary& s) { return s.T_z; });
    put_mean(out, "psi6", runs, [](const GranularSummary& s) { return s.psi6; });
    out["pressure"] = mean_pressure(runs);
    double worst = 0.0;
    std::vector<std::uint64_t> hashes;
    for (const GranularSummary& s : runs) {
        worst = std::max(worst, s.max_overlap);
        hashes.push_back(s.state_hash);
    }
    out["max_overlap"] = worst;
    out["absorbing_runs"] = std::ranges::count(runs, true, &GranularSummary::absorbing_state);
    out["rods"] = mean_rods(bed.problem, runs);
    if (bed.problem.rods.size() == 2)
        out["pair"] = mean_pair(runs);
    out["state_hash"] = hash_text(granular::combined_hash(hashes));
    out["runs"] = asked;
    out["finished_runs"] = runs.size();
    out.update(header(bed));
    out["cost"] = cost_json(cost_of(runs));
    return out.dump(2) + "\n";
}

std::string ensemble_csv(const granular::GranularProblem& problem, std::span<const GranularSummary> runs) {
    std::vector<std::string> names = {"run",  "simulated_time", "cpu_seconds", "T_xy", "T_z",
                                      "psi6", "max_overlap",    "p_xx",        "p_xy", "p_yy"};
    for (std::size_t i = 0; i < problem.rods.size(); ++i)
        for (const char* name : {"mean_speed", "net_turn", "force", "thrust"})
            names.push_back(fmt::format("{}{}", name, i));
    const bool pair = problem.rods.size() == 2;
    if (pair)
        names.insert(names.end(), {"separation_change", "half_box_time", "half_box_separation_change"});
    std::vector<std::vector<double>> columns(names.size());
    for (const GranularSummary& s : runs) {
        std::vector<double> row = {static_cast<double>(s.run + 1),
                                   s.simulated_time,
                                   s.cpu_seconds,
                                   s.T_xy,
                                   s.T_z,
                                   s.psi6,
                                   s.max_overlap,
                                   s.pressure[0],
                                   s.pressure[1],
                                   s.pressure[2]};
        for (const RodSummary& rod : s.rods)
            row.insert(row.end(), {rod.mean_speed, rod.net_turn, rod.force, rod.thrust});
        const double none = std::nan("");
        const bool far = s.pair.half_box_time >= 0.0;
        if (pair)
            row.insert(row.end(), {s.pair.change, far ? s.pair.half_box_time : none,
                                   far ? s.pair.half_box_change : none});
        for (std::size_t k = 0; k < row.size(); ++k)
            columns[k].push_back(row[k]);
    }
    return store::to_csv(names, columns);
}

std::optional<GranularSummary> read_summary(const std::filesystem::path& file,
                                            const granular::GranularProblem& problem, std::uint32_t run) {
    std::ifstream in(file);
    const json parsed = json::parse(in, nullptr, false);
    if (!parsed.is_object())
        return std::nullopt;
    try {
        GranularSummary summary = summary_of(parsed, run);
        return summary.rods.size() == problem.rods.size() ? std::optional(std::move(summary)) : std::nullopt;
    } catch (const std::exception&) { // a file of another version: the run is done again
        return std::nullopt;
    }
}

} // namespace rodwake::app
