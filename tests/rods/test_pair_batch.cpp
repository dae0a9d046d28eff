// The batch beside rods::simulate: the same endings and states, whoever else is in it.

#include "random_pairs.hpp"

#include "rodwake/core/error.hpp"
#include "support/instruction_sets.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>

using namespace rodwake;
using namespace rodwake::rods;

namespace {

RodResult reference(const PairProblem& pair, double rtol) {
    RodOptions options;
    options.ode.method = integrate::Method::erk;
    options.ode.rtol = rtol;
    options.ode.atol = 0.01 * rtol;
    return simulate(to_rod_problem(pair), options);
}

/// Largest difference of the final states, and of the times.
double difference(const PairResult& result, const RodResult& exact) {
    double worst = std::abs(result.time - exact.outcome.time);
    for (std::size_t k = 0; k < 6; ++k)
        worst = std::max(worst, std::abs(result.state[k] - exact.solution.final_state[k]));
    return worst;
}

struct Comparison {
    int compared = 0, unlike = 0, contacts = 0;
    std::vector<double> errors;
    double worst_contact_time = 0.0;

    double quantile(double part) {
        std::sort(errors.begin(), errors.end());
        return errors[static_cast<std::size_t>(part * static_cast<double>(errors.size() - 1))];
    }
};

Comparison compare(const std::vector<PairProblem>& pairs, double rtol, double reference_rtol) {
    const auto results = results_of(pairs, {.rtol = rtol, .atol = 0.01 * rtol});
    Comparison all;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const RodResult exact = reference(pairs[i], reference_rtol);
        if (results[i].handed_over() || !exact.solution.status.ok())
            continue;
        ++all.compared;
        if (results[i].ending != exact.outcome.ending) {
            ++all.unlike;
            continue;
        }
        all.errors.push_back(difference(results[i], exact));
        if (exact.outcome.ending != Ending::contact)
            continue;
        ++all.contacts;
        all.worst_contact_time =
            std::max(all.worst_contact_time, std::abs(results[i].time - exact.outcome.time));
    }
    return all;
}

/// Two rods that hardly feel each other on courses that cross: known to all digits but those of kappa.
PairProblem crossing(double x, double contact) {
    return {{1.0, 1.0},
            {.kappa = 1e-14},
            {Pose{-5.0, 0.0, 0.0}, Pose{x, -5.0, 0.5 * std::numbers::pi}},
            20.0,
            contact};
}

bool same_bits(const PairResult& a, const PairResult& b) {
    return a.end == b.end && a.ending == b.ending && a.steps == b.steps &&
           a.rhs_evaluations == b.rhs_evaluations &&
           std::memcmp(a.state.data(), b.state.data(), sizeof a.state) == 0 && a.time == b.time &&
           a.min_separation == b.min_separation && a.min_separation_time == b.min_separation_time &&
           a.ahead_x == b.ahead_x && a.ahead_y == b.ahead_y;
}

} // namespace

TEST_CASE("pairs of a batch end as rods::simulate ends them") {
    for (const bool polar : {false, true}) {
        CAPTURE(polar);
        Comparison all = compare(random_pairs(polar ? 400 : 1200, 31, polar), 1e-9, 1e-12);
        CHECK(all.compared > (polar ? 380 : 1180));
        CHECK(all.unlike * 1000 <= all.compared); // on a boundary
        CHECK(all.contacts > 40);
        CHECK(all.quantile(0.5) < 3e-9);
        CHECK(all.quantile(0.99) < 1e-6); // trajectories that part from their neighbours
        CHECK(all.worst_contact_time < 1e-6);
    }
}

TEST_CASE("every coupling alone turns a pair of a batch as rods::simulate does") {
    for (const Coupling& coupling : coupling_list) {
        INFO(std::string(coupling.name));
        PairProblem pair{{1.0, 1.0}, {}, {Pose{0.0, 1.0, 0.3}, Pose{-0.5, -1.0, -0.2}}, 10.0};
        pair.couplings.*coupling.number = 0.5;
        const RodResult exact = reference(pair, 1e-10);
        CHECK(std::abs(exact.outcome.turn[0]) > 1e-3);
        const PairResult result = results_of({pair}, {.rtol = 1e-8, .atol = 1e-10}).front();
        REQUIRE_FALSE(result.handed_over());
        CHECK(difference(result, exact) < 1e-6); // 100 rtol
    }
}

TEST_CASE("the error of a batch scales with rtol") {
    const auto pairs = random_pairs(150, 32, false);
    CHECK(compare(pairs, 1e-6, 1e-12).quantile(0.5) < 3e-6);
    CHECK(compare(pairs, 1e-6, 1e-12).quantile(0.5) > 1e-8); // the comparison sees errors
    CHECK(compare(pairs, 1e-11, 1e-13).quantile(0.5) < 3e-10);
}

TEST_CASE("a pair's bits do not depend on who else is in the batch") {
    auto pairs = random_pairs(60, 33, false);
    const auto polar = random_pairs(10, 34, true);
    pairs.insert(pairs.end(), polar.begin(), polar.end());
    const PairOptions options{.rtol = 1e-6, .atol = 1e-8};
    const auto together = results_of(pairs, options);
    const std::vector<PairProblem> reversed(pairs.rbegin(), pairs.rend());
    const auto backwards = results_of(reversed, options);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        CAPTURE(i);
        REQUIRE(same_bits(together[i], backwards[pairs.size() - 1 - i]));
        REQUIRE(same_bits(together[i], results_of({pairs[i]}, options)[0]));
    }
    CHECK_FALSE(same_bits(together[0], together[1]));
}

TEST_CASE("every instruction set gives a batch the same bits") {
    const auto pairs = random_pairs(25, 35, true);
    const PairOptions options{.rtol = 1e-6, .atol = 1e-8};
    const auto first = results_of(pairs, options);
    std::size_t sets = 0;
    for_each_instruction_set([&] {
        ++sets;
        const auto again = results_of(pairs, options);
        for (std::size_t i = 0; i < pairs.size(); ++i)
            REQUIRE(same_bits(again[i], first[i]));
    });
    CHECK(sets > 1);
}

TEST_CASE("a contact that begins and ends inside a step is found where it begins") {
    // rod 0 is at (t - 5, 0), rod 1 at (x, t - 5): at t = 5 they pass at the distance |x|/sqrt 2, at t = 5 +
    // x/2
    const double x = 0.1;
    const double nearest = x / std::sqrt(2.0), half = std::sqrt(0.5 * (0.08 * 0.08 - nearest * nearest));
    const PairResult met = results_of({crossing(x, 0.08)}, {})[0];
    CHECK(met.ending == Ending::contact);
    CHECK(met.time == Approx(5.0 + 0.5 * x - half).margin(1e-11));
    CHECK(met.separation == Approx(0.08).epsilon(1e-11));
    CHECK(met.min_separation_time == met.time);
    const PairResult missed = results_of({crossing(x, 0.07)}, {})[0];
    CHECK(missed.ending == Ending::escape);
    CHECK(missed.time == 20.0);
    CHECK(missed.min_separation == Approx(nearest).epsilon(1e-9));
    CHECK(missed.min_separation_time == Approx(5.0 + 0.5 * x).epsilon(1e-9));
}

TEST_CASE("who was ahead when the rods had turned most is known") {
    PairProblem pair = crossing(3.0, 0.0);
    pair.couplings.kappa = 0.5; // turns little, and one way
    const PairResult result = results_of({pair}, {})[0];
    CHECK(result.turn[1] != 0.0);
    const double moved_x = result.state[0] - result.state[3] - (pair.rods[0].x - pair.rods[1].x);
    CHECK(std::abs(result.ahead_x) > 1.0);
    CHECK(std::abs(result.ahead_x) <= std::abs(moved_x) + 40.0);
    // as an observer of the steps of rods::simulate would keep it
    double most = 0.0, ahead = 0.0;
    RodOptions options;
    options.ode.method = integrate::Method::erk;
    options.ode.max_step = 0.02;
    options.ode.on_step = [&](const integrate::Step& step) {
        const double turned =
            std::abs(step.state[2] - pair.rods[0].heading) + std::abs(step.state[5] - pair.rods[1].heading);
        if (turned <= most)
            return;
        most = turned;
        ahead = step.state[0] - step.state[3] - pair.rods[0].x + pair.rods[1].x;
    };
    simulate(to_rod_problem(pair), options);
    CHECK(result.ahead_x == Approx(ahead).margin(1.0)); // steps of the batch are up to half a unit long here
}

TEST_CASE("stiff pairs and what the kernels cannot do are handed over") {
    PairProblem stiff = crossing(1.0, 0.0);
    stiff.couplings.kappa = 1e5;
    stiff.rods = {Pose{0.0, 0.0, 0.0}, Pose{-0.5, 0.02, 0.0}};
    PairProblem negative = crossing(1.0, 0.0), tiny = crossing(1.0, 0.0);
    negative.medium.eta = -0.5;
    tiny.medium.eta = 1e12; // nu r below the table
    tiny.rods[1] = {-5.0 + 1e-3, 0.0, 0.1};
    const std::vector pairs = {stiff, negative, tiny, crossing(1.0, 0.0)};
    const auto results = results_of(pairs, {.max_attempts = 500});
    CHECK(results[0].end == PairEnding::too_many_steps);
    CHECK(results[1].end == PairEnding::out_of_range);
    CHECK(results[2].end == PairEnding::out_of_range);
    CHECK_FALSE(results[3].handed_over());
    CHECK(outcome_of(pairs[1], results[1]).reason == "the integration stopped early");
}

TEST_CASE(
    "a pair that starts in contact ends there, as in rods::simulate, and the others are what they were") {
    PairProblem touching = crossing(1.0, 10.0), same = crossing(1.0, 0.1);
    same.rods[1] = same.rods[0];
    const auto results = results_of({touching, crossing(1.0, 0.0), same}, {});
    for (const auto& [pair, result] : {std::pair(touching, results[0]), std::pair(same, results[2])}) {
        const RodOutcome expected = simulate(to_rod_problem(pair), {}).outcome,
                         found = outcome_of(pair, result);
        CHECK(found.ending == Ending::contact);
        CHECK(found.reason == expected.reason);
        CHECK((found.time == 0.0 && found.min_separation_time == 0.0));
        CHECK(found.min_separation == expected.min_separation);
        CHECK(result.separation == expected.min_separation);
    }
    CHECK(results[1].state == results_of({crossing(1.0, 0.0)}, {})[0].state);
}

TEST_CASE("a batch refuses what rods::simulate refuses") {
    const auto refuses = [](PairProblem pair, const char* why) {
        std::vector<PairResult> results(2);
        const std::vector<PairProblem> both = {crossing(1.0, 0.0), pair};
        CHECK_THROWS_WITH(simulate_pairs(both, {}, results), Catch::Contains(why));
    };
    PairProblem pair = crossing(1.0, 0.0);
    pair.t_end = 0.0;
    refuses(pair, "t_end = 0");
    pair = crossing(1.0, 0.0);
    pair.rods[1] = pair.rods[0];
    refuses(pair, "same place");
    pair = crossing(1.0, 0.0);
    pair.rods[1].heading = std::nan("");
    refuses(pair, "finite");
    pair.medium.eta = -3.0;
    refuses(pair, "eta = -3");
    std::vector<PairResult> none;
    CHECK_THROWS_WITH(simulate_pairs(std::vector{crossing(1.0, 0.0)}, {}, none),
                      Catch::Contains("0 results for 1 pairs"));
    std::vector<PairResult> one(1);
    CHECK_THROWS_WITH(simulate_pairs(std::vector{crossing(1.0, 0.0)}, {.rtol = 1.0}, one),
                      Catch::Contains("rtol = 1"));
}

TEST_CASE("an outcome in words is that of rods::simulate") {
    for (const PairProblem& pair : random_pairs(30, 36, false)) {
        const RodOutcome got = outcome_of(pair, results_of({pair}, {})[0]),
                         exact = reference(pair, 1e-8).outcome;
        CHECK(got.ending == exact.ending);
        CHECK(got.reason.substr(0, 20) == exact.reason.substr(0, 20));
        CHECK(got.min_separation == Approx(exact.min_separation).epsilon(1e-5));
        CHECK(got.pair.distance == Approx(exact.pair.distance).epsilon(1e-4));
        CHECK(got.turn[0] == Approx(exact.turn[0]).margin(1e-4));
    }
}

TEST_CASE("only a pair in the plane with a medium and a coupling becomes one of a batch") {
    RodProblem problem = to_rod_problem(crossing(1.0, 0.5));
    REQUIRE(to_pair_problem(problem));
    CHECK(to_pair_problem(problem)->contact_distance == 0.5);
    RodProblem box = problem, three = problem, apart = problem, alone = problem;
    box.box = 50.0;
    three.rods.push_back({9.0, 9.0, 0.0});
    apart.couplings = {};
    alone.medium.reset();
    for (const RodProblem& other : {box, three, apart, alone})
        CHECK_FALSE(to_pair_problem(other));
}

TEST_CASE("rods that pass through each other are handed over") {
    PairProblem pair{elastic::Medium{1.0, 1.0}, {.kappa = 5.0}, {Pose{0, 0, 0}, Pose{3, 0, M_PI}}, 20.0, 0.0};
    PairResult result;
    simulate_pairs({&pair, 1}, {}, {&result, 1});
    CHECK(result.end == PairEnding::out_of_range);
    pair.contact_distance = 0.1;
    simulate_pairs({&pair, 1}, {}, {&result, 1});
    CHECK(result.ending == Ending::contact);
}

TEST_CASE("rods that are too far apart to turn each other do not pursue, in the batch and beside it") {
    for (const auto& [distance, ending] :
         {std::pair(10.0, Ending::pursuit), std::pair(1e300, Ending::undecided)}) {
        PairProblem pair;
        pair.couplings.kappa = 1.0;
        pair.rods = {Pose{0.0, 0.0, 0.0}, Pose{-distance, 0.0, 0.0}};
        pair.t_end = 20.0;
        CAPTURE(distance);
        CHECK(results_of({pair}, {})[0].ending == ending);
        CHECK(reference(pair, 1e-8).outcome.ending == ending);
    }
}
