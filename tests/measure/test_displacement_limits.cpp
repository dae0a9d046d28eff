// Displacement from input that is too short, useless or out of its domain.

#include "measured_wake.hpp"

#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace rodwake;
using namespace rodwake::measure;
using namespace measure_test;
using synthetic::reduced;

TEST_CASE("short or useless input gives numbers or an error", "[displacement]") {
    const SyntheticWake wake(WakeSetup{.medium = {1.3, 20.0}, .noise = 0.1});
    const DisplacementAccumulator one = accumulator_of(wake, {}, frames_of(wake, 1));
    const auto field = reduced(one);
    for (const auto* values : {&field.Ux, &field.Uy, &field.count, &field.coherence})
        CHECK(std::ranges::all_of(*values, [](double v) { return std::isfinite(v); }));
    CHECK(std::ranges::count(field.count, 0.0) > 0);
    CHECK(field.blocks == 1);
    for (const auto* sigma : {&field.sigma_x, &field.sigma_y}) // one block tells no error
        CHECK(std::ranges::all_of(*sigma, [](double s) { return std::isnan(s); }));

    DisplacementOptions late;
    late.from = 1e9;
    const DisplacementAccumulator none = accumulator_of(wake, late, frames_of(wake, 3));
    CHECK_THROWS_AS(reduced(none), InputError);
    const DisplacementAccumulator mixed[] = {one, none};
    CHECK_THROWS_AS(reduce(mixed), InputError);
    CHECK_THROWS_AS(reduce(std::span<const DisplacementAccumulator>{}), InputError);
}

TEST_CASE("options outside their domain are refused", "[displacement]") {
    const SyntheticWake wake{WakeSetup{}};
    const auto refuse = [&](auto change) {
        DisplacementOptions options;
        options.spacing = 1.0;
        change(options);
        CHECK_THROWS_AS(DisplacementAccumulator(wake.layout(), options), InputError);
    };
    refuse([](auto& options) { options.spacing = 0.0; });
    refuse([](auto& options) { options.spacing = 50.0; });
    refuse([](auto& options) { options.rod = 1; });
    refuse([](auto& options) { options.far_from = 70.0; });
    refuse([](auto& options) { options.far_from = -1.0; });
    refuse([](auto& options) { options.block = 0.0; });
    refuse([](auto& options) { options.from = std::nan(""); });
    auto few = wake.layout();
    few.beads = 49;
    DisplacementOptions options;
    options.spacing = 1.0;
    CHECK_THROWS_AS(DisplacementAccumulator(few, options), InputError);
}

TEST_CASE("a liquid has no phases", "[displacement]") {
    const SyntheticWake wake(WakeSetup{.noise = 5.0});
    CHECK_THROWS_AS(measured(wake, {}, 5), RunError);
}
