// Many rods: pairs that matter are found without looking at all, threads change no bit, far wakes are left
// out within the tolerance.

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

using namespace rodwake;
using namespace rodwake::rods;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// `lattice` > 0: coordinates are whole multiples of it, so that many separations are equal to the bit.
std::vector<double> random_state(RandomStream& random, std::size_t rods, double width, double height,
                                 double lattice) {
    const auto place = [&](double side) {
        const double at = random.uniform(-0.7 * side, 1.3 * side);
        return lattice > 0.0 ? lattice * std::round(at / lattice) : at;
    };
    std::vector<double> y;
    for (std::size_t a = 0; a < rods; ++a)
        y.insert(y.end(), {place(width), place(height), random.uniform(-4.0, 4.0)});
    return y;
}

/// What the headings make of a state in a time h.
std::vector<double> walked(const std::vector<double>& y, double h) {
    std::vector<double> after = y;
    for (std::size_t k = 0; k < y.size(); k += 3) {
        after[k] += h * std::cos(y[k + 2]);
        after[k + 1] += h * std::sin(y[k + 2]);
    }
    return after;
}

/// The state of rods a and b alone.
std::vector<double> two_of(integrate::State y, std::size_t a, std::size_t b) {
    std::vector<double> two(y.begin() + 3 * static_cast<long>(a), y.begin() + 3 * static_cast<long>(a) + 3);
    two.insert(two.end(), y.begin() + 3 * static_cast<long>(b), y.begin() + 3 * static_cast<long>(b) + 3);
    return two;
}

// Each pair by itself: of two rods nothing is left out.

template<class See>
void each_pair(integrate::State y, const See& see) {
    for (std::size_t a = 0; a < y.size() / 3; ++a)
        for (std::size_t b = a + 1; b < y.size() / 3; ++b)
            see(a, b);
}

Separation closest_of_all(integrate::State y, Box box) {
    Separation best{0, 1, infinity};
    each_pair(y, [&](std::size_t a, std::size_t b) {
        const double distance = closest_pair(two_of(y, a, b), box).distance;
        if (distance < best.distance)
            best = {a, b, distance};
    });
    return best;
}

double step_of_all(integrate::State y, Box box) {
    double limit = infinity;
    each_pair(y, [&](std::size_t a, std::size_t b) {
        limit = std::min(limit, encounter_step(two_of(y, a, b), box));
    });
    return limit;
}

std::optional<Approach> approach_of_all(const integrate::Step& step, Box box, double below) {
    std::optional<Approach> best;
    each_pair(step.state, [&](std::size_t a, std::size_t b) {
        const auto before = two_of(step.state_before, a, b), after = two_of(step.state, a, b);
        const auto found = closest_approach({step.time_before, step.time, before, after}, box);
        if (found && found->pair.distance < (best ? best->pair.distance : below))
            best = Approach{found->time, {a, b, found->pair.distance}};
    });
    return best;
}

void check_equal(const std::optional<Approach>& found, const std::optional<Approach>& wanted) {
    REQUIRE(found.has_value() == wanted.has_value());
    if (!found)
        return;
    CHECK(found->time == wanted->time);
    CHECK(found->pair.first == wanted->pair.first);
    CHECK(found->pair.second == wanted->pair.second);
    CHECK(found->pair.distance == wanted->pair.distance);
}

void check_state(const std::vector<double>& y, Box box, double h) {
    const Separation found = closest_pair(y, box), wanted = closest_of_all(y, box);
    CHECK(found.first == wanted.first);
    CHECK(found.second == wanted.second);
    CHECK(found.distance == wanted.distance);
    CHECK(encounter_step(y, box) == step_of_all(y, box));
    const std::vector<double> after = walked(y, h);
    const integrate::Step step{2.0, 2.0 + h, y, after};
    for (const double below : {infinity, found.distance, 0.1 * found.distance})
        check_equal(closest_approach(step, box, below), approach_of_all(step, box, below));
}

RodProblem crowd(std::size_t rods, double side, const Couplings& couplings,
                 const InteractionOptions& sums = {}) {
    RandomStream random(17);
    RodProblem problem;
    problem.medium = elastic::Medium{1.3, 0.8};
    problem.couplings = couplings;
    for (std::size_t a = 0; a < rods; ++a) {
        const double x = random.uniform(0.0, side), y = random.uniform(0.0, side);
        problem.rods.push_back({x, y, random.uniform(-3.2, 3.2)});
    }
    problem.t_end = 0.3;
    problem.sums = sums;
    return problem;
}

std::vector<double> rates(const RodProblem& problem) {
    const auto y = to_state(problem.rods);
    std::vector<double> ydot(y.size());
    model_of(problem).rhs(y, ydot);
    return ydot;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k)
        largest = std::max(largest, std::abs(a[k] - b[k]));
    return largest;
}

} // namespace

TEST_CASE("near pairs are found as by looking at all, on the plane and in a box") {
    RandomStream random(5);
    for (const std::size_t rods : {2U, 16U, 17U, 40U, 90U})
        for (const double lattice : {0.0, 0.25})
            for (const double height : {9.0, 0.5, 400.0})
                for (const Box& box : {Box(), Box(9.0), Box(PeriodicBox(9.0, 14.0))})
                    for (const double h : {0.01, 0.4}) {
                        INFO(rods << " rods, lattice " << lattice << ", height " << height << ", box "
                                  << (box ? to_string(*box) : "none") << ", h " << h);
                        check_state(random_state(random, rods, 9.0, height, lattice), box, h);
                    }
}

TEST_CASE("rods in a row, whichever way, are found too") {
    for (const bool upright : {false, true})
        for (const Box box : {Box(), Box(31.0)}) {
            std::vector<double> y;
            for (int k = 0; k < 60; ++k)
                y.insert(y.end(), {upright ? 2.0 : 0.5 * k, upright ? 0.5 * k : 2.0, k % 2 ? 0.1 : 3.0});
            check_state(y, box, 0.2);
        }
}

TEST_CASE("a place that is not finite hides no pair") {
    RandomStream random(8);
    auto y = random_state(random, 30, 9.0, 9.0, 0.0);
    const Separation before = closest_pair(y);
    const std::size_t other = before.first == 3 || before.second == 3 ? 4 : 3;
    y[3 * other] = std::nan("");
    CHECK(closest_pair(y).distance == before.distance); // a sort by it would have no order
    CHECK(std::isfinite(encounter_step(y)));
}

TEST_CASE("threads change no bit of a run of many rods", "[threads]") {
    const Couplings couplings{.kappa = 3.0, .gamma1 = 0.01};
    RodProblem problem = crowd(200, 60.0, couplings);
    RodOptions options;
    options.ode.method = suitable_method(problem);
    options.ode.rtol = 1e-3;
    const RodResult one = simulate(problem, options);
    REQUIRE(one.solution.status.ok());
    for (const std::size_t threads : {2U, 3U}) {
        problem.sums.threads = threads;
        const RodResult other = simulate(problem, options);
        CHECK(other.solution.final_state == one.solution.final_state);
        CHECK(other.outcome.min_separation == one.outcome.min_separation);
    }
}

TEST_CASE("far wakes on meshes change no turning rate by more than the tolerance") {
    const Couplings all[] = {{.kappa = 4.0}, {.gamma1 = -2.0, .gamma2 = 3.0}, {.kappa = -4.0, .gamma2 = 1.0}};
    for (const Couplings& couplings : all) {
        const auto exact = rates(crowd(2500, 120.0, couplings));
        for (const double tolerance : {1e-1, 1e-3, 1e-5}) {
            const auto kept = rates(crowd(2500, 120.0, couplings, {.turning_tolerance = tolerance}));
            const double changed = largest_difference(kept, exact);
            INFO("kappa " << couplings.kappa << ", gamma2 " << couplings.gamma2 << ", tolerance "
                          << tolerance);
            CHECK(changed < tolerance);
            if (tolerance == 1e-1)
                CHECK(changed > 0.0); // not pair by pair
        }
    }
}

TEST_CASE("sums that need the exact field on the plane are refused elsewhere") {
    RodProblem problem = crowd(10, 9.0, {.kappa = 1.0}, {.accuracy = elastic::Accuracy::single});
    problem.box = 9.0;
    CHECK_THROWS_AS(model_of(problem), InputError);
    problem.box.reset();
    CHECK_NOTHROW(model_of(problem));
    problem.field = elastic::exact_field(*problem.medium);
    CHECK_THROWS_AS(model_of(problem), InputError);
}

TEST_CASE("precision of the sums tells in the rates") {
    const Couplings couplings{.kappa = 4.0};
    const auto exact = rates(crowd(100, 40.0, couplings));
    const double scale = *std::ranges::max_element(exact, {}, [](double rate) { return std::abs(rate); });
    const double fine =
                     largest_difference(rates(crowd(100, 40.0, couplings, {elastic::Accuracy::fine})), exact),
                 single = largest_difference(rates(crowd(100, 40.0, couplings, {elastic::Accuracy::single})),
                                             exact);
    // errors of one wake as accuracy.hpp has them; kappa and 99 of them
    CHECK(fine < 1e-7 * std::abs(scale) * 99.0);
    CHECK(single < 1e-3 * std::abs(scale) * 99.0);
    CHECK(fine < single);
}

TEST_CASE("of many rods pairs are not followed one by one") {
    RodProblem problem = crowd(most_followed_rods + 1, 500.0, {});
    RodResult result = simulate(problem, {});
    CHECK(result.outcome.ending == Ending::undecided);
    CHECK_THAT(result.outcome.reason, Catch::Contains("more than 100 rods"));
    CHECK(std::isfinite(result.outcome.min_separation));
    problem.couplings.kappa = 1e5; // stiff, were it a pair
    CHECK(suitable_method(problem) == integrate::Method::erk);
}
