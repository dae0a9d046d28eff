// A run taken up from a checkpoint repeats the uninterrupted one to the bit.

#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <cstring>

using namespace rodwake;

namespace {

const rods::RodProblem three_rods{elastic::Medium{1.0, 1.0},
                                  {.kappa = 2.0, .gamma1 = 0.5, .gamma2 = -0.5},
                                  {{0, 0, 0}, {-3, 4, 0.3}, {-6, -2, 0.1}},
                                  30.0,
                                  {0.0, 1.0, 2.5, 5.0, 17.5, 30.0},
                                  std::nullopt};

rods::RodOptions options(integrate::Method method) {
    rods::RodOptions chosen;
    chosen.ode.method = method;
    chosen.ode.rtol = 1e-8;
    chosen.ode.atol = 1e-10;
    // Far below the default: several segments even in a short run. (Multistep methods start at order 1 each
    // time.)
    chosen.ode.segment_steps = method == integrate::Method::erk ? 6 : 30;
    return chosen;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

bool same_run(const rods::RodResult& a, const rods::RodResult& b) {
    bool same =
        same_bits(a.solution.times, b.solution.times) &&
        a.solution.states.size() == b.solution.states.size() &&
        same_bits({a.outcome.min_separation, a.outcome.time}, {b.outcome.min_separation, b.outcome.time}) &&
        a.outcome.ending == b.outcome.ending && a.solution.statistics.steps == b.solution.statistics.steps;
    for (std::size_t i = 0; same && i < a.solution.states.size(); ++i)
        same = same_bits(a.solution.states[i], b.solution.states[i]);
    return same;
}

} // namespace

TEST_CASE("every checkpoint of a run leads to the same end, to the bit") {
    const auto method = GENERATE(integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk);
    std::vector<rods::RodCheckpoint> checkpoints;
    rods::RodOptions whole = options(method);
    whole.on_checkpoint = [&](const rods::RodCheckpoint& c) { checkpoints.push_back(c); };
    const rods::RodResult uninterrupted = rods::simulate(three_rods, whole);
    REQUIRE(checkpoints.size() >= 2);
    for (const rods::RodCheckpoint& checkpoint : checkpoints) {
        rods::RodOptions rest = options(method);
        rest.resume_from = checkpoint;
        CHECK(same_run(uninterrupted, rods::simulate(three_rods, rest)));
    }
    rods::RodOptions wrong = options(method); // the comparison can fail
    wrong.resume_from = checkpoints[0];
    wrong.resume_from->state[3] += 1e-9;
    CHECK_FALSE(same_run(uninterrupted, rods::simulate(three_rods, wrong)));
}

TEST_CASE("method auto takes BDF for stiff headings only") {
    const auto pair = [](double kappa) {
        return rods::RodProblem{
            elastic::Medium{}, {.kappa = kappa}, {{0, 2.5, 0}, {0, -2.5, 0}}, 1.0, {}, {}};
    };
    CHECK(rods::suitable_method(pair(0.5)) == integrate::Method::erk);
    CHECK(rods::suitable_method(pair(100.0)) == integrate::Method::erk);
    CHECK(rods::suitable_method(pair(1e4)) == integrate::Method::bdf);
    CHECK(rods::stiffness(pair(0.0)) == 0.0);
    CAPTURE(rods::stiffness(pair(100.0)), rods::stiffness(pair(1e4)));
    CHECK(rods::stiffness(pair(1e4)) == Approx(100.0 * rods::stiffness(pair(100.0)))); // linear in kappa
}
