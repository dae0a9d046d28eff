// The written criteria of an ending, the contact event, and bad input.

#include "rodwake/core/error.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/rods/noise.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace rodwake;
using rodwake::Ending;

namespace {

Ending classify(const std::vector<rods::Pose>& pair, double turning, TailWindow history) {
    const auto y = rods::to_state(pair);
    std::vector<double> ydot;
    for (const auto& rod : pair)
        ydot.insert(ydot.end(), {std::cos(rod.heading), std::sin(rod.heading), turning});
    return rods::classify_pair(y, ydot, 0, 1, history);
}

const TailWindow steady{2.9, 3.0, 0.0}, changing{1.0, 3.0, 0.0}, turned_lately{1.0, 3.0, 0.1};

rods::RodProblem straight(std::vector<rods::Pose> rods, double t_end, std::optional<double> contact) {
    return {std::nullopt, {}, std::move(rods), t_end, {}, contact};
}

} // namespace

TEST_CASE("pursuit needs locked headings, a steady distance and a rear rod on the other's trail") {
    CHECK(classify({{3, 0, 0}, {0, 0.1, 0.05}}, 0.0, steady) == Ending::pursuit);
    CHECK(classify({{0, 0.1, 0.05}, {3, 0, 0}}, 0.0, steady) == Ending::pursuit); // whichever is in front
    CHECK(classify({{3, 0, 0}, {0, 0.1, 0.2}}, 0.0, steady) != Ending::pursuit);  // headings 0.2 apart
    CHECK(classify({{3, 0, 0}, {0, 0.1, 0.05}}, 0.0, changing) != Ending::pursuit);
    CHECK(classify({{0, 3, 0}, {0, 0, 0}}, 0.0, steady) == Ending::undecided); // abreast: nobody follows
    CHECK(classify({{3, 0, 2 * M_PI}, {0, 0, 0}}, 0.0, steady) ==
          Ending::pursuit); // headings count modulo a turn
}

TEST_CASE("escape needs growing distance and torques too weak to turn back") {
    CHECK(classify({{3, 0, 0}, {-3, 0, M_PI}}, 0.0, changing) == Ending::escape);
    CHECK(classify({{3, 0, 0}, {-3, 0, M_PI}}, 0.1, changing) ==
          Ending::undecided); // turns 0.3 rad meanwhile
    CHECK(classify({{3, 0, 0}, {-3, 0, M_PI}}, 0.0, turned_lately) ==
          Ending::undecided); // the rate only crosses 0
    CHECK(classify({{-3, 0, 0}, {3, 0, M_PI}}, 0.0, changing) == Ending::undecided); // approaching
}

TEST_CASE("the reason of an undecided run names the criteria that failed, with their numbers") {
    const auto failed = [](const PairEnd& pair) { return failed_criteria(pair, {}); };
    PairEnd pair{3.0, 0.1, 1.0, 0.0, {0.0, 0.2}, 0.2, changing};
    CHECK(failed(pair) == "no pursuit (the headings differ by 0.2 rad, limit 0.1), no escape (met)");
    pair.late.max_turning = 0.1;
    CHECK_THAT(failed(pair),
               Catch::Contains("turn by 1.5 of the angle between them while it doubles, limit 0.05"));
    pair.angle = 0.05;
    CHECK_THAT(failed(pair), Catch::Contains("varied by 1 of its mean at last, limit 0.05"));
    pair.vx = -0.5;
    CHECK_THAT(failed(pair), Catch::Contains("the separation does not grow, its rate is -0.5 of v0"));
    pair.late = steady;
    pair.x = 0.0;
    pair.y = -3.0;
    pair.heading[1] = 0.05;
    CHECK_THAT(failed(pair),
               Catch::Contains("the rear rod is 0.999 of the separation off the axis, limit 0.2"));

    // Of a run, and of the same pair in a batch.
    const rods::RodProblem problem{
        elastic::Medium{1.0, 1.0 / 0.3}, {23.5, 0.0, 0.0}, {{0, 0, 0}, {0, -5, M_PI / 2}}, 4.0, {}, 0.1};
    const std::string reason = rods::simulate(problem, {}).outcome.reason;
    CHECK_THAT(reason, Catch::StartsWith("rods 0 and 1 show no pursuit (the headings differ by ") &&
                           Catch::Contains("), no escape (") && Catch::Contains("), no orbit (") &&
                           Catch::EndsWith(" by t = 4; a longer t_end may decide"));
    const rods::PairProblem pairs[] = {*rods::to_pair_problem(problem)};
    rods::PairResult results[1];
    rods::simulate_pairs(pairs, {}, results);
    CHECK(rods::outcome_of(pairs[0], results[0]).reason.substr(0, 60) == reason.substr(0, 60));
}

TEST_CASE("the reason of an open outcome says that another run ends otherwise") {
    // side by side and pushed apart: rounding breaks the mirror symmetry in bdf
    const rods::RodProblem problem{
        elastic::Medium{1.0, 1.0}, {-1e4, 0.0, 0.0}, {{0, 2.5, 0}, {0, -2.5, 0}}, 60.0, {}, 0.1};
    rods::RodOptions options;
    options.ode.method = integrate::Method::bdf;
    const rods::RodOutcome outcome = rods::simulate_certified(problem, options).outcome;
    CHECK(outcome.ending == Ending::undecided);
    CHECK_THAT(outcome.reason, Catch::EndsWith("; a run with method erk ends in escape"));
}

TEST_CASE("rods that part at a small angle have not escaped while their wakes may still close it") {
    // at 30 000 they are in pursuit: they turn back by the last thousandth of a radian
    for (const auto& [t_end, ending] :
         {std::pair{1500.0, Ending::undecided}, {6000.0, Ending::undecided}, {30'000.0, Ending::pursuit}}) {
        rods::RodProblem problem{elastic::Medium{1.0, 1.0},
                                 {18.146875762939, 0.0, 0.0},
                                 {{0, 0, 0}, {0, -5, M_PI / 2}},
                                 t_end,
                                 {},
                                 0.1};
        CAPTURE(t_end);
        CHECK(rods::simulate(problem, {}).outcome.ending == ending);
        CHECK(rods::simulate_certified(problem, {}).outcome.ending == ending);
        const rods::PairProblem pair = *rods::to_pair_problem(problem);
        rods::PairResult result;
        rods::simulate_certified({&pair, 1}, {1e-8, 1e-10}, {&result, 1});
        CHECK(result.ending == ending);
    }
}

TEST_CASE("contact is found to the accuracy of the method") {
    const auto method = GENERATE(integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk);
    rods::RodOptions options;
    options.ode.method = method;
    const auto result = rods::simulate(straight({{-5, 0, 0}, {5, 0, M_PI}}, 20.0, 0.5), options);
    CHECK(result.outcome.ending == Ending::contact);
    CHECK(result.outcome.time == Approx(4.75).margin(1e-9)); // straight courses: exact but for root polishing
    CHECK(result.outcome.min_separation == Approx(0.5).margin(1e-9));
}

TEST_CASE("a contact that begins and ends inside one step is not missed") {
    const auto method = GENERATE(integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk);
    // Straight courses are integrated exactly, so steps grow far beyond the 0.07 that this encounter lasts.
    const double miss = 0.0995, contact = 0.1;
    rods::RodOptions options;
    options.ode.method = method;
    const auto result = rods::simulate(
        straight({{-40, 0, 0}, {0, -40 - miss * std::sqrt(2.0), M_PI / 2}}, 200.0, contact), options);
    INFO(result.solution.status.message());
    CHECK(result.outcome.ending == Ending::contact);
    CHECK(result.outcome.min_separation == Approx(contact).margin(1e-9)); // root polishing
}

TEST_CASE("contact of straight walkers that start far apart is found where the closed form has it") {
    const auto method = GENERATE(integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk);
    const double far = GENERATE(1e2, 1e4, 3e5, 1e6, 1e8, 1e10);
    const double contact = GENERATE(0.1, 2.0);
    const double rounding = 64.0 * std::numeric_limits<double>::epsilon() * far; // of places, some steps long
    rods::RodOptions options;
    options.ode.method = method;
    for (const double miss : {0.0, 0.5 * contact, 0.999 * contact, 1.001 * contact}) {
        const bool meets = miss < contact;
        if (std::abs(miss - contact) < 4.0 * rounding)
            continue; // nobody can tell
        // both come to the origin under a right angle, the second behind so that they miss by so much
        const auto result = rods::simulate(
            straight({{-far, 0, 0}, {0, -far - miss * std::sqrt(2.0), M_PI / 2}}, 3.0 * far, contact),
            options);
        CAPTURE(integrate::to_string(method), far, contact, miss, result.solution.status.message());
        CHECK(result.outcome.ending == (meets ? Ending::contact : Ending::escape));
        if (!meets)
            continue;
        // relative speed sqrt 2, closest at far + miss/sqrt 2
        const double half_chord = std::sqrt((contact - miss) * (contact + miss)),
                     time = far + (miss - half_chord) / std::sqrt(2.0);
        const double steepness = contact / half_chord; // dt = dr/(dr/dt)
        CHECK(std::abs(result.outcome.time - time) < 4.0 * steepness * rounding + 1e-9);
    }
}

TEST_CASE("of several contacts in one step the first counts") {
    const auto method = GENERATE(integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk);
    rods::RodOptions options;
    options.ode.method = method;
    // rods 0 and 1 graze at t = 1000; 2 and 3 meet head on at t = 3000
    const auto result = rods::simulate(
        straight({{-1000, 0, 0}, {0, -1000 - 0.1, M_PI / 2}, {-3000, 5e4, 0}, {3000, 5e4, M_PI}}, 1e4, 0.1),
        options);
    CHECK(result.outcome.ending == Ending::contact);
    CHECK(result.outcome.time == Approx(1000.0).margin(0.2)); // the chord of the graze
}

TEST_CASE("straight walkers in a box meet images that they reach inside a step") {
    const auto method = GENERATE(integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk);
    rods::RodOptions options;
    options.ode.method = method;
    auto problem = straight({{0, 0, 0}, {5, 5, M_PI}}, 1e4, 0.1);
    problem.rods[1].heading = M_PI + 0.01;
    problem.box = 10.0;
    // the way apart is (5 - 2 t, 5 - 0.01 t), nearly: lanes close in at t = 490, and images pass each 5
    const auto result = rods::simulate(problem, options);
    CHECK(result.outcome.ending == Ending::contact);
    CHECK(result.outcome.time == Approx(492.48).margin(2e-3)); // the closed form, looked at each 1e-3
}

TEST_CASE("the smallest separation is that of the whole path, not of the output times") {
    const auto result = rods::simulate(straight({{-5, 0, 0}, {0, -5.5, M_PI / 2}}, 20.0, std::nullopt), {});
    CHECK(result.outcome.min_separation ==
          Approx(0.5 / std::sqrt(2.0)).epsilon(1e-9)); // Hermite exact for straight courses
    CHECK(result.outcome.ending == Ending::escape);
}

TEST_CASE("rods that start within the contact distance are in contact at 0, whatever integrates them") {
    const auto starts = {std::vector<rods::Pose>{{0, 0, 0}, {1, 0, 2}, {9, 0, 0}}, // at the distance itself
                         std::vector<rods::Pose>{{0, 0, 0}, {0.5, 0, 2}, {9, 0, 0}},
                         std::vector<rods::Pose>{{0, 0, 0}, {0, 0, 2}, {9, 0, 0}}}; // in one place
    for (const auto& rods : starts) {
        rods::RodProblem problem = straight(rods, 1.0, 1.0);
        problem.medium = elastic::Medium{1.0, 1.0};
        problem.couplings.kappa = 1.0;
        problem.output_times = {0.0, 0.5};
        const double apart = rods[1].x;
        const auto ends_there = [&](const rods::RodResult& result) {
            CHECK(result.outcome.ending == Ending::contact);
            CHECK(result.outcome.time == 0.0);
            CHECK(result.outcome.min_separation == apart);
            CHECK(result.outcome.min_separation_time == 0.0);
            CHECK(result.outcome.turn == std::vector<double>(3));
            CHECK(result.outcome.pair.second == 1);
            CHECK(result.solution.status.ok());
            CHECK(result.solution.times == std::vector{0.0});
            CHECK(result.solution.states == std::vector(1, rods::to_state(rods)));
            CHECK_THAT(result.outcome.reason, Catch::Matchers::Contains("within the contact distance"));
        };
        for (const rods::Formulation form :
             {rods::Formulation::angle, rods::Formulation::director, rods::Formulation::dae}) {
            rods::RodOptions options;
            options.form = form;
            options.ode.method = integrate::Method::bdf;
            ends_there(rods::simulate(problem, options));
        }
        ends_there(
            rods::simulate(problem, {}, {.rotational = 0.1, .translational = 0.1, .time_step = 0.1}, 0));
        CHECK(rods::suitable_time_step(problem, 0.1) > 0.0);
        CHECK(rods::suitable_method(problem) == integrate::Method::erk);
        CHECK_THROWS_AS(rods::to_ode(problem), InputError); // whose event could not find it
    }
    auto apart = straight({{0, 0, 0}, {1, 0, 0}}, 1.0, std::nextafter(1.0, 0.0));
    CHECK(rods::simulate(apart, {}).outcome.time > 0.0);
    apart.contact_distance = 1.0;
    apart.output_times = {2.0};
    CHECK_THROWS_WITH(rods::simulate(apart, {}), Catch::Matchers::Contains("output_times"));
}

TEST_CASE("ill-posed problems are refused with the reason") {
    using Catch::Matchers::Contains;
    const rods::RodOptions options;
    CHECK_THROWS_WITH(rods::simulate(straight({}, 1.0, {}), options), Contains("no rods"));
    CHECK_THROWS_WITH(rods::simulate(straight({{1, 1, 0}, {1, 1, 2}}, 1.0, {}), options),
                      Contains("same place"));
    CHECK_THROWS_WITH(rods::simulate(straight({{0, 0, 0}}, -1.0, {}), options), Contains("t_end"));
    CHECK_THROWS_AS(
        rods::simulate({elastic::Medium{-1.0, 1.0}, {.kappa = 1}, {{0, 0, 0}, {1, 0, 0}}, 1.0, {}, {}},
                       options),
        InputError);
    CHECK_THROWS_AS(
        rods::simulate({elastic::Medium{1.0, 0.0}, {.kappa = 1}, {{0, 0, 0}, {1, 0, 0}}, 1.0, {}, {}},
                       options),
        InputError);
}

TEST_CASE("rods that run into each other without a contact distance fail with an explanation, not with NaN") {
    const auto method = GENERATE(integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk);
    const rods::RodProblem attracted{
        elastic::Medium{}, {.kappa = 0.5}, {{0, 2.5, 0}, {0, -2.5, 0}}, 60.0, {}, {}};
    rods::RodOptions options;
    options.ode.method = method;
    options.ode.max_steps = 20000;
    const auto result = rods::simulate(attracted, options);
    for (const double value : result.solution.final_state)
        CHECK(std::isfinite(value));
    REQUIRE_FALSE(result.solution.status.ok());
    CHECK_THAT(result.solution.status.message(), Catch::Matchers::Contains("rods_run.contact_distance"));
}

TEST_CASE("rods that do not interact do not pursue each other") {
    const auto result = rods::simulate(straight({{0, 0, 0}, {3, 0, 0}}, 10.0, std::nullopt), {});
    CHECK(result.outcome.ending == Ending::undecided);
}

TEST_CASE("an escape stays one when the run goes on") {
    // Separation grows from t = 10 on; at t = 40 the turning rate happens to cross zero.
    for (const double t_end : {200.0, 400.0, 800.0}) {
        const rods::RodProblem problem{
            elastic::Medium{}, {.kappa = -100.0}, {{0, 0, 0}, {-6, -5, M_PI / 2}}, t_end, {}, {}};
        const auto outcome = rods::simulate(problem, {}).outcome;
        INFO("t_end " << t_end << ": " << outcome.reason);
        CHECK(outcome.ending == Ending::escape);
    }
}

TEST_CASE("rods that pass through each other without a contact distance have no outcome") {
    for (const double kappa : {0.5, 5.0, -0.5})
        for (const auto method : {integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk}) {
            rods::RodProblem problem = straight({{0, 0, 0}, {3, 0, M_PI}}, 20.0, std::nullopt);
            problem.medium = elastic::Medium{1.0, 1.0};
            problem.couplings.kappa = kappa;
            rods::RodOptions options;
            options.ode.method = method;
            const auto result = rods::simulate(problem, options);
            CAPTURE(kappa, integrate::to_string(method));
            REQUIRE_FALSE(result.solution.status.ok());
            CHECK(result.solution.status.reached == Approx(1.5).margin(1e-6)); // half the way each
            CHECK_THAT(result.solution.status.advice, Catch::Matchers::Contains("contact_distance"));
            problem.contact_distance = 0.1;
            CHECK(rods::simulate(problem, options).outcome.ending == Ending::contact);
            problem.contact_distance.reset();
            problem.couplings.kappa = 0.0; // rods that feel nothing may pass
            CHECK(rods::simulate(problem, options).solution.status.ok());
        }
}
