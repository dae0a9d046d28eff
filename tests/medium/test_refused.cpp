// What a dynamic medium cannot be asked for, and what the error says of it.

#include "rodwake/core/error.hpp"
#include "rodwake/medium/simulate.hpp"

#include <catch2/catch.hpp>

#include <functional>
#include <limits>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

MediumProblem good() {
    MediumProblem p;
    p.rods.medium = elastic::Medium{1.0, 1.0};
    p.rods.couplings = {1.0, 0.0, 0.0};
    p.rods.rods = {{0.0, 2.0, 0.0}, {0.0, -2.0, 0.0}};
    p.rods.t_end = 0.1;
    p.medium = {.box = 10.0, .force_width = 1.0, .modes = 16};
    return p;
}

void refused(const std::function<void(MediumProblem&, rods::RodOptions&)>& spoil, const char* said) {
    MediumProblem problem = good();
    rods::RodOptions options;
    spoil(problem, options);
    CHECK_THROWS_WITH(simulate(problem, options), Catch::Contains(said));
    CHECK_THROWS_AS(simulate(problem, options), InputError);
}

using P = MediumProblem;
using O = rods::RodOptions;

} // namespace

TEST_CASE("boxes, widths and modes that do not fit are refused in words") {
    REQUIRE_NOTHROW(simulate(good(), {}));
    refused([](P& p, O&) { p.medium.force_width = 0.6; },
            "below the grid spacing box/modes = 0.625: take modes = 17 or more");
    refused([](P& p, O&) { p.medium.force_width = 2.6; }, "box = 10 is less than 4 force_width = 10.4");
    refused([](P& p, O&) { p.medium.modes = 3; }, "modes = 3: must be 4 to 2048");
    refused([](P& p, O&) { p.medium.modes = 4096; }, "modes = 4096: must be 4 to 2048");
    for (const double bad :
         {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        refused([=](P& p, O&) { p.medium.box = bad; }, "box = ");
        refused([=](P& p, O&) { p.medium.force_width = bad; }, "force_width = ");
    }
}

TEST_CASE("rods within a force's width of each other, also through the box's sides, are refused") {
    refused([](P& p, O&) { p.rods.rods[1].y = 1.2; },
            "rods[0] and rods[1] start 0.8 apart, closer than force_width = 1");
    refused([](P& p, O&) { p.rods.rods[1].y = -7.5; }, "start 0.5 apart");
}

TEST_CASE("more fields than there may be, or than memory holds, are refused") {
    const auto crowd = [](P& p, std::size_t rods) {
        p.medium = {.box = 1000.0, .force_width = 4.0, .modes = 250};
        p.rods.rods.clear();
        for (std::size_t i = 0; i < rods; ++i)
            p.rods.rods.push_back(
                {10.0 * static_cast<double>(i % 99), 10.0 * static_cast<double>(i / 99), 0.0});
    };
    refused([=](P& p, O&) { crowd(p, most_fields + 1), p.medium.evaluation = Evaluation::sums; },
            "at most 64 rods, not 65: take fewer rods, evaluation = \"mesh\"");
    refused(
        [=](P& p, O&) { crowd(p, 2000), p.medium.self_field = true, p.medium.evaluation = Evaluation::sums; },
        "modes = 250 and 2000 rods would take 10 GB");
}

TEST_CASE("inertia that is none, or of which the mesh knows no own field, is refused") {
    for (const double bad : {-1.0, 2e6, 1e-200, std::numeric_limits<double>::quiet_NaN()})
        refused([=](P& p, O&) { p.medium.inertia = bad; }, "inertia = ");
    refused([](P& p, O&) { p.medium.inertia = 0.1, p.medium.evaluation = Evaluation::mesh; },
            "inertia = 0.1 with self_field = false is not available for 2 rods");
    refused(
        [](P& p, O&) {
            p.rods.medium = elastic::Medium{1.0, 1e-3};
            p.medium.evaluation = Evaluation::mesh;
        },
        "takes a rod's own field off for alpha force_width up to 10");
    MediumProblem problem = good();
    problem.medium.inertia = 0.1;
    problem.medium.evaluation = Evaluation::mesh;
    problem.medium.self_field = true;
    CHECK_NOTHROW(simulate(problem, {}));
}

TEST_CASE("few rods are summed over, many get the mesh") {
    DynamicMedium medium;
    CHECK(evaluation_of(medium, most_fields) == Evaluation::sums);
    CHECK(evaluation_of(medium, most_fields + 1) == Evaluation::mesh);
    medium.self_field = true;
    CHECK(evaluation_of(medium, most_summed) == Evaluation::sums);
    CHECK(evaluation_of(medium, most_summed + 1) == Evaluation::mesh);
    medium.evaluation = Evaluation::sums;
    CHECK(evaluation_of(medium, 10000) == Evaluation::sums);
}

TEST_CASE("other boxes, media and forms are refused") {
    refused([](P& p, O&) { p.rods.box = 11.0; },
            "the rods' box, 11, differs from the box of the dynamic medium, 10");
    refused([](P& p, O&) { p.rods.medium.reset(); }, "need its eta and xi");
    refused([](P& p, O&) { p.rods.medium->eta = -2.0; }, "eta");
    refused([](P&, O& o) { o.form = rods::Formulation::director; }, "form \"angle\"");
    refused([](P& p, O&) { p.rods.sums.turning_tolerance = 1e-3; }, "no turning_tolerance");
    refused([](P&, O& o) { o.ode.rtol = 1.0; }, "rtol = 1");
    refused([](P& p, O&) { p.medium.closure = Closure::steady, p.medium.start = Start::rest; },
            "start = \"rest\" needs closure = \"none\"");
}
