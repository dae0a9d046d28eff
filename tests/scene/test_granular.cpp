// The granular tables: units of their own, defaults that follow other keys, values that do not fit each
// other.

#include "rodwake/scene/read.hpp"
#include "rodwake/scene/set.hpp"
#include "support.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <numbers>

using namespace scene_test;
using namespace rodwake::scene;

namespace {

Granular granular(const std::string& more = "", const std::vector<std::string>& overrides = {}) {
    return *parse(bed(more), overrides).granular;
}

const std::string rod = "[[granular.rods]]\nposition = [\"10 a\", 0.004]\n";

} // namespace

TEST_CASE("the granular tables of the contract are read as they stand there") {
    const Scene scene = parse(R"(schema = 1
[granular]
phi_b = 0.80
box = "78 a"
start = "lattice"
orientation = 0.0
time_step = "2e-5 s"
equilibrate = "0.5 s"
duration = "10 s"
seed = 1
runs = 1
plates = { gap = "1.3 mm", frequency = "150 Hz", gamma = 5.0 }
[granular.contacts]
particle_particle = { friction = 0.06, restitution = 0.4 }
rod_wall = { friction = 0.04, restitution = 0.2 }
bead_wall = { friction = 0.3, restitution = 0.5 }
rod_rod = { friction = 0.5 }
[[granular.rods]]
kind = "motile"
position = ["20 a", "46.5 a"]
heading = 0.0
imposed_speed = "1 mm/s"
)");
    const Granular& g = *scene.granular;
    CHECK(g.phi_b == 0.80);
    CHECK(g.box == BoxSize{78.0 * 0.4e-3, 78.0 * 0.4e-3});
    CHECK(g.time_step == 2e-5);
    CHECK(g.equilibrate == 0.5);
    CHECK(g.duration == 10.0);
    CHECK(g.plates == rodwake::granular::Plates{1.3e-3, 150.0, 5.0});
    CHECK(g.contacts.particle_particle == rodwake::granular::Surface{0.06, 0.4});
    CHECK(g.contacts.rod_wall == rodwake::granular::Surface{0.04, 0.2});
    CHECK(g.contacts.bead_wall == rodwake::granular::Surface{0.3, 0.5});
    CHECK(g.contacts.rod_rod == SurfaceChange{0.5, std::nullopt});
    CHECK_FALSE(g.contacts.bead_bead);
    REQUIRE(g.rods.size() == 1);
    CHECK(g.rods[0].position == std::vector{20.0 * 0.4e-3, 46.5 * 0.4e-3});
    CHECK(g.rods[0].imposed_speed == 1e-3);
    check_round_trip(scene);
}

TEST_CASE("what is absent from a bed has the default of the contract") {
    const Granular g = granular(rod);
    Granular expected;
    expected.phi_b = 0.7;
    expected.box = {30.0 * 0.4e-3, 30.0 * 0.4e-3};
    expected.duration = 1.0;
    expected.rods.emplace_back().position = {10.0 * 0.4e-3, 0.004};
    CHECK(g == expected);
    CHECK(g.contacts.particle_particle == rodwake::granular::Surface{0.05, 0.3});
    CHECK(g.contacts.rod_wall == rodwake::granular::Surface{0.03, 0.1});
    CHECK(g.contacts.bead_wall == rodwake::granular::Surface{0.2, 0.3});
    CHECK(g.plates == rodwake::granular::Plates{1.2e-3, 200.0, 7.0});
    CHECK(g.output.formats == std::vector<std::string>{"h5md", "xyz_if_short"});
}

TEST_CASE("granular numbers are SI in every scene and need no scales") {
    const std::string more = "gravity = \"9810 mm/s^2\"\nbead_density = \"2.7 g/cm^3\"\n" + rod;
    const Granular plain = granular("gravity = 9.81\nbead_density = 2700\n" + rod);
    CHECK(granular(more) == plain);
    CHECK(*parse("units = \"si\"\n" + bed(more)).granular == plain);
    const std::string scales = "[scales]\nf_over_mu = 0.001\nv0 = 0.002\n";
    for (const std::string units : {"reduced", "si"})
        CHECK(*parse("units = \"" + units + "\"\n" + bed(more) + scales).granular == plain);
    CHECK(granular("", {"granular.plates.frequency=0.2 kHz"}).plates.frequency == 200.0);
    says(bed("order_cutoff = \"1 f/mu\"\n"), "unknown unit \"f/mu\"; known: m, cm, mm, um, a");
    says("units = \"si\"\n" + bed() + "[[rods]]\nposition = [0, 0]\n[rods_run]\nt_end = 1\n",
         "units = \"si\" needs [scales]");
    // Reduced tables keep their units beside the bed.
    const Scene both = parse("units = \"si\"\n" + bed() + scales +
                             "[[rods]]\nposition = [0.002, 0]\n[rods_run]\nt_end = 1\n");
    CHECK(both.rods[0].position[0] == 2.0);
    CHECK(both.granular->box.x == 30.0 * 0.4e-3);
    check_round_trip(both);
}

TEST_CASE("in a bed, a is its own bead radius") {
    CHECK(granular("bead_radius = \"0.5 mm\"\n").box.x == 30.0 * 0.5e-3);
    says(bed("bead_radius = \"2 a\"\n"), "unknown unit \"a\"");
    const std::string scales = "[scales]\nf_over_mu = 0.001\nv0 = 0.002\nbead_radius = 0.0005\n";
    says(bed(scales), "granular.bead_radius is 0.0004 m and scales.bead_radius 0.0005 m");
    CHECK(error_text(bed("bead_radius = 0.0005\n" + scales)) == "");
}

TEST_CASE("kinds of beads, their spread, and what they rule out") {
    const std::string kinds = "[[granular.bead_kinds]]\nradius = \"0.4 mm\"\nshare = 0.5\n"
                              "[[granular.bead_kinds]]\nradius = \"1.4 a\"\nshare = 0.5\n";
    const Granular mixed = granular("start = \"random\"\nbead_spread = 0.02\n" + kinds);
    REQUIRE(mixed.bead_kinds.size() == 2);
    CHECK(mixed.bead_kinds[1].radius == 1.4 * 0.4e-3);
    CHECK(mixed.bead_kinds[1].share == 0.5);
    CHECK(mixed.bead_spread == 0.02);
    CHECK(granular().bead_kinds.empty());
    // the time step is that of the smallest beads
    CHECK(time_step(mixed) == mixed.plates.longest_step(mixed.gravity, 0.96 * 0.4e-3));
    CHECK(time_step(granular()) == granular().plates.longest_step(9.81, 0.4e-3));
    const Scene written = parse(bed("start = \"random\"\nbead_spread = 0.02\n" + kinds));
    check_round_trip(written);
    // the gap is that of the largest beads, unless the scene gives one or 1.2 mm is wide enough
    CHECK(mixed.plates.gap == 2.7 * (1.04 * (1.4 * 0.4e-3)));
    CHECK(to_toml(written).find("# gap: 1.57248 mm; with beads of several sizes") != std::string::npos);
    for (const std::string gap : {"1.2 mm", "1.6 mm"}) {
        const Granular given = granular("start = \"random\"\n" + kinds, {"granular.plates.gap=" + gap});
        CHECK(given.plates.gap == (gap == "1.2 mm" ? 1.2e-3 : 1.6e-3));
        CHECK(given.gap.value() == given.plates.gap);
    }
    for (const char* narrow : {"bead_spread = 0.05\n", "bead_radius = \"0.5 mm\"\n",
                               "[[granular.bead_kinds]]\nradius = \"0.56 mm\"\n"})
        CHECK(granular(narrow).plates.gap == 1.2e-3);
    Scene changed = written;
    CHECK_FALSE(compile_setter(changed, "granular.bead_kinds.1.radius").set(changed, 0.5e-3));
    CHECK(changed.granular->plates.gap == 2.7 * (1.04 * 0.5e-3));
    says(bed(kinds), "start = \"lattice\" puts equal beads on the sites of a triangular lattice");
    says(bed("start = \"random\"\n" + kinds), "box = \"fit\" fits a lattice of equal beads",
         {"granular.box=fit"});
    says(bed("bead_spread = 0.3\n"), "bead_spread");
    says(bed("[[granular.bead_kinds]]\nshare = 1.0\n"), "granular.bead_kinds[0] needs the key radius");
    CHECK(error_text(bed("[[granular.bead_kinds]]\nradius = \"0.4 mm\"\n")) == ""); // one size: a lattice
    const std::string measured =
        "start = \"random\"\n" + kinds + "[[granular.rods]]\nposition = [\"10 a\", 0.004]\n[measure]\n";
    says(bed(measured + "displacement = \"phase\"\n"),
         "beads of several sizes ([[granular.bead_kinds]]): they follow "
         "the Bragg peaks of a lattice");
    says(bed(measured + "displacement = \"density\"\n"), "use displacement = \"lagrangian\"");
    CHECK(error_text(bed(measured + "displacement = \"lagrangian\"\n")) == "");
    says(bed(measured + "phonons = true\n"), "they are waves of a lattice");
    says(bed(measured + "mechanics = true\n"), "it takes the mass of a bead");
    says(bed(measured + "order = true\n"),
         "they have no common first shell; use order_neighbours = \"delaunay\"");
    CHECK(error_text(bed(measured + "order = true\norder_neighbours = \"delaunay\"\n"
                                    "displacement = \"lagrangian\"\n")) == "");
}

TEST_CASE("rods at random in a bed") {
    const std::string random =
        "[granular.rods_random]\ncount = 8\nmin_separation = \"3 a\"\nspread = \"20 deg\"\n";
    const Granular placed = granular(random);
    REQUIRE(placed.rods.size() == 8);
    CHECK(granular(random).rods == placed.rods);
    CHECK(granular(random + "seed = 2\n").rods != placed.rods);
    const double a = 0.4e-3, side = 78 * a;
    for (std::size_t i = 0; i < 8; ++i) {
        const GranularRod& one = placed.rods[i];
        CHECK(std::abs(one.heading) <= 20.0 * std::numbers::pi / 180.0);
        CHECK((one.position[0] >= 0.0 && one.position[0] <= side && one.position[1] >= 0.0 &&
               one.position[1] <= side));
        // Points on the axes, a thousandth of the rod apart: those of two rods are a diameter and 3 a apart
        // at least.
        for (std::size_t j = 0; j < i; ++j) {
            double least = 1.0;
            for (int s = -40; s <= 40; ++s)
                for (int t = -40; t <= 40; ++t) {
                    const auto at = [](const GranularRod& rod, int step) {
                        const double along = 1.7e-3 * step / 40.0;
                        return std::array{rod.position[0] + along * std::cos(rod.heading),
                                          rod.position[1] + along * std::sin(rod.heading)};
                    };
                    const auto p = at(one, s), q = at(placed.rods[j], t);
                    least = std::min(least, std::hypot(std::remainder(p[0] - q[0], side),
                                                       std::remainder(p[1] - q[1], side)));
                }
            CHECK(least > 2.0 * 0.4e-3 + 3.0 * a);
        }
    }
    const Scene scene = parse(bed(random + "kind = \"apolar\"\n"));
    CHECK(scene.granular->rods[0].shape.spheres == 13);
    check_round_trip(scene);
    says(bed(random), "no room for 500 rods of 4.5 mm with min_separation = 0.0012 m",
         {"granular.rods_random.count=500"});
    says(bed(random + rod), "[[granular.rods]] and [granular.rods_random] are given: leave one out");
    says(bed(random), "box = \"fit\" depends on the rods", {"granular.box=fit"});
}

TEST_CASE("beads from a file") {
    const std::string text = "schema = 1\n[granular]\nbox = \"30 a\"\nduration = 1\n";
    const Granular given = *parse(text + "start = \"file\"\nstart_file = \"beads.csv\"\n").granular;
    CHECK(given.start == GranularStart::file);
    CHECK(given.start_file == "beads.csv");
    check_round_trip(parse(text + "start = \"file\"\nstart_file = \"beads.csv\"\n"));
    check_round_trip(parse(text + "start = \"file\"\nstart_file = \"bed.h5md\"\nstart_frame = 2\n"));
    says(text + "beads = 10\nstart_frame = 2\n", "start_frame belongs to start = \"file\" only");
    says(text + "start_file = \"beads.csv\"\n", "start_file belongs to start = \"file\" only");
    says(text + "start = \"file\"\nbeads = 10\n", "start = \"file\" needs start_file");
    says(text + "start = \"file\"\nbeads = 10\nstart_file = \"b.csv\"\n",
         "give one of phi_b | beads | start_file");
}

TEST_CASE("beads are given once") {
    says("schema = 1\n[granular]\nbox = 1\nduration = 1\n",
         "granular needs one of phi_b | beads | start_file");
    says(bed("beads = 10\n"),
         "granular gives phi_b (line 3) and beads (line 6): give one of phi_b | beads | start_file");
    const Granular counted = granular("", {"granular.beads=10"});
    CHECK(counted.beads == 10);
    CHECK_FALSE(counted.phi_b);
    CHECK(granular("", {"granular.phi_b=0.6"}).phi_b == 0.6);
    says(bed(), "nothing to simulate", {"granular.beads=0"});
    CHECK(error_text(bed(rod), {"granular.beads=0"}) == "");
    says(bed("count_rod_area = false\n"), "count_rod_area has no effect with beads", {"granular.beads=10"});
    CHECK(error_text(bed("count_rod_area = false\n")) == "");
    CHECK(granular().count_rod_area);
}

TEST_CASE("a run may end where its rods have come to") {
    CHECK_FALSE(granular(rod).stop_at_travel);
    CHECK(granular("stop_at_travel = \"39 a\"\n" + rod).stop_at_travel == 39.0 * 0.4e-3);
    says(bed("stop_at_travel = \"39 a\"\n"), "x.toml:6:18: stop_at_travel needs [[granular.rods]]");
    check_round_trip(parse(bed("stop_at_travel = \"39 a\"\n" + rod)));
}

TEST_CASE("a restart has a file, and nothing else has one") {
    says(bed("start = \"restart\"\n"), "x.toml:6:9: start = \"restart\" needs restart_from");
    says(bed("restart_from = \"c.h5\"\n"), "x.toml:6:16: restart_from belongs to start = \"restart\" only");
    const Granular g = granular("start = \"restart\"\nrestart_from = \"results/bed/c.h5\"\n");
    CHECK(g.start == GranularStart::restart);
    CHECK(g.restart_from == "results/bed/c.h5");
}

TEST_CASE("spheres and thickness of a rod follow its kind unless they are given") {
    const auto one = [](const std::string& more, const std::vector<std::string>& overrides = {}) {
        return granular(rod + more, overrides).rods.at(0).shape;
    };
    CHECK(one("").spheres == 12);
    CHECK(one("").thick_diameter == 1.1e-3);
    CHECK(one("kind = \"apolar\"\n").spheres == 13);
    CHECK(one("kind = \"apolar\"\n").thick_diameter == 0.95e-3);
    CHECK(one("kind = \"apolar\"\nspheres = 15\nthick_diameter = \"1 mm\"\n").spheres == 15);
    CHECK(one("kind = \"apolar\"\nthick_diameter = \"1 mm\"\n").thick_diameter == 1e-3);
    CHECK(one("", {"granular.rods.0.kind=apolar"}).spheres == 13);
    const std::string resolved = to_toml(parse(bed(rod)));
    CHECK(parse(resolved, {"granular.rods.0.kind=apolar"}).granular->rods[0].shape.spheres == 13);
}

TEST_CASE("without time_step the step follows the plates") {
    CHECK_FALSE(granular().time_step);
    CHECK(time_step(granular()) == 1e-4);
    CHECK(time_step(granular("[granular.plates]\ngamma = 20\n")) ==
          1.0 / (143 * 200.0)); // 142.5 in the period
    CHECK(time_step(granular("time_step = 2e-5\n[granular.plates]\ngamma = 20\n")) == 2e-5);
}

TEST_CASE("overrides reach into the bed") {
    const Granular g = granular(rod, {"granular.rods.0.heading=90 deg", "granular.rods.0.position.1=3 a",
                                      "granular.contacts.bead_rod.friction=0.1", "granular.output.formats=[]",
                                      "granular.plates.gamma=0", "granular.seed=9223372036854775807"});
    CHECK(g.rods[0].heading == std::numbers::pi / 2.0);
    CHECK(g.rods[0].position[1] == 3.0 * 0.4e-3);
    CHECK(g.contacts.bead_rod == SurfaceChange{0.1, std::nullopt});
    CHECK(g.output.formats.empty());
    CHECK(g.plates.gamma == 0.0);
    CHECK(g.seed == 9223372036854775807);
    says(bed(rod), "no entry 1: granular.rods has 1 (numbered from 0)", {"granular.rods.1.heading=0"});
}

TEST_CASE("values of a bed that do not fit each other") {
    says(bed("[granular.output]\nformats = [\"xyz\", \"xyz\"]\n"),
         "formats[1] = \"xyz\": is in the list already");
    says(bed("[granular.output]\nframes = 1e-5\n"), "frames = 1e-05 s is shorter than time_step = 0.0001 s");
    says(bed("[granular.output]\ntable = 1e-5\n"), "table = 1e-05 s is shorter than time_step");
    says(bed("[granular.output]\nframes = 1e-4\n"),
         "frames = 0.0001 s gives 1e+07 of them in 1000 s; at most 1e+06", {"granular.duration=1000"});
    says(bed(), "table = 0.01 s gives 2e+07 of them", {"granular.duration=2e5"});
    says(bed("[granular.output]\nframes = 5e-5\n[granular.plates]\ngamma = 20\n"), "time_step",
         {"granular.plates.gamma=7"});
    says(bed("time_step = 1e-300\n"), "steps; at most 1e+12");
    says(bed("time_step = 1.1e-3\n"), "must be > 0 and <= 0.001: above 1e-3 s");
    says(bed(rod + "segments = 5\n"), "x.toml:8:12: segments belong to taper = \"stepwise\" only");
    CHECK(granular(rod + "taper = \"stepwise\"\nsegments = 5\n").rods[0].shape.segments == 5);
    says(bed("[[granular.rods]]\nheading = 0\n"),
         "granular.rods[0] needs the key position, for example position = [\"20 a\", \"46.5 a\"]");
    says(bed("[granular.contacts]\nwall_bead = { friction = 0.1 }\n"),
         "[granular.contacts] unknown key \"wall_bead\"");
}

TEST_CASE("figures of the bed need it, and what they draw") {
    const auto drawn = [](const std::string& kind, const std::string& more = "") {
        return bed(more) + "[[figures]]\nname = \"f\"\nkind = \"" + kind + "\"\n";
    };
    for (const std::string kind : {"snapshot", "rod_tracks", "side_view", "movie", "granular_table"})
        CHECK(error_text(drawn(kind, rod)) == "");
    says(drawn("rod_tracks"), "needs [[granular.rods]]");
    says(drawn("movie", "[granular.output]\nformats = [\"xyz\"]\n"),
         "needs \"h5md\" in granular.output.formats");
    says(drawn("snapshot", "[granular.output]\nformats = []\n"), "needs \"h5md\" in granular.output.formats");
    says(drawn("side_view", "[granular.output]\nlast_period = false\n"), "last_period = true");
    says(drawn("movie") + "frame = 3\n", "x.toml:9:9: frame belongs to kind snapshot only");
    says(drawn("movie") + "colour = \"red\"\n", "colour = \"red\": of kind movie it is order or orientation");
    CHECK(parse(drawn("movie")).figures[0].colour == "order");
    const auto film = parse(drawn("movie") + "colour = \"orientation\"\nfps = 30\n");
    CHECK(film.figures[0].colour == "orientation");
    CHECK(film.figures[0].fps == 30);
    check_round_trip(film);
    CHECK(parse(drawn("snapshot") + "frame = 3\n").figures[0].frame == 3);
    const Scene windowed = parse(drawn("snapshot") + "x = [\"1 a\", 0.008]\n");
    CHECK(windowed.figures[0].x == std::vector{0.4e-3, 0.008});
    check_round_trip(windowed);
}

TEST_CASE("beds of all sorts survive writing") {
    check_round_trip(parse(bed()));
    check_round_trip(parse(bed(rod)));
    check_round_trip(parse(bed(rod), {"granular.beads=0", "granular.rods.0.kind=apolar",
                                      "granular.rods.0.imposed_speed=0", "granular.start=random",
                                      "granular.output.formats=[]", "granular.output.frames=0.3 s",
                                      "granular.order_cutoff=2.9 a", "granular.equilibrate=0"}));
    check_round_trip(
        parse(complete, {"granular.count_rod_area=false", "granular.contacts.bead_bead.friction=0.1",
                         "granular.rods.0.segments=7", "granular.bead_radius=0.1234567 mm",
                         "scales.bead_radius=0.1234567 mm", "figures.2.frame=4"}));
    Scene changed = parse(bed(rod));
    changed.granular->rods[0].shape.density += 1.0;
    CHECK_FALSE(changed == parse(bed(rod)));
}
