// granular.box: one length, two, and the rectangle that a lattice without strain fills.

#include "rodwake/app/describe.hpp"
#include "rodwake/app/granular.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/granular/observe.hpp"
#include "rodwake/scene/read.hpp"
#include "store/scratch.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>

using namespace rodwake;
using Catch::Contains;

namespace {

const double a = 0.4e-3;

scene::Scene bed(const std::string& box, const std::string& more = "phi_b = 0.8\n",
                 const std::string& rods = "") {
    return scene::parse_scene(
        fmt::format("schema = 1\n[granular]\nbox = {}\nduration = \"1 s\"\n{}{}", box, more, rods),
        "scene.toml");
}

const std::string two_rods = R"([[granular.rods]]
position = ["20 a", "20 a"]
[[granular.rods]]
position = ["40 a", "40 a"]
heading = "90 deg"
)";

/// Strain of the lattice that a start takes with these beads and rods.
double start_strain(const scene::Scene& scene) {
    const granular::GranularProblem p = app::granular_problem(scene);
    double covered = 0.0;
    for (const granular::RodSpec& rod : p.rods)
        covered += granular::make_clump(rod.shape).projected_area();
    const double sites = static_cast<double>(p.beads) * p.box.area() / (p.box.area() - covered);
    return granular::fit_lattice(p.box, static_cast<long>(std::ceil(sites * (1.0 - 1e-9))), p.orientation)
        .strain;
}

} // namespace

TEST_CASE("a box of two lengths is a rectangle, of one a square, and both are written as they were") {
    const auto sides = bed("[\"78 a\", \"77.0 a\"]");
    const auto problem = app::granular_problem(sides);
    CHECK(problem.box == PeriodicBox(78 * a, 77 * a));
    CHECK(problem.beads == static_cast<std::size_t>(std::lround(0.8 * 78 * 77 / M_PI)));
    CHECK(scene::parse_scene(scene::to_toml(sides), "again").granular->box == sides.granular->box);
    const auto square = bed("\"78 a\"");
    CHECK(app::granular_problem(square).box.square());
    CHECK_THAT(scene::to_toml(square),
               Contains("\nbox = 0.031200000000000002\n")); // the text by which folders know a scene
    const auto fitted = bed("\"fit 155 a\"");
    CHECK(fitted.granular->box == scene::BoxSize{155 * a, 155 * a, true});
    CHECK(scene::parse_scene(scene::to_toml(fitted), "again").granular->box == fitted.granular->box);
    CHECK(bed("\"fit\"").granular->box == bed("\"fit 78 a\"").granular->box);
}

TEST_CASE("a fitted box keeps the density and leaves the start's lattice without strain") {
    for (const char* size : {"\"fit\"", "\"fit 155 a\"", "\"fit 40 a\""})
        for (const char* rows : {"0 deg", "90 deg", "60 deg"})
            for (const std::string& rods : {std::string(), two_rods})
                for (const char* count : {"true", "false"}) {
                    CAPTURE(size, rows, rods.empty(), count);
                    const auto scene = bed(
                        size,
                        fmt::format("phi_b = 0.78\ncount_rod_area = {}\norientation = \"{}\"\n", count, rows),
                        rods);
                    const auto found = app::bed_size(*scene.granular);
                    REQUIRE(found.lattice);
                    CHECK(start_strain(scene) < 1e-12); // rounding
                    CHECK(found.lattice->row_ratio() == Approx(std::sqrt(0.75)).epsilon(1e-14));
                    CHECK(found.lattice->rows_along_y == (std::string(rows) == "90 deg"));
                    const double wanted = scene.granular->box.x;
                    const double half_a_row =
                        1.9 * a / wanted; // rows come in pairs, 3.7 a wide; sites in them 2.1 a apart
                    CHECK(std::abs(found.box.x / found.box.y - 1.0) < 1.6 * half_a_row);
                    CHECK(std::abs(found.box.mean_side() / wanted - 1.0) < 1.6 * half_a_row);
                    // as in a square: to less than a bead
                    double shadows = 0.0;
                    for (const auto& rod : scene.granular->rods)
                        shadows += granular::make_clump(rod.shape).projected_area();
                    const double beads =
                        (0.78 * found.box.area() - (std::string(count) == "true" ? shadows : 0.0)) /
                        (M_PI * a * a);
                    CHECK(std::abs(static_cast<double>(found.beads) - beads) < 1.0);
                }
}

TEST_CASE("beads as given keep the area of the square, vacancies take what is left") {
    const auto scene = bed("\"fit\"", "beads = 1549\n", two_rods);
    const auto found = app::bed_size(*scene.granular);
    CHECK(found.beads == 1549);
    CHECK(found.box.area() == Approx(78 * a * 78 * a).epsilon(1e-14));
    CHECK(found.lattice->sites() >= 1549);
    CHECK(start_strain(scene) < 1e-12);
}

TEST_CASE("the paper's box without its strain has 42 rows of 37, and check says so") {
    const auto scene = bed("\"fit\"");
    const auto found = app::bed_size(*scene.granular);
    CHECK(found.lattice->rows == 42);
    CHECK(found.lattice->in_row == 37);
    CHECK(found.beads == 1554);
    CHECK(found.box.x / a == Approx(78.789).margin(0.002));
    CHECK(found.box.y / a == Approx(77.454).margin(0.001));
    const auto plan = app::make_plan(scene, app::stages_of(scene));
    std::string said;
    for (const app::PlanLine& line : app::describe(plan))
        said += line.text + "\n";
    CHECK_THAT(said, Contains("42 rows of 37 sites along x") && Contains("row ratio 0.866025"));
}

TEST_CASE("what no lattice or box can be is refused with what to do") {
    const auto refusal = [](const scene::Scene& scene) {
        return store_test::error_of<InputError>([&] { (void)app::granular_problem(scene); });
    };
    CHECK_THAT(refusal(bed("\"fit\"", "phi_b = 0.8\norientation = \"45 deg\"\n")),
               Contains("give 0 or 90 deg"));
    CHECK_THAT(refusal(bed("\"fit 3 a\"")), Contains("sites"));
    CHECK_THAT(refusal(bed("[\"78 a\", \"7 a\"]")), Contains("8 bead radii"));
    for (const char* box :
         {"[\"78 a\"]", "\"fit huge\"", "\"fits\"", "[\"78 a\", -1.0]", "true", "\"fit -3 a\""}) {
        CAPTURE(box);
        CHECK_THROWS_WITH(bed(box), Contains("granular.box"));
    }
    CHECK_THROWS_WITH(bed("\"fit\"", "phi_b = 0.8\nstart = \"restart\"\nrestart_from = \"final.rwc\"\n"),
                      Contains("summary.json"));
    CHECK_THROWS_WITH(bed("\"fit\"", "phi_b = 0.8\n",
                          "[fit]\nparameters = [\"eta\"]\nbox = \"78 a\"\n"
                          "[[fit.profiles]]\nfile = \"p.csv\"\ncomponent = \"Ux\"\nalong = \"x\"\n"),
                      Contains("give its two sides"));
}
