#include "rodwake/app/scanned_bed.hpp"

#include "bed/granular_summary.hpp"
#include "bed/run_tables.hpp"
#include "rodwake/core/error.hpp"
#include "run/record_table.hpp"
#include "scan_parts.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

constexpr std::size_t told_rods = 5; ///< rods with columns of their own

bool has_pair(const scene::Scene& scene) { return scene.granular->rods.size() == 2; }

/// What the summary of a run tells behind the numbers of a pair, which have a time of their own.
std::vector<SummaryNumber> told_numbers(const scene::Scene& scene) {
    std::vector<SummaryNumber> told =
        summary_numbers(rod_numbers(std::min(scene.granular->rods.size(), told_rods)), false);
    const std::string_view time = field_names<PairNumbers>().front();
    std::erase_if(told, [&](const SummaryNumber& number) {
        return number.scan_column.empty() || (has_pair(scene) && number.scan_column == time);
    });
    return told;
}

} // namespace

scan::Columns columns_of_beds(const scene::Scene& scene) {
    scan::Columns columns;
    if (has_pair(scene))
        for (const Ending ending : all_endings)
            columns.outcomes.emplace_back(rodwake::to_string(ending));
    else
        columns.outcomes = {"finished"};
    if (has_pair(scene))
        for_each_number(PairNumbers{}, 2, [&](const auto& field, int rod, double) {
            columns.observables.push_back(numbered(field.name, rod));
        });
    for (const SummaryNumber& number : told_numbers(scene))
        columns.observables.push_back(number.scan_column);
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
    BedYield yield;
    if (has_pair(scene)) {
        const PairNumbers pair = pair_numbers(scene, run);
        yield.outcome = static_cast<std::int32_t>(pair.outcome);
        for_each_number(pair, 2, [&](const auto&, int, double number) { yield.values.push_back(number); });
    }
    for (const SummaryNumber& number : told_numbers(scene))
        yield.values.push_back(run.summary(number.path, number.path));
    return yield;
}

} // namespace rodwake::app
