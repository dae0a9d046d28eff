// Every way to ask for what cannot be done is an InputError that names it.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "toy_problems.hpp"

using namespace rodwake::fitting;
using Catch::Matchers::Contains;
using rodwake::InputError;

namespace {

template<class Change>
Problem changed(Change change) {
    Problem problem = toy::decay();
    change(problem);
    return problem;
}

} // namespace

TEST_CASE("a problem is checked") {
    const auto refused = [](auto change, const std::string& words) {
        CHECK_THROWS_WITH(validate(changed(change)), Contains(words));
        CHECK_THROWS_AS(validate(changed(change)), InputError);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    refused([](Problem& p) { p.parameters[1].name = ""; }, "parameter 1 has no name");
    refused([](Problem& p) { p.parameters[2].name = "a"; }, "two parameters are called \"a\"");
    refused(
        [](Problem& p) {
            p.parameters[0].lower = 3.0;
            p.parameters[0].upper = 2.0;
        },
        "bounds of a are reversed");
    refused([](Problem& p) { p.parameters[0].lower = p.parameters[0].upper = 1.0; },
            "both bounds of a are 1");
    refused([](Problem& p) { p.parameters[0].lower = 2.0; }, "a starts at 1, outside its bounds");
    refused([&](Problem& p) { p.parameters[0].upper = nan; }, "a bound of a is not a number");
    refused([&](Problem& p) { p.parameters[0].start = inf; }, "the start of a is not a finite number");
    refused([](Problem& p) { p.parameters[1].start = 0.0; }, "b is searched in the logarithm");
    refused([](Problem& p) { p.parameters[1].lower = -1.0; }, "lower bound must be above 0, not -1");
    refused([](Problem& p) { p.parameters[1].scale = -1.0; }, "the scale of b is -1");
    refused([](Problem& p) { p.parameters[2].tied_to = "z"; }, "c is tied to z, which is no parameter");
    refused([](Problem& p) { p.parameters[2].tied_to = "c"; }, "not free itself");
    refused(
        [](Problem& p) {
            p.parameters[2].tied_to = "a";
            p.parameters[0].fixed = true;
        },
        "not free itself");
    refused(
        [](Problem& p) {
            p.parameters[2].tied_to = "a";
            p.parameters[2].fixed = true;
        },
        "both fixed and tied");
    refused(
        [&](Problem& p) {
            p.parameters[2].tied_to = "a";
            p.parameters[2].tie_factor = nan;
        },
        "factor that ties c");
    refused([](Problem& p) { p.residuals = 2; }, "2 data points cannot fix 3 parameters");
    refused(
        [](Problem& p) {
            p.residuals = 0;
            for (auto& q : p.parameters)
                q.fixed = true;
        },
        "0 data points");
    refused([](Problem& p) { p.evaluate = nullptr; }, "no function");
    CHECK_NOTHROW(validate(toy::decay()));
}

TEST_CASE("a method is checked") {
    const auto refused = [](auto change, const std::string& words) {
        Method method;
        change(method);
        CHECK_THROWS_WITH(fit(toy::decay(), method), Contains(words));
        CHECK_THROWS_AS(fit(toy::decay(), method), InputError);
    };
    refused([](Method& m) { m.tolerance = 0.0; }, "tolerance 0");
    refused([](Method& m) { m.max_evaluations = 0; }, "max_evaluations 0");
    refused([](Method& m) { m.starts = 0; }, "starts 0");
    refused([](Method& m) { m.spread = 1.0; }, "spread 1");
    refused([](Method& m) { m.loss_width = -1.0; }, "loss_width -1");
    refused(
        [](Method& m) {
            m.done = {{3, {1, 1, 1}, {1, 1, 1}, 1.0, "converged: x", 1}};
        },
        "belongs to another fit");
    refused([](Method& m) { m.done = {{0, {1}, {1}, 1.0, "converged: x", 1}}; }, "belongs to another fit");
    for (const Algorithm a : {Algorithm::mlsl, Algorithm::crs, Algorithm::isres, Algorithm::direct_l})
        refused([a](Method& m) { m.algorithm = a; },
                to_string(a) + " searches the whole box of the bounds, so a needs");
}

TEST_CASE("ties and fixed parameters make all values") {
    Problem problem = toy::decay();
    problem.parameters[0].tied_to = "c";
    problem.parameters[0].tie_factor = 2.0;
    problem.parameters[1].fixed = true;
    CHECK(free_parameters(problem) == std::vector<std::size_t>{2});
    CHECK(all_values(problem, std::vector<double>{5.0}) == std::vector<double>{10.0, 1.0, 5.0});
}
