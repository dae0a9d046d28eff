#include "scan_values.hpp"

#include "bed/granular_summary.hpp"
#include "bed/run_tables.hpp"
#include "run/record_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

namespace rodwake::app {

namespace {

/// (|turn of the rear rod| - |turn of the front rod|)/(their sum); NaN without a common heading, or if nobody
/// turned.
double non_reciprocity(std::span<const double> first, const rods::Box& box, const RelativeDisplacement& ahead,
                       std::span<const double> turn) {
    const rods::Offset d = rods::offset(first, 0, 1, box);
    const PairFrame course(first[2], first[5], d.x, d.y);
    if (!course.common())
        return std::nan("");
    const std::size_t front = course.ahead(d.x + ahead.x, d.y + ahead.y) >= 0.0 ? 0 : 1;
    const double of_front = std::abs(turn[front]), of_rear = std::abs(turn[1 - front]);
    constexpr double nothing = 1e-9; // rad
    return of_front + of_rear > nothing ? (of_rear - of_front) / (of_rear + of_front) : std::nan("");
}

void put_pair(EncounterEnd& end, integrate::State y, const rods::Separation& pair, const rods::Box& box) {
    const rods::Offset d = rods::offset(y, pair.first, pair.second, box);
    end.separation = std::hypot(d.x, d.y);
    end.angle = angle_between(y[3 * pair.first + 2], y[3 * pair.second + 2]);
}

} // namespace

void FrontRodTracker::add(integrate::State y) {
    const double turned = std::abs(y[2] - first_[2]) + std::abs(y[5] - first_[5]);
    if (turned <= most_)
        return;
    most_ = turned;
    // moved since the start, so that images in a box do not matter
    ahead_ = {y[0] - y[3] - first_[0] + first_[3], y[1] - y[4] - first_[1] + first_[4]};
}

EncounterEnd end_of(const rods::RodProblem& problem, const rods::RodResult& run,
                    const RelativeDisplacement& ahead) {
    const rods::RodOutcome& outcome = run.outcome;
    EncounterEnd end{outcome.ending, outcome.time, outcome.min_separation, outcome.min_separation_time,
                     outcome.turn};
    end.non_reciprocity = problem.rods.size() == 2 ? non_reciprocity(rods::to_state(problem.rods),
                                                                     problem.box, ahead, outcome.turn)
                                                   : std::nan("");
    put_pair(end, run.solution.final_state, outcome.pair, problem.box);
    end.steps = run.solution.statistics.steps;
    end.rhs_evaluations = run.solution.statistics.rhs_evaluations;
    end.certificate = static_cast<double>(outcome.certificate);
    end.pair = outcome.pair;
    end.failed = outcome.failed;
    if (outcome.ending == Ending::orbit)
        end.orbit_separation = outcome.separation, end.omega = outcome.omega;
    return end;
}

EncounterEnd end_of(const rods::PairProblem& pair, const rods::PairResult& run) {
    EncounterEnd end{
        run.ending, run.time, run.min_separation, run.min_separation_time, {run.turn[0], run.turn[1]}};
    end.non_reciprocity =
        non_reciprocity(rods::to_state(pair.rods), {}, {run.ahead_x, run.ahead_y}, run.turn);
    put_pair(end, run.state, {0, 1, run.separation}, {});
    end.steps = run.steps;
    end.rhs_evaluations = run.rhs_evaluations;
    end.certificate = static_cast<double>(run.certificate);
    end.orbit_separation = run.orbit_separation, end.omega = run.omega;
    return end;
}

void store(const EncounterEnd& end, const ScanPlan& plan, const OutputUnits& units, scan::Result& result) {
    result.status = scan::Status::ok;
    result.outcome = static_cast<std::int32_t>(end.ending);
    if (plan.decide)
        result.set_cause(end.failed);
    std::size_t next = 0; // the order of ScanPlan's columns is that of the description
    for_each_number(end, told_turns, [&](const auto& field, int, double number) {
        const double unit = field.info.unit == "{scan time}"         ? units.time
                            : field.info.unit == "{scan length}"     ? units.length
                            : field.info.unit == "rad/({scan time})" ? 1.0 / units.time
                                                                     : 1.0;
        result.values[next++] = number * unit;
    });
    if (plan.base.rods.size() > 2) {
        const bool met = is_capture(end.ending);
        for (const std::size_t rod : {end.pair.first, end.pair.second})
            result.values[next++] = met ? static_cast<double>(rod) : std::nan("");
    }
    for (std::size_t k = 0; k < plan.columns.observables.size(); ++k)
        if (const std::string& name = plan.columns.observables[k];
            !std::isfinite(result.values[k]) && name != "non_reciprocity" && name != "separation" &&
            name != "omega" && !name.starts_with("pair_")) {
            result.status = scan::Status::not_finite;
            result.set_cause(name + " is not finite");
        }
}

namespace {

constexpr ColumnInfo others[] = {
    {"outcome", "1",
     "contact, pursuit, escape, undecided, orbit or bound, of beds without a pair finished; of several runs "
     "the "
     "most "
     "frequent (empty: the point failed)"},
    {"status", "1", "ok, failed, time_limit, not_finite or exception; of several runs ok if one finished"},
    {"retries", "1", "attempts before the last"},
    {"point", "1", "number of the point, from 1, as its folder"},
    {"run", "1", "number of the run, from 1, as its folder"},
    {"runs", "1", "runs that finished, over which the row has means"},
    {"failed_runs", "1", "runs that failed"},
    {"delta_y_runs", "1", "runs that came half a box"},
    {"contact", "1", "share of the runs"},
    {"pursuit", "1", "share of the runs"},
    {"escape", "1", "share of the runs"},
    {"undecided", "1", "share of the runs"},
    {"<k>_low", "1", "lower end of the 95 % interval of the share (Clopper and Pearson)"},
    {"<k>_high", "1", "upper end of the 95 % interval of the share (Clopper and Pearson)"}};

} // namespace

std::span<const ColumnInfo> scan_columns() {
    // The numbers of a point, of several runs their means: of rods, and of beds those of their rods and of
    // their summaries.
    static const std::vector<ColumnInfo> columns = [] {
        std::vector<ColumnInfo> numbers, of_beds;
        add_number_columns<EncounterEnd>(numbers);
        add_number_columns<MetPair>(numbers);
        add_number_columns<CaptureNumbers>(numbers);
        add_number_columns<PairNumbers>(of_beds);
        for (const SummaryNumber& number : summary_numbers({"<k>"}, true))
            if (!number.scan_column.empty())
                of_beds.push_back(column_info(number.scan_column, number.unit, number.meaning));
        for (const ColumnInfo& column : of_beds)
            if (std::ranges::find(numbers, column.name, &ColumnInfo::name) == numbers.end())
                numbers.push_back(column);
        std::vector<ColumnInfo> all(std::begin(others), std::end(others));
        for (const ColumnInfo& column : numbers) {
            all.push_back(column);
            all.push_back(column_info(std::string(column.name) + "_error", column.unit,
                                      "standard error of the mean (empty: unknown)"));
        }
        return all;
    }();
    return columns;
}

} // namespace rodwake::app
