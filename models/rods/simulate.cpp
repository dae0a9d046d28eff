#include "rodwake/rods/simulate.hpp"

#include "held_wakes.hpp"
#include "pose_track.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "straight_walkers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

namespace rodwake::rods {

using integrate::State;

double body_step(const BodyForces& bodies, State y) {
    return bodies.any() ? bodies.step_limit(y, y.size() / 3 > most_followed_rods ? 0.5 : 1.0 / 12.0)
                        : std::numeric_limits<double>::infinity();
}

std::function<double(double, State)> step_limit(const RodProblem& problem) {
    if (!problem.medium || has_wide_wakes(*problem.medium))
        return [box = problem.box](double, State y) { return encounter_step(y, box); };
    return [box = problem.box, medium = *problem.medium](double, State y) {
        return std::min(encounter_step(y, box), wake_step(y, medium, box));
    };
}

elastic::MutualWakesOptions sum_options(const Couplings& c, const InteractionOptions& sums) {
    const auto& [kappa, gamma1, gamma2] = c;
    const double polar = std::abs(gamma1) + std::abs(gamma2);
    const double share = (c.apolar() && c.polar() ? 0.5 : 1.0) * sums.turning_tolerance;
    elastic::MutualWakesOptions options{sums.accuracy, sums.threads, 0.0, 0.0};
    // nobody reads that sum
    constexpr double anything = 1e30;
    options.strain_tolerance = share == 0.0 ? 0.0
                               : c.apolar() ? std::numbers::sqrt2 * share / std::abs(kappa)
                                            : anything;
    options.polar_tolerance = share == 0.0 ? 0.0 : c.polar() ? share / polar : anything;
    return options;
}

std::shared_ptr<const elastic::WakeField> wakes_of(const RodProblem& problem) {
    if (!problem.medium)
        return nullptr;
    const bool asks_sums =
        problem.sums.turning_tolerance != 0.0 || problem.sums.accuracy != elastic::Accuracy::full;
    if (asks_sums && (problem.field || problem.box))
        throw InputError("turning_tolerance and accuracy of sums need the exact field on the plane");
    if (!problem.field)
        return elastic::exact_field(*problem.medium, problem.box,
                                    sum_options(problem.couplings, problem.sums));
    const elastic::Medium& of = problem.field->medium();
    if (of.eta != problem.medium->eta || of.xi != problem.medium->xi || problem.field->box() != problem.box)
        throw InputError("the field of the problem was made for another medium or box");
    return problem.field;
}

RodModel model_of(const RodProblem& problem) {
    return {problem.couplings.any() ? wakes_of(problem) : nullptr, problem.couplings, problem.rods.size(),
            problem.rows, BodyForces(problem.bodies, problem.rods.size(), problem.box)};
}

integrate::OdeProblem to_ode(const RodProblem& problem) {
    validate(problem);
    const auto model = std::make_shared<const RodModel>(model_of(problem));
    integrate::OdeProblem ode;
    ode.initial_state = to_state(problem.rods);
    ode.rhs = [model](double, State y, std::span<double> ydot) { model->rhs(y, ydot); };
    if (model->has_jacobian()) // else difference quotients
        // NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
        ode.jacobian = [model](double, State y, Eigen::Ref<Eigen::MatrixXd> j) { model->jacobian(y, j); };
    ode.component_name = RodModel::component_name;
    // in a box straight courses meet many images in one step
    const bool bodies = model->bodies().any();
    if (model->rods() > 1 && (model->interacting() || (problem.box && problem.contact_distance)))
        ode.step_limit = step_limit(problem);
    if (model->rods() > 1 && bodies)
        ode.step_limit = [model, others = ode.step_limit](double t, State y) {
            return std::min(body_step(model->bodies(), y),
                            others ? others(t, y) : std::numeric_limits<double>::infinity());
        };
    ode.relative_cap = 1.0; // f/mu and rad: the plane has no origin and headings no zero
    if (problem.contact_distance && problem.rods.size() > 1) {
        // The separation inside a step is known from the headings, unless bodies push rods aside: then it is
        // sampled.
        const double distance = *problem.contact_distance;
        integrate::Event contact;
        contact.name = "contact";
        contact.value = [distance, box = problem.box](double, State y) {
            return closest_pair(y, box).distance - distance;
        };
        contact.crossing = integrate::Crossing::falling;
        contact.terminal = true;
        contact.sampled = bodies;
        if (!bodies)
            contact.candidate_time = [distance, box = problem.box](const integrate::Step& step) {
                return first_approach_time(step, box, distance);
            };
        ode.events.push_back(std::move(contact));
    }
    return ode;
}

namespace {

RodCheckpoint beginning(const integrate::OdeProblem& ode, const RodProblem& problem,
                        const EndingCriteria& criteria) {
    const double tail_start = (1.0 - criteria.steady_fraction) * problem.t_end;
    RodCheckpoint start;
    start.time = ode.start_time;
    start.state = ode.initial_state;
    for (const Pose& rod : problem.rods)
        start.headings.push_back(rod.heading);
    start.record = start_record(to_state(problem.rods), tail_start, problem.box,
                                BodyForces(problem.bodies, problem.rods.size(), problem.box), problem.t_end);
    return start;
}

/// Without a contact distance a solver may step across the singularity of a head-on meeting. What follows is
/// no solution.
void refuse_passing(integrate::Solution& solution, const SeparationRecord& record, const RodProblem& problem,
                    double tolerance) {
    if (!solution.status.ok() || problem.contact_distance || problem.rods.size() < 2 ||
        !(problem.medium && problem.couplings.any()))
        return;
    const double first = closest_pair(to_state(problem.rods), problem.box).distance;
    const Separation& pair = record.smallest;
    if (pair.distance > passing_resolution(solution.final_state, first, tolerance))
        return;
    integrate::Status& status = solution.status;
    status.termination = integrate::Termination::failed;
    status.reached = record.smallest_time;
    status.wanted = problem.t_end;
    status.flag = "COLLISION";
    status.cause = fmt::format("rods[{}] and rods[{}] came within {:.3g}, and their fields are singular at "
                               "contact: how they pass is within the tolerance",
                               pair.first, pair.second, pair.distance);
    status.advice = "set rods_run.contact_distance, so that the run stops when two rods meet";
}

/// Poses instead of states of another form.
void to_poses(integrate::Solution& solution, const PoseTrack& track) {
    solution.states = track.outputs(solution.states);
    solution.final_state = track.poses(solution.final_state);
    for (integrate::EventHit& hit : solution.hits)
        hit.state = track.poses(hit.state);
}

/// The outputs of the run as a whole: those before the checkpoint, then those of the part just solved.
void prepend(integrate::Solution& part, const RodCheckpoint& from, const std::vector<double>& times) {
    const auto done = static_cast<std::ptrdiff_t>(from.outputs.size());
    part.times.insert(part.times.begin(), times.begin(), times.begin() + done);
    part.states.insert(part.states.begin(), from.outputs.begin(), from.outputs.end());
    part.statistics += from.statistics;
}

/// What is solved.
struct Equations {
    integrate::OdeProblem ode;
    StateRates rates;                             ///< in form angle
    bool interacting;                             ///< rods that do not cannot pursue each other
    bool singular;                                ///< fields are, where rods meet
    StateRates wakes = nullptr, others = nullptr; ///< of both kinds of steps, if wakes are held
};

RodResult solve_equations(const RodProblem& problem, const RodOptions& options, Equations equations) {
    integrate::OdeProblem& ode = equations.ode;
    const StateRates& rates = equations.rates;
    const RodCheckpoint from =
        options.resume_from ? *options.resume_from : beginning(ode, problem, options.criteria);
    ode.start_time = from.time;
    ode.initial_state = from.state;
    SeparationRecord record = from.record;
    const std::vector<double> times = output_times(problem);
    const BodyForces bodies(problem.bodies, problem.rods.size(), problem.box);
    const std::span<const double> times_left = std::span(times).subspan(from.outputs.size());
    PoseTrack track(options.form, from.headings, times_left);

    integrate::OdeOptions solver = options.ode;
    solver.atol = std::min(solver.atol, 0.1 * solver.rtol); // of coordinates of order 1: more would undo rtol
    // Segments short enough that a checkpoint comes every few seconds: a step costs N (N - 1) field points.
    const std::size_t rods = problem.rods.size();
    const double steps = 2e7 / static_cast<double>(std::max<std::size_t>(rods * rods, 1));
    solver.segment_steps =
        std::min(solver.segment_steps, static_cast<long>(std::clamp(steps, 200.0, 20000.0)));
    // Left alone, ARKODE starts at the time in which a coordinate that is 0 reaches its tolerance and needs
    // half a dozen steps to get going. Rods matter to each other on the scale of f/mu; too long a step is
    // rejected and costs one.
    if (solver.initial_step == 0.0 && solver.method == integrate::Method::erk)
        solver.initial_step = 0.01; // f/(mu v0)
    solver.on_step = [&](const integrate::Step& raw) {
        const integrate::Step step = track.step(raw);
        add_step(record, step, rates, problem.box, bodies);
        if (options.ode.on_step)
            options.ode.on_step(step);
    };
    const auto checkpoint = [&](const integrate::Segment& segment) {
        std::vector<std::vector<double>> outputs = from.outputs;
        const std::vector<std::vector<double>> added = track.outputs(segment.outputs);
        outputs.insert(outputs.end(), added.begin(), added.end());
        const auto done = static_cast<std::ptrdiff_t>(outputs.size());
        return RodCheckpoint{segment.time,
                             {segment.state.begin(), segment.state.end()},
                             track.headings(),
                             {times.begin(), times.begin() + done},
                             std::move(outputs),
                             record,
                             integrate::Statistics(from.statistics) += segment.statistics};
    };
    solver.on_segment = [&](const integrate::Segment& segment) {
        if (options.on_checkpoint)
            options.on_checkpoint(checkpoint(segment));
    };

    RodResult result;
    result.solution = equations.wakes ? solve_with_held_wakes(ode, equations.wakes, equations.others,
                                                              step_limit(problem), solver, times_left)
                                      : integrate::solve(ode, solver, times_left);
    const integrate::Solution& end = result.solution;
    if (options.on_end && end.status.termination == integrate::Termination::reached_end)
        options.on_end(checkpoint({end.final_time, end.final_state, end.states, end.statistics}));
    if (options.form != Formulation::angle)
        to_poses(result.solution, track);
    prepend(result.solution, from, times);
    if (equations.singular) {
        explain_collision(result.solution, problem.box);
        refuse_passing(result.solution, record, problem, solver.rtol + solver.atol); // relative_cap is 1
    }
    result.outcome = classify_outcome(problem, equations.interacting, rates, result.solution, record,
                                      options.criteria, TurnedBy::steady_wakes);
    result.record = std::move(record);
    return result;
}

} // namespace

std::optional<RodCheckpoint> carried_over(RodCheckpoint from, const RodProblem& problem,
                                          const EndingCriteria& criteria) {
    if (from.time >= problem.t_end)
        return std::nullopt;

    // Rows up to the checkpoint are those of the earlier run at the output times of this one.
    std::vector<double> times;
    std::vector<std::vector<double>> outputs;
    for (const double time : output_times(problem)) {
        if (time > from.time)
            break;
        const auto row = std::ranges::find_if(from.times, [&](double there) {
            return std::abs(there - time) <= 1e-14 * problem.t_end; // multiples of two intervals
        });
        if (row == from.times.end())
            return std::nullopt;
        times.push_back(time);
        outputs.push_back(from.outputs[static_cast<std::size_t>(row - from.times.begin())]);
    }
    from.times = std::move(times);
    from.outputs = std::move(outputs);

    // The last part of a longer run begins later: what was recorded of the earlier one is dropped.
    const std::vector<double> poses = to_state(problem.rods); // their number alone counts
    SeparationRecord record =
        start_record(poses, (1.0 - criteria.steady_fraction) * problem.t_end, problem.box,
                     BodyForces(problem.bodies, problem.rods.size(), problem.box), problem.t_end);
    if (record.tail_start != from.record.tail_start) {
        if (from.time > record.tail_start || (problem.bodies.any() && from.time > record.bodies.tail_start))
            return std::nullopt;
        record.smallest = from.record.smallest;
        record.smallest_time = from.record.smallest_time;
        record.bodies.smallest_gap = from.record.bodies.smallest_gap;
        record.bodies.smallest_gap_time = from.record.bodies.smallest_gap_time;
        from.record = std::move(record);
    }
    return from;
}

RodResult simulate(const RodProblem& problem, const RodOptions& options) {
    if (auto met = contact_at_start(problem))
        return *std::move(met);
    integrate::OdeProblem ode = to_ode(problem, options.form);
    if (!problem.box && walks_straight(problem) && problem.rods.size() <= most_followed_rods) {
        // The places of a run have fewer digits than the closed form.
        ode.events.clear();
        if (const double meeting = first_meeting(problem); meeting < HUGE_VAL) {
            integrate::Event event;
            event.name = "contact";
            event.value = [meeting](double t, State) { return meeting - t; };
            event.crossing = integrate::Crossing::falling;
            event.terminal = true;
            event.sampled = false;
            ode.events.push_back(std::move(event));
        }
    }
    const RodModel model = model_of(problem);
    const StateRates rates = [&model](State y, std::span<double> ydot) { model.rhs(y, ydot); };
    Equations equations{std::move(ode), rates, model.interacting(), true};
    if (!options.held_wakes || !model.interacting() || !model.bodies().any())
        return solve_equations(problem, options, std::move(equations));
    if (options.form != Formulation::angle)
        throw InputError("wakes are held in form \"angle\" only");
    RodProblem points = problem;
    points.bodies = {};
    points.rows = {};
    const RodModel wakes = model_of(points), others(nullptr, {}, model.rods(), problem.rows, model.bodies());
    equations.wakes = [&wakes](State y, std::span<double> ydot) { wakes.rhs(y, ydot); };
    equations.others = [&others](State y, std::span<double> ydot) { others.rhs(y, ydot); };
    equations.ode.step_limit = [&model](double, State y) { return body_step(model.bodies(), y); };
    return solve_equations(problem, options, std::move(equations));
}

RodResult simulate_rates(const RodProblem& problem, const StateRates& rates, double width,
                         const RodOptions& options) {
    if (options.form != Formulation::angle)
        throw InputError("rods with rates of their own are integrated in form \"angle\"");
    if (auto met = contact_at_start(problem))
        return *std::move(met);
    integrate::OdeProblem ode = to_ode(problem);
    ode.rhs = [&rates](double, State y, std::span<double> ydot) { rates(y, ydot); };
    ode.jacobian = nullptr;
    if (ode.step_limit)
        ode.step_limit = [limit = ode.step_limit, width,
                          bodies = BodyForces(problem.bodies, problem.rods.size(), problem.box)](double t,
                                                                                                 State y) {
            return std::min(std::max(limit(t, y), width), body_step(bodies, y)); // bodies are not as wide
        };
    return solve_equations(problem, options, {std::move(ode), rates, problem.couplings.any(), false});
}

} // namespace rodwake::rods
