// Rods in the dynamic medium's forces whose fields know nothing of their past: against wakes of point forces,
// and against the medium itself.

#include "medium/closed_rates.hpp"
#include "reference_run.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/medium/simulate.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

const elastic::Medium solid{1.0, 2.0};
constexpr rods::Couplings couplings{2.0, 1.0, -0.5};
/// Along sides of the box, so that images of a rod do not turn it.
const std::vector<double> poses{0.0, 2.0, 0.0, 0.5, -2.0, 0.5 * std::numbers::pi};

std::vector<double> rates(const DynamicMedium& medium, std::size_t threads = 1) {
    ClosedRates closed(solid, medium, couplings, 2, threads);
    std::vector<double> ydot(poses.size());
    closed.rates(poses, ydot);
    return ydot;
}

DynamicMedium closed(double width, Closure closure) {
    return {.box = 12.0,
            .force_width = width,
            .modes = static_cast<std::size_t>(2.0 * 12.0 / width),
            .closure = closure};
}

/// A weakly turning pair in a medium that relaxes fast, to t = 6: its slowest mode in 12^2 alpha/(2 pi)^2 =
/// 0.07.
MediumProblem pair(Closure closure) {
    MediumProblem p;
    p.rods.medium = elastic::Medium{1.0, 50.0};
    p.rods.couplings = {1.0, 0.0, 0.0};
    p.rods.rods = {{0.0, 1.5, 0.0}, {0.0, -1.5, 0.0}};
    p.rods.t_end = 6.0;
    p.medium = closed(0.6, closure);
    return p;
}

rods::RodResult run(const MediumProblem& problem) {
    rods::RodOptions options;
    options.ode.rtol = 1e-9;
    options.ode.atol = 1e-11;
    return simulate(problem, options);
}

} // namespace

TEST_CASE("steady closure: rates are those of point forces but for w^2") {
    std::vector<double> exact(poses.size());
    rods::RodModel(elastic::exact_field(solid, 12.0), couplings, 2).rhs(poses, exact);
    const double wide = tests::distance(rates(closed(0.4, Closure::steady)), exact),
                 narrow = tests::distance(rates(closed(0.2, Closure::steady)), exact);
    CHECK(std::log2(wide / narrow) == Approx(2.0).margin(0.15)); // of the next order, w^4
    CHECK(narrow < 0.02 * std::abs(exact[2]));
}

TEST_CASE("threads change no bit of a closure's rates", "[threads]") {
    for (const bool self_field : {false, true}) {
        DynamicMedium medium = closed(0.5, Closure::first_order);
        medium.self_field = self_field;
        CHECK(rates(medium, 1) == rates(medium, 3));
    }
    CHECK_THROWS_AS(rates(closed(0.5, Closure::none)), InputError);
}

TEST_CASE("where a medium relaxes fast the first order is nearer to its memory than steady wakes") {
    const std::vector<double> memory = run(pair(Closure::none)).solution.final_state,
                              steady = run(pair(Closure::steady)).solution.final_state,
                              first = run(pair(Closure::first_order)).solution.final_state;
    REQUIRE(std::abs(memory[2]) > 0.05); // it turns
    CAPTURE(memory[2], steady[2], first[2]);
    CHECK(tests::distance(first, memory) < 0.5 * tests::distance(steady, memory));
}

TEST_CASE("closed runs pass through a meeting: fields are smooth over the width of forces") {
    MediumProblem problem = pair(Closure::steady);
    problem.rods.rods = {{-1.5, 0.0, 0.0}, {1.5, 0.0, std::numbers::pi}};
    problem.rods.t_end = 3.0;
    const rods::RodResult result = run(problem);
    CHECK(result.solution.final_time == 3.0);
    CHECK(result.solution.final_state[0] == Approx(1.5).margin(1e-6)); // head-on neither turns the other
    CHECK(result.outcome.min_separation < 0.1);
}

TEST_CASE("a closed run stops at contact") {
    MediumProblem problem = pair(Closure::steady);
    problem.rods.couplings.kappa = 30.0;
    problem.rods.t_end = 20.0;
    problem.rods.contact_distance = 0.7;
    const rods::RodResult result = run(problem);
    CHECK(result.outcome.ending == Ending::contact);
    CHECK(result.outcome.min_separation == Approx(0.7).epsilon(1e-9));
}
