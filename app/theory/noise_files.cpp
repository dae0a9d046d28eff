// What an ensemble of rods that diffuse leaves: noise.json and ensemble.csv.

#include "noise_runs.hpp"
#include "rods_ensemble.hpp"
#include "rodwake/core/estimate.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"

#include <cmath>

namespace rodwake::app {

namespace {
using rods::NoiseSums;
using rods::NoisyEnd;

EndingCounts endings_of(const NoiseSums& sums) {
    EndingCounts counts;
    for (const NoisyEnd& end : sums.ends)
        if (end.failed)
            ++counts.failed;
        else
            counts.add(end.ending);
    return counts;
}

FirstContact first_contact(const NoiseSums& sums, const OutputUnits& units) {
    std::vector<double> times;
    for (const NoisyEnd& end : sums.ends)
        if (!end.failed && end.ending == Ending::contact)
            times.push_back(end.time * units.time);
    const Estimate mean = mean_of(times);
    FirstContact contact;
    contact.error = mean.error;
    contact.runs = times.size();
    if (!times.empty())
        contact.mean = mean.value;
    return contact;
}

void add_capture(NoiseReport& report, const NoiseSums& sums, std::size_t rods) {
    const scan::Proportion of = captured(sums, rods);
    if (of.of == 0) // a single rod captures none
        return;
    const auto [low, high] = of.wilson(capture_quantile);
    report.capture_probability = of.value();
    report.capture_low = low;
    report.capture_high = high;
}

std::vector<double> in_units_of(double unit, std::vector<double> values) {
    for (double& value : values)
        value *= unit;
    return values;
}

} // namespace

/// A list of rows.
static nlohmann::ordered_json member_json(const RodTable& table) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < table.values.size(); ++k) {
        if (k % table.rods == 0)
            rows.push_back(nlohmann::ordered_json::array());
        rows.back().push_back(finite_or_null(table.values[k]));
    }
    return rows;
}

scan::Proportion captured(const NoiseSums& sums, std::size_t rods) {
    const rods::CaptureCount counted = rods::count_captures(sums.ends, rods);
    return {counted.count, counted.of};
}

std::string noise_json(const NoiseSums& sums, const NoisePlan& plan, const rods::RodProblem& problem,
                       const OutputUnits& units) {
    const std::size_t rods = problem.rods.size();
    const double area = units.length * units.length;
    const rods::NoiseMeans square = rods::mean_square_displacement(sums),
                           cosine = rods::heading_correlation(sums);
    NoiseReport report;
    report.runs = sums.ends.size();
    add_capture(report, sums, rods);
    report.endings = endings_of(sums);
    report.first_contact_time = first_contact(sums, units);
    if (!sums.failure.empty())
        report.failure = sums.failure;
    report.rotational_diffusion = plan.noise.rotational / units.time;
    report.translational_diffusion = plan.noise.translational * units.length * units.length / units.time;
    report.speed = units.length / units.time;
    report.time_step = plan.noise.time_step * units.time;
    report.seed = plan.noise.seed;
    report.times = in_units_of(units.time, rods::stored_times(problem));
    report.runs_at_time = sums.reached;
    report.mean_square_displacement = {in_units_of(area, square.values), rods};
    report.mean_square_displacement_error = {in_units_of(area, square.errors), rods};
    report.heading_correlation = {cosine.values, rods};
    report.heading_correlation_error = {cosine.errors, rods};
    report.units = {units.length_name, units.time_name, {}};
    return record_json(report).dump(1) + "\n";
}

std::string noise_csv(const NoiseSums& sums, std::size_t rods, const OutputUnits& units) {
    const auto of_pair = [&](double value) { return rods > 1 ? value : std::nan(""); };
    std::vector<NoisyRow> rows;
    for (std::size_t i = 0; i < sums.ends.size(); ++i) {
        const NoisyEnd& end = sums.ends[i];
        rows.push_back({static_cast<double>(i), end.failed ? std::nan("") : ending_code(end.ending),
                        end.time * units.time, of_pair(end.min_separation * units.length),
                        of_pair(static_cast<double>(end.first)), of_pair(static_cast<double>(end.second))});
    }
    return csv_of(rows);
}

} // namespace rodwake::app
