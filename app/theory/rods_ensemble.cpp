#include "rods_ensemble.hpp"

#include "rodwake/core/estimate.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/rods/body_shape.hpp"
#include "rodwake/rods/separation.hpp"
#include "run/record_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::app {

namespace {
using rods::RodResult;

Spread spread_of(const std::vector<double>& values) {
    const Estimate mean = mean_of(values);
    Spread out;
    out.samples = values.size();
    if (!values.empty())
        out.mean = mean.value;
    if (mean.known() && !values.empty())
        out.spread = mean.error * std::sqrt(static_cast<double>(values.size()));
    return out;
}

} // namespace

std::vector<RodResult> run_ensemble(const rods::RodProblem& problem, const rods::RodOptions& options,
                                    const elastic::MeasuredDisplacement& measured,
                                    const scene::MeasuredMedium& keys, const RunContext& context) {
    rods::RodOptions each;
    each.form = options.form;
    each.ode = options.ode;
    each.ode.on_step = nullptr;
    each.criteria = options.criteria;
    std::vector<RodResult> samples(static_cast<std::size_t>(keys.samples));
    parallel_for(samples.size(), context.thread_count(), [&](std::size_t i) {
        rods::RodProblem drawn = problem;
        drawn.field =
            measured.drawn(static_cast<std::uint64_t>(keys.seed), static_cast<std::uint32_t>(i), problem.box);
        samples[i] = rods::simulate(drawn, each);
    });
    return context.stopped() ? std::vector<RodResult>{} : samples;
}

std::string ensemble_csv(const std::vector<RodResult>& samples, rods::Box box, const OutputUnits& units) {
    std::vector<DrawnRow> rows;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const RodResult& result = samples[i];
        const std::vector<double>& last = result.solution.final_state;
        const double separation = last.size() < 6 ? std::nan("") : rods::closest_pair(last, box).distance;
        rows.push_back({static_cast<double>(i),
                        result.solution.status.ok() ? ending_code(result.outcome.ending) : std::nan(""),
                        result.outcome.time * units.time, separation * units.length,
                        result.outcome.min_separation * units.length,
                        result.outcome.turn.empty() ? std::nan("") : result.outcome.turn.front()});
    }
    return csv_of(rows);
}

DrawnReport drawn_report(const std::vector<RodResult>& samples, rods::Box box, const OutputUnits& units) {
    DrawnReport report;
    report.samples = samples.size();
    std::vector<double> last, least, contacts;
    for (const RodResult& result : samples) {
        if (!result.solution.status.ok()) {
            ++report.failed;
            continue;
        }
        report.add(result.outcome.ending);
        if (result.solution.final_state.size() < 6)
            continue;
        last.push_back(rods::closest_pair(result.solution.final_state, box).distance * units.length);
        least.push_back(result.outcome.min_separation * units.length);
        if (result.outcome.ending == Ending::contact)
            contacts.push_back(result.outcome.time * units.time);
    }
    report.final_separation = spread_of(last);
    report.min_separation = spread_of(least);
    report.contact_time = spread_of(contacts);
    return report;
}

void store_ensemble(store::Hdf5Writer& results, const std::string& group,
                    const std::vector<RodResult>& samples, const std::vector<double>& times,
                    const OutputUnits& units) {
    const std::size_t rods = samples.front().solution.final_state.size() / 3;
    for (const std::size_t which : {0, 1}) {
        std::vector<double> values;
        for (const RodResult& result : samples)
            for (std::size_t t = 0; t < times.size(); ++t)
                for (std::size_t rod = 0; rod < rods; ++rod)
                    values.push_back(t < result.solution.states.size()
                                         ? result.solution.states[t][3 * rod + which] * units.length
                                         : std::nan(""));
        results.dataset(group + (which == 0 ? "/x" : "/y"), values, {samples.size(), times.size(), rods},
                        units.length_name);
    }
    std::vector<double> scaled = times;
    for (double& t : scaled)
        t *= units.time;
    results.dataset(group + "/t", scaled, {times.size()}, units.time_name);
}

void store_bodies(store::Hdf5Writer& results, const std::string& group, const rods::RodProblem& problem,
                  const OutputUnits& units) {
    const auto put = [&](const char* name, double unit, const std::string& unit_name, auto number) {
        std::vector<double> values;
        for (std::size_t rod = 0; rod < problem.rods.size(); ++rod)
            values.push_back(unit * static_cast<double>(problem.bodies.of(rod).*number));
        results.dataset(group + "/body/" + name, values, {values.size()}, unit_name);
    };
    if (problem.bodies.any()) {
        put("spheres", 1.0, "1", &rods::BodyShape::spheres);
        put("length", units.length, units.length_name, &rods::BodyShape::length);
        put("thick_diameter", units.length, units.length_name, &rods::BodyShape::thick_diameter);
        put("thin_diameter", units.length, units.length_name, &rods::BodyShape::thin_diameter);
    }
    if (problem.box)
        results.dataset(group + "/box",
                        std::array{problem.box->x * units.length, problem.box->y * units.length}, {2},
                        units.length_name);
}

} // namespace rodwake::app
