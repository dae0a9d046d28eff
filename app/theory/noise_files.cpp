// What an ensemble of rods that diffuse leaves: noise.json and ensemble.csv.

#include "noise_runs.hpp"
#include "rods_ensemble.hpp"
#include "rodwake/core/estimate.hpp"
#include "rodwake/store/csv.hpp"
#include "run/values_json.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::app {

namespace {
using nlohmann::ordered_json;
using rods::NoiseSums;
using rods::NoisyEnd;

/// Numbers of [time][rod] as such a table.
ordered_json table_of(const std::vector<double>& values, std::size_t rods, double unit) {
    ordered_json table = ordered_json::array();
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (k % rods == 0)
            table.push_back(ordered_json::array());
        table.back().push_back(finite_or_null(unit * values[k]));
    }
    return table;
}

ordered_json endings_json(const NoiseSums& sums) {
    ordered_json json;
    for (const Ending ending : all_endings)
        json[to_string(ending)] = std::ranges::count_if(
            sums.ends, [&](const NoisyEnd& end) { return !end.failed && end.ending == ending; });
    json["failed"] = std::ranges::count_if(sums.ends, &NoisyEnd::failed);
    return json;
}

ordered_json contact_json(const NoiseSums& sums, const OutputUnits& units) {
    std::vector<double> times;
    for (const NoisyEnd& end : sums.ends)
        if (!end.failed && end.ending == Ending::contact)
            times.push_back(end.time * units.time);
    const Estimate mean = mean_of(times);
    return {{"mean", times.empty() ? ordered_json() : ordered_json(mean.value)},
            {"error", finite_or_null(mean.error)},
            {"runs", times.size()}};
}

void add_capture(ordered_json& json, const NoiseSums& sums, std::size_t rods) {
    const scan::Proportion of = captured(sums, rods);
    const auto [low, high] = of.wilson(capture_quantile);
    const bool any = of.of > 0; // a single rod captures none
    json["capture_probability"] = any ? ordered_json(of.value()) : ordered_json();
    json["capture_low"] = any ? ordered_json(low) : ordered_json();
    json["capture_high"] = any ? ordered_json(high) : ordered_json();
    json["capture_confidence"] = 0.95;
}

} // namespace

scan::Proportion captured(const NoiseSums& sums, std::size_t rods) {
    const rods::CaptureCount counted = rods::count_captures(sums.ends, rods);
    return {counted.count, counted.of};
}

std::string noise_json(const NoiseSums& sums, const NoisePlan& plan, const rods::RodProblem& problem,
                       const OutputUnits& units) {
    ordered_json json = {{"runs", sums.ends.size()}};
    add_capture(json, sums, problem.rods.size());
    json["endings"] = endings_json(sums);
    json["first_contact_time"] = contact_json(sums, units);
    if (!sums.failure.empty())
        json["failure"] = sums.failure;
    json["rotational_diffusion"] = plan.noise.rotational / units.time;
    json["translational_diffusion"] = plan.noise.translational * units.length * units.length / units.time;
    json["speed"] = units.length / units.time; // v0
    json["time_step"] = plan.noise.time_step * units.time;
    json["seed"] = plan.noise.seed;
    json["times"] = ordered_json::array();
    for (const double time : rods::stored_times(problem))
        json["times"].push_back(time * units.time);
    json["runs_at_time"] = sums.reached;
    const double area = units.length * units.length;
    const rods::NoiseMeans square = rods::mean_square_displacement(sums),
                           cosine = rods::heading_correlation(sums);
    const std::size_t rods = problem.rods.size();
    json["mean_square_displacement"] = table_of(square.values, rods, area);
    json["mean_square_displacement_error"] = table_of(square.errors, rods, area);
    json["heading_correlation"] = table_of(cosine.values, rods, 1.0);
    json["heading_correlation_error"] = table_of(cosine.errors, rods, 1.0);
    json["units"] = {{"length", units.length_name}, {"time", units.time_name}};
    return json.dump(1) + "\n";
}

std::string noise_csv(const NoiseSums& sums, std::size_t rods, const OutputUnits& units) {
    const std::vector<std::string> names = {"run", "outcome", "time", "min_separation", "first", "second"};
    std::vector<std::vector<double>> columns(names.size());
    const auto of_pair = [&](double value) { return rods > 1 ? value : std::nan(""); };
    for (std::size_t i = 0; i < sums.ends.size(); ++i) {
        const NoisyEnd& end = sums.ends[i];
        const auto ending = std::ranges::find(all_endings, end.ending) - all_endings.begin();
        const double row[] = {static_cast<double>(i),
                              end.failed ? std::nan("") : static_cast<double>(ending),
                              end.time * units.time,
                              of_pair(end.min_separation * units.length),
                              of_pair(static_cast<double>(end.first)),
                              of_pair(static_cast<double>(end.second))};
        for (std::size_t c = 0; c < columns.size(); ++c)
            columns[c].push_back(row[c]);
    }
    return store::to_csv(names, columns);
}

} // namespace rodwake::app
