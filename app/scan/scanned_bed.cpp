#include "rodwake/app/scanned_bed.hpp"

#include "bed/granular_summary.hpp"
#include "rodwake/core/error.hpp"
#include "scan_parts.hpp"
#include "theory/pair_run.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

/// What a run wrote; of two rods with what became of the pair.
struct Finished {
    const RunTables& tables;
    PairNumbers pair;

    double summary(const std::string& name) const { return tables.summary(name, name); }
};

/// A number of a run: its column, and how it is made.
struct Observable {
    std::string name;
    std::function<double(const Finished&)> of;
};

constexpr std::size_t told_rods = 5; ///< rods with columns of their own

bool has_pair(const scene::Scene& scene) { return scene.granular->rods.size() == 2; }

Observable of_pair(const char* name, double PairNumbers::*number) {
    return {name, [number](const Finished& run) { return run.pair.*number; }};
}

std::vector<Observable> of_pair() {
    return {of_pair("time", &PairNumbers::outcome_time),
            of_pair("delta_y", &PairNumbers::half_box_change),
            of_pair("last_change", &PairNumbers::last_change),
            of_pair("separation", &PairNumbers::separation),
            of_pair("min_separation", &PairNumbers::min_separation),
            {"turn0", [](const Finished& run) { return run.pair.turn[0]; }},
            {"turn1", [](const Finished& run) { return run.pair.turn[1]; }},
            of_pair("non_reciprocity", &PairNumbers::non_reciprocity),
            {"leader", [](const Finished& run) { return static_cast<double>(run.pair.leader); }}};
}

/// The list of columns, in their order; "time" is the first.
std::vector<Observable> observables_of(const scene::Scene& scene) {
    std::vector<Observable> all = has_pair(scene) ? of_pair() : std::vector<Observable>{};
    const std::size_t rods = std::min(scene.granular->rods.size(), told_rods);
    for (const SummaryNumber& number : summary_numbers(rod_numbers(rods), false))
        if (!number.scan_column.empty() && !(has_pair(scene) && number.scan_column == all.front().name))
            all.push_back({number.scan_column,
                           [path = number.path](const Finished& run) { return run.summary(path); }});
    return all;
}

} // namespace

scan::Columns columns_of_beds(const scene::Scene& scene) {
    scan::Columns columns;
    if (has_pair(scene))
        for (const Ending ending : {Ending::contact, Ending::pursuit, Ending::escape, Ending::undecided})
            columns.outcomes.emplace_back(rodwake::to_string(ending));
    else
        columns.outcomes = {"finished"};
    for (const Observable& one : observables_of(scene))
        columns.observables.push_back(one.name);
    return columns;
}

std::vector<double> costs_of_beds(const ScanPlan& plan) {
    const scan::PointList points(plan.design);
    std::vector<double> costs(static_cast<std::size_t>(scan::places(plan.design)), 0.0);
    for (std::size_t place = 0; place < costs.size(); ++place)
        try {
            costs[place] =
                sphere_steps(scanned_bed(plan, points.at_place(static_cast<std::int64_t>(place))).problem);
        } catch (const InputError&) { // its point fails, with this cause
        }
    return costs;
}

BedPlan scanned_bed(const ScanPlan& plan, const scan::Point& point) {
    BedPlan bed{{"scene", "", "", plan.base}, {}, {}, {}};
    if (const auto wrong = set_point(plan, bed.of.scene, point))
        throw InputError(*wrong);
    bed.problem = granular_problem(bed.of.scene);
    std::erase(bed.of.scene.granular->output.formats, "xyz_if_short"); // one run is short, a thousand are not
    bed.schedule = granular_schedule(*bed.of.scene.granular, bed.problem);
    return bed;
}

BedYield yield_of(const scene::Scene& scene, const RunTables& run) {
    Finished finished{run, {}};
    BedYield yield;
    if (has_pair(scene)) {
        finished.pair = pair_numbers(scene, run);
        yield.outcome = static_cast<std::int32_t>(finished.pair.outcome);
    }
    for (const Observable& one : observables_of(scene))
        yield.values.push_back(one.of(finished));
    return yield;
}

} // namespace rodwake::app
