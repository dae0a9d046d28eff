// Certificates of outcomes: never wrong, of straight walkers against the closed form, of others against runs
// at rtol 1e-12, each over encounters that graze.

#include "random_pairs.hpp"

#include "rods/pair_decision.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/rods/classify_outcome.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <catch2/catch.hpp>
#include <numbers>

using namespace rodwake;
using namespace rodwake::rods;

namespace {

const PairOptions exact_options{1e-12, 1e-14, {}, 1'000'000};

/// A run's smallest separation, if nothing stops it.
std::vector<PairProblem> grazing(std::vector<PairProblem> pairs, RandomStream& random) {
    for (PairProblem& pair : pairs)
        pair.contact_distance = 0.0;
    const std::vector<PairResult> free = results_of(pairs, exact_options);
    std::vector<PairProblem> kept;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const double margin = random.log_uniform(1e-9, 0.1) * (random.uniform() < 0.5 ? -1.0 : 1.0);
        pairs[i].contact_distance = free[i].min_separation * (1.0 + margin);
        const double start =
            std::hypot(pairs[i].rods[0].x - pairs[i].rods[1].x, pairs[i].rods[0].y - pairs[i].rods[1].y);
        if (!free[i].handed_over() && pairs[i].contact_distance < start)
            kept.push_back(pairs[i]);
    }
    return kept;
}

struct Tally {
    int proved = 0, checked = 0, open = 0, wrong = 0, coarse_wrong = 0;
};

Tally tally_of(const std::vector<PairProblem>& pairs, const PairOptions& options) {
    std::vector<PairResult> results(pairs.size());
    simulate_certified(pairs, options, results);
    const std::vector<PairResult> exact = results_of(pairs, exact_options);
    Tally tally;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (results[i].handed_over() || exact[i].handed_over())
            continue;
        const bool wrong = results[i].ending != exact[i].ending;
        const Certificate c = results[i].certificate;
        (c == Certificate::verified  ? tally.proved
         : c == Certificate::checked ? tally.checked
                                     : tally.open) += 1;
        tally.wrong += wrong && c != Certificate::open;
        tally.coarse_wrong += wrong;
    }
    return tally;
}

/// Straight walkers one of which passes the other at `nearest` after `ahead`, and where in units of it.
RodProblem passing(RandomStream& random, double nearest, double ahead) {
    const double h = random.uniform(-3.0, 3.0), other = h + random.uniform(0.2, 3.0);
    const double vx = std::cos(other) - std::cos(h), vy = std::sin(other) - std::sin(h);
    const double v = std::hypot(vx, vy);
    RodProblem problem;
    problem.rods = {Pose{0.0, 0.0, h},
                    Pose{-nearest * vy / v - ahead * vx, nearest * vx / v - ahead * vy, other}};
    problem.t_end = 1.5 * ahead;
    problem.contact_distance = 1.0;
    return problem;
}

using Exact = boost::multiprecision::cpp_bin_float_50;

/// Of two straight walkers.
Exact smallest_separation(const RodProblem& problem) {
    const Pose &a = problem.rods[0], &b = problem.rods[1];
    const Exact x = Exact(a.x) - b.x, y = Exact(a.y) - b.y,
                vx = cos(Exact(a.heading)) - cos(Exact(b.heading)),
                vy = sin(Exact(a.heading)) - sin(Exact(b.heading));
    const Exact nearest = -(x * vx + y * vy) / (vx * vx + vy * vy), end = problem.t_end;
    const Exact t = nearest < 0 ? Exact(0) : nearest < end ? nearest : end;
    const Exact dx = x + vx * t, dy = y + vy * t;
    return sqrt(dx * dx + dy * dy);
}

} // namespace

TEST_CASE("Bounds without width decide as the criteria do; wide ones do not") {
    EncounterBounds bounds;
    bounds.contact = EncounterBounds::Contact::none;
    bounds.x = 10.0;
    bounds.heading[1] = std::numbers::pi; // parting
    bounds.late_least = {5.0, 5.0};
    bounds.late_most = {10.0, 10.0};
    bounds.late_turning = {0.0, 0.001};
    const auto anywhere = [](double) { return true; };
    CHECK(certain_ending(bounds, {}, anywhere) == Ending::escape); // 0.001 10/2 rad is left, 0.05 pi allowed
    bounds.late_turning.high = 0.032;
    CHECK_FALSE(certain_ending(bounds, {}, anywhere));
    bounds.late_turning.low = 0.0316;
    CHECK(certain_ending(bounds, {}, anywhere) == Ending::undecided);
    bounds.heading[1] = 0.0; // abreast, one behind the other
    bounds.late_least = bounds.late_most = {10.0, 10.0};
    CHECK(certain_ending(bounds, {}, anywhere) == Ending::pursuit);
    CHECK(certain_ending(bounds, {}, [](double) { return false; }) == Ending::undecided);
    CHECK_FALSE(certain_ending(bounds, {}, [](double r) { return r > 9.99; }).value_or(Ending::pursuit) ==
                Ending::undecided);
    bounds.place_error = 0.1;
    CHECK_FALSE(certain_ending(bounds, {}, [](double r) { return r < 10.05; }));
    bounds.late_most.high = 10.6; // more than 5 % of it
    CHECK_FALSE(certain_ending(bounds, {}, anywhere));
    bounds.contact = EncounterBounds::Contact::unknown;
    CHECK_FALSE(certain_ending(bounds, {}, anywhere));
    bounds.contact = EncounterBounds::Contact::certain;
    CHECK(certain_ending(bounds, {}, anywhere) == Ending::contact);
}

TEST_CASE("Certificates of rods that turn are true, and many") {
    std::vector<PairProblem> pairs = random_pairs(60, 7, false);
    const std::vector<PairProblem> polar = random_pairs(40, 9, true);
    pairs.insert(pairs.end(), polar.begin(), polar.end());
    for (PairProblem& pair : pairs)
        pair.couplings.kappa = std::clamp(pair.couplings.kappa, -20.0, 20.0);
    const Tally tally = tally_of(pairs, {1e-7, 1e-9});
    CHECK(tally.wrong == 0);
    CHECK(tally.proved >= 96);
    CHECK(tally.open <= 10);
}

TEST_CASE("No certificate is wrong where rods that turn graze, and some outcomes are") {
    RandomStream random(11);
    std::vector<PairProblem> pairs = random_pairs(200, 10, false);
    for (PairProblem& pair : pairs)
        pair.couplings.kappa = std::clamp(pair.couplings.kappa, -20.0, 20.0);
    const Tally tally = tally_of(grazing(pairs, random), {1e-4, 1e-6});
    CHECK(tally.wrong == 0);
    CHECK(tally.coarse_wrong > 5);
    CHECK(tally.proved + tally.checked > 10);
}

TEST_CASE("No tolerance is a hundred times tighter than the tightest") {
    const std::vector<PairProblem> pairs = random_pairs(3, 12, false);
    CHECK(tally_of(pairs, {1e-12, 1e-14}).checked == 0);
}

TEST_CASE("An outcome at its very limit is open") {
    PairProblem pair = random_pairs(1, 8, false)[0];
    pair.medium = {1.0, 1.0};
    pair.couplings = {0.3, 0.0, 0.0};
    pair.rods = {Pose{0.0, 0.0, 0.0}, Pose{4.0, -3.0, 1.9}};
    pair.contact_distance = 0.0;
    const double nearest = results_of({pair}, exact_options)[0].min_separation;
    for (const double share : {1.0 + 1e-12, 1.0 - 1e-12, 0.5}) { // the bound reaches 1e-9
        pair.contact_distance = share * nearest;
        std::vector<PairResult> results(1);
        simulate_certified(std::span(&pair, 1), {1e-6, 1e-8}, results);
        CHECK(results[0].certificate == (share == 0.5 ? Certificate::verified : Certificate::open));
    }
}

TEST_CASE("Straight walkers that graze, near and far, are all proved, and end as 50 digits say") {
    RandomStream random(13);
    int proved = 0, wrong = 0, in_doubt = 0;
    for (int k = 0; k < 2000; ++k) {
        const bool hard = k % 20 < 2; // beyond extended precision
        const double margin = random.log_uniform(1e-13, hard ? 1e-11 : 0.1) * (k % 2 == 0 ? -1.0 : 1.0);
        const RodProblem problem = passing(random, 1.0 + margin, hard ? 1e6 : random.log_uniform(3.0, 1e6));
        const RodOutcome outcome = simulate_certified(problem, {}).outcome;
        const Exact gap = smallest_separation(problem) - 1;
        proved += outcome.certificate == Certificate::verified;
        wrong += (outcome.ending == Ending::contact) != (gap < 0);
        in_doubt += abs(gap) < 5e-18 * problem.t_end; // of extended precision
    }
    CHECK(wrong == 0);
    CHECK(proved == 2000);
    CHECK(in_doubt > 10);
}

TEST_CASE("A straight run stops where its rods meet, whatever the form") {
    RandomStream random(14);
    for (const Formulation form : {Formulation::angle, Formulation::director, Formulation::dae}) {
        RodOptions options;
        options.form = form;
        options.ode.method = integrate::Method::bdf;
        const RodProblem problem = passing(random, 0.6, 10.0); // 0.8 before the closest place
        const RodResult run = simulate(problem, options);
        CHECK(run.outcome.ending == Ending::contact);
        CHECK(run.outcome.pair.distance == Approx(1.0).epsilon(1e-12));
        RodProblem late = problem;
        late.t_end = run.outcome.time * (1.0 - 1e-12);
        CHECK(simulate(late, options).outcome.ending != Ending::contact);
        late.t_end = run.outcome.time * (1.0 + 1e-12);
        CHECK(simulate(late, options).outcome.ending == Ending::contact);
    }
}

TEST_CASE("Straight walkers that start in contact but for a bit meet") {
    RodProblem problem; // 0.31 apart when rounded up, and less by their places
    problem.rods = {Pose{0.1, -2.91, 5.653726380565315},
                    Pose{0.3505873097755323, -3.092499315558885, 8.795319034155108}};
    problem.contact_distance = 0.31;
    problem.t_end = 2.0;
    REQUIRE_FALSE(contact_at_start(problem));
    const RodOutcome outcome = simulate_certified(problem, {}).outcome;
    CHECK(outcome.ending == Ending::contact);
    CHECK(outcome.time < 1e-12);
}

TEST_CASE("Rods that walk straight are proved, an ulp from contact too") {
    RodProblem problem;
    problem.t_end = 30.0;
    problem.contact_distance = 1.0;
    const auto pass = [&](double aside) { // the second walks to and past the first, which stands across
        problem.rods = {Pose{0.0, 0.0, 0.0}, Pose{10.0, aside, std::numbers::pi}};
        return simulate_certified(problem, {}).outcome;
    };
    CHECK(pass(1.0 + 1e-9).certificate == Certificate::verified);
    CHECK(pass(1.0 + 1e-9).ending != Ending::contact);
    CHECK(pass(1.0 - 1e-9).ending == Ending::contact);
    CHECK(pass(1.0 - 1e-9).certificate == Certificate::verified);
    problem.rods = {Pose{}, Pose{0.0, std::nextafter(1.0, 2.0), 0.0}}; // abreast, an ulp from contact
    problem.t_end = 300.0;
    CHECK(simulate_certified(problem, {}).outcome.certificate == Certificate::verified);
    CHECK(simulate_certified(problem, {}).outcome.ending != Ending::contact);
    problem.t_end = 30.0;
    pass(2.0);
    problem.rods.push_back({500.0, 0.0, 1.0});
    CHECK(pass(2.0).certificate == Certificate::verified);
}

TEST_CASE("Runs beyond the theorem are checked, those that failed are open") {
    RodProblem problem;
    problem.medium = elastic::Medium{1.0, 1.0};
    problem.couplings.kappa = 1.0;
    problem.rods = {Pose{0.0, 2.0, 0.0}, Pose{0.0, -2.0, 0.0}};
    problem.t_end = 5.0;
    problem.contact_distance = 0.1;
    RodOptions options;
    CHECK(simulate_certified(problem, options).outcome.certificate == Certificate::verified);
    problem.rods.push_back({3.0, 7.0, 1.0});
    CHECK(simulate_certified(problem, options, true).outcome.certificate == Certificate::checked);
    problem.rods.resize(2);
    problem.couplings.kappa = 0.0;
    problem.rows.gamma = 0.01; // nothing but a crystal turns them
    problem.rods = {Pose{0.0, 2.0, 0.5}, Pose{0.0, -2.0, -0.5}};
    CHECK(simulate_certified(problem, options).outcome.certificate == Certificate::checked);
    problem.rows.gamma = 0.0;
    problem.couplings.kappa = 1.0;
    problem.couplings.kappa = std::nan("");
    CHECK(simulate_certified(problem, {}).outcome.certificate == Certificate::open);
    problem.rods.resize(1);
    problem.couplings.kappa = 1.0;
    CHECK(simulate_certified(problem, {}).outcome.certificate == Certificate::verified);
}
