// Tables and values that do not fit each other.

#include "support.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace scene_test;

namespace {

std::string with_figure(const std::string& lines) {
    return two_rods(
        "[medium]\neta = 1\nxi = 1\n[field]\nx = [-1, 1]\ny = [-1, 1]\n[[field.cuts]]\nfrom = 0\nto = 1\n"
        "[[figures]]\nname = \"f\"\n" +
        lines);
}

} // namespace

TEST_CASE("tables that need each other") {
    says("schema = 1\n", "x.toml:1:1: nothing to do: give [[rods]] with [rods_run], or [field], or "
                         "[granular], or [tracks], or [fit]");
    says("schema = 1\n[medium]\neta = 1\nxi = 1\n", "nothing to do");
    says("schema = 1\n[[rods]]\nposition = [0, 0]\n", "[[rods]] need [rods_run] with t_end");
    says("schema = 1\n[rods_run]\nt_end = 1\n", "x.toml:2:1: [rods_run] needs [[rods]]");
    says("schema = 1\nrods = []\n[rods_run]\nt_end = 1\n", "[rods_run] needs [[rods]]");
    says(two_rods("[rods_random]\ncount = 3\nextent = 9\n"),
         "[[rods]] and [rods_random] are given: leave one out");
    says("schema = 1\n[rods_random]\ncount = 3\nextent = 9\n",
         "x.toml:2:1: [[rods]] need [rods_run] with t_end");
    says("schema = 1\n[medium]\neta = 1\nxi = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n[rods_order]\nlink = 1\n",
         "[rods_order] needs rods to analyse");
    says("schema = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n", "x.toml:2:1: [field] needs [medium]");
    says(two_rods("[coupling]\nkappa = 1\n"), "x.toml:8:1: [coupling] with two or more rods needs [medium]");
    says(
        "schema = 1\n[medium]\neta = 1\nxi = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n[[variants]]\nname = \"v\"\n"
        "set = { \"medium.eta\" = 2 }\n",
        "[[variants]] run the rods or the bed again: they need [[rods]] or [granular]");
    CHECK(error_text(
              "schema = 1\n[coupling]\nkappa = 1\n[[rods]]\nposition = [0, 0]\n[rods_run]\nt_end = 1\n") ==
          "");
}

TEST_CASE("rods at random, their order and the sums of their wakes fit each other") {
    const auto crowd = [](const std::string& keys, const std::string& run = "",
                          const std::string& more = "") {
        return "schema = 1\n[rods_random]\ncount = 20\nextent = 9\n" + keys + "[rods_run]\nt_end = 4\n" +
               run + more;
    };
    const std::string box = "[medium]\neta = 1\nxi = 1\nperiodic = 8\n";
    says(crowd("min_separation = 2\n"),
         "may cover 0.3: fewer rods, a larger extent or a smaller min_separation");
    says(crowd("", "", box), "rods_random.extent is 9 f/mu, more than the periodic box of 8");
    says(crowd("", "", "[medium]\neta = 1\nxi = 1\nperiodic = [20, 8]\n"),
         "more than the periodic box of 20 x 8");
    says(crowd("", "", "[medium]\neta = 1\nxi = 1\nperiodic = [20, -8]\n"), "medium.periodic");
    says(crowd("", "", "[medium]\neta = 1\nxi = 1\nperiodic = [20, 18, 8]\n"), "medium.periodic");
    says(crowd("", "", "[medium]\neta = 1\nxi = 1\nfield = \"table\"\nperiodic = [20, 18]\n"),
         "tables are of square boxes, and medium.periodic is 20 x 18");
    says(crowd("", "turning_tolerance = 1e-6\n", box),
         "turning_tolerance needs the exact field on the plane");
    says(crowd("", "precision = \"single\"\n", box), "precision needs the exact field on the plane");
    says(crowd("", "", "[rods_order]\nlink = 1\nfrom = 4\n"), "is not before the end of the run, 4");
    says(crowd("", "", "[rods_order]\nlink = 1\nfrom = 1\nblock = 3.5\n"), "longer than what counts, 3");
    says(replaced(crowd("", "method = \"bdf\"\n"), "count = 20", "count = 3001"), "at most 3000 rods");
    CHECK(error_text(crowd("", "contact_distance = 0.1\n")).empty());
}

TEST_CASE("rods at random keep their distance, and depend on the seed") {
    const std::string text = "schema = 1\n[rods_random]\ncount = 200\nextent = 20\nmin_separation = 0.8\n"
                             "heading = 1\nspread = 0.5\n[rods_run]\nt_end = 1\n";
    const Scene scene = parse(text);
    REQUIRE(scene.rods.size() == 200);
    CHECK(parse(text) == scene);
    CHECK(parse(text, {"rods_random.seed=2"}).rods != scene.rods);
    double nearest = 1e9;
    for (std::size_t a = 0; a < 200; ++a) {
        const auto& p = scene.rods[a].position;
        CHECK((std::abs(p[0]) < 10.0 && std::abs(p[1]) < 10.0));
        CHECK(std::abs(scene.rods[a].heading - 1.0) < 0.5);
        for (std::size_t b = 0; b < a; ++b) {
            const auto& q = scene.rods[b].position;
            nearest = std::min(
                nearest, std::hypot(std::remainder(p[0] - q[0], 20.0), std::remainder(p[1] - q[1], 20.0)));
        }
    }
    CHECK(nearest >= 0.8);
    CHECK(nearest < 0.9); // so many are bound to come near
}

TEST_CASE("rods at random fill a disc evenly, up to its edge on all sides") {
    const std::string text = "schema = 1\n[rods_random]\ncount = 2000\nshape = \"disc\"\nextent = 60\n"
                             "min_separation = 0.6\n[rods_run]\nt_end = 1\n";
    const Scene scene = parse(text);
    REQUIRE(scene.rods.size() == 2000);
    std::array<int, 4> right_up_left_down{};
    int inner = 0;
    for (const auto& rod : scene.rods) {
        const double r = std::hypot(rod.position[0], rod.position[1]);
        CHECK(r < 30.0);
        inner += r < 30.0 * std::numbers::sqrt2 / 2.0; // half of the area
        for (int k = 0; k < 4; ++k)
            right_up_left_down[k] += rod.position[k % 2] * (k < 2 ? 1.0 : -1.0) > 29.0;
    }
    CHECK(std::abs(inner - 1000) < 90); // four deviations of a binomial distribution
    CHECK(std::ranges::min(right_up_left_down) > 0);
    says(replaced(text, "0.6", "0.9"), "cover 0.45 of the disc of diameter 60, and may cover 0.3");
    CHECK(parse(replaced(text, "\"disc\"", "\"square\"")) == parse(replaced(text, "shape = \"disc\"\n", "")));
}

TEST_CASE("starts that coincide or touch") {
    says("schema = 1\n[[rods]]\nposition = [1, 2]\n[[rods]]\nposition = [0, 0]\n[[rods]]\nposition = [1.0, "
         "2.0]\n"
         "[rods_run]\nt_end = 1\n",
         "x.toml:7:12: rods[0] (line 3) and rods[2] (line 7) start at the same point");
    CHECK(error_text(two_rods("contact_distance = 1.0\n")) == ""); // in contact at 0
    CHECK(error_text(two_rods("contact_distance = 0.1\n"), {"rods.1.position=[0.0, 0.0]"}) == "");
}

TEST_CASE("a measured field needs its file, the unit of length and theory beyond it") {
    const std::string file = "[medium.measured]\nfile = \"measure.h5\"\n";
    const std::string scales = "[scales]\nf_over_mu = \"4 a\"\nv0 = \"1 mm/s\"\n";
    const auto medium = [](const std::string& more) { return "[medium]\nfield = \"measured\"\n" + more; };
    const std::string given = "eta = 1\nxi = 1\n";
    CHECK(error_text(two_rods(scales + medium(given) + file)) == "");
    says(two_rods(scales + medium(given)), "medium.field = \"measured\" needs [medium.measured] with file");
    says(two_rods(medium(given) + file), "needs [scales] with f_over_mu");
    says(two_rods(scales + medium("fitted = true\n") + file +
                  "[fit]\nparameters = [\"f_over_mu\", \"eta\", \"xi\"]\n"
                  "[[fit.profiles]]\nfile = \"u.csv\"\n"),
         "needs eta and xi of its own");
    says(two_rods(scales + medium(given) + "[medium.measured]\nsamples = 3\n"),
         "medium.measured needs the key file");
    CHECK(parse(two_rods("[medium]\neta = 1\nxi = 1\n" + file)).medium->measured->samples == 32);
}

TEST_CASE("a dynamic medium needs modes for its force, rods apart and no other box or method") {
    const auto scene = [](const std::string& dynamic, const std::string& run = "",
                          const std::string& medium = "") {
        return two_rods(run + "[medium]\neta = 1\nxi = 1\nfield = \"dynamic\"\n" + medium +
                        "[medium.dynamic]\n" + dynamic);
    };
    CHECK(error_text(two_rods("[medium]\neta = 1\nxi = 1\nfield = \"dynamic\"\n")) == "");
    const auto medium =
        *parse(scene("box = 20\nforce_width = 0.25\nmodes = 100\nself_field = true\nstart = \"rest\"\n"
                     "evaluation = \"mesh\"\ninertia = 0.5\n"))
             .medium;
    CHECK(medium.dynamic == rodwake::medium::DynamicMedium{.box = 20.0,
                                                           .force_width = 0.25,
                                                           .modes = 100,
                                                           .self_field = true,
                                                           .start = rodwake::medium::Start::rest,
                                                           .evaluation = rodwake::medium::Evaluation::mesh,
                                                           .inertia = 0.5});
    CHECK(medium.box()->x == 20.0);
    says(scene("force_width = 0.3\n"),
         "[medium.dynamic]: force_width = 0.3 is below the grid spacing box/modes = 0.4167");
    says(scene("box = 1.9\n"), "[medium.dynamic]: box = 1.9 is less than 4 force_width = 2");
    says(scene("force_width = 1.5\n"), "rods[0] and rods[1] start 1 apart, closer than force_width = 1.5");
    says(scene("box = 5.0\n", "", "periodic = 5.0\n"),
         "medium.periodic cannot be combined with medium.field = \"dynamic\"");
    says(scene("", "method = \"bdf\"\n"),
         "rods_run.method = \"bdf\": with medium.field = \"dynamic\" rods and medium");
    says(scene("", "form = \"director\"\n"),
         "rods_run.form = \"director\": medium.field = \"dynamic\" takes \"angle\"");
    says(scene("", "turning_tolerance = 1e-4\n"),
         "rods_run.turning_tolerance needs the exact field on the plane");
    says(scene("inertia = 0.1\nevaluation = \"mesh\"\n"),
         "[medium.dynamic]: inertia = 0.1 with self_field = false is not available");
    CHECK(parse(scene("closure = \"steady\"\n")).medium->memory().closure ==
          rodwake::medium::Closure::steady);
    says(scene("closure = \"steady\"\nstart = \"rest\"\n"),
         "[medium.dynamic]: a closure has no initial state");
}

TEST_CASE("a film needs a medium that is integrated, an interval and points enough") {
    const auto scene = [](const std::string& film, const std::string& figure = "",
                          const std::string& field = "field = \"dynamic\"\n") {
        return "schema = 1\n[medium]\neta = 1\nxi = 1\n" + field + "[medium.dynamic]\n" + film +
               "[[rods]]\nposition = [0, 1]\n[[rods]]\nposition = [0, -1]\n[rods_run]\nt_end = 1\n" +
               (figure.empty() ? "" : "[[figures]]\nname = \"f\"\nkind = \"" + figure + "\"\n");
    };
    CHECK(error_text(scene("film_interval = 0.5\n", "medium_film")) == "");
    CHECK(parse(scene("film_interval = 0.5\nfilm_grid = 96\n")).medium->memory().film_grid == 96);
    says(scene("film_interval = 0.5\nfilm_grid = 64\n"), "film_grid = 64: its spacing box/film_grid = 0.625");
    says(scene("film_interval = 0.5\nclosure = \"steady\"\n"),
         "film_interval needs a medium that is integrated");
    says(scene("", "medium_film"), "a figure of kind medium_film needs medium.field = \"dynamic\" with "
                                   "medium.dynamic.film_interval");
    says(scene("film_interval = 0.5\n", "medium_instants", "field = \"exact\"\n"),
         "a figure of kind medium_instants needs medium.field = \"dynamic\" with");
}

TEST_CASE("field grids and cuts") {
    const std::string medium = "schema = 1\n[medium]\neta = 1\nxi = 1\n";
    says(medium + "[field]\nx = [0, 1]\n", "field.x and field.y come together");
    says(medium + "[field]\ny = [0, 1]\n", "field.x and field.y come together");
    says(medium + "[field]\n", "neither a grid (x and y) nor [[field.cuts]]");
    says(medium + "[field]\nx = [1, 1]\ny = [0, 1]\n", "x.toml:6:5: field.x: min = 1 must be below max = 1");
    says(medium + "[field]\nx = [0, 1]\ny = [0, 1]\nnx = 4000\nny = 4000\n",
         "nx * ny is 16000000; at most 4000000");
    says(medium + "[[field.cuts]]\nfrom = 2\nto = 1\n",
         "x.toml:7:6: field.cuts[0]: from = 2 must be below to = 1");
    CHECK(error_text(medium + "[[field.cuts]]\nfrom = 1\nto = 2\n") == "");
}

TEST_CASE("figures") {
    CHECK(error_text(with_figure("kind = \"cut\"\n")) == "");
    CHECK(error_text(with_figure("kind = \"trajectories\"\n")) == "");
    says(with_figure("kind = \"cut\"\ncut = 1\n"), "there is no cut 1: field.cuts has 1 (numbered from 0)");
    says(with_figure("kind = \"polar_streamlines\"\n"), "needs gammas = ");
    says(with_figure("kind = \"cut\"\nx = [2, 1]\n"), "min = 2 must be below max = 1");
}

TEST_CASE("a form needs a method that can take it") {
    const auto with = [](const std::string& method, const std::string& form) {
        return "schema = 1\n[[rods]]\nposition = [0, 0]\n[rods_run]\nt_end = 1\nmethod = \"" + method +
               "\"\nform = \"" + form + "\"\n";
    };
    says(with("adams", "director"), "set method to \"bdf\", \"erk\" or \"auto\"");
    says(with("erk", "dae"), "set method to \"bdf\" or \"auto\"");
    for (const char* form : {"angle", "director", "dae"})
        CHECK(parse(with("bdf", form)).rods_run->method == rodwake::integrate::Method::bdf);
}

TEST_CASE("dense matrices of too many rods are refused in every form") {
    const auto with = [](int rods, const std::string& run) {
        return "schema = 1\n[rods_random]\nextent = 500\ncount = " + std::to_string(rods) +
               "\n[rods_run]\nt_end = 1\n" + run;
    };
    says(with(3001, "method = \"bdf\"\n"),
         "9003 x 9003 numbers for 3001 rods in form \"angle\", 0.65 GB each");
    says(with(1801, "form = \"dae\"\n"), "at most 1800 rods");
    says(with(2251, "method = \"bdf\"\nform = \"director\"\n"), "at most 2250 rods");
    CHECK(parse(with(3001, "")).rods.size() == 3001);
}

TEST_CASE("a tolerance of the table and no noise are accepted, dotted or as tables") {
    const std::string medium = "[medium]\neta = 1\nxi = 1\nfield = \"exact\"\n";
    CHECK(parse(two_rods(medium + "table.tolerance = 1e-6\n")).medium->table->tolerance == 1e-6);
    CHECK(parse(two_rods(medium + "[medium.table]\ntolerance = 1e-6\n")).medium->table->tolerance == 1e-6);
    says(two_rods(medium + "table.tolerance = 0.2\n"), "x.toml:12:19: medium.table.tolerance = 0.2: must be");
    CHECK(parse(two_rods("[noise]\nrotational_diffusion = 0.0\n")).noise->rotational_diffusion == 0.0);
    CHECK(parse(two_rods("[noise]\nrotational_diffusion = 0.01\nruns = 5\n")).noise->runs == 5);
}

TEST_CASE("noise has a method of its own") {
    const auto noisy_rods = [](const std::string& run, const std::string& more = "") {
        return "schema = 1\n[[rods]]\nposition = [0, 1]\n[[rods]]\nposition = [0, -1]\n[rods_run]\nt_end = "
               "4\n" +
               run + "[noise]\nrotational_diffusion = 0.01\n" + more;
    };
    CHECK(noisy(parse(noisy_rods("method = \"auto\"\n"))));
    CHECK(parse(noisy_rods("", "capture_error = 0.1\n")).noise->most_runs == 10'000);
    says("schema = 1\n[[rods]]\nposition = [0, 1]\n[rods_run]\nt_end = 4\n[noise]\nrotational_diffusion = "
         "0.01\n"
         "capture_error = 0.1\n",
         "noise.capture_error = 0.1: a single rod captures none");
    CHECK_FALSE(noisy(parse(two_rods("[noise]\nrotational_diffusion = 0.0\n"))));
    says(noisy_rods("method = \"bdf\"\n"),
         "x.toml:8:10: rods_run.method: rods with [noise] are integrated by a method of");
    says(noisy_rods("form = \"director\"\n"),
         "rods_run.form = \"director\": rods with [noise] take form \"angle\" only");
    says(noisy_rods("", "[medium]\neta = 1\nxi = 1\nfield = \"measured\"\n[medium.measured]\nfile = "
                        "\"m.h5\"\n[scales]\nf_over_mu = 1\nv0 = 1\n"),
         "an ensemble is drawn from the errors of the field or from [noise], not both");
    says(noisy_rods("", "[medium]\neta = 1\nxi = 1\nfield = \"measured\"\n"),
         "needs [medium.measured] with file");
    says(noisy_rods("", "[medium]\neta = 1\nxi = 1\nfield = \"dynamic\"\n"),
         "[noise] cannot be combined with medium.field = \"dynamic\"");
}

TEST_CASE("places that an override gives have no line") {
    CHECK(error_text(two_rods(), {"rods.1.position=[0.0, 0.0]"}) ==
          "-s rods.1.position=[0.0, 0.0]: rods[0] (line 3) and rods[1] start at the same point");
}

TEST_CASE("names are unique") {
    says(with_figure("kind = \"cut\"\n[[figures]]\nname = \"f\"\nkind = \"cut\"\n"),
         "the name \"f\" is taken by figures[0] (line 18)");
    // What the command line sets has no line.
    CHECK(error_text(two_rods(), {"rods.1.position=[0.0, 0.0]"}) ==
          "-s rods.1.position=[0.0, 0.0]: rods[0] (line 3) and rods[1] start at the same point");
    CHECK(error_text(with_figure("kind = \"cut\"\n[[figures]]\nname = \"g\"\nkind = \"cut\"\n"),
                     {"figures.0.name=g"})
              .ends_with(": the name \"g\" is taken by figures[0]"));
    CHECK(error_text(two_rods(""), {"rods.0.position=[1.0, 1.0]", "rods.1.position=[1.0, 1.0]"})
              .ends_with("rods[0] and rods[1] start at the same point"));
    says(two_rods("[[variants]]\nname = \"v\"\nset = { \"rods_run.t_end\" = 3 }\n[[variants]]\nname = \"v\"\n"
                  "set = { \"rods_run.t_end\" = 4 }\n"),
         "the name \"v\" is taken by variants[0] (line 9)");
}
