// Scans of beds: what a point is, what it costs, what its runs yield.

#include "rodwake/app/scan_problem.hpp"
#include "scan_scenes.hpp"

#include <map>

using namespace app_test;

namespace {

const std::string bed_text = "schema = 1\n[granular]\nbeads = 20\nbox = \"30 a\"\nduration = \"0.02 s\"\n"
                             "equilibrate = \"0 s\"\nruns = 3\n";
const std::string pair_of_rods = "[[granular.rods]]\nposition = [\"15 a\", \"6 a\"]\n"
                                 "[[granular.rods]]\nposition = [\"15 a\", \"-6 a\"]\n";
const std::string of_beads = axis("key = \"granular.beads\"\nvalues = [10, 30, 20]");

std::string described(const std::string& change, const std::string& scan = of_beads) {
    return app::scan_key(overridden(bed_text + pair_of_rods + "[scan]\n" + scan, change));
}

/// Two rods that walk side by side, the first 2 a to the left in the end.
app::RunTables tables() {
    return {[](const std::string& name, const std::string&) { return name == "psi6" ? 0.75 : 0.5; },
            [](const std::vector<std::string>& names) {
                const std::map<std::string, app::Column> tracks = {
                    {"t", {-1.0, 0.0, 1.0, 2.0}},          {"x0", {0.0, 0.0, 0.004, 0.008}},
                    {"y0", {0.9, 0.0024, 0.0028, 0.0032}}, {"theta0", {0.0, 0.0, 0.1, 0.2}},
                    {"x1", {0.0, 0.0, 0.004, 0.008}},      {"y1", {0.0, -0.0024, -0.0024, -0.0024}},
                    {"theta1", {0.0, 0.0, 0.0, 0.0}}};
                std::vector<app::Column> found;
                for (const std::string& name : names)
                    found.push_back(tracks.at(name));
                return found;
            }};
}

double number(const scene::Scene& scene, const std::string& name) {
    const app::ScanPlan made = plan(of_beads, bed_text + pair_of_rods);
    const auto& names = made.columns.observables;
    const auto at = std::ranges::find(names, name);
    REQUIRE(at != names.end());
    return app::observables_of(scene, tables()).values[static_cast<std::size_t>(at - names.begin())];
}

} // namespace

TEST_CASE("A scan of beds has runs, costs and the columns of a pair") {
    const app::ScanPlan made = plan(of_beads, bed_text + pair_of_rods);
    CHECK(made.subject == scene::ScanSubject::beds);
    CHECK(made.design.runs == 3);
    CHECK(scan::places(made.design) == 3);
    CHECK(scan::size(made.design) == 9);
    CHECK(made.design.costs == std::vector<double>{6800, 10800, 8800}); // beads and 24 spheres, 200 steps
    CHECK(scan::place_of_run(scan::PointList(made.design)[0].id) == 1);
    CHECK(made.columns.outcomes == std::vector<std::string>{"contact", "pursuit", "escape", "undecided"});
    CHECK(made.columns.observables.front() == "time");
    CHECK(made.columns.observables.size() <= scan::max_observables);
}

TEST_CASE("Beds with other numbers of rods have columns of their own, never too many") {
    std::string rods;
    for (int rod = 0; rod < 8; ++rod) {
        const app::ScanPlan made = plan(of_beads, bed_text + rods);
        CHECK(made.columns.observables.size() <= scan::max_observables);
        CHECK((made.columns.outcomes.size() == 1) == (rod != 2));
        rods += "[[granular.rods]]\nposition = [\"15 a\", \"" + std::to_string(3 * rod) + " a\"]\n";
    }
}

TEST_CASE("The bed of a point has its values, with units and ties") {
    const app::ScanPlan made =
        plan(of_beads + axis("keys = [\"granular.rods.0.position.1\", \"granular.rods.1.position.1\"]\n"
                             "factor = [0.5, -0.5]\nlabel = \"d_0\"\nvalues = [\"10 a\", \"14 a\"]"),
             bed_text + pair_of_rods);
    CHECK(made.labels == std::vector<std::string>{"", "d_0"});
    const scan::PointList points(made.design);
    const app::BedPlan bed = app::scanned_bed(made, points.at_place(3));
    CHECK(bed.problem.beads == 30);
    CHECK(bed.problem.rods[0].position.y() == Approx(7 * 0.4e-3).epsilon(1e-15));
    CHECK(bed.problem.rods[1].position.y() == Approx(-7 * 0.4e-3).epsilon(1e-15));
    CHECK(bed.problem.seed == 1);
    CHECK(bed.schedule.row_every == 100);
    CHECK_FALSE(bed.schedule.xyz); // short as it is
}

TEST_CASE("A point that is no bed costs nothing until it is evaluated") {
    const app::ScanPlan made = plan(axis("key = \"granular.beads\"\nvalues = [20, 5000]"), bed_text);
    CHECK(made.design.costs.back() == 0.0);
    const scan::PointList points(made.design);
    CHECK_THROWS_AS(app::scanned_bed(made, points.at_place(1)), InputError);
}

TEST_CASE("What a run yields is made from its tables") {
    const scene::Scene scene = overridden(bed_text + pair_of_rods, "granular.seed=1");
    CHECK(number(scene, "psi6") == 0.75);
    CHECK(number(scene, "separation") == Approx(12.0));
    CHECK(number(scene, "last_change") == Approx(2.0));
    CHECK(number(scene, "delta_y") == Approx(1.5)); // half of 30 a is 6 mm: three quarters of the way
    CHECK(number(scene, "turn1") == 0.0);
    CHECK(number(scene, "mean_speed0") == 0.5);
}

TEST_CASE("Points of beds depend on the bed, not on how many runs there are or what figures call it") {
    const std::string as_is = described("granular.runs=3");
    CHECK(described("granular.runs=50") == as_is);
    CHECK(described("granular.output.checkpoint=\"5 s\"") == as_is);
    CHECK(described("title=\"beds\"") == as_is);
    CHECK(described("scan.axes.0.label=\"N\"") == as_is);
    CHECK(described("scan.time_limit=5.0") == as_is);
    CHECK(described("granular.seed=2") != as_is);
    CHECK(described("granular.duration=\"0.03 s\"") != as_is);
    CHECK(described("granular.runs=3", axis("key = \"granular.beads\"\nvalues = [10, 30]")) != as_is);
}

TEST_CASE("A scan of beds takes the place of the bed as written") {
    const scene::Scene scanned = read(of_beads, bed_text + pair_of_rods);
    CHECK(app::stages_of(scanned) == std::vector{app::Stage::scan});
    const auto made = app::make_plan(scanned, std::vector{app::Stage::scan});
    CHECK(made.beds.size() == 1); // to be described
    const scene::Scene bed = overridden(bed_text + pair_of_rods, "granular.seed=1");
    CHECK(app::stages_of(bed) == std::vector{app::Stage::granular});
}

TEST_CASE("More runs than the limit are refused with what they are") {
    CHECK(has(refusal("max_points = 8\n" + of_beads, bed_text),
              "3 points of 3 runs, 9 runs in all, more than scan.max_points = 8"));
    CHECK(
        has(refusal(axis("key = \"granular.plates.gamma\"\nfrom = 1.0\nto = 5.0\ncount = 100001"), bed_text),
            "at most 100000"));
}
