#include "rodwake/medium/simulate.hpp"
#include "rodwake/core/box_sides.hpp"

#include "closed_rates.hpp"
#include "film_reel.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/medium/modal_field.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "step_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace rodwake::medium {

namespace {

using integrate::State;
using rods::RodCheckpoint;
using rods::RodOptions;
using rods::RodProblem;

/// Rods whose own turning is kept by itself.
std::size_t told_apart(const DynamicMedium& medium, std::size_t rods) {
    return medium.self_field && evaluation_of(medium, rods) == Evaluation::sums && rods <= most_fields ? rods
                                                                                                       : 0;
}

RodCheckpoint beginning(const RodProblem& problem, const DynamicMedium& medium, CoupledStep& method,
                        const EndingCriteria& criteria, const rods::BodyForces& bodies) {
    constexpr double first_step = 0.05; // f/(mu v0); too long a step is rejected
    const Coupled start = method.start(rods::to_state(problem.rods));
    RodCheckpoint from;
    from.state = start.poses;
    from.state.push_back(first_step);
    from.state.resize(from.state.size() + told_apart(medium, problem.rods.size()));
    from.statistics.rhs_evaluations = 1;
    from.state.insert(from.state.end(), start.fields.begin(), start.fields.end());
    from.record = rods::start_record(start.poses, (1.0 - criteria.steady_fraction) * problem.t_end,
                                     problem.box, bodies, problem.t_end);
    return from;
}

/// First time in a step at which two rods are as close as `distance`: the later end of a bracket of rounding.
/// Rods that bodies push aside do not follow their headings, by which approaches are known: the step, as
/// short as body_step has it, is sampled.
std::optional<double> contact_time(const DoubleStep& step, double distance, rods::Box box, bool bodies) {
    constexpr int samples = 4; // of half a step
    const auto near = [&](State y) { return rods::closest_pair(y, box).distance <= distance; };
    const double times[] = {step.time, step.time + step.half, step.end()};
    for (std::size_t k = 0; k < 2; ++k) {
        const integrate::Step half{times[k], times[k + 1], step.poses[k], step.poses[k + 1]};
        double before = half.time_before, after = half.time;
        if (bodies) {
            for (int part = 1; part < samples && after == half.time; ++part) {
                const double time = half.time_before + (half.time - half.time_before) * part / samples;
                (near(step.at(time)) ? after : before) = time;
            }
            if (after == half.time && !near(half.state))
                continue;
        } else if (!near(half.state)) {
            const auto approach = rods::closest_approach(half, box, distance);
            if (!approach || !near(step.at(approach->time)))
                continue;
            after = approach->time;
        }
        for (double middle = 0.5 * (before + after); before < middle && middle < after;
             middle = 0.5 * (before + after))
            (near(step.at(middle)) ? after : before) = middle;
        return after;
    }
    return std::nullopt;
}

/// A part of what is asked for: steps are many, and their errors add up. atol as rods::simulate caps it.
Tolerance tolerance(const integrate::OdeOptions& ode) {
    constexpr double share = 1.0 / 64.0, smallest = 1e-13;
    return {std::max(share * ode.rtol, smallest), share * std::min(ode.atol, 0.1 * ode.rtol)};
}

/// One run on its way.
class MediumRun {
public:
    MediumRun(const RodProblem& problem, const DynamicMedium& medium, const RodOptions& options,
              const FilmSink& film)
        : problem_(problem), options_(options), width_(medium.force_width),
          bodies_(problem.bodies, problem.rods.size(), problem.box), times_(rods::output_times(problem)),
          method_(make_step(*problem.medium, medium, problem.couplings, problem.rods.size(),
                            problem.sums.threads, bodies_)),
          from_(options.resume_from ? *options.resume_from
                                    : beginning(problem, medium, *method_, options.criteria, bodies_)),
          record_(from_.record), outputs_(from_.outputs), own_turn_(told_apart(medium, problem.rods.size())),
          control_(*method_, tolerance(options.ode), coupled(from_.state, own_turn_), from_.time,
                   from_.state[3 * problem.rods.size()]),
          film_(*problem.medium, medium, problem.rods.size(), problem.t_end, film) {
        // A checkpoint every few seconds; a step costs as much as modes times rods.
        const auto modes = static_cast<double>(medium.modes), rods = static_cast<double>(problem.rods.size());
        segment_ = std::min(options.ode.segment_steps,
                            static_cast<long>(std::clamp(8e6 / (modes * modes * rods), 20.0, 2000.0)));
        if (options.resume_from)
            film_.skip(from_.time);
    }

    MediumResult finish() {
        while (output_due(control_.time()))
            outputs_.push_back(control_.state().poses);
        if (film_.due(control_.time()))
            film_.add(control_.state().poses, control_.state().fields);
        if (auto met = rods::contact_at_start(problem_)) {
            solution_ = std::move(met->solution);
            ended_ = true;
        }
        while (control_.time() < problem_.t_end && !ended_)
            step();
        if (!ended_ && options_.on_end)
            options_.on_end(checkpoint());
        if (solution_.final_state.empty()) {
            solution_.final_time = control_.time();
            solution_.final_state = control_.state().poses;
        }
        solution_.times.assign(times_.begin(), times_.begin() + static_cast<std::ptrdiff_t>(outputs_.size()));
        solution_.states = outputs_;
        solution_.statistics = statistics();
        solution_.status.reached = solution_.final_time;
        solution_.status.wanted = problem_.t_end;
        solution_.status.step = control_.next_step();
        solution_.status.order = 4;
        MediumResult result;
        result.outcome = rods::classify_outcome(
            problem_, problem_.couplings.any(),
            [&](State, std::span<double> ydot) { std::ranges::copy(control_.rates(), ydot.begin()); },
            solution_, record_, options_.criteria);
        result.own_turn = own_turn_;
        result.solution = std::move(solution_);
        return result;
    }

private:
    Coupled coupled(const std::vector<double>& state, std::vector<double>& own_turn) const {
        const auto poses = state.begin() + static_cast<std::ptrdiff_t>(3 * problem_.rods.size());
        const auto fields = poses + 1 + static_cast<std::ptrdiff_t>(own_turn.size());
        std::copy(poses + 1, fields, own_turn.begin());
        return {{state.begin(), poses}, {fields, state.end()}};
    }

    bool output_due(double until) const {
        return outputs_.size() < times_.size() && times_[outputs_.size()] <= until;
    }

    void step() {
        if (options_.ode.stop_requested && options_.ode.stop_requested()) {
            if (options_.on_checkpoint) // the method has no history: any step will do
                options_.on_checkpoint(checkpoint());
            return end(integrate::Termination::interrupted);
        }
        if (statistics().steps >= options_.ode.max_steps)
            return fail("TOO_MANY_STEPS", fmt::format("{} steps were not enough", options_.ode.max_steps),
                        "raise rods_run.max_steps or rods_run.rtol");

        // No longer than rods take to pass each other, or the width of a force, which the field resolves.
        const std::vector<double>& poses = control_.state().poses;
        double longest = problem_.rods.size() < 2
                             ? std::numeric_limits<double>::infinity()
                             : std::max(rods::encounter_step(poses, problem_.box), width_);
        longest = std::min(longest, rods::body_step(bodies_, poses));
        if (options_.ode.max_step > 0.0)
            longest = std::min(longest, options_.ode.max_step);
        if (!control_.advance(longest, problem_.t_end, failures_))
            return fail("STEP_TOO_SMALL", "no step keeps the tolerance",
                        "raise rods_run.rtol or medium.dynamic.force_width");
        ++steps_;
        const DoubleStep& last = control_.last();
        const auto contact = problem_.contact_distance && problem_.rods.size() > 1
                                 ? contact_time(last, *problem_.contact_distance, problem_.box, bodies_.any())
                                 : std::nullopt;

        // Outputs, separations and frames of the film up to contact, or to the end of the step.
        const double until = contact.value_or(control_.time()), middle = last.time + last.half;
        const auto poses_at = [&](double time) { return time == control_.time() ? poses : last.at(time); };
        while (output_due(until))
            outputs_.push_back(poses_at(times_[outputs_.size()]));
        if (until <= middle) {
            add_part(last.time, last.poses[0], until, until < middle ? last.at(until) : last.poses[1]);
        } else {
            add_part(last.time, last.poses[0], middle, last.poses[1]);
            add_part(middle, last.poses[1], until, until < control_.time() ? last.at(until) : last.poses[2]);
        }
        last.add_own_turn(until, own_turn_);
        while (film_.due(until)) {
            const double time = film_.next_time();
            film_.add(poses_at(time), control_.fields_at(time));
        }
        if (contact) {
            solution_.final_time = until;
            solution_.final_state = last.at(until);
            solution_.hits.push_back({0, until, solution_.final_state});
            return end(integrate::Termination::stopped_at_event);
        }
        if (options_.on_checkpoint && steps_ % segment_ == 0 && control_.time() < problem_.t_end)
            options_.on_checkpoint(checkpoint());
    }

    void add_part(double before, State state_before, double after, State state) {
        const integrate::Step part{before, after, state_before, state};
        const auto rates = [&](State y,
                               std::span<double> ydot) { // of the step, at the three times that are asked for
            const double when = y.data() == state.data()          ? after
                                : y.data() == state_before.data() ? before
                                                                  : record_.tail_start;
            std::ranges::copy(control_.last().rates_at(when), ydot.begin());
        };
        rods::add_step(record_, part, rates, problem_.box, bodies_);
        if (options_.ode.on_step)
            options_.ode.on_step(part);
    }

    void end(integrate::Termination how) {
        solution_.status.termination = how;
        ended_ = true;
    }

    void fail(std::string flag, std::string cause, std::string advice) {
        integrate::Status& status = solution_.status;
        status.flag = std::move(flag);
        status.cause = std::move(cause);
        status.advice = std::move(advice);
        end(integrate::Termination::failed);
    }

    integrate::Statistics statistics() const {
        integrate::Statistics all = from_.statistics;
        all.steps += steps_;
        all.rhs_evaluations += control_.evaluations();
        all.error_test_failures += failures_;
        return all;
    }

    RodCheckpoint checkpoint() const {
        RodCheckpoint now;
        now.time = control_.time();
        now.state = control_.state().poses;
        now.state.push_back(control_.next_step());
        now.state.insert(now.state.end(), own_turn_.begin(), own_turn_.end());
        now.state.insert(now.state.end(), control_.state().fields.begin(), control_.state().fields.end());
        for (std::size_t rod = 0; rod < problem_.rods.size(); ++rod)
            now.headings.push_back(control_.state().poses[3 * rod + 2]);
        now.times.assign(times_.begin(), times_.begin() + static_cast<std::ptrdiff_t>(outputs_.size()));
        now.outputs = outputs_;
        now.record = record_;
        now.statistics = statistics();
        return now;
    }

    const RodProblem& problem_;
    const RodOptions& options_;
    double width_;
    rods::BodyForces bodies_;
    std::vector<double> times_;
    std::unique_ptr<CoupledStep> method_;
    RodCheckpoint from_;
    rods::SeparationRecord record_;
    std::vector<std::vector<double>> outputs_;
    std::vector<double> own_turn_; ///< up to now
    StepControl control_;
    FilmReel film_;
    long segment_ = 0, steps_ = 0, failures_ = 0;
    bool ended_ = false;
    integrate::Solution solution_;
};

} // namespace

std::size_t worthwhile_threads(const DynamicMedium& medium, std::size_t rods, std::size_t threads) {
    // A step on the mesh of 4600 modes (96 a side) and 100 rods takes 14.5 ms on one thread in some 130 loops
    // (studies/reports/medium.md, as what a rod costs in modes): 0.1 ms each. Two threads took 0.7 to 0.9
    // times as long as one for loops of that length, beside a busy process as long; for loops of 10 us 1.0
    // to 1.1.
    constexpr std::size_t modes_per_thread = 2000, modes_of_a_rod = 9;
    const std::size_t modes = medium.modes * medium.modes / 2;
    const bool mesh = evaluation_of(medium, rods) == Evaluation::mesh;
    return threads_for(mesh ? modes + modes_of_a_rod * rods : modes * rods / 2, modes_per_thread, threads);
}

void validate_start(const DynamicMedium& medium, std::span<const rods::Pose> rods,
                    std::optional<double> contact_distance) {
    if (rods.size() < 2)
        return;
    const rods::Separation pair = rods::closest_pair(rods::to_state(rods), medium.box);
    if (pair.distance < medium.force_width && !(pair.distance <= contact_distance.value_or(-1.0)))
        throw InputError(
            fmt::format("rods[{}] and rods[{}] start {:.4g} apart, closer than force_width = {}: start them "
                        "farther apart or take a narrower force",
                        pair.first, pair.second, pair.distance, medium.force_width));
}

void validate_bodies(const DynamicMedium& medium, const rods::RodProblem& rods) {
    if (rods.bodies.any() && !medium.self_field &&
        evaluation_of(medium, rods.rods.size()) == Evaluation::mesh)
        throw InputError(
            fmt::format("rods with bodies on the mesh: the part of a rod's own field, which "
                        "self_field = false leaves out, is known there only for rods that walk "
                        "along their headings; take self_field = true, or sums for at most {} rods",
                        most_fields));
}

std::size_t state_size(const DynamicMedium& medium, std::size_t rods) {
    if (medium.closure != Closure::none)
        return 3 * rods;
    return 3 * rods + 1 + told_apart(medium, rods) + field_numbers(medium, rods);
}

MediumResult simulate(const MediumProblem& problem, const rods::RodOptions& options, const FilmSink& film) {
    // The problem as rods see it: in the medium's box.
    RodProblem rods = problem.rods;
    if (rods.box && *rods.box != problem.medium.box)
        throw InputError(fmt::format("the rods' box, {}, differs from the box of the dynamic medium, {}",
                                     to_string(*rods.box), problem.medium.box));
    rods.box = problem.medium.box;
    if (!rods::contact_at_start(rods))
        rods::validate(rods);
    if (!rods.medium)
        throw InputError("rods in a dynamic medium need its eta and xi");
    validate(*rods.medium, problem.medium, rods.rods.size());
    if (options.form != rods::Formulation::angle)
        throw InputError("rods in a dynamic medium are integrated in form \"angle\"");
    validate_bodies(problem.medium, rods);
    if (rods.rows.any())
        throw InputError("a dynamic medium takes no rows of a crystal");
    if (rods.field || rods.sums.turning_tolerance != 0.0 || rods.sums.accuracy != elastic::Accuracy::full)
        throw InputError("a dynamic medium takes no other field, no turning_tolerance and no lower accuracy");
    if (!(options.ode.rtol >= 1e-13 && options.ode.rtol <= 0.1 && options.ode.atol > 0.0))
        throw InputError(fmt::format("rtol = {}, atol = {}: rtol must be 1e-13 to 0.1, atol > 0",
                                     options.ode.rtol, options.ode.atol));
    validate_start(problem.medium, rods.rods, rods.contact_distance);
    validate_film(problem.medium, rods.rods.size(), rods.t_end);
    if (problem.medium.closure != Closure::none)
        return {simulate_closed(rods, problem.medium, options), {}};
    return MediumRun(rods, problem.medium, options, film).finish();
}

} // namespace rodwake::medium
