#include "rodwake/rods/certificate.hpp"

#include "pair_proof.hpp"
#include "rodwake/rods/conclude.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::rods {

namespace {

using Contact = EncounterBounds::Contact;

// Rods that walk straight

/// Two of them, to the rounding of long double.
EncounterBounds straight_bounds(const Pose& a, const Pose& b, double contact, double t_end,
                                const EndingCriteria& criteria) {
    using Real = long double;
    const Real x = static_cast<Real>(a.x) - b.x, y = static_cast<Real>(a.y) - b.y;
    const Real vx = std::cos(static_cast<Real>(a.heading)) - std::cos(static_cast<Real>(b.heading)),
               vy = std::sin(static_cast<Real>(a.heading)) - std::sin(static_cast<Real>(b.heading));
    const Real square = vx * vx + vy * vy;
    const auto distance = [&](Real t) { return std::hypot(x + vx * t, y + vy * t); };
    const auto nearest = [&](Real from) {
        const Real t = square > 0 ? -(x * vx + y * vy) / square : from;
        return distance(std::clamp<Real>(t, from, t_end));
    };
    const Real largest = std::hypot(x, y) + 2.0L * t_end;
    const Real rounding = 32 * std::numeric_limits<Real>::epsilon() * largest;
    const double error = static_cast<double>(rounding) +
                         8.0 * std::numeric_limits<double>::epsilon() * static_cast<double>(largest);
    EncounterBounds bounds;
    const Real gap = nearest(0) - contact;
    bounds.contact = contact == 0.0 || gap > rounding ? Contact::none
                     : gap < -rounding                ? Contact::certain
                                                      : Contact::unknown;
    bounds.x = static_cast<double>(x + vx * t_end);
    bounds.y = static_cast<double>(y + vy * t_end);
    bounds.heading[0] = a.heading;
    bounds.heading[1] = b.heading;
    bounds.place_error = error;
    bounds.heading_error[0] = bounds.heading_error[1] =
        8.0 * std::numeric_limits<double>::epsilon() *
        (1.0 + std::max(std::abs(a.heading), std::abs(b.heading)));
    const Real from = (1.0 - criteria.steady_fraction) * t_end;
    const auto least = static_cast<double>(nearest(from)),
               most = static_cast<double>(std::max(distance(from), distance(t_end)));
    bounds.late_least = {least - error, least + error};
    bounds.late_most = {most - error, most + error};
    return bounds;
}

// How two runs differ

/// A run's end as far as decisions need it.
struct RunEnd {
    Ending ending;
    double time, min_separation;
    integrate::State state;
};

double gap_rate(integrate::State y, std::size_t a, std::size_t b, Offset d) {
    const double vx = std::cos(y[3 * a + 2]) - std::cos(y[3 * b + 2]),
                 vy = std::sin(y[3 * a + 2]) - std::sin(y[3 * b + 2]);
    return (d.x * vx + d.y * vy) / std::hypot(d.x, d.y);
}

constexpr double times_the_difference = 10.0;

/// A contact is sure if the rods would go on, past it, by more than that: their separation falls at `rate`
/// and curves up with v^2/r and their turning.
bool deep_contact(const RunEnd& run, const RunEnd& tight, std::size_t a, std::size_t b, double turning,
                  Box box) {
    const Offset d = offset(run.state, a, b, box), other = offset(tight.state, a, b, box);
    const double r = std::hypot(d.x, d.y), rate = gap_rate(run.state, a, b, d);
    const double difference =
        std::abs(rate * (run.time - tight.time)) + std::hypot(d.x - other.x, d.y - other.y);
    return rate < 0.0 && rate * rate / (2.0 * (4.0 / r + turning)) > times_the_difference * difference;
}

Interval widened(double value, double other) {
    const double error = times_the_difference * std::abs(value - other);
    return {value - error, value + error};
}

EncounterBounds difference_bounds(const RunEnd& run, const RunEnd& tight, std::size_t a, std::size_t b,
                                  const LatePart& late, const LatePart& tight_late, Box box) {
    const Offset d = offset(run.state, a, b, box), other = offset(tight.state, a, b, box);
    EncounterBounds bounds;
    bounds.contact = Contact::none;
    bounds.x = d.x;
    bounds.y = d.y;
    bounds.place_error = times_the_difference * std::hypot(d.x - other.x, d.y - other.y);
    for (const std::size_t k : {0, 1}) {
        const std::size_t at = 3 * (k == 0 ? a : b) + 2;
        bounds.heading[k] = run.state[at];
        bounds.heading_error[k] = times_the_difference * std::abs(run.state[at] - tight.state[at]);
    }
    bounds.late_least = widened(late.min_separation, tight_late.min_separation);
    bounds.late_most = widened(late.max_separation, tight_late.max_separation);
    bounds.late_turning = widened(late.max_turning, tight_late.max_turning);
    return bounds;
}

bool stays_apart(const RunEnd& run, const RunEnd& tight, double contact) {
    const double margin = std::min(run.min_separation, tight.min_separation) - contact;
    return margin > times_the_difference * std::abs(run.min_separation - tight.min_separation);
}

/// The ending of all pairs together, as conclude tells it; nothing: it may be another.
std::optional<Ending> together(std::span<const std::optional<Ending>> pairs) {
    const auto has = [&](std::optional<Ending> ending) { return std::ranges::count(pairs, ending) > 0; };
    if (has(Ending::contact) || has(Ending::pursuit))
        return has(Ending::contact) ? Ending::contact : Ending::pursuit;
    if (has(std::nullopt))
        return std::nullopt;
    return has(Ending::undecided) ? Ending::undecided : Ending::escape;
}

/// The ending of rods that walk straight.
std::optional<Ending> straight_ending(std::span<const Pose> rods, double contact, double t_end,
                                      const EndingCriteria& criteria) {
    std::vector<std::optional<Ending>> pairs;
    for (std::size_t a = 0; a < rods.size(); ++a)
        for (std::size_t b = a + 1; b < rods.size(); ++b) {
            const EncounterBounds bounds = straight_bounds(rods[a], rods[b], contact, t_end, criteria);
            pairs.push_back(certain_ending(bounds, criteria, [](double) { return false; }));
            if (bounds.contact == Contact::unknown)
                return std::nullopt; // a contact outdoes the other endings
        }
    return together(pairs);
}

Feels feels_of(const elastic::Medium& medium, const Couplings& couplings, double t_end,
               const EndingCriteria& criteria) {
    return [&, t_end](double distance) {
        return reaches(medium, couplings, distance, t_end, criteria.residual_turn);
    };
}

bool walks_straight(const RodProblem& problem) { return !problem.medium || !problem.couplings.any(); }

} // namespace

namespace {

/// Runs whose check takes a fraction of a second: wakes at rods that the first one worked out.
constexpr double cheap_run = 4e6;

integrate::OdeOptions tighter(integrate::OdeOptions ode) {
    ode.rtol = std::max(0.01 * ode.rtol, 1e-13);
    ode.atol *= 0.01;
    ode.max_steps *= 10;
    ode.on_step = nullptr;
    ode.on_segment = nullptr;
    return ode;
}

bool done(const RodResult& run) {
    return run.solution.status.termination == integrate::Termination::reached_end ||
           run.solution.status.termination == integrate::Termination::stopped_at_event;
}

RunEnd end_of_run(const RodResult& run) {
    return {run.outcome.ending, run.outcome.time, run.outcome.min_separation, run.solution.final_state};
}

double late_turning_at_end(const RodProblem& problem, integrate::State y, std::size_t a, std::size_t b) {
    std::vector<double> rate(y.size());
    model_of(problem).rhs(y, rate);
    return std::abs(rate[3 * a + 2]) + std::abs(rate[3 * b + 2]);
}

bool cheap(const RodProblem& problem, const RodResult& run) {
    const auto rods = static_cast<double>(problem.rods.size());
    const auto cost = static_cast<double>(run.solution.statistics.rhs_evaluations) * rods * rods;
    return cost <= cheap_run && problem.rods.size() <= most_followed_rods;
}

/// Whether a second run, at a tighter tolerance, ends alike, and clearly so.
bool checked(const RodProblem& problem, const RodOptions& options, const RodResult& run,
             const RodResult& tight) {
    if (!done(tight) || tight.outcome.ending != run.outcome.ending)
        return false;
    const RunEnd end = end_of_run(run), tight_end = end_of_run(tight);
    const Separation& pair = run.outcome.pair;
    if (run.outcome.ending == Ending::contact)
        return pair.first == tight.outcome.pair.first && pair.second == tight.outcome.pair.second &&
               deep_contact(end, tight_end, pair.first, pair.second,
                            late_turning_at_end(problem, end.state, pair.first, pair.second), problem.box);
    if (!stays_apart(end, tight_end, problem.contact_distance.value_or(0.0)))
        return false;
    const bool anywhere = !problem.medium || problem.field || problem.box; // as conclude has it
    const Feels near = problem.medium
                           ? feels_of(*problem.medium, problem.couplings, problem.t_end, options.criteria)
                           : Feels();
    const bool straight = walks_straight(problem);
    const Feels feels = [&](double distance) { return !straight && (anywhere || near(distance)); };
    std::vector<std::optional<Ending>> pairs;
    for (std::size_t a = 0; a < problem.rods.size(); ++a)
        for (std::size_t b = a + 1; b < problem.rods.size(); ++b) {
            const std::size_t at = a * problem.rods.size() + b;
            pairs.push_back(certain_ending(difference_bounds(end, tight_end, a, b, run.record.late[at],
                                                             tight.record.late[at], problem.box),
                                           options.criteria, feels));
        }
    return together(pairs) == run.outcome.ending;
}

/// Whether the theorem of the proof is about this run.
std::optional<PairProblem> provable(const RodProblem& problem, const RodOptions& options) {
    if (options.resume_from) // its first steps are not known
        return std::nullopt;
    return to_pair_problem(problem);
}

bool proved(const PairProblem& pair, const PairTrack& track, Ending ending, const EndingCriteria& criteria,
            ProofSpace& space) {
    const auto bounds = proved_bounds(pair, track, ending == Ending::contact, criteria, space);
    return bounds && certain_ending(*bounds, criteria,
                                    feels_of(pair.medium, pair.couplings, pair.t_end, criteria)) == ending;
}

PairTrack track_from(const std::vector<double>& state) {
    PairTrack track;
    track.add(0.0, state);
    return track;
}

} // namespace

namespace {

/// A run whose steps are kept if a proof may follow.
struct FollowedRun {
    RodResult run;
    PairTrack track;
};

FollowedRun follow(const RodProblem& problem, RodOptions options, bool kept) {
    FollowedRun followed;
    if (kept) {
        followed.track = track_from(to_state(problem.rods));
        options.ode.on_step = [&track = followed.track,
                               also = options.ode.on_step](const integrate::Step& step) {
            track.add(step.time, step.state);
            if (also)
                also(step);
        };
    }
    followed.run = simulate(problem, options);
    return followed;
}

Certificate certificate_of(const RodProblem& problem, const RodOptions& options, const FollowedRun& first) {
    const RodOutcome& outcome = first.run.outcome;
    if (problem.rods.size() < 2 || (outcome.ending == Ending::contact && outcome.time == 0.0))
        return Certificate::proved;
    if (walks_straight(problem) && !problem.box) {
        const double contact = problem.contact_distance.value_or(0.0);
        const auto exact = straight_ending(problem.rods, contact, problem.t_end, options.criteria);
        return exact == outcome.ending ? Certificate::proved : Certificate::open;
    }
    const auto pair = provable(problem, options);
    ProofSpace space;
    if (pair && proved(*pair, first.track, outcome.ending, options.criteria, space))
        return Certificate::proved;
    if (!cheap(problem, first.run))
        return Certificate::open;
    RodOptions other = options;
    other.ode = tighter(options.ode);
    other.on_checkpoint = nullptr;
    other.resume_from.reset();
    const FollowedRun tight = follow(problem, other, pair.has_value());
    if (pair && done(tight.run) && proved(*pair, tight.track, outcome.ending, options.criteria, space))
        return Certificate::proved;
    return checked(problem, options, first.run, tight.run) ? Certificate::checked : Certificate::open;
}

} // namespace

RodResult simulate_certified(const RodProblem& problem, const RodOptions& options) {
    FollowedRun first = follow(problem, options, provable(problem, options).has_value());
    if (done(first.run))
        first.run.outcome.certificate = certificate_of(problem, options, first);
    return std::move(first.run);
}

namespace {

bool straight(const PairProblem& pair) { return !pair.couplings.any(); }

bool proved(const PairProblem& pair, const PairTrack& track, const PairResult& result,
            const EndingCriteria& criteria, ProofSpace& space) {
    if (result.ending == Ending::contact && result.time == 0.0)
        return true;
    if (straight(pair))
        return straight_ending(pair.rods, pair.contact_distance, pair.t_end, criteria) == result.ending;
    return proved(pair, track, result.ending, criteria, space);
}

bool checked(const PairProblem& pair, const PairResult& run, const PairResult& tight,
             const EndingCriteria& criteria) {
    if (tight.handed_over() || run.ending != tight.ending)
        return false;
    const RunEnd end{run.ending, run.time, run.min_separation, run.state},
        tight_end{tight.ending, tight.time, tight.min_separation, tight.state};
    if (run.ending == Ending::contact)
        return deep_contact(end, tight_end, 0, 1, std::abs(run.rate[2]) + std::abs(run.rate[5]), {});
    return stays_apart(end, tight_end, pair.contact_distance) &&
           certain_ending(difference_bounds(end, tight_end, 0, 1, run.late, tight.late, {}), criteria,
                          feels_of(pair.medium, pair.couplings, pair.t_end, criteria)) == run.ending;
}

/// Runs the pairs and keeps their steps.
std::vector<PairTrack> follow(std::span<const PairProblem> pairs, const PairOptions& options,
                              std::span<PairResult> results) {
    std::vector<PairTrack> tracks;
    tracks.reserve(pairs.size());
    for (const PairProblem& pair : pairs)
        tracks.push_back(track_from(to_state(pair.rods)));
    PairOptions followed = options;
    followed.on_step = [&](std::size_t pair, const PairStep& step) {
        tracks[pair].add(step.time, step.state);
        if (options.on_step)
            options.on_step(pair, step);
    };
    simulate_pairs(pairs, followed, results);
    return tracks;
}

/// The pairs whose results have not been proved, once more.
void look_again(std::span<const PairProblem> pairs, const PairOptions& options, std::span<PairResult> results,
                ProofSpace& space) {
    std::vector<std::size_t> rest;
    std::vector<PairProblem> again;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (!results[i].handed_over() && results[i].certificate == Certificate::open && !straight(pairs[i])) {
            rest.push_back(i);
            again.push_back(pairs[i]);
        }
    PairOptions tight = options;
    tight.rtol = std::max(0.01 * options.rtol, 1e-13);
    tight.atol *= 0.01;
    tight.max_attempts *= 10;
    tight.on_step = nullptr;
    std::vector<PairResult> ends(rest.size());
    const std::vector<PairTrack> tracks = follow(again, tight, ends);
    for (std::size_t k = 0; k < rest.size(); ++k) {
        PairResult& result = results[rest[k]];
        if (!ends[k].handed_over() && proved(again[k], tracks[k], result, options.criteria, space))
            result.certificate = Certificate::proved;
        else if (checked(again[k], result, ends[k], options.criteria))
            result.certificate = Certificate::checked;
    }
}

} // namespace

void simulate_certified(std::span<const PairProblem> pairs, const PairOptions& options,
                        std::span<PairResult> results) {
    const std::vector<PairTrack> tracks = follow(pairs, options, results);
    ProofSpace space;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (!results[i].handed_over() && proved(pairs[i], tracks[i], results[i], options.criteria, space))
            results[i].certificate = Certificate::proved;
    look_again(pairs, options, results, space);
}

namespace {

struct PairBox {
    PairProblem middle;
    PairSpread spread;
    Couplings least, most; ///< by size
};

PairBox box_between(const PairProblem& low, const PairProblem& high) {
    PairBox box{low, {}, {}, {}};
    double* const spread = box.spread.start.data();
    for (std::size_t rod = 0; rod < 2; ++rod) {
        const Pose &a = low.rods[rod], &b = high.rods[rod];
        box.middle.rods[rod] = {0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.heading + b.heading)};
        spread[0] += 0.5 * std::abs(b.x - a.x);
        spread[1] += 0.5 * std::abs(b.y - a.y);
        spread[2 + rod] = 0.5 * std::abs(b.heading - a.heading);
    }
    for (const Coupling& one : coupling_list) {
        const double a = low.couplings.*one.number, b = high.couplings.*one.number;
        const double middle = 0.5 * (a + b), half = 0.5 * std::abs(b - a);
        box.middle.couplings.*one.number = middle;
        box.spread.couplings.*one.number = half;
        box.least.*one.number = std::max(0.0, std::abs(middle) - half);
        box.most.*one.number = std::abs(middle) + half;
    }
    return box;
}

} // namespace

bool all_end(const PairProblem& low, const PairProblem& high, Ending ending, const PairOptions& options) {
    if (low.medium.eta != high.medium.eta || low.medium.xi != high.medium.xi || low.t_end != high.t_end ||
        low.contact_distance != high.contact_distance)
        return false;
    const PairBox box = box_between(low, high);
    std::vector<PairResult> result(1);
    const std::vector<PairTrack> track = follow(std::span(&box.middle, 1), options, result);
    if (result[0].handed_over() || result[0].ending != ending || !box.middle.couplings.any())
        return false;
    ProofSpace space;
    const auto bounds =
        proved_bounds(box.middle, track[0], ending == Ending::contact, options.criteria, space, box.spread);
    const auto ends = [&](const Couplings& couplings) {
        return certain_ending(*bounds, options.criteria,
                              feels_of(low.medium, couplings, low.t_end, options.criteria)) == ending;
    };
    return bounds && ends(box.least) && ends(box.most);
}

} // namespace rodwake::rods
