// Rods that diffuse, against closed forms and against themselves at shorter steps on the same paths.

#include "rodwake/core/error.hpp"
#include "rodwake/rods/noise_ensemble.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace rodwake;
using namespace rodwake::rods;

namespace {

/// Sum of values and of their squares.
struct Mean {
    double sum = 0.0, squares = 0.0;
    int count = 0;

    void add(double value) {
        sum += value;
        squares += value * value;
        ++count;
    }
    double value() const { return sum / count; }
    double error() const { return std::sqrt((squares / count - value() * value()) / count); }
};

RodProblem side_by_side(double half) {
    RodProblem problem;
    problem.rods = {{0.0, half, 0.0}, {0.0, -half, 0.0}};
    problem.t_end = 4.0;
    return problem;
}

RodProblem wakes(double half, double kappa) {
    RodProblem problem = side_by_side(half);
    problem.medium = elastic::Medium{1.0, 1.0};
    problem.couplings.kappa = kappa;
    return problem;
}

/// Probability that Brownian motion of diffusion coefficient D in the plane, from the distance r of a disc of
/// radius a, has touched the disc by the time t (Carslaw and Jaeger, Conduction of Heat in Solids, 13.5):
/// 1 + (2/pi) int exp(-D u^2 t) (J0(u r) Y0(u a) - Y0(u r) J0(u a))/(J0(u a)^2 + Y0(u a)^2) du/u. In ln u;
/// below u = 1e-7/a by what the integrand becomes there.
double touched(double a, double r, double D, double t) {
    const double from = std::log(1e-7 / a), to = std::log(std::sqrt(40.0 / (D * t)));
    const double log_ratio = std::log(r / a), c = std::log(0.5 * a) + std::numbers::egamma;
    constexpr int points = 4000; // the rule is exact to 1e-6 at 2000
    double sum = -log_ratio * (std::atan(2.0 / std::numbers::pi * (from + c)) + 0.5 * std::numbers::pi);
    for (int i = 0; i < points; ++i) {
        const double u = std::exp(from + (i + 0.5) * (to - from) / points);
        const double ja = std::cyl_bessel_j(0, u * a), ya = std::cyl_neumann(0, u * a);
        sum += std::exp(-D * u * u * t) *
               (std::cyl_bessel_j(0, u * r) * ya - std::cyl_neumann(0, u * r) * ja) / (ja * ja + ya * ya) *
               (to - from) / points;
    }
    return 1.0 + 2.0 / std::numbers::pi * sum;
}

double distance(const std::vector<double>& y, const std::vector<double>& other) {
    double squares = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i)
        squares += (y[i] - other[i]) * (y[i] - other[i]);
    return std::sqrt(squares);
}

const RodOptions options{};

} // namespace

TEST_CASE("free rods lose their headings and spread as theory says") {
    RodProblem problem;
    problem.rods = {{0.0, 0.0, 0.3}};
    problem.t_end = 4.0;
    problem.output_times = {0.0, 1.0, 4.0};
    const double D = 0.5, Dt = 0.05;
    const Noise noise{D, Dt, suitable_time_step(problem, D), 1};
    Mean square[3], heading[3];
    for (std::uint32_t run = 0; run < 4000; ++run) {
        const RodResult result = simulate(problem, options, noise, run);
        REQUIRE(result.solution.states.size() == 3);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& y = result.solution.states[k];
            square[k].add(y[0] * y[0] + y[1] * y[1]);
            heading[k].add(std::cos(y[2] - 0.3));
        }
    }
    CHECK(square[0].value() == 0.0);
    for (std::size_t k = 1; k < 3; ++k) {
        const double t = problem.output_times[k];
        const double expected = 2.0 / (D * D) * (D * t - 1.0 + std::exp(-D * t)) + 4.0 * Dt * t;
        CHECK(std::abs(square[k].value() - expected) < 3.0 * square[k].error());
        CHECK(std::abs(heading[k].value() - std::exp(-D * t)) < 3.0 * heading[k].error());
    }
}

TEST_CASE("two rods in each other's wake: strong order 1.5 on one Brownian path") {
    const RodProblem problem = wakes(2.0, 2.0);
    constexpr std::uint32_t runs = 40;
    std::vector<double> squares(5);
    for (std::uint32_t run = 0; run < runs; ++run) {
        const auto at = [&](int level) { // steps of 4/2^level
            return simulate(problem, options, {0.2, 0.02, std::ldexp(4.0, -level), 1}, run)
                .solution.final_state;
        };
        const auto fine = at(11);
        for (int level = 4; level <= 8; ++level)
            squares[static_cast<std::size_t>(level - 4)] += std::pow(distance(at(level), fine), 2) / runs;
    }
    double slope = 0.0;
    for (int k = 0; k < 5; ++k)
        slope -= (k - 2) * 0.5 * std::log2(squares[static_cast<std::size_t>(k)]) / 10.0;
    // 1.46 over 100 runs; the scatter of an rms of 40 moves it by less than 0.1
    CHECK(slope == Approx(1.5).margin(0.2));
}

TEST_CASE("separations that diffuse meet with the probability of Brownian motion, however long the steps") {
    RodProblem problem;
    problem.rods = {{0.0, 0.0, 0.7}, {0.0, 1.0, 0.7}}; // abreast: no drift between them
    problem.t_end = 0.6;
    problem.contact_distance = 0.5;
    const double Dt = 0.2;
    constexpr int runs = 4000;
    Mean early, late;
    for (std::uint32_t run = 0; run < runs; ++run) {
        const RodResult result = simulate(problem, options, {0.0, Dt, 0.05, 1}, run);
        const bool met = result.outcome.ending == Ending::contact;
        late.add(met);
        early.add(met && result.outcome.time < 0.2);
        if (met)
            CHECK(closest_pair(result.solution.final_state).distance == Approx(0.5).epsilon(1e-12));
    }
    CHECK(std::abs(late.value() - touched(0.5, 1.0, 2.0 * Dt, 0.6)) < 3.0 * late.error());
    CHECK(std::abs(early.value() - touched(0.5, 1.0, 2.0 * Dt, 0.2)) < 3.0 * early.error());
}

TEST_CASE("contacts of rods that only turn at random are those of shorter steps on the same path") {
    RodProblem problem = wakes(2.5, 10.0);
    problem.t_end = 20.0;
    problem.contact_distance = 0.1;
    int contacts = 0;
    for (std::uint32_t run = 0; run < 12; ++run) {
        const RodResult coarse = simulate(problem, options, {0.01, 0.0, 0.1, 3}, run);
        const RodResult fine = simulate(problem, options, {0.01, 0.0, 0.02, 3}, run);
        CHECK(coarse.outcome.ending == fine.outcome.ending);
        if (fine.outcome.ending != Ending::contact)
            continue;
        ++contacts;
        // means of 25 contacts differ by 3e-5 between steps of 0.1 and 0.0125; single ones by some 1e-3
        CHECK(coarse.outcome.time == Approx(fine.outcome.time).margin(5e-3));
        CHECK(coarse.outcome.min_separation == Approx(0.1).epsilon(1e-12));
    }
    CHECK(contacts > 0);
}

TEST_CASE("a run depends on seed and number alone, and rods are independent") {
    RodProblem problem = side_by_side(2.0);
    const Noise noise{0.3, 0.0, 0.05, 7};
    const auto y = simulate(problem, options, noise, 5).solution.final_state;
    CHECK(y == simulate(problem, options, noise, 5).solution.final_state);
    CHECK(y != simulate(problem, options, noise, 6).solution.final_state);
    CHECK(y != simulate(problem, options, {0.3, 0.0, 0.05, 8}, 5).solution.final_state);
    Mean product;
    for (std::uint32_t run = 0; run < 2000; ++run) {
        const auto end = simulate(problem, options, {0.3, 0.0, 4.0, 7}, run).solution.final_state;
        product.add(end[2] * end[5]); // headings start at 0
    }
    CHECK(std::abs(product.value()) < 3.0 * product.error());
}

TEST_CASE("an ensemble is the same on any number of threads, and in parts", "[threads]") {
    RodProblem problem = wakes(2.5, 10.0);
    problem.contact_distance = 0.5;
    problem.output_times = {0.0, 2.0};
    const Noise noise{0.1, 0.01, 0.1, 2};
    NoiseSums one = no_runs(problem), two = no_runs(problem), parts = no_runs(problem);
    CHECK(run_ensemble(problem, options, noise, 40, 1, one));
    CHECK(run_ensemble(problem, options, noise, 40, 2, two));
    CHECK(run_ensemble(problem, options, noise, 13, 1, parts));
    CHECK(run_ensemble(problem, options, noise, 40, 2, parts));
    CHECK(one.ends.size() == 40);
    for (const NoiseSums* other : {&two, &parts}) {
        CHECK(one.square == other->square);
        CHECK(one.square_squares == other->square_squares);
        CHECK(one.cosine == other->cosine);
        for (std::size_t run = 0; run < 40; ++run)
            CHECK(one.ends[run].time == other->ends[run].time);
    }
    CHECK(one.square[0] == 0.0);
    CHECK(one.cosine[0] == 40.0);
    CHECK(one.reached == std::vector<double>{40.0, one.reached[1], one.reached[2]});
}

TEST_CASE("noisy runs without noise follow the equations of motion") {
    RodProblem problem = wakes(2.0, 2.0);
    RodOptions exact;
    exact.ode.method = integrate::Method::erk;
    exact.ode.rtol = 1e-11;
    const auto y = simulate(problem, exact).solution.final_state;
    CHECK(distance(simulate(problem, options, {0.0, 0.0, 0.01, 1}, 0).solution.final_state, y) < 1e-8);
}

TEST_CASE("noisy runs refuse what cannot be and fail with a reason") {
    const RodProblem problem = wakes(2.0, 2.0);
    CHECK_THROWS_AS(simulate(problem, options, {-0.1, 0.0, 0.1, 1}, 0), InputError);
    CHECK_THROWS_AS(simulate(problem, options, {0.1, -1.0, 0.1, 1}, 0), InputError);
    CHECK_THROWS_AS(simulate(problem, options, {0.1, 0.0, 0.0, 1}, 0), InputError);
    RodOptions few;
    few.ode.max_steps = 10;
    const auto status = simulate(problem, few, {0.1, 0.0, 0.01, 1}, 0).solution.status;
    CHECK(status.termination == integrate::Termination::failed);
    CHECK_THAT(status.message(), Catch::Contains("the steps allowed were used up"));
    RodOptions stopped;
    stopped.ode.stop_requested = [] { return true; };
    CHECK(simulate(problem, stopped, {0.1, 0.0, 0.01, 1}, 0).solution.status.termination ==
          integrate::Termination::interrupted);
}

TEST_CASE("two rods in each other's wake: weak order 2", "[.long]") {
    const RodProblem problem = wakes(4.0, 2.0);
    constexpr std::uint32_t runs = 4000;
    std::vector<double> bias(5), squares(5);
    for (std::uint32_t run = 0; run < runs; ++run) {
        const auto at = [&](int level) { // steps of 4/2^level: 1 to 1/16, beside 1/64
            const auto y =
                simulate(problem, options, {1.0, 0.05, std::ldexp(4.0, -level), 1}, run).solution.final_state;
            return y[0] + y[3]; // how far they got along x
        };
        const double fine = at(8);
        for (int level = 2; level <= 6; ++level) {
            const double error = at(level) - fine;
            bias[static_cast<std::size_t>(level - 2)] += error / runs;
            squares[static_cast<std::size_t>(level - 2)] += error * error / runs;
        }
    }
    double slope = 0.0, variance = 0.0;
    for (std::size_t k = 0; k < 5; ++k) {
        const double weight = (static_cast<double>(k) - 2.0) / 10.0;
        slope -= weight * std::log2(std::abs(bias[k]));
        variance += weight * weight * squares[k] / runs / (bias[k] * bias[k]);
        UNSCOPED_INFO("step " << std::ldexp(4.0, -static_cast<int>(k) - 2) << ": mean " << bias[k] << " +- "
                              << std::sqrt(squares[k] / runs) << ", rms " << std::sqrt(squares[k]));
    }
    UNSCOPED_INFO("slope " << slope << " +- " << std::sqrt(variance) / std::log(2.0));
    CHECK(std::abs(slope - 2.0) < 0.1 + 3.0 * std::sqrt(variance) / std::log(2.0));
}
