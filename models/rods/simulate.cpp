#include "rodwake/rods/simulate.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace rodwake::rods {

namespace {

using integrate::State;

void validate(const RodProblem& problem) {
    if (problem.rods.empty())
        throw InputError("no rods: give at least one");
    if (!(problem.t_end > 0.0 && std::isfinite(problem.t_end)))
        throw InputError(fmt::format("t_end = {}: must be > 0 and finite", problem.t_end));
    if (problem.rods.size() < 2)
        return;
    const Separation pair = closest_pair(to_state(problem.rods));
    if (!(pair.distance > 0.0))
        throw InputError(
            fmt::format("rods[{}] and rods[{}] are in the same place: their fields are singular there",
                        pair.first, pair.second));
    if (problem.contact_distance && !(*problem.contact_distance < pair.distance))
        throw InputError(
            fmt::format("contact_distance = {}: must be below the smallest starting separation, {} "
                        "between rods[{}] and rods[{}]",
                        *problem.contact_distance, pair.distance, pair.first, pair.second));
}

integrate::Event contact_event(double distance) {
    integrate::Event event;
    event.name = "contact";
    event.value = [distance](double, State y) { return closest_pair(y).distance - distance; };
    event.crossing = integrate::Crossing::falling;
    event.terminal = true;
    event.suspect = [distance](const integrate::Step& step) -> std::optional<double> {
        const auto approach = closest_approach(step);
        return approach && approach->pair.distance < distance ? std::optional(approach->time) : std::nullopt;
    };
    return event;
}

std::vector<double> output_times(const RodProblem& problem) {
    std::vector<double> times = problem.output_times;
    if (times.empty() || times.back() < problem.t_end)
        times.push_back(problem.t_end);
    return times;
}

/// Follows the separations along the run: the smallest of all, and each pair's range over the last part.
class SeparationRecord {
public:
    SeparationRecord(State start, double late_from) : late_from_(late_from) {
        if (start.size() > 3) {
            rods_ = start.size() / 3;
            smallest_ = closest_pair(start);
            late_.assign(rods_ * rods_, {std::numeric_limits<double>::infinity(), 0.0});
        }
    }

    void add(const integrate::Step& step) {
        if (rods_ == 0)
            return;
        keep_smaller(closest_pair(step.state));
        if (const auto approach = closest_approach(step))
            keep_smaller(approach->pair);
        if (step.time >= late_from_)
            add_late(step.state);
    }

    void keep_smaller(const Separation& pair) {
        if (pair.distance < smallest_.distance)
            smallest_ = pair;
    }

    void add_late(State y) {
        for (std::size_t a = 0; a < rods_; ++a)
            for (std::size_t b = a + 1; b < rods_; ++b) {
                const double r = std::hypot(y[3 * a] - y[3 * b], y[3 * a + 1] - y[3 * b + 1]);
                PairHistory& range = late_[a * rods_ + b];
                range = {std::min(range.min_late, r), std::max(range.max_late, r)};
            }
    }

    const Separation& smallest() const { return smallest_; }
    const PairHistory& late(std::size_t a, std::size_t b) const { return late_[a * rods_ + b]; }

private:
    std::size_t rods_ = 0;
    double late_from_;
    Separation smallest_{0, 0, std::numeric_limits<double>::infinity()};
    std::vector<PairHistory> late_;
};

void describe(RodOutcome& outcome, std::size_t rods, const integrate::Status& status) {
    if (!status.ok())
        outcome.reason = "the integration stopped early";
    else if (status.outcome == integrate::Outcome::interrupted)
        outcome.reason = fmt::format("interrupted at t = {:.6g}", outcome.time);
    else if (rods < 2)
        outcome.reason = "a single rod has no partner";
    else if (outcome.ending == Ending::contact)
        outcome.reason = fmt::format("rods {} and {} came within {:.6g} at t = {:.6g}", outcome.pair.first,
                                     outcome.pair.second, outcome.pair.distance, outcome.time);
    else if (outcome.ending == Ending::pursuit)
        outcome.reason = fmt::format("rods {} and {} share a heading and keep their distance of {:.6g}",
                                     outcome.pair.first, outcome.pair.second, outcome.pair.distance);
    else if (outcome.ending == Ending::escape)
        outcome.reason = fmt::format("all rods part; rods {} and {} came closest, {:.6g} apart",
                                     outcome.pair.first, outcome.pair.second, outcome.min_separation);
    else
        outcome.reason =
            fmt::format("neither contact, locked pursuit nor parting by t = {:.6g}; a longer t_end may "
                        "decide",
                        outcome.time);
}

/// Ending of all pairs together; sets the pair it is about.
void classify(RodOutcome& outcome, const RodModel& model, State y, const SeparationRecord& record,
              const EndingCriteria& criteria) {
    std::vector<double> ydot(y.size());
    model.rhs(y, ydot);
    bool all_escape = true;
    for (std::size_t a = 0; a < model.rods(); ++a)
        for (std::size_t b = a + 1; b < model.rods(); ++b) {
            const Ending ending = classify_pair(y, ydot, a, b, record.late(a, b), criteria);
            all_escape = all_escape && ending == Ending::escape;
            if (ending == Ending::pursuit && outcome.ending != Ending::pursuit) {
                outcome.ending = Ending::pursuit;
                outcome.pair = {a, b, std::hypot(y[3 * a] - y[3 * b], y[3 * a + 1] - y[3 * b + 1])};
            }
        }
    if (all_escape)
        outcome.ending = Ending::escape;
}

RodOutcome conclude(const RodProblem& problem, const RodModel& model, const integrate::Solution& solution,
                    SeparationRecord& record, const EndingCriteria& criteria) {
    const State y = solution.final_state;
    RodOutcome outcome;
    outcome.time = solution.final_time;
    for (std::size_t a = 0; a < model.rods(); ++a)
        outcome.turn.push_back(y[3 * a + 2] - problem.rods[a].heading);
    const bool contact = solution.status.outcome == integrate::Outcome::stopped_at_event;
    if (model.rods() > 1) {
        record.add_late(y);
        outcome.pair = contact ? closest_pair(y) : record.smallest();
    }
    outcome.min_separation = contact ? outcome.pair.distance : record.smallest().distance;
    if (contact)
        outcome.ending = Ending::contact;
    else if (solution.status.outcome == integrate::Outcome::reached_end && model.rods() > 1)
        classify(outcome, model, y, record, criteria);
    describe(outcome, model.rods(), solution.status);
    return outcome;
}

} // namespace

integrate::OdeProblem to_ode(const RodProblem& problem) {
    validate(problem);
    const auto model =
        std::make_shared<const RodModel>(problem.medium, problem.couplings, problem.rods.size());
    integrate::OdeProblem ode;
    ode.initial_state = to_state(problem.rods);
    ode.rhs = [model](double, State y, std::span<double> ydot) { model->rhs(y, ydot); };
    ode.jacobian = [model](double, State y, Eigen::Ref<Eigen::MatrixXd> j) { model->jacobian(y, j); };
    ode.component_name = RodModel::component_name;
    ode.relative_cap = 1.0; // f/mu and rad: the plane has no origin and headings no zero
    if (problem.contact_distance && problem.rods.size() > 1)
        ode.events.push_back(contact_event(*problem.contact_distance));
    return ode;
}

RodResult simulate(const RodProblem& problem, const RodOptions& options) {
    const integrate::OdeProblem ode = to_ode(problem);
    SeparationRecord record(ode.initial_state, (1.0 - options.criteria.steady_fraction) * problem.t_end);
    integrate::OdeOptions solver = options.ode;
    solver.on_step = [&](const integrate::Step& step) {
        record.add(step);
        if (options.ode.on_step)
            options.ode.on_step(step);
    };
    RodResult result;
    result.solution = integrate::solve(ode, solver, output_times(problem));
    const RodModel model(problem.medium, problem.couplings, problem.rods.size());
    result.outcome = conclude(problem, model, result.solution, record, options.criteria);
    return result;
}

} // namespace rodwake::rods
