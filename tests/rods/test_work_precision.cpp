// Work and precision on the reference trajectories: the table of docs/validation_rods.md.

#include "reference.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdio>

using namespace rodwake;

TEST_CASE("work and precision of the three methods on the reference trajectories", "[.][long]") {
    std::printf("error over rtol / right-hand sides, each method at rtol 1e-4, 1e-6, 1e-8, 1e-11\n");
    for (const test::ReferenceCase& reference : test::reference_cases()) {
        std::printf("%-46s", reference.name.c_str());
        for (const auto method : {integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk}) {
            std::printf(" | %s", integrate::to_string(method).c_str());
            for (const double rtol : {1e-4, 1e-6, 1e-8, 1e-11}) {
                rods::RodOptions options;
                options.ode.method = method;
                options.ode.rtol = rtol;
                options.ode.atol = rtol / 100.0;
                const auto result = rods::simulate(reference.problem, options);
                const double error = test::worst_error(reference, result);
                std::printf(" %.1e/%ld", error / rtol, result.solution.statistics.rhs_evaluations);
                CHECK(error <= 200.0 * rtol); // as in test_trajectories.cpp
            }
        }
        std::printf("\n");
    }
}
