// Fits of made-up profiles: known parameters come back, within errors that mean what they say.

#include "catch2/catch.hpp"
#include "rodwake/fitting/report.hpp"
#include "synthetic_profiles.hpp"

#include <array>

using namespace rodwake::fitting;
using namespace fitting_test;

namespace {

const std::vector<double> truth = {2.2, 1.3, 22.0};

std::vector<Parameter> elastic_parameters(const std::vector<double>& start) {
    return {{.name = "f_over_mu", .start = start[0]},
            {.name = "eta", .start = start[1], .lower = 1e-6, .upper = 1e6, .transform = Transform::log},
            {.name = "xi", .start = start[2], .lower = 1e-6, .upper = 1e6, .transform = Transform::log}};
}

/// U_x(x, 0) and U_y(x, 4) at 50 places each, as the paper has them, in a box of 78.
std::vector<Profile> two_profiles(const WakeModel& model, double sigma, rodwake::RandomStream* noise) {
    const Profile ux{.name = "Ux", .component = Component::Ux, .along = Axis::x, .at = 0.0};
    Profile uy = ux;
    uy.component = Component::Uy, uy.at = 4.0, uy.name = "Uy";
    const auto list = elastic_parameters(truth);
    return {made_up(model, list, truth, ux, 50, 38.0, sigma, noise),
            made_up(model, list, truth, uy, 50, 38.0, sigma, noise)};
}

/// How many of `fits` 95 % intervals hold the true value, for each parameter; behind them how many would, if
/// they had a quarter of their width.
std::array<int, 6> covered(int fits) {
    const WakeModel model{78.0, 0.0, 0.0};
    std::array<int, 6> count{};
    for (int i = 0; i < fits; ++i) {
        rodwake::RandomStream noise(2026, static_cast<std::uint32_t>(i));
        const Problem problem =
            wake_problem(model, two_profiles(model, 0.01, &noise), elastic_parameters({1.5, 2.0, 15.0}));
        const Report found = report(problem, fit(problem, {}));
        for (std::size_t j = 0; j < 3; ++j) {
            const ParameterEstimate& one = found.estimates[j];
            const double middle = 0.5 * (one.low + one.high), half = 0.5 * (one.high - one.low);
            count[j] += std::abs(truth[j] - middle) <= half;
            count[j + 3] += std::abs(truth[j] - middle) <= 0.25 * half;
        }
    }
    return count;
}

} // namespace

TEST_CASE("exact profiles give the parameters back to rounding") {
    for (const std::optional<rodwake::PeriodicBox> box :
         {std::optional<rodwake::PeriodicBox>(), std::optional<rodwake::PeriodicBox>(78.0),
          std::optional(rodwake::PeriodicBox(78.0, 60.0))}) {
        const WakeModel model{box, 0.0, 0.0};
        const Problem problem =
            wake_problem(model, two_profiles(model, 0.01, nullptr), elastic_parameters({1.0, 1.0, 10.0}));
        const Fit found = fit(problem, {});
        CHECK(found.termination == Termination::converged);
        for (std::size_t j = 0; j < 3; ++j)
            CHECK(found.values[j] ==
                  Approx(truth[j]).epsilon(1e-9)); // rounding of U times the condition of the problem
    }
}

// Binomial scatter of 100 fits: 95 +- 2.2, so 5 and fewer misses at 4 standard deviations: 86.
TEST_CASE("most 95 % intervals hold the true value") {
    const auto count = covered(100);
    for (std::size_t j = 0; j < 3; ++j) {
        CHECK(count[j] >= 86);
        CHECK(count[j + 3] < 60); // intervals that claim too much are seen
    }
}

TEST_CASE("95 % intervals hold the true value in 93 to 97 % of 1000 fits", "[.][long]") {
    const auto count = covered(1000);
    for (std::size_t j = 0; j < 3; ++j) {
        WARN("intervals that hold the true value, of 1000: " << count[j]);
        CHECK(count[j] >= 930);
        CHECK(count[j] <= 970);
    }
}

namespace {

/// How many of so many random starts within a factor of 10 reach the best optimum.
std::size_t at_best_optimum(std::size_t starts) {
    const WakeModel model{78.0, 0.0, 0.0};
    rodwake::RandomStream noise(11);
    const Problem problem = wake_problem(model, two_profiles(model, 0.02, &noise), elastic_parameters(truth));
    Method many;
    many.starts = starts;
    many.spread = 10.0;
    many.threads = 2;
    const Fit found = fit(problem, many);
    CHECK(found.starts.size() == starts);
    return report(problem, found).same_optimum;
}

} // namespace

TEST_CASE("random starts within a factor of 10 reach one optimum") { CHECK(at_best_optimum(20) >= 19); }

TEST_CASE("of 100 random starts within a factor of 10 at least 95 reach one optimum", "[.long]") {
    CHECK(at_best_optimum(100) >= 95);
}

TEST_CASE("U_x far behind the rod alone does not fix the medium, and the report says so") {
    const Profile far{.name = "tail", .component = Component::Ux, .along = Axis::x, .at = 0.0};
    const auto list = elastic_parameters(truth);
    Profile tail = made_up({}, list, truth, far, 40, 1.0, 0.001);
    for (double& place : tail.place)
        place = -6000.0 + 1000.0 * place; // there U_x is f sqrt(xi/|x|)/(2 sqrt(pi)) times a function of eta
    tail.value = predict({}, tail, tail.place, list, truth).value;
    for (std::size_t i = 0; i < tail.sigma.size(); ++i)
        tail.sigma[i] = 0.01 * std::abs(tail.value[i]);
    const Problem problem = wake_problem({}, {tail}, list);
    const Report said = report(problem, fit(problem, {}));
    REQUIRE_FALSE(said.flat.empty());
    REQUIRE_FALSE(said.diagnostics.empty());
    CHECK_THAT(said.flat.front().text, Catch::Matchers::Contains("xi"));
}
