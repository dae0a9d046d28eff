#include "encounter.hpp"

#include "explicit_run.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace rodwake::app {

namespace {

// Steps that an encounter may take, and a cell of a diagram that the kernels do not take: about a second, and
// a tenth of one, in a browser.
constexpr long most_attempts = 100'000, most_attempts_of_cell = 5'000;

void check_rtol(double rtol) {
    if (!(rtol >= 1e-13 && rtol <= 0.1))
        throw InputError(fmt::format("rtol = {}: must be in [1e-13, 0.1]", rtol));
}

void add_row(std::vector<double>& rows, double time, integrate::State y, integrate::State rates) {
    rows.push_back(time);
    rows.insert(rows.end(), y.begin(), y.end());
    for (std::size_t i = 2; i < rates.size(); i += 3)
        rows.push_back(rates[i]);
}

/// Nothing if the kernels hand the pair over.
bool by_kernels(const rods::RodProblem& problem, double rtol, EncounterPath& encounter) {
    const auto pair = rods::to_pair_problem(problem);
    if (!pair || rods::contact_at_start(problem))
        return false;
    rods::PairOptions options{rtol, 0.01 * rtol};
    options.max_attempts = most_attempts;
    // Callbacks of steps do not know the rates of a pair's start.
    const std::vector<double> start = rods::to_state(problem.rods);
    std::vector<double> rates(start.size());
    model_on_plane(problem).rhs(start, rates);
    add_row(encounter.rows, 0.0, start, rates);
    options.on_step = [&](std::size_t, const rods::PairStep& step) {
        add_row(encounter.rows, step.time, step.state, step.rate);
    };
    rods::PairResult result;
    rods::simulate_pairs({&*pair, 1}, options, {&result, 1});
    if (result.end == rods::PairEnding::too_many_steps)
        throw too_stiff(most_attempts, result.time);
    if (result.handed_over()) {
        encounter.rows.clear();
        return false;
    }
    encounter.outcome = rods::outcome_of(*pair, result);
    return true;
}

EncounterSummary summary_of(const rods::RodOutcome& outcome) {
    EncounterSummary end{outcome.ending, outcome.time, outcome.min_separation};
    for (std::size_t rod = 0; rod < 2 && rod < outcome.turn.size(); ++rod)
        end.turn[rod] = outcome.turn[rod];
    return end;
}

EncounterSummary summary_of(const rods::PairResult& result) {
    return {result.ending, result.time, result.min_separation, {result.turn[0], result.turn[1]}};
}

/// By itself, whatever it is.
EncounterSummary end_alone(const rods::RodProblem& problem, double rtol) {
    try {
        return summary_of(explicit_run(problem, rtol, most_attempts_of_cell, [](auto&&...) {}));
    } catch (const std::exception&) { // one bad cell must not cost the others
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        return {Ending::undecided, nan, nan};
    }
}

} // namespace

EncounterPath encounter(const rods::RodProblem& problem, double rtol) {
    check_rtol(rtol);
    EncounterPath encounter;
    encounter.rods = problem.rods.size();
    if (!by_kernels(problem, rtol, encounter))
        encounter.outcome = explicit_run(problem, rtol, most_attempts, [&](double time, auto y, auto rates) {
            add_row(encounter.rows, time, y, rates);
        });
    return encounter;
}

void encounters(std::span<const rods::RodProblem> problems, double rtol, std::span<EncounterSummary> ends) {
    check_rtol(rtol);
    std::vector<rods::PairProblem> pairs;
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < problems.size(); ++i) {
        std::optional<rods::PairProblem> pair;
        try {
            pair = rods::to_pair_problem(problems[i]);
            if (pair)
                rods::validate(*pair);
        } catch (const InputError&) {
            pair.reset();
        }
        if (pair) {
            pairs.push_back(*pair);
            indices.push_back(i);
        } else {
            ends[i] = end_alone(problems[i], rtol);
        }
    }
    std::vector<rods::PairResult> results(pairs.size());
    rods::simulate_pairs(pairs, {rtol, 0.01 * rtol}, results);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t k = 0; k < pairs.size(); ++k)
        ends[indices[k]] =
            results[k].end == rods::PairEnding::too_many_steps // nor would the solver of one do
                ? EncounterSummary{Ending::undecided, nan, nan}
                : results[k].handed_over() ? end_alone(problems[indices[k]], rtol) : summary_of(results[k]);
}

void wakes(const elastic::Medium& medium, std::span<const elastic::Source> rods, elastic::FieldPoints points,
           const WakeColumns& columns) {
    const elastic::WakeKernel kernel(medium);
    std::vector<double> x(points.x.begin(), points.x.end());
    std::vector<std::size_t> at_rod;
    for (std::size_t i = 0; i < x.size(); ++i)
        for (const elastic::Source& rod : rods)
            if (std::hypot(x[i] - rod.x, points.y[i] - rod.y) < 1e-9) { // no number there: moved aside
                at_rod.push_back(i);
                x[i] += 1e-6;
            }
    kernel.strain_and_polar(rods, {x, points.y}, columns.strain, columns.polar);
    const elastic::Field field(medium);
    for (std::size_t i = 0; i < columns.displacement_x.size(); ++i) {
        const auto u =
            elastic::superpose(field, rods, x[i], points.y[i], {.displacement = true}).displacement;
        columns.displacement_x[i] = u.x;
        columns.displacement_y[i] = u.y;
    }
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (const std::size_t i : at_rod)
        for (const std::span<double> column :
             {columns.strain.xx, columns.strain.xy, columns.strain.yy, columns.polar.laplacian_x,
              columns.polar.laplacian_y, columns.polar.gradient_x, columns.polar.gradient_y,
              columns.displacement_x, columns.displacement_y})
            if (!column.empty())
                column[i] = nan;
}

} // namespace rodwake::app
