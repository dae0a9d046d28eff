#include "rodwake/rods/certificate.hpp"

#include "pair_proof.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "straight_walkers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rodwake::rods {

namespace {

// Differences between two runs of rods that turn

constexpr double tighter_by = 0.01, tightest = 1e-13;
/// Tolerance of a second run with shorter steps: proofs know a solution only by the ends of its steps.
constexpr double for_proof = 0.007;
constexpr double times_the_difference = 10.0;

/// The end of a run, as decisions need it.
struct RunEnd {
    double time, min_separation;
    integrate::State state;
};

/// Two runs of one problem at different tolerances.
struct TwoRuns {
    RunEnd run, tight;
    double contact, t_end;
    Box box;
    double scale; ///< smallest difference that counts: the requested tolerance at this size
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

/// A contact is certain if rods that continue past it come nearer by more than the difference of the runs
/// before t_end. Their separation falls at `rate` and curves up by v^2/r and their turning, which may double
/// within r/10.
bool deep_contact(const TwoRuns& runs, std::size_t a, std::size_t b, double turning) {
    const Offset d = offset(runs.run.state, a, b, runs.box);
    const double r = std::hypot(d.x, d.y);
    const integrate::State y = runs.run.state;
    const double vx = std::cos(y[3 * a + 2]) - std::cos(y[3 * b + 2]),
                 vy = std::sin(y[3 * a + 2]) - std::sin(y[3 * b + 2]);
    const double rate = (d.x * vx + d.y * vy) / r + heading_difference(runs, a) +
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

bool stays_apart(const TwoRuns& runs) {
    if (runs.contact == 0.0)
        return true;
    const double margin = std::min(runs.run.min_separation, runs.tight.min_separation) - runs.contact;
    double difference = std::abs(runs.run.min_separation - runs.tight.min_separation);
    const std::size_t rods = runs.run.state.size() / 3;
    if (rods == 2) // the difference of the ends does not cancel where that of the minima does by chance
        difference = std::max(difference, place_difference(runs, 0, 1));
    return margin > times_the_difference * std::max(difference, runs.scale);
}

Feels feels_of(const elastic::Medium& medium, const Couplings& couplings, double t_end,
               const EndingCriteria& criteria) {
    return [&, t_end](double distance) {
        return reaches(medium, couplings, distance, t_end, criteria.felt_turn);
    };
}

// Single runs

/// Number of wakes at rods in a run of some milliseconds.
constexpr double cheap_run = 5e4;

bool done(const RodResult& run) {
    return run.solution.status.termination == integrate::Termination::reached_end ||
           run.solution.status.termination == integrate::Termination::stopped_at_event;
}

/// A second run and its steps.
struct FollowedRun {
    RodResult run;
    StepTrack track;
};

FollowedRun follow(const RodProblem& problem, RodOptions options) {
    FollowedRun followed;
    if (problem.rods.size() != 2) // proofs are of pairs
        return {simulate(problem, options), {}};
    followed.track.add(0.0, to_state(problem.rods));
    options.ode.on_step = [&, on_step = options.ode.on_step](const integrate::Step& step) {
        followed.track.add(step.time, step.state);
        if (on_step)
            on_step(step);
    };
    followed.run = simulate(problem, options);
    return followed;
}

FollowedRun follow_tighter(const RodProblem& problem, RodOptions options, double by) {
    RodProblem again = problem;
    again.output_times.clear();
    integrate::OdeOptions& ode = options.ode;
    ode.rtol = std::max(by * ode.rtol, tightest);
    ode.atol *= by;
    ode.max_steps *= 10;
    ode.on_step = nullptr;
    ode.on_segment = nullptr;
    options.on_checkpoint = options.on_end = nullptr;
    options.resume_from.reset();
    return follow(again, options);
}

bool proved(const PairProblem& pair, const StepTrack& track, Ending ending, const EndingCriteria& criteria,
            ProofSpace& space) {
    const auto bounds = proved_bounds(pair, track, ending == Ending::contact, criteria, space);
    return bounds && certain_ending(*bounds, criteria,
                                    feels_of(pair.medium, pair.couplings, pair.t_end, criteria)) == ending;
}

/// Bounds of the encounter of the pair (a, b) from the enlarged difference of two runs.
EncounterBounds difference_bounds(const TwoRuns& runs, std::size_t a, std::size_t b, const TailWindow& late,
                                  const TailWindow& tight) {
    const Offset d = offset(runs.run.state, a, b, runs.box);
    const double distance = place_difference(runs, a, b);
    EncounterBounds bounds;
    bounds.contact = EncounterBounds::Contact::none;
    bounds.x = d.x;
    bounds.y = d.y;
    bounds.place_error = times_the_difference * distance;
    for (const std::size_t k : {0, 1}) {
        bounds.heading[k] = runs.run.state[3 * (k == 0 ? a : b) + 2];
        bounds.heading_error[k] = times_the_difference * heading_difference(runs, k == 0 ? a : b);
    }
    const auto widened = [](double value, double other, double floor) -> Enclosure {
        const double error = times_the_difference * std::max(std::abs(value - other), floor);
        return {value - error, value + error};
    };
    bounds.late_least = widened(late.min_separation, tight.min_separation, distance);
    bounds.late_most = widened(late.max_separation, tight.max_separation, distance);
    bounds.late_turning = widened(late.max_turning, tight.max_turning,
                                  late.max_turning * distance * (1.0 + 4.0 / late.min_separation));
    return bounds;
}

/// Whether a second run at a tighter tolerance has the same ending by a clear margin.
bool checked(const RodProblem& problem, const RodOptions& options, const RodResult& run,
             const RodResult& tight) {
    if (!done(tight) || tight.outcome.ending != run.outcome.ending)
        return false;
    const auto end_of = [](const RodResult& r) {
        return RunEnd{r.outcome.time, r.outcome.min_separation, r.solution.final_state};
    };
    const TwoRuns runs{
        end_of(run),   end_of(tight), problem.contact_distance.value_or(0.0),
        problem.t_end, problem.box,   scale_of(run.solution.final_state, options.ode.rtol, options.ode.atol)};
    const auto& [a, b, distance] = run.outcome.pair;
    if (run.outcome.ending == Ending::contact) {
        std::vector<double> rate(runs.run.state.size());
        model_of(problem).rhs(runs.run.state, rate);
        return a == tight.outcome.pair.first && b == tight.outcome.pair.second &&
               deep_contact(runs, a, b, std::abs(rate[3 * a + 2]) + std::abs(rate[3 * b + 2]));
    }
    if (!stays_apart(runs))
        return false;

    // Every pair must end alike for certain. Only on the plane is it known how far rods feel each other.
    const bool interacting = model_of(problem).interacting(),
               plane = problem.medium && !problem.field && !problem.box;
    const Feels near = plane ? feels_of(*problem.medium, problem.couplings, problem.t_end, options.criteria)
                             : [](double) { return true; };
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

/// The certificate, if it needs neither proof nor second run.
std::optional<Certificate> certificate_at_once(const RodProblem& problem, const RodOutcome& outcome,
                                               const EndingCriteria& criteria) {
    if (problem.rods.size() < 2)
        return Certificate::verified;
    if (outcome.ending == Ending::contact && outcome.time == 0.0)
        return certificate_at_start(problem, outcome);
    if (problem.rods.size() > most_followed_rods || problem.bodies.any())
        return Certificate::open;
    if (walks_straight(problem))
        return !problem.box && straight_ending(problem, criteria) == outcome.ending ? Certificate::verified
                                                                                    : Certificate::open;
    return std::nullopt;
}

Certificate certificate_of(const RodProblem& problem, const RodOptions& options, FollowedRun& first,
                           bool thorough) {
    RodOutcome& outcome = first.run.outcome;
    if (const auto certificate = certificate_at_once(problem, outcome, options.criteria))
        return *certificate;

    // A proof from the steps of the run, or from shorter steps. A resumed run lacks its first ones.
    const auto pair = options.resume_from ? std::nullopt : to_pair_problem(problem);
    ProofSpace space;
    const auto proves = [&](const FollowedRun& run) {
        return pair && done(run.run) && run.run.outcome.ending == outcome.ending &&
               proved(*pair, run.track, outcome.ending, options.criteria, space);
    };
    const double short_steps = options.ode.method == integrate::Method::erk ? for_proof : 1.0;
    if (proves(first) || (pair && short_steps < 1.0 && proves(follow_tighter(problem, options, short_steps))))
        return Certificate::verified;

    // A second run, unless it takes long.
    const auto rods = static_cast<double>(problem.rods.size());
    const bool cheap =
        static_cast<double>(first.run.solution.statistics.rhs_evaluations) * rods * rods <= cheap_run;
    if (tighter_by * options.ode.rtol < tightest || !(thorough || cheap))
        return Certificate::open;
    const FollowedRun tight = follow_tighter(problem, options, pair ? short_steps * tighter_by : tighter_by);
    if (proves(tight))
        return Certificate::verified;
    if (checked(problem, options, first.run, tight.run))
        return Certificate::checked;

    // It stays open: say so if this run, or one by an explicit method, ends otherwise.
    if (done(tight.run) && tight.run.outcome.ending != outcome.ending) {
        outcome.reason += fmt::format("; a run at a hundredth of the tolerance ends in {}",
                                      to_string(tight.run.outcome.ending));
    } else if (options.ode.method != integrate::Method::erk && options.form == Formulation::angle) {
        RodOptions explicit_options = options;
        integrate::OdeOptions& ode = explicit_options.ode;
        ode.method = integrate::Method::erk;
        ode.max_steps = std::min(ode.max_steps, 20'000L); // it may be stiff
        ode.on_step = nullptr;
        ode.on_segment = nullptr;
        explicit_options.on_checkpoint = explicit_options.on_end = nullptr;
        explicit_options.resume_from.reset();
        const RodResult other = simulate(problem, explicit_options);
        if (done(other) && other.outcome.ending != outcome.ending)
            outcome.reason +=
                fmt::format("; a run with method erk ends in {}", to_string(other.outcome.ending));
    }
    return Certificate::open;
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

/// Runs the pairs and keeps their steps.
std::vector<StepTrack> follow(std::span<const PairProblem> pairs, PairOptions options,
                              std::span<PairResult> results) {
    std::vector<StepTrack> tracks(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i)
        tracks[i].add(0.0, to_state(pairs[i].rods));
    options.on_step = [&, on_step = options.on_step](std::size_t pair, const PairStep& step) {
        tracks[pair].add(step.time, step.state);
        if (on_step)
            on_step(pair, step);
    };
    simulate_pairs(pairs, options, results);
    return tracks;
}

PairOptions tighter(PairOptions options, double by) {
    options.rtol = std::max(by * options.rtol, tightest);
    options.atol *= by;
    options.max_attempts *= 10;
    options.on_step = nullptr;
    return options;
}

/// Runs the pairs of `rest` again at a tolerance tighter by that factor, proves them, or with `check`
/// compares the two runs. Pairs that stay open remain in `rest`.
void look_again(std::span<const PairProblem> pairs, const PairOptions& options, double by, bool check,
                std::span<PairResult> results, std::vector<std::size_t>& rest, ProofSpace& space) {
    std::vector<PairProblem> again;
    again.reserve(rest.size());
    for (const std::size_t i : rest)
        again.push_back(pairs[i]);
    std::vector<PairResult> ends(rest.size());
    const std::vector<StepTrack> tracks = follow(again, tighter(options, by), ends);
    std::vector<std::size_t> left;
    for (std::size_t k = 0; k < rest.size(); ++k) {
        PairResult& result = results[rest[k]];
        if (!ends[k].handed_over() && ends[k].ending == result.ending &&
            proved(again[k], tracks[k], result.ending, options.criteria, space))
            result.certificate = Certificate::verified;
        else if (check && checked(again[k], result, ends[k], options))
            result.certificate = Certificate::checked;
        else
            left.push_back(rest[k]);
    }
    rest = left;
}

} // namespace

bool walks_straight(const RodProblem& problem) {
    return !problem.rows.any() && !problem.bodies.any() && (!problem.medium || !problem.couplings.any());
}

Certificate certificate_at_start(const RodProblem& problem, const RodOutcome& met) {
    double largest = 1.0;
    for (const Pose& rod : problem.rods)
        largest = std::max({largest, std::abs(rod.x), std::abs(rod.y)});
    const double limit = problem.contact_distance.value_or(0.0);
    return met.pair.distance < limit - 1e-14 * (largest + limit) ? Certificate::verified : Certificate::open;
}

RodResult simulate_certified(const RodProblem& problem, const RodOptions& options, bool thorough) {
    FollowedRun first = follow(problem, options);
    if (done(first.run))
        first.run.outcome.certificate = certificate_of(problem, options, first, thorough);
    return first.run;
}

void simulate_certified(std::span<const PairProblem> pairs, const PairOptions& options,
                        std::span<PairResult> results) {
    const std::vector<StepTrack> tracks = follow(pairs, options, results);
    std::vector<std::size_t> rest;
    ProofSpace space;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        PairResult& result = results[i];
        std::optional<Certificate> certificate;
        if (result.handed_over())
            certificate = Certificate::open;
        else if (!pairs[i].couplings.any() || (result.ending == Ending::contact && result.time == 0.0))
            certificate = certificate_at_once(
                to_rod_problem(pairs[i]), outcome_of(pairs[i], result, options.criteria), options.criteria);
        result.certificate = certificate.value_or(Certificate::open);
        if (!certificate && proved(pairs[i], tracks[i], result.ending, options.criteria, space))
            result.certificate = Certificate::verified;
        else if (!certificate)
            rest.push_back(i);
    }
    look_again(pairs, options, for_proof, false, results, rest, space);
    if (tighter_by * options.rtol >= tightest)
        look_again(pairs, options, for_proof * tighter_by, true, results, rest, space);
}

bool all_end(std::span<const PairProblem> corners, Ending ending, const PairOptions& options) {
    const PairProblem& first = corners[0];
    if (!std::ranges::all_of(corners, [&](const PairProblem& pair) {
            return pair.medium.eta == first.medium.eta && pair.medium.xi == first.medium.xi &&
                   pair.t_end == first.t_end && pair.contact_distance == first.contact_distance;
        }))
        return false;

    // The box that has the pairs as corners, in each number, and its couplings by size.
    PairProblem middle_pair = first;
    PairSpread spread;
    Couplings least, most;
    const auto middle_and_half = [&](const auto& number) {
        double low = number(first), high = low;
        for (const PairProblem& pair : corners) {
            low = std::min(low, number(pair));
            high = std::max(high, number(pair));
        }
        return std::pair(0.5 * (low + high), 0.5 * (high - low));
    };
    for (std::size_t rod = 0; rod < 2; ++rod) {
        constexpr double Pose::*members[] = {&Pose::x, &Pose::y, &Pose::heading};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [middle, half] =
                middle_and_half([&](const PairProblem& pair) { return pair.rods[rod].*members[k]; });
            middle_pair.rods[rod].*members[k] = middle;
            spread.start[k == 2 ? 2 + rod : k] += half;
        }
    }
    for (const Coupling& coupling : coupling_list) {
        const auto number = coupling.number;
        const auto [middle, half] =
            middle_and_half([&](const PairProblem& pair) { return pair.couplings.*number; });
        middle_pair.couplings.*number = middle;
        spread.couplings.*number = half;
        least.*number = std::max(0.0, std::abs(middle) - half);
        most.*number = std::abs(middle) + half;
    }

    // Bounds from a run of the middle that hold in the whole box.
    std::vector<PairResult> result(1);
    const std::vector<StepTrack> track =
        follow(std::span(&middle_pair, 1), tighter(options, for_proof), result);
    if (result[0].handed_over() || result[0].ending != ending || !middle_pair.couplings.any())
        return false;
    ProofSpace space;
    const auto bounds =
        proved_bounds(middle_pair, track[0], ending == Ending::contact, options.criteria, space, spread);
    const auto ends = [&](const Couplings& couplings) {
        return certain_ending(*bounds, options.criteria,
                              feels_of(middle_pair.medium, couplings, middle_pair.t_end, options.criteria)) ==
               ending;
    };
    return bounds && ends(least) && ends(most);
}

} // namespace rodwake::rods
