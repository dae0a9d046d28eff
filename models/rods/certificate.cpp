#include "rodwake/rods/certificate.hpp"

#include "pair_decision.hpp"
#include "rodwake/rods/conclude.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::rods {

namespace {

using Contact = EncounterBounds::Contact;
using Real = long double;

// Rods that walk straight

/// R_0 - R_1 of two of them.
struct StraightPair {
    Real x, y, vx, vy, t_end;

    StraightPair(const Pose& a, const Pose& b, double end)
        : x(static_cast<Real>(a.x) - b.x), y(static_cast<Real>(a.y) - b.y),
          vx(std::cos(static_cast<Real>(a.heading)) - std::cos(static_cast<Real>(b.heading))),
          vy(std::sin(static_cast<Real>(a.heading)) - std::sin(static_cast<Real>(b.heading))), t_end(end) {}

    Real distance(Real t) const { return std::hypot(x + vx * t, y + vy * t); }
    Real nearest(Real from) const {
        const Real square = vx * vx + vy * vy;
        const Real t = square > 0 ? -(x * vx + y * vy) / square : from;
        return distance(std::clamp<Real>(t, from, t_end));
    }
    Real largest() const { return std::hypot(x, y) + 2.0L * t_end; }
};

Contact straight_contact(const StraightPair& pair, double contact) {
    const Real gap = pair.nearest(0) - contact;
    const Real rounding = 32 * std::numeric_limits<Real>::epsilon() * (pair.largest() + contact);
    if (contact == 0.0 || gap > rounding)
        return Contact::none;
    return gap < -rounding ? Contact::certain : Contact::unknown;
}

/// Two that do not meet, to the rounding of double.
EncounterBounds straight_bounds(const Pose& a, const Pose& b, const StraightPair& pair,
                                const EndingCriteria& criteria) {
    constexpr double ulps = 16.0 * std::numeric_limits<double>::epsilon();
    const double error = ulps * static_cast<double>(pair.largest());
    EncounterBounds bounds;
    bounds.contact = Contact::none;
    bounds.x = static_cast<double>(pair.x + pair.vx * pair.t_end);
    bounds.y = static_cast<double>(pair.y + pair.vy * pair.t_end);
    bounds.heading[0] = a.heading;
    bounds.heading[1] = b.heading;
    bounds.place_error = error;
    if (a.heading != b.heading) // else their velocities are equal, however rounded
        bounds.heading_error[0] = bounds.heading_error[1] =
            ulps * (1.0 + std::max(std::abs(a.heading), std::abs(b.heading)));
    const Real from = (1.0 - criteria.steady_fraction) * pair.t_end;
    const auto least = static_cast<double>(pair.nearest(from)),
               most = static_cast<double>(std::max(pair.distance(from), pair.distance(pair.t_end)));
    bounds.late_least = {least - error, least + error};
    bounds.late_most = {most - error, most + error};
    return bounds;
}

/// The ending of all pairs together, as conclude tells it; nothing: it may be another.
std::optional<Ending> together(std::span<const std::optional<Ending>> pairs) {
    const auto has = [&](std::optional<Ending> ending) { return std::ranges::count(pairs, ending) > 0; };
    for (const Ending first : {Ending::contact, Ending::pursuit})
        if (has(first))
            return first;
    if (has(Ending::undecided)) // escape is an ending of all
        return has(std::nullopt) ? std::nullopt : std::optional(Ending::undecided);
    return has(std::nullopt) ? std::nullopt : std::optional(Ending::escape);
}

std::optional<Ending> straight_ending(const RodProblem& problem, const EndingCriteria& criteria) {
    const std::span<const Pose> rods = problem.rods;
    const double contact = problem.contact_distance.value_or(0.0);
    std::vector<std::optional<Ending>> pairs;
    bool clear = true; // of contacts that are not certain: a contact outdoes the other endings
    for (std::size_t a = 0; a < rods.size(); ++a)
        for (std::size_t b = a + 1; b < rods.size(); ++b) {
            const StraightPair pair(rods[a], rods[b], problem.t_end);
            const Contact met = straight_contact(pair, contact);
            if (met == Contact::certain)
                return Ending::contact;
            clear = clear && met == Contact::none;
            pairs.push_back(certain_ending(straight_bounds(rods[a], rods[b], pair, criteria), criteria,
                                           [](double) { return false; }));
        }
    return clear ? together(pairs) : std::nullopt;
}

// How two runs of rods that turn differ

constexpr double tighter_by = 0.01, tightest = 1e-13;
constexpr double times_the_difference = 10.0;

/// A run's end as far as decisions need it.
struct RunEnd {
    double time, min_separation;
    integrate::State state;
};

/// What is compared: two runs and what they are of.
struct TwoRuns {
    RunEnd run, tight;
    double contact, t_end;
    Box box;
    double scale; ///< no difference is taken to be smaller than the tolerance that was asked of this size
};

double scale_of(integrate::State y, double rtol, double atol) {
    double largest = 1.0;
    for (std::size_t rod = 0; 3 * rod < y.size(); ++rod)
        largest = std::max({largest, std::abs(y[3 * rod] - y[0]), std::abs(y[3 * rod + 1] - y[1])});
    return rtol * largest + atol;
}

double place_difference(const TwoRuns& runs, std::size_t a, std::size_t b) {
    const Offset d = offset(runs.run.state, a, b, runs.box), other = offset(runs.tight.state, a, b, runs.box);
    return std::max(runs.scale, std::hypot(d.x - other.x, d.y - other.y));
}

double heading_difference(const TwoRuns& runs, std::size_t rod) {
    return std::max(runs.scale, std::abs(runs.run.state[3 * rod + 2] - runs.tight.state[3 * rod + 2]));
}

double gap_rate(integrate::State y, std::size_t a, std::size_t b, Offset d) {
    const double vx = std::cos(y[3 * a + 2]) - std::cos(y[3 * b + 2]),
                 vy = std::sin(y[3 * a + 2]) - std::sin(y[3 * b + 2]);
    return (d.x * vx + d.y * vy) / std::hypot(d.x, d.y);
}

/// A contact is sure if the rods, going on past it, would get nearer by more than that, and before the end:
/// their separation falls at `rate` and curves up by v^2/r and their turning, which may double in a tenth of
/// r.
bool deep_contact(const TwoRuns& runs, std::size_t a, std::size_t b, double turning) {
    const Offset d = offset(runs.run.state, a, b, runs.box);
    const double r = std::hypot(d.x, d.y);
    const double rate = gap_rate(runs.run.state, a, b, d) + heading_difference(runs, a) +
                        heading_difference(runs, b) + 4.0 * place_difference(runs, a, b) / r;
    if (!(rate < 0.0))
        return false;
    const double bend = 4.0 / (0.9 * r) + 2.0 * turning;
    const double left = std::max(0.0, runs.t_end - std::max(runs.run.time, runs.tight.time));
    const double time = std::min({left, -rate / bend, 0.1 * r / 2.0}); // they close in at 2 at most
    const double depth = -(rate + 0.5 * bend * time) * time;
    return depth > times_the_difference *
                       (2.0 * std::abs(runs.run.time - runs.tight.time) + place_difference(runs, a, b));
}

Interval widened(double value, double other, double floor) {
    const double error = times_the_difference * std::max(std::abs(value - other), floor);
    return {value - error, value + error};
}

EncounterBounds difference_bounds(const TwoRuns& runs, std::size_t a, std::size_t b, const LatePart& late,
                                  const LatePart& tight) {
    const Offset d = offset(runs.run.state, a, b, runs.box);
    EncounterBounds bounds;
    bounds.contact = Contact::none;
    bounds.x = d.x;
    bounds.y = d.y;
    bounds.place_error = times_the_difference * place_difference(runs, a, b);
    for (const std::size_t k : {0, 1}) {
        bounds.heading[k] = runs.run.state[3 * (k == 0 ? a : b) + 2];
        bounds.heading_error[k] = times_the_difference * heading_difference(runs, k == 0 ? a : b);
    }
    const double distance = place_difference(runs, a, b);
    bounds.late_least = widened(late.min_separation, tight.min_separation, distance);
    bounds.late_most = widened(late.max_separation, tight.max_separation, distance);
    bounds.late_turning = widened(late.max_turning, tight.max_turning,
                                  late.max_turning * distance * (1.0 + 4.0 / late.min_separation));
    return bounds;
}

bool stays_apart(const TwoRuns& runs) {
    if (runs.contact == 0.0)
        return true;
    const double margin = std::min(runs.run.min_separation, runs.tight.min_separation) - runs.contact;
    double difference = std::abs(runs.run.min_separation - runs.tight.min_separation);
    const std::size_t rods = runs.run.state.size() / 3;
    if (rods == 2) // that of the ends has not cancelled by chance where the other has
        difference = std::max(difference, place_difference(runs, 0, 1));
    return margin > times_the_difference * std::max(difference, runs.scale);
}

Feels feels_of(const elastic::Medium& medium, const Couplings& couplings, double t_end,
               const EndingCriteria& criteria) {
    return [&, t_end](double distance) {
        return reaches(medium, couplings, distance, t_end, criteria.residual_turn);
    };
}

// Single runs

/// Wakes at rods that the first run worked out: of some milliseconds.
constexpr double cheap_run = 5e4;

bool done(const RodResult& run) {
    return run.solution.status.termination == integrate::Termination::reached_end ||
           run.solution.status.termination == integrate::Termination::stopped_at_event;
}

RodResult run_tighter(const RodProblem& problem, RodOptions options) {
    RodProblem again = problem;
    again.output_times.clear();
    integrate::OdeOptions& ode = options.ode;
    ode.rtol *= tighter_by;
    ode.atol *= tighter_by;
    ode.max_steps *= 10;
    ode.on_step = nullptr;
    ode.on_segment = nullptr;
    options.on_checkpoint = nullptr;
    options.resume_from.reset();
    return simulate(again, options);
}

RunEnd end_of_run(const RodResult& run) {
    return {run.outcome.time, run.outcome.min_separation, run.solution.final_state};
}

double turning_of(const RodProblem& problem, integrate::State y, std::size_t a, std::size_t b) {
    std::vector<double> rate(y.size());
    model_of(problem).rhs(y, rate);
    return std::abs(rate[3 * a + 2]) + std::abs(rate[3 * b + 2]);
}

bool cheap(const RodProblem& problem, const RodResult& run) {
    const auto rods = static_cast<double>(problem.rods.size());
    return static_cast<double>(run.solution.statistics.rhs_evaluations) * rods * rods <= cheap_run;
}

/// Whether a pair that far apart may follow, as conclude has it.
Feels feels_of(const RodProblem& problem, const EndingCriteria& criteria) {
    if (!problem.medium || problem.field || problem.box)
        return [](double) { return true; };
    return feels_of(*problem.medium, problem.couplings, problem.t_end, criteria);
}

/// Whether a second run, at a tighter tolerance, ends alike, and clearly so.
bool checked(const RodProblem& problem, const RodOptions& options, const RodResult& run,
             const RodResult& tight) {
    if (!done(tight) || tight.outcome.ending != run.outcome.ending)
        return false;
    const TwoRuns runs{end_of_run(run),
                       end_of_run(tight),
                       problem.contact_distance.value_or(0.0),
                       problem.t_end,
                       problem.box,
                       scale_of(run.solution.final_state, options.ode.rtol, options.ode.atol)};
    const auto& [a, b, distance] = run.outcome.pair;
    if (run.outcome.ending == Ending::contact)
        return a == tight.outcome.pair.first && b == tight.outcome.pair.second &&
               deep_contact(runs, a, b, turning_of(problem, runs.run.state, a, b));
    if (!stays_apart(runs))
        return false;
    const bool interacting = model_of(problem).interacting();
    const Feels near = feels_of(problem, options.criteria);
    const Feels feels = [&](double apart) { return interacting && near(apart); };
    std::vector<std::optional<Ending>> pairs;
    for (std::size_t i = 0; i < problem.rods.size(); ++i)
        for (std::size_t k = i + 1; k < problem.rods.size(); ++k) {
            const std::size_t at = i * problem.rods.size() + k;
            pairs.push_back(
                certain_ending(difference_bounds(runs, i, k, run.record.late[at], tight.record.late[at]),
                               options.criteria, feels));
        }
    return together(pairs) == run.outcome.ending;
}

Certificate certificate_of(const RodProblem& problem, const RodOptions& options, const RodResult& run,
                           bool thorough) {
    if (problem.rods.size() < 2)
        return Certificate::proved;
    if (run.outcome.ending == Ending::contact && run.outcome.time == 0.0)
        return certificate_at_start(problem, run.outcome);
    if (problem.rods.size() > most_followed_rods)
        return Certificate::open;
    if (walks_straight(problem))
        return !problem.box && straight_ending(problem, options.criteria) == run.outcome.ending
                   ? Certificate::proved
                   : Certificate::open;
    if (tighter_by * options.ode.rtol < tightest || !(thorough || cheap(problem, run)))
        return Certificate::open;
    return checked(problem, options, run, run_tighter(problem, options)) ? Certificate::checked
                                                                         : Certificate::open;
}

// Batches

bool checked(const PairProblem& pair, const PairResult& run, const PairResult& tight,
             const PairOptions& options) {
    if (tight.handed_over() || run.ending != tight.ending)
        return false;
    const TwoRuns runs{{run.time, run.min_separation, run.state},
                       {tight.time, tight.min_separation, tight.state},
                       pair.contact_distance,
                       pair.t_end,
                       {},
                       scale_of(run.state, options.rtol, options.atol)};
    if (run.ending == Ending::contact)
        return deep_contact(runs, 0, 1, std::abs(run.rate[2]) + std::abs(run.rate[5]));
    return stays_apart(runs) &&
           certain_ending(difference_bounds(runs, 0, 1, run.late, tight.late), options.criteria,
                          feels_of(pair.medium, pair.couplings, pair.t_end, options.criteria)) == run.ending;
}

/// What needs no second run; nothing: one is needed.
std::optional<Certificate> at_once(const PairProblem& pair, const PairResult& run,
                                   const PairOptions& options) {
    if (run.handed_over())
        return Certificate::open;
    const RodProblem problem = to_rod_problem(pair);
    if (!pair.couplings.any() || (run.ending == Ending::contact && run.time == 0.0)) {
        RodOptions single;
        single.criteria = options.criteria;
        RodResult result;
        result.outcome = outcome_of(run);
        return certificate_of(problem, single, result, false);
    }
    return tighter_by * options.rtol < tightest ? std::optional(Certificate::open) : std::nullopt;
}

} // namespace

bool walks_straight(const RodProblem& problem) {
    return !problem.rows.any() && (!problem.medium || !problem.couplings.any());
}

Certificate certificate_at_start(const RodProblem& problem, const RodOutcome& met) {
    double largest = 1.0;
    for (const Pose& rod : problem.rods)
        largest = std::max({largest, std::abs(rod.x), std::abs(rod.y)});
    const double limit = problem.contact_distance.value_or(0.0);
    return met.pair.distance < limit - 1e-14 * (largest + limit) ? Certificate::proved : Certificate::open;
}

RodResult simulate_certified(const RodProblem& problem, const RodOptions& options, bool thorough) {
    RodResult run = simulate(problem, options);
    if (done(run))
        run.outcome.certificate = certificate_of(problem, options, run, thorough);
    return run;
}

void simulate_certified(std::span<const PairProblem> pairs, const PairOptions& options,
                        std::span<PairResult> results) {
    simulate_pairs(pairs, options, results);
    std::vector<std::size_t> rest;
    std::vector<PairProblem> again;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto certificate = at_once(pairs[i], results[i], options);
        results[i].certificate = certificate.value_or(Certificate::open);
        if (certificate)
            continue;
        rest.push_back(i);
        again.push_back(pairs[i]);
    }
    PairOptions tight = options;
    tight.rtol *= tighter_by;
    tight.atol *= tighter_by;
    tight.max_attempts *= 10;
    tight.on_step = nullptr;
    std::vector<PairResult> ends(rest.size());
    if (!rest.empty())
        simulate_pairs(again, tight, ends);
    for (std::size_t k = 0; k < rest.size(); ++k)
        if (checked(again[k], results[rest[k]], ends[k], options))
            results[rest[k]].certificate = Certificate::checked;
}

} // namespace rodwake::rods
