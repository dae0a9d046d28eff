// What is proved of outcomes: the parts of the bound against what they bound, the bound against runs at the
// tightest tolerance, certificates against those runs' outcomes.

#include "random_pairs.hpp"

#include "rods/pair_jets.hpp"
#include "rods/pair_proof.hpp"
#include "rods/turning_bound.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/rods/conclude.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace rodwake;
using namespace rodwake::rods;

namespace {

constexpr double step = 1e-5; // of central differences: their error is step^2, and rounding over step

std::vector<double> state_of(const PairProblem& pair) { return to_state(pair.rods); }

/// Jets of one state, by the kernels.
PairJets jets_of(const PairProblem& pair) {
    PairJets jets;
    jets.resize(1);
    const std::vector<double> y = state_of(pair);
    const double columns[4] = {y[0] - y[3], y[1] - y[4], y[2], y[5]};
    for (std::size_t k = 0; k < 4; ++k)
        jets.at[k][0] = columns[k];
    REQUIRE(fill_jets(pair.medium, pair.couplings, jets));
    return jets;
}

double rate_of(const PairProblem& pair, std::size_t rod) {
    std::vector<double> rate(6);
    model_of(to_rod_problem(pair)).rhs(state_of(pair), rate);
    return rate[3 * rod + 2];
}

/// The pair with x, y of R_0 - R_1 or a heading moved.
PairProblem moved(PairProblem pair, std::size_t coordinate, double by) {
    double* const where[4] = {&pair.rods[0].x, &pair.rods[0].y, &pair.rods[0].heading, &pair.rods[1].heading};
    *where[coordinate] += by;
    return pair;
}

double difference_quotient(const PairProblem& pair, std::size_t rod, std::size_t coordinate) {
    return (rate_of(moved(pair, coordinate, step), rod) - rate_of(moved(pair, coordinate, -step), rod)) /
           (2.0 * step);
}

/// Of rod 0 in the wake of rod 1: where r + x is.
double ahead_of(const PairProblem& pair) {
    const double x = pair.rods[0].x - pair.rods[1].x, y = pair.rods[0].y - pair.rods[1].y;
    return std::hypot(x, y) + x * std::cos(pair.rods[1].heading) + y * std::sin(pair.rods[1].heading);
}

double distance_of(const PairProblem& pair) {
    return std::hypot(pair.rods[0].x - pair.rods[1].x, pair.rods[0].y - pair.rods[1].y);
}

/// Largest rate of rod 0, over `share` of the bound, at places within half the width.
double worst_share(const PairProblem& pair, RandomStream& random, double share) {
    const TurningBound bound(pair.medium, pair.couplings);
    const double r = distance_of(pair), width = bound.suitable_width(r, ahead_of(pair));
    const double most = share * bound.at(r, ahead_of(pair), width).rate;
    double worst = 0.0;
    for (int k = 0; k < 20; ++k) {
        const double way = 0.5 * width * r / std::numbers::sqrt2 * random.uniform(),
                     where = random.uniform(-std::numbers::pi, std::numbers::pi);
        worst = std::max(
            worst,
            std::abs(rate_of(moved(moved(pair, 0, way * std::cos(where)), 1, way * std::sin(where)), 0)) /
                most);
    }
    return worst;
}

/// The steps of a run.
PairTrack track_of(const PairProblem& pair, const PairOptions& options, PairResult& result) {
    PairTrack track;
    track.add(0.0, state_of(pair));
    PairOptions followed = options;
    followed.on_step = [&](std::size_t, const PairStep& one) { track.add(one.time, one.state); };
    std::vector<PairResult> results(1);
    simulate_pairs(std::span(&pair, 1), followed, results);
    result = results[0];
    return track;
}

/// Largest error of a final state over its bound; 0 where there is no bound, or the run ended early.
double share_of_bound(const PairProblem& pair, double shrunk, int& bounded) {
    PairResult run, exact;
    ProofSpace space;
    PairOptions options{1e-9, 1e-11};
    const PairTrack track = track_of(pair, options, run);
    track_of(pair, {1e-13, 1e-15, {}, 1'000'000}, exact);
    if (run.handed_over() || exact.handed_over() || run.ending == Ending::contact)
        return 0.0;
    const auto bounds = proved_bounds(pair, track, false, options.criteria, space);
    if (!bounds)
        return 0.0;
    ++bounded;
    const double rounding = 1e-11; // of the exact run: 1000 steps, coordinates up to 40
    const double x = run.state[0] - run.state[3] - exact.state[0] + exact.state[3],
                 y = run.state[1] - run.state[4] - exact.state[1] + exact.state[4];
    return std::max(
        {std::hypot(x, y) / (shrunk * bounds->place_error + rounding),
         std::abs(run.state[2] - exact.state[2]) / (shrunk * bounds->heading_error[0] + rounding),
         std::abs(run.state[5] - exact.state[5]) / (shrunk * bounds->heading_error[1] + rounding)});
}

} // namespace

TEST_CASE("Jets are the rates and their derivatives") {
    for (const bool polar : {false, true})
        for (const PairProblem& pair : random_pairs(20, 3, polar)) {
            const PairJets jets = jets_of(pair);
            for (const std::size_t rod : {0, 1}) {
                const std::size_t first = rod == 0 ? PairJets::rate0 : PairJets::rate1;
                const double size = TurningBound(pair.medium, pair.couplings)
                                        .at(distance_of(pair), 0.0, 0.1)
                                        .rate; // of the parts, and of derivatives over the distance
                CHECK(jets(first, 0) == Approx(rate_of(pair, rod)).margin(1e-12 * size));
                for (std::size_t k = 0; k < 4; ++k)
                    CHECK(jets(first + 1 + k, 0) ==
                          Approx(difference_quotient(pair, rod, k)).epsilon(1e-6).margin(1e-7 * size));
            }
        }
}

TEST_CASE("The bound of the turning rate holds about a place, and a fiftieth of it would not") {
    RandomStream random(5);
    double worst = 0.0, worst_of_part = 0.0;
    for (const bool polar : {false, true})
        for (const PairProblem& pair : random_pairs(100, 4, polar)) {
            worst = std::max(worst, worst_share(pair, random, 1.0));
            worst_of_part = std::max(worst_of_part, worst_share(pair, random, 0.02));
        }
    CHECK(worst < 1.0);
    CHECK(worst_of_part > 1.0);
}

TEST_CASE("The error of a run is below its bound, and above a millionth of it") {
    int bounded = 0, again = 0;
    double worst = 0.0, worst_of_little = 0.0;
    for (const bool polar : {false, true})
        for (const PairProblem& pair : random_pairs(40, 6, polar)) {
            worst = std::max(worst, share_of_bound(pair, 1.0, bounded));
            worst_of_little = std::max(worst_of_little, share_of_bound(pair, 1e-6, again));
        }
    CHECK(bounded >= 20);
    CHECK(worst < 1.0);
    CHECK(worst_of_little > 1.0);
}

TEST_CASE("Bounds without width decide as the criteria do; wide ones do not") {
    EncounterBounds bounds;
    bounds.contact = EncounterBounds::Contact::none;
    bounds.x = 10.0;
    bounds.heading[1] = std::numbers::pi; // parting
    bounds.late_least = {5.0, 5.0};
    bounds.late_most = {10.0, 10.0};
    bounds.late_turning = {0.0, 0.001};
    const auto anywhere = [](double) { return true; };
    CHECK(certain_ending(bounds, {}, anywhere) == Ending::escape); // 0.001 10/2 rad is left, 0.05 allowed
    bounds.late_turning.high = 0.011;
    CHECK_FALSE(certain_ending(bounds, {}, anywhere));
    bounds.late_turning.low = 0.0101;
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

TEST_CASE("Certificates are true, and many") {
    std::vector<PairProblem> pairs = random_pairs(60, 7, false);
    for (PairProblem& pair : pairs)
        pair.couplings.kappa = std::clamp(pair.couplings.kappa, -20.0, 20.0);
    std::vector<PairResult> results(pairs.size());
    simulate_certified(pairs, {1e-7, 1e-9}, results);
    const std::vector<PairResult> exact = results_of(pairs, {1e-12, 1e-14, {}, 1'000'000});
    int proved = 0, open = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        proved += results[i].certificate == Certificate::proved;
        open += results[i].certificate == Certificate::open;
        if (results[i].certificate != Certificate::open)
            CHECK(results[i].ending == exact[i].ending);
    }
    CHECK(proved >= 30);
    CHECK(open <= 6);
}

TEST_CASE("An outcome at its very limit is open") {
    PairProblem pair = random_pairs(1, 8, false)[0];
    pair.medium = {1.0, 1.0};
    pair.couplings = {0.3, 0.0, 0.0};
    pair.rods = {Pose{0.0, 0.0, 0.0}, Pose{4.0, -3.0, 1.9}};
    pair.contact_distance = 0.0;
    PairResult run;
    track_of(pair, {1e-12, 1e-14, {}, 1'000'000}, run);
    for (const double off : {1e-12, -1e-12}) {
        pair.contact_distance = run.min_separation + off;
        std::vector<PairResult> results(1);
        simulate_certified(std::span(&pair, 1), {1e-5, 1e-7}, results);
        CHECK(results[0].certificate == Certificate::open);
    }
    pair.contact_distance = 0.5 * run.min_separation;
    std::vector<PairResult> results(1);
    simulate_certified(std::span(&pair, 1), {1e-7, 1e-9}, results);
    CHECK(results[0].certificate == Certificate::proved);
}

TEST_CASE("Rods that walk straight are proved but at rounding") {
    RodProblem problem;
    problem.t_end = 30.0;
    problem.contact_distance = 1.0;
    const auto pass = [&](double aside) { // the second walks to and past the first, which stands across
        problem.rods = {Pose{0.0, 0.0, 0.0}, Pose{10.0, aside, std::numbers::pi}};
        return simulate_certified(problem, {}).outcome;
    };
    CHECK(pass(1.0 + 1e-9).certificate == Certificate::proved);
    CHECK(pass(1.0 + 1e-9).ending != Ending::contact);
    CHECK(pass(1.0 - 1e-9).ending == Ending::contact);
    CHECK(pass(1.0 - 1e-9).certificate == Certificate::proved);
    problem.rods = {Pose{}, Pose{0.0, std::nextafter(1.0, 2.0), 0.0}}; // abreast, an ulp from contact
    problem.t_end = 300.0;
    CHECK(simulate_certified(problem, {}).outcome.certificate == Certificate::open);
    problem.t_end = 30.0;
    pass(2.0);
    problem.rods.push_back({500.0, 0.0, 1.0});
    CHECK(pass(2.0).certificate == Certificate::proved);
}

TEST_CASE("Runs beyond the theorem are checked, those that failed are open") {
    RodProblem problem;
    problem.medium = elastic::Medium{1.0, 1.0};
    problem.couplings.kappa = 1.0;
    problem.rods = {Pose{0.0, 2.0, 0.0}, Pose{0.0, -2.0, 0.0}};
    problem.t_end = 5.0;
    problem.contact_distance = 0.1;
    CHECK(simulate_certified(problem, {}).outcome.certificate == Certificate::proved);
    problem.rods.push_back({3.0, 7.0, 1.0});
    CHECK(simulate_certified(problem, {}).outcome.certificate == Certificate::checked);
    problem.couplings.kappa = std::nan("");
    CHECK(simulate_certified(problem, {}).outcome.certificate == Certificate::open);
    problem.rods.resize(1);
    problem.couplings.kappa = 1.0;
    CHECK(simulate_certified(problem, {}).outcome.certificate == Certificate::proved);
}

TEST_CASE("A box of pairs ends alike, or not") {
    PairProblem low;
    low.medium = {1.0, 1.0};
    low.couplings.kappa = 0.3;
    low.rods = {Pose{0.0, 0.0, 0.0}, Pose{5.0, -4.0, -1.5}};
    low.t_end = 40.0;
    low.contact_distance = 0.1;
    PairProblem high = low;
    high.couplings.kappa = 0.31;
    high.rods[1].x += 0.05;
    const PairOptions options{1e-8, 1e-10};
    std::vector<PairResult> corner(1);
    simulate_pairs(std::span(&low, 1), options, corner);
    CHECK(all_end(low, high, corner[0].ending, options));
    CHECK_FALSE(all_end(low, high, Ending::contact, options));
    high.rods[1].x -= 9.0; // across a collision course
    CHECK_FALSE(all_end(low, high, corner[0].ending, options));
    high = low;
    high.medium.eta = 1.1;
    CHECK_FALSE(all_end(low, high, corner[0].ending, options));
}
