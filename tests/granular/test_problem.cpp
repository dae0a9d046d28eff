// What a granular run refuses, and with which words; what is legal at the edge of the domain.

#include "beds.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/granular/problem.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace rodwake;
using granular::GranularProblem;
using granular::RodSpec;

namespace {

constexpr double a = 0.4e-3;

GranularProblem bed(std::size_t beads = 1549) {
    GranularProblem problem;
    problem.beads = beads;
    return problem;
}

RodSpec rod_at(double x, double y, double heading = 0.0) { return granular::beds::long_rod(x, y, heading); }

GranularProblem with_rods(std::initializer_list<RodSpec> rods, std::size_t beads = 0) {
    auto problem = bed(beads);
    problem.rods = rods;
    return problem;
}

std::string refusal(const GranularProblem& problem) {
    try {
        validate(problem);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

template<class Change>
void refuses(const std::string& words, Change change, GranularProblem problem = bed()) {
    change(problem);
    INFO(words);
    CHECK_THAT(refusal(problem), Catch::Contains(words));
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();

} // namespace

TEST_CASE("times become whole steps, and a bead weighs what a sphere does") {
    CHECK(granular::whole_steps(1.0, 2e-5) == 50000);
    CHECK(granular::whole_steps(2.99e-5, 2e-5) == 1);
    CHECK(granular::whole_steps(3.01e-5, 2e-5) == 2);
    CHECK(granular::whole_steps(1e-9, 2e-5) == 0);
    CHECK(granular::whole_steps(1e-9, 2e-5, 1) == 1);
    granular::GranularProblem problem;
    problem.bead_radius = 1e-3;
    problem.bead_density = 3000.0;
    CHECK(granular::bead_mass(problem) == Approx(1.2566370614359172e-5).epsilon(1e-14));
}

TEST_CASE("sound problems pass") {
    CHECK(refusal(bed()) == "");
    CHECK(refusal(with_rods({rod_at(0, 0)})) == ""); // a rod alone
    CHECK(refusal(with_rods({rod_at(20 * a, 46.5 * a), rod_at(20 * a, 31.5 * a)}, 1549)) == "");
    auto edge = bed();
    edge.plates.gamma = 0.0; // static plates
    edge.start_speed = 0.0;
    edge.overlap_limit = 1.0;
    edge.contacts.bead_bead = {0.0, 1.0};
    CHECK(refusal(edge) == "");
    edge.time_step = 1.0; // no period to resolve
    CHECK(refusal(edge) == "");
    edge.gravity = 0.0;
    CHECK(refusal(edge) == "");
    edge.plates.gamma = 7.0;
    CHECK_THAT(refusal(edge), Catch::Contains("gamma = 7 with gravity = 0"));
}

TEST_CASE("amplitude and area fraction are what they are called") {
    const double omega = 2.0 * M_PI * 200.0;
    CHECK(bed().plates.amplitude(9.81) == Approx(7.0 * 9.81 / (omega * omega)).epsilon(1e-15)); // rounding
    auto still = bed().plates;
    still.gamma = 0.0;
    CHECK(still.amplitude(9.81) == 0.0);
    CHECK(bead_area_fraction(bed()) == Approx(1549 * M_PI / (78.0 * 78.0)).epsilon(1e-14));
}

TEST_CASE("the longest step is a whole fraction of the plates' period that keeps their move short") {
    const GranularProblem standard;
    CHECK(standard.time_step == standard.plates.longest_step(standard.gravity, standard.bead_radius));
    struct Case {
        double gamma, frequency, radius, steps;
    };
    // by hand: Gamma g/(2 pi f^2)/(0.0137 a) = 7.122 Gamma at 200 Hz and 0.4 mm; a fall of 2e-4 a takes
    // 1.277e-4 s
    for (const Case& c :
         {Case{0.0, 200.0, 0.4e-3, 50}, Case{1.2, 200.0, 0.4e-3, 50}, Case{7.0, 200.0, 0.4e-3, 50},
          Case{7.1, 200.0, 0.4e-3, 51}, Case{20.0, 200.0, 0.4e-3, 143}, Case{50.0, 200.0, 0.4e-3, 357},
          Case{20.0, 200.0, 0.8e-3, 72}, Case{7.0, 100.0, 0.4e-3, 200}, Case{0.0, 100.0, 0.4e-3, 79},
          Case{0.0, 1.0, 0.4e-3, 7831}}) {
        const granular::Plates plates{1.2e-3, c.frequency, c.gamma};
        CAPTURE(c.gamma, c.frequency, c.radius);
        CHECK(plates.longest_step(9.81, c.radius) == Approx(1.0 / (c.steps * c.frequency)).epsilon(1e-14));
        const double move = c.gamma * 9.81 / (2.0 * M_PI * c.frequency) / (c.steps * c.frequency);
        CHECK(move <= 0.0137 * c.radius);
    }
    const granular::Plates still{1.2e-3, 200.0, 0.0};
    CHECK(still.longest_step(0.0, 0.4e-3) == 1e-4); // nothing falls
    CHECK(still.amplitude(0.0) == 0.0);
}

TEST_CASE("numbers outside their domain are refused by name") {
    for (const double bad : {0.0, -1.0, not_a_number, inf}) {
        refuses("bead_radius = ", [&](auto& p) { p.bead_radius = bad; });
        refuses("bead_density = ", [&](auto& p) { p.bead_density = bad; });
        refuses("box = ", [&](auto& p) { p.box = bad; });
        refuses("gap = ", [&](auto& p) { p.plates.gap = bad; });
        refuses("frequency = ", [&](auto& p) { p.plates.frequency = bad; });
        refuses("time_step = ", [&](auto& p) { p.time_step = bad; });
        refuses("overlap_limit = ", [&](auto& p) { p.overlap_limit = bad; });
    }
    for (const double bad : {-1.0, not_a_number, inf}) {
        refuses("gamma = ", [&](auto& p) { p.plates.gamma = bad; });
        refuses("gravity = ", [&](auto& p) { p.gravity = bad; });
        refuses("start_speed = ", [&](auto& p) { p.start_speed = bad; });
        refuses("bead-bead friction", [&](auto& p) { p.contacts.bead_bead.friction = bad; });
        refuses("rod-rod restitution", [&](auto& p) { p.contacts.rod_rod.restitution = bad; });
    }
    refuses("bead-rod restitution = 1.1", [](auto& p) { p.contacts.bead_rod.restitution = 1.1; });
    refuses("rod-plate friction = -0.1", [](auto& p) { p.contacts.rod_plate.friction = -0.1; });
    refuses("bead-plate restitution", [](auto& p) { p.contacts.bead_plate.restitution = 2; });
    refuses("orientation = ", [](auto& p) { p.orientation = not_a_number; });
    refuses("overlap_limit = 1.5", [](auto& p) { p.overlap_limit = 1.5; });
    refuses("equilibration_steps = -1", [](auto& p) { p.equilibration_steps = -1; });
    refuses("steps = -5", [](auto& p) { p.steps = -5; });
    refuses("amplitude", [](auto& p) { p.plates.frequency = 1e-300; });
    refuses("beads = ", [](auto& p) { p.beads = std::numeric_limits<std::size_t>::max(); });
    refuses("no beads and no rods", [](auto& p) { p.beads = 0; });
}

TEST_CASE("numbers of a rod are refused with its index") {
    const auto one_good = with_rods({rod_at(0, 0), rod_at(0, 20 * a)});
    refuses(
        "rod 1: position x = nan", [](auto& p) { p.rods[1].position.x() = not_a_number; }, one_good);
    refuses(
        "rod 1: position y = 1e+99", [](auto& p) { p.rods[1].position.y() = 1e99; }, one_good);
    refuses(
        "rod 0: heading = inf", [](auto& p) { p.rods[0].heading = inf; }, one_good);
    refuses(
        "rod 0: imposed_speed = nan", [](auto& p) { p.rods[0].imposed_speed = not_a_number; }, one_good);
    refuses(
        "rod 1: density = 0", [](auto& p) { p.rods[1].shape.density = 0; }, one_good);
    refuses(
        "rod 1: spheres = 12: an apolar rod",
        [](auto& p) { p.rods[1].shape.kind = granular::RodKind::apolar; }, one_good);
}

TEST_CASE("a period of the plates needs eight steps") {
    refuses("steps a period", [](auto& p) { p.time_step = 1.0 / (200.0 * 7.9); });
    auto eight = bed();
    eight.time_step = 1.0 / (200.0 * 8.0);
    CHECK(refusal(eight) == "");
}

TEST_CASE("beads and rods must fit between the plates") {
    refuses("larger than the bead diameter", [](auto& p) { p.plates.gap = 2 * a; });
    const auto lone = with_rods({rod_at(0, 0)});
    refuses(
        "rod 0: gap = 0.0011 m", [](auto& p) { p.plates.gap = 1.1e-3; }, lone);
    auto tight = with_rods({rod_at(0, 0)});
    tight.plates.gap = 1.101e-3;
    CHECK(refusal(tight) == "");
}

TEST_CASE("the box must hold a rod apart from its own image") {
    const auto lone = with_rods({rod_at(0, 0)});
    refuses(
        "its own image", [](auto& p) { p.box = 4e-3; }, lone); // shorter than the rod
    refuses(
        "its own image", [](auto& p) { p.box = 5.3e-3; }, lone); // 4.5 mm + 2.2 * 0.4 mm = 5.38 mm
    auto roomy = with_rods({rod_at(0, 0)});
    roomy.box = 5.4e-3;
    CHECK(refusal(roomy) == "");
    refuses(
        "8 bead radii", [](auto& p) { p.box = 7.9 * a; }, bed(1));
}

TEST_CASE("more than the closest packing is refused with the numbers") {
    const double most = M_PI / std::sqrt(12.0) * 78.0 * 78.0 / M_PI; // beads that cover pi/sqrt(12)
    CHECK(refusal(bed(static_cast<std::size_t>(most))) == "");
    const auto words = refusal(bed(static_cast<std::size_t>(most) + 1));
    CHECK_THAT(words,
               Catch::Contains("1757 beads") && Catch::Contains("at most 0.9069") && Catch::Contains("1756"));
    const auto rods = with_rods({rod_at(0, 0)}, static_cast<std::size_t>(most));
    CHECK_THAT(refusal(rods), Catch::Contains("the rods 0.0041"));
}

TEST_CASE("rods that overlap are refused, images and headings considered") {
    const double box = 78 * a;
    const auto words = "rods 0 and 1 overlap";
    CHECK_THAT(refusal(with_rods({rod_at(5e-3, 5e-3), rod_at(5e-3, 5.5e-3)})), Catch::Contains(words));
    CHECK_THAT(refusal(with_rods({rod_at(5e-3, 0.2e-3), rod_at(5e-3, box - 0.2e-3)})),
               Catch::Contains(words));
    CHECK_THAT(refusal(with_rods({rod_at(0.1e-3, 5e-3), rod_at(box - 0.1e-3, 5e-3)})),
               Catch::Contains(words));
    // 2 mm apart: side by side free, but not if one of them is turned across
    CHECK(refusal(with_rods({rod_at(5e-3, 5e-3), rod_at(5e-3, 7e-3)})) == "");
    CHECK_THAT(refusal(with_rods({rod_at(5e-3, 5e-3), rod_at(5e-3, 7e-3, M_PI / 2)})),
               Catch::Contains(words));
    CHECK_THAT(refusal(with_rods({rod_at(5e-3, 5e-3), rod_at(20e-3, 5e-3), rod_at(20e-3, 5e-3 + 3 * box)})),
               Catch::Contains("rods 1 and 2") && !Catch::Contains("rods 0 and"));
}

TEST_CASE("everything that is wrong is named at once") {
    auto problem = bed();
    problem.bead_radius = -1;
    problem.time_step = not_a_number;
    problem.rods = {rod_at(0, 0)};
    problem.rods[0].shape.spheres = 0;
    CHECK_THAT(refusal(problem), Catch::Contains("bead_radius") && Catch::Contains("time_step") &&
                                     Catch::Contains("rod 0: spheres = 0"));
}
