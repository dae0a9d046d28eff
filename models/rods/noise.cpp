#include "rodwake/rods/noise.hpp"

#include "interaction.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/integrate/additive_noise.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "within_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace rodwake::rods {

namespace {

using integrate::PathIncrement;
using integrate::State;
using integrate::Termination;

constexpr int deepest = 30;                              ///< halvings of a span
constexpr std::size_t most_spans = std::size_t{1} << 24; ///< what a counter has room for
constexpr double resolution = 1e-4;      ///< steps in which smooth contacts are located, f/(mu v0)
constexpr double most_relaxation = 0.25; ///< of a heading in a step: step times rate
constexpr double approach_share =
    0.25;                          ///< of encounter_step, in which rods close a third of their separation
constexpr double jump_share = 0.1; ///< of the separation: by how much it diffuses in a step

/// The fastest rate at which a heading can relax in these wakes: 2 |kappa| times the size of the traceless
/// strain, and the size of the polar drive.
double relaxation_rate(const elastic::FieldValues& f, const Couplings& c) {
    const auto& [kappa, gamma1, gamma2] = c;
    double rate = 0.0;
    if (c.apolar())
        rate += 2.0 * std::abs(kappa) * std::hypot(f.strain.xy, 0.5 * (f.strain.xx - f.strain.yy));
    if (c.polar())
        rate += std::hypot(gamma1 * f.laplacian.x + gamma2 * f.gradient_of_trace.x,
                           gamma1 * f.laplacian.y + gamma2 * f.gradient_of_trace.y);
    return rate;
}

double relaxation_rate(const Rows& rows) { return 6.0 * std::abs(rows.gamma); }

/// One run on its way.
class Walk {
public:
    Walk(const RodProblem& problem, const RodOptions& options, const Noise& noise, std::uint32_t run)
        : problem_(problem), options_(options), noise_(noise), model_(model_of(problem)),
          y_(to_state(problem.rods)), before_(y_), rates_(y_.size()), sums_(problem.rods.size()),
          step_(
              [this](State y, std::span<double> ydot) {
                  ++solution_.statistics.rhs_evaluations;
                  model_.rhs(y, ydot);
              },
              y_.size()),
          place_{noise.seed, run, 0, 0}, pairs_(problem.rods.size() > 1),
          record_(start_record(y_, (1.0 - options.criteria.steady_fraction) * problem.t_end, problem.box,
                               model_.bodies(), problem.t_end)) {}

    RodResult run();

private:
    /// A node of the halving of a span.
    struct PathNode {
        std::uint32_t number;
        int depth;
        double start, length;
    };
    using Path = std::vector<PathIncrement>;

    /// These go on to the end of a node; false: the run is over.
    bool advance(const PathNode& node);
    bool halve(const PathNode& node);
    /// Nothing if the step must be halved.
    std::optional<bool> take(const PathNode& node);

    bool stop(double time, Termination how);
    void add(const integrate::Step& step);
    double step_limit();
    double strength(std::size_t component) const {
        return std::sqrt(2.0 * (component % 3 == 2 ? noise_.rotational : noise_.translational));
    }
    integrate::Normals normals(std::uint32_t node, std::size_t component);

    const RodProblem& problem_;
    const RodOptions& options_;
    const Noise& noise_;
    RodModel model_;
    std::vector<double> y_, before_, rates_; ///< rates of y_
    std::vector<elastic::FieldValues> sums_;
    integrate::AdditiveNoiseStep step_;
    NoisePlace place_;
    bool pairs_, rates_known_ = false;
    std::vector<Path> path_, later_; ///< by depth: of the node, and of the half that waits
    SeparationRecord record_;
    integrate::Solution solution_;
};

integrate::Normals Walk::normals(std::uint32_t node, std::size_t component) {
    constexpr NoisePlace::Use uses[] = {NoisePlace::Use::x, NoisePlace::Use::y, NoisePlace::Use::heading};
    place_.node = node;
    return integrate::normals_of(place_.bits(uses[component % 3], component / 3));
}

/// Longest step from here; see noise.hpp. Works out the rates on the way.
double Walk::step_limit() {
    if (!rates_known_)
        ++solution_.statistics.rhs_evaluations;
    if (!rates_known_ && model_.interacting())
        model_.wakes(y_, sums_);
    double fastest = relaxation_rate(problem_.rows);
    for (std::size_t a = 0; a < model_.rods(); ++a) {
        const Direction n = direction(y_, a);
        const bool turns = model_.interacting();
        rates_[3 * a] = n.cosine;
        rates_[3 * a + 1] = n.sine;
        rates_[3 * a + 2] = turns ? turning_rate(sums_[a], problem_.couplings, {n.cosine, n.sine}) : 0.0;
        if (problem_.rows.any())
            rates_[3 * a + 2] += problem_.rows.rate(y_[3 * a + 2]);
        if (turns)
            fastest = std::max(fastest, relaxation_rate(sums_[a], problem_.couplings));
    }
    model_.bodies().add_rates(y_, rates_);
    if (pairs_ && model_.bodies().any())
        fastest = std::max(fastest, model_.bodies().relaxation_rate(y_));
    rates_known_ = true;
    double limit = std::min(noise_.time_step, most_relaxation / fastest);
    if (pairs_ && model_.bodies().any())
        limit = std::min(limit, model_.bodies().step_limit(y_, 0.5));
    if (!pairs_ || !(model_.interacting() || problem_.contact_distance))
        return limit;
    limit = std::min(limit, approach_share * encounter_step(y_, problem_.box));
    if (noise_.translational > 0.0) {
        const double r = jump_share * closest_pair(y_, problem_.box).distance;
        limit = std::min(limit, r * r / (4.0 * noise_.translational));
    }
    return limit;
}

bool Walk::stop(double time, Termination how) {
    solution_.final_time = solution_.status.reached = time;
    solution_.status.termination = how;
    return false;
}

void Walk::add(const integrate::Step& step) {
    add_step(
        record_, step, [this](State y, std::span<double> ydot) { model_.rhs(y, ydot); }, problem_.box,
        model_.bodies());
    if (options_.ode.on_step)
        options_.ode.on_step(step);
}

std::optional<bool> Walk::take(const PathNode& node) {
    before_ = y_;
    const auto depth = static_cast<std::size_t>(node.depth);
    step_.take(y_, rates_, node.length, path_[depth]);
    if (!std::ranges::all_of(y_, [](double value) { return std::isfinite(value); }))
        throw InputError("the state is not finite");
    place_.node = node.number;

    // The first contact in the step, if there is one. Of separations that are smooth it is at the end of the
    // step, or on the cubic within it, and is located in short steps.
    const integrate::Step step{node.start, node.start + node.length, before_, y_};
    const double h = step.time - step.time_before;
    std::optional<Meeting> met;
    if (pairs_ && problem_.contact_distance) {
        const double distance = *problem_.contact_distance;
        if (noise_.translational > 0.0) {
            met = bridge_contact(step, distance, 4.0 * noise_.translational, problem_.box, place_);
        } else {
            const Separation at_end = closest_pair(y_, problem_.box);
            const auto contact =
                at_end.distance <= distance
                    ? std::optional(Approach{fall_time(step, at_end.first, at_end.second, distance), at_end})
                    : closest_approach(step, problem_.box, distance);
            if (contact && node.depth < deepest && h > resolution) {
                y_ = before_;
                return std::nullopt;
            }
            if (contact)
                met = {(contact->time - step.time_before) / h, contact->pair.first, contact->pair.second};
        }
    }
    if (!met) {
        add(step);
        rates_known_ = false;
        ++solution_.statistics.steps;
        return true;
    }

    // The state at contact is taken between the step's ends, and the pair put at its distance along its line.
    for (std::size_t i = 0; i < y_.size(); ++i)
        y_[i] = before_[i] + met->share * (y_[i] - before_[i]);
    put_apart(y_, {met->first, met->second, *problem_.contact_distance}, problem_.box);
    const double time = step.time_before + met->share * h;
    add({step.time_before, time, before_, y_});
    rates_known_ = false;
    ++solution_.statistics.steps;
    return stop(time, Termination::stopped_at_event);
}

bool Walk::halve(const PathNode& node) {
    const auto depth = static_cast<std::size_t>(node.depth), below = depth + 1;
    if (path_.size() <= below) {
        path_.resize(below + 1, Path(y_.size()));
        later_.resize(below + 1, Path(y_.size()));
    }
    for (std::size_t i = 0; i < y_.size(); ++i)
        if (const double s = strength(i); s > 0.0)
            std::tie(path_[below][i], later_[below][i]) =
                integrate::halves(path_[depth][i], node.length, s, normals(node.number, i));
    const double half = 0.5 * node.length;
    if (!advance({2 * node.number, node.depth + 1, node.start, half}))
        return false;
    path_[below].swap(later_[below]);
    return advance({2 * node.number + 1, node.depth + 1, node.start + half, half});
}

bool Walk::advance(const PathNode& node) {
    if (options_.ode.stop_requested && options_.ode.stop_requested())
        return stop(node.start, Termination::interrupted);
    const bool many = solution_.statistics.steps >= options_.ode.max_steps;
    if (many || node.depth >= deepest) {
        integrate::Status& status = solution_.status;
        status.step = node.length;
        status.order = 2; // weak
        const bool asked = noise_.time_step < node.length;
        status.flag = many ? "TOO_MUCH_WORK" : "STEP_TOO_SHORT";
        status.cause = many    ? "the steps allowed were used up"
                       : asked ? "noise.time_step is below 2^-30 of the time between two outputs"
                               : "headings turn too fast for any step";
        status.advice = many    ? "raise rods_run.max_steps, or noise.time_step"
                        : asked ? "choose a longer noise.time_step, or more output times"
                                : "set rods_run.contact_distance, or a longer one";
        return stop(node.start, Termination::failed);
    }
    if (node.length > step_limit())
        return halve(node);
    const std::optional<bool> on = take(node);
    return on ? *on : halve(node);
}

RodResult Walk::run() {
    solution_.status.wanted = problem_.t_end;
    try {
        double start = 0.0;
        bool on = true;
        for (const double end : output_times(problem_)) {
            if (end > start) {
                // Draw the increments over the span, and go through it.
                path_.resize(std::max<std::size_t>(path_.size(), 1), Path(y_.size()));
                later_.resize(path_.size(), Path(y_.size()));
                for (std::size_t i = 0; i < y_.size(); ++i)
                    if (const double s = strength(i); s > 0.0)
                        path_[0][i] = integrate::draw_increment(end - start, s, normals(0, i));
                on = advance({1, 0, start, end - start});
                if (!on)
                    break;
                ++place_.span;
            }
            solution_.times.push_back(end);
            solution_.states.push_back(y_);
            start = end;
        }
        if (on)
            stop(start, Termination::reached_end);
    } catch (const InputError& error) {
        solution_.status.flag = "RHSFUNC_FAIL";
        solution_.status.cause = error.what();
        y_ = before_;
        stop(solution_.times.empty() ? 0.0 : solution_.times.back(), Termination::failed);
    }
    solution_.final_state = y_;
    explain_collision(solution_, problem_.box);
    RodResult result;
    result.solution = std::move(solution_);
    const StateRates rates = [this](State y, std::span<double> ydot) { model_.rhs(y, ydot); };
    result.outcome =
        classify_outcome(problem_, model_.interacting(), rates, result.solution, record_, options_.criteria);
    return result;
}

} // namespace

double suitable_time_step(const RodProblem& problem, double rotational) {
    double fastest = std::max({1.0, rotational, relaxation_rate(problem.rows)});
    const RodModel model = model_of(problem);
    if (model.interacting() && !contact_at_start(problem)) {
        std::vector<elastic::FieldValues> sums(model.rods());
        model.wakes(to_state(problem.rods), sums);
        for (const elastic::FieldValues& sum : sums)
            fastest = std::max(fastest, relaxation_rate(sum, problem.couplings));
    }
    return 0.05 / fastest;
}

RodResult simulate(const RodProblem& problem, const RodOptions& options, const Noise& noise,
                   std::uint32_t run) {
    if (auto met = contact_at_start(problem))
        return *std::move(met);
    validate(problem);
    if (!(noise.rotational >= 0.0 && noise.translational >= 0.0 && std::isfinite(noise.rotational) &&
          std::isfinite(noise.translational)))
        throw InputError(fmt::format("diffusion coefficients {} and {}: must be >= 0 and finite",
                                     noise.rotational, noise.translational));
    if (!(noise.time_step > 0.0))
        throw InputError(fmt::format("time step {} of noisy runs: must be > 0", noise.time_step));
    if (problem.output_times.size() >= most_spans)
        throw InputError(fmt::format("noisy runs take fewer than {} output times", most_spans));
    return Walk(problem, options, noise, run).run();
}

} // namespace rodwake::rods
