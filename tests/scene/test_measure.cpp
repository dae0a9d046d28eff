// [measure]: what it needs of the bed, and what figures need of it.

#include "support.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;
using rodwake::scene::WindowKind;

namespace {

const std::string rod = "[[granular.rods]]\nposition = [\"8 a\", \"15 a\"]\n";

std::string measured(const std::string& keys, const std::string& rods = rod) {
    return bed(rods) + "[measure]\n" + keys;
}

std::string drawn(const std::string& keys, const std::string& figure) {
    return measured(keys) + "[[figures]]\nname = \"f\"\n" + figure;
}

} // namespace

TEST_CASE("lengths of [measure] are in metres, strings may use the bed's own radius") {
    const auto m =
        parse(bed("bead_radius = \"1 mm\"\n" + rod) + "[measure]\nspacing = \"0.5 a\"\nblock = \"2 s\"\n")
            .measure;
    REQUIRE(m);
    CHECK(*m->spacing == Approx(5e-4));
    CHECK(m->block == 2.0);
    CHECK_FALSE(m->order);
}

TEST_CASE("[measure] needs the bed and its rods") {
    says(two_rods("[measure]\norder = true\n"), "[measure] needs [granular], the bed that is measured");
    for (const char* key : {"flow = true\n", "force = true\n", "displacement = \"phase\"\n"})
        says(measured(key, ""), "needs [[granular.rods]]");
    says(measured("pairs = true\n"), "pairs needs two [[granular.rods]]; there are 1");
    says(measured("rod = 1\n"), "there is no rod 1: granular.rods has 1 (numbered from 0)");
    CHECK(error_text(measured("order = true\nmicrorheology = true\n", "")) == "");
}

TEST_CASE("measuring begins at a time or after a distance") {
    const auto from = [](const std::string& keys) { return *parse(measured(keys)).measure; };
    CHECK(from("from = \"500 ms\"\n").from == 0.5);
    CHECK_FALSE(from("from = 0.5\n").from_travel);
    const auto far = from("from = \"20 a\"\n"), both = from("from = 0.5\nfrom_travel = \"20 a\"\n");
    CHECK(far.from == 0.0);
    REQUIRE(far.from_travel);
    CHECK(far.from_travel == both.from_travel);
    CHECK(both.from == 0.5);
    says(measured("from = \"20 a\"\nfrom_travel = \"30 a\"\n"), "is a distance, and so is from_travel");
    says(measured("from = \"0 a\"\n"), "must be > 0");
    says(measured("from = \"2 kg\"\n"), "expected a time or length");
    says(measured("from = \"20 a\"\n", ""), "from_travel (or a distance in from) needs [[granular.rods]]");
}

TEST_CASE("times and lengths of [measure] fit the run") {
    says(measured("interval = 1e-6\n"), "shorter than granular.time_step");
    says(measured("from = 2.0\n"), "not before the end of the run");
    says(measured("interval = 0.1\nblock = 0.05\n"), "shorter than the interval of 0.1 s");
    says(measured("interval = 0.1\norder_interval = 0.25\n"), "no whole multiple of the interval");
    says(measured("s_low = 2.0\ns_high = 1.0\n"), "must be above s_low");
    says(measured("bead_drag_error = 0.1\n"), "measure.bead_drag is not");
    says(measured("spacing = \"20 a\"\n"), "a quarter of the box");
    says(measured("far_from = \"25 a\"\n"), "0.45 of the box");
    says(measured("order_cutoff = \"3 a\"\norder_neighbours = \"delaunay\"\n"),
         "belongs to order_neighbours");
    CHECK(error_text(measured("interval = 0.1\norder_interval = 0.5\n")) == "");
}

TEST_CASE("currents are taken in parts of the interval, and blocks hold their lags") {
    const std::string base = "phonons = true\ninterval = 0.1\nblock = 0.25\n";
    CHECK(error_text(measured(base)) == "");
    CHECK(error_text(measured(base + "phonon_interval = 0.02\nphonon_lag = 0.125\n")) == "");
    says(measured(base + "phonon_interval = 0.02\nphonon_lag = 0.1\n"), "is below 6 of their intervals");
    says(measured(base + "phonon_interval = 0.03\n"), "the interval of 0.1 s is no whole multiple of it");
    says(measured(base + "phonon_interval = 1e-6\n"), "shorter than granular.time_step");
    says(measured(base + "phonon_lag = 0.2\n"), "longer than half of block = 0.25 s");
    says(measured("phonons = true\nblock = 0.9\n"), "at least 2 blocks");
    CHECK(error_text(measured("phonon_interval = 0.03\ninterval = 0.1\n")) == ""); // of no use here
    CHECK(error_text(measured("mechanics = true\n", "")) == ""); // the decay of the drift needs no rod
    const std::string gaussian =
        "[granular.body_force]\nkind = \"gaussian\"\nacceleration = 0.01\nwidth = \"2 a\"\n";
    says(measured("mechanics = true\n", rod + gaussian), "kind = \"uniform\"");
    says(measured("inertia_error = 0.1\n"), "give inertia_factor");
    CHECK(error_text(measured("inertia_factor = 1.27\ninertia_error = 0.03\n")) == "");
    says(measured("from_travel = 1e-3\n", ""), "from_travel (or a distance in from) needs [[granular.rods]]");
}

TEST_CASE("lags of the heading rise and fit into a block and the run") {
    const std::string base = "heading_diffusion = true\nblock = 0.8\n";
    CHECK(error_text(measured(base)) == "");
    CHECK(error_text(measured(base + "heading_lag_low = 0.05\nheading_lag_high = 0.4\n")) == "");
    says(measured(base + "heading_lag_high = 0.5\n"), "longer than half of block = 0.8 s");
    says(measured(base + "heading_lag_low = 0.2\n"),
         "must be below the longest lag of 0.2 s, a quarter of block");
    CHECK(error_text(measured("heading_diffusion = true\n")) == ""); // 1 s in a block of 5 s: up to 0.25 s
    says(measured("heading_diffusion = true\nheading_lag_high = 1.25\n"),
         "lags up to 1.25 s need twice as much, and 1 s are measured");
    says(measured(base, ""), "heading_diffusion needs [[granular.rods]]");
    says(measured("speed_deviations = true\n"), "measured up to version 0.3 only, which is tag v0.3.0");
}

TEST_CASE("figures need what they show") {
    says(drawn("order = true\n", "kind = \"series\"\n"), "needs [[variants]]");
    says(drawn("displacement = \"phase\"\n", "kind = \"profile\"\nalong = \"y\"\nsqrt_scaled = true\n"),
         "sqrt_scaled belongs to profiles along x");
    const std::string variant = "[[variants]]\nname = \"v\"\nset = { \"granular.phi_b\" = 0.6 }\n";
    says(drawn("order = true\n", "kind = \"series\"\nquantity = \"force\"\n") + variant,
         "needs measure.force = true");
    CHECK(error_text(drawn("order = true\n", "kind = \"series\"\nquantity = \"psi6\"\n") + variant) == "");
    CHECK(error_text(drawn("displacement = \"phase\"\n",
                           "kind = \"profile\"\ncomponent = \"Uy\"\nalong = \"y\"\n")) == "");
}

// --- [tracks]: windows in all their forms, there and back, and what does not fit beside each other

TEST_CASE("a window is a word or a table of lengths, and is written as it is read") {
    CHECK(parse(filmed).tracks->window.kind == WindowKind::automatic);
    const struct {
        std::string text;
        WindowKind kind;
        std::vector<double> sizes;
    } cases[] = {
        {"\"hull\"", WindowKind::hull, {}},
        {"\"automatic\"", WindowKind::automatic, {}},
        {"{ circle = [\"20 mm\", 0.01, \"40 a\"] }", WindowKind::circle, {0.02, 0.01, 0.016}},
        {"{ rectangle = [0.0, 0.0, \"2 cm\", 0.03] }", WindowKind::rectangle, {0.0, 0.0, 0.02, 0.03}}};
    for (const auto& one : cases) {
        const Scene scene = parse(filmed, {"tracks.window=" + one.text});
        CHECK(scene.tracks->window.kind == one.kind);
        CHECK(scene.tracks->window.sizes == one.sizes);
        CHECK(parse(rodwake::scene::to_toml(scene)).tracks == scene.tracks);
    }
}

TEST_CASE("a wrong window is reported with what is expected") {
    const struct {
        std::string window, said;
    } cases[] = {{"{ ring = [1.0, 2.0] }", "expected a string such as \"hull\", { circle = [x, y, radius] }"},
                 {"\"hul\"", "must be one of automatic, hull, periodic (did you mean \"hull\"?)"},
                 {"{ circle = [1.0, 2.0] }", "expected 3 numbers, found 2"},
                 {"{ circle = [1.0, 2.0, 0.0] }", "the radius of the circle must be above 0"},
                 {"{ circle = [1.0, 2.0, \"3 s\"] }", "expected a length"},
                 {"{ rectangle = [1.0, 0.0, 1.0, 1.0] }", "x0 below x1"},
                 {"\"periodic\"", "needs box, for example box = \"78 a\""}};
    for (const auto& one : cases) {
        const std::string text = error_text(filmed, {"tracks.window=" + one.window});
        INFO(text);
        CHECK_THAT(text, Catch::Contains(one.said));
    }
}

TEST_CASE("what tracks do not go with is refused") {
    const std::string alone = filmed.substr(0, filmed.find("[measure]"));
    CHECK(mentions(problems_of(alone), "tracks", "needs [measure]"));
    CHECK(mentions(problems_of(filmed + "[granular]\nphi_b = 0.7\nbox = \"30 a\"\nduration = 1.0\n"),
                   "tracks", "tracks replace a simulated bed"));
    CHECK(
        mentions(problems_of(filmed, {"tracks.time_column=t"}), "tracks.frames_per_second", "leave one out"));
    CHECK(mentions(problems_of(filmed, {"tracks.frames_per_second="}), "tracks.frames_per_second",
                   "time_column where the file has times"));
    // Files that may have times and a box of their own are looked at first.
    for (const char* of : {"tracks.file=film.dump", "tracks.format=xyz"})
        for (const char* without : {"tracks.frames_per_second=", "tracks.window=periodic"})
            CHECK(problems_of(filmed, {of, without}).empty());
    CHECK(mentions(
        problems_of(filmed, {"tracks.format=gsd", "tracks.frames_per_second=", "tracks.time_column=t"}),
        "tracks.time_column", "only CSV and extended XYZ have such columns"));
    CHECK(mentions(problems_of(filmed, {"tracks.box=30 a"}), "tracks.box", "belongs to window"));
    CHECK(mentions(problems_of(filmed, {"measure.order=false"}), "measure",
                   "nothing that can be measured on tracks"));
    for (const char* key : {"force", "phonons", "mechanics"})
        CHECK(mentions(problems_of(filmed, {std::string("measure.") + key + "=true"}),
                       std::string("measure.") + key, "needs a bed"));
    CHECK(mentions(problems_of(filmed, {"measure.pairs=true"}), "measure.pairs", "needs contact_distance"));
    CHECK(mentions(problems_of(filmed, {"measure.displacement=density"}), "measure.displacement",
                   "give phase or lagrangian"));
    CHECK(mentions(problems_of(filmed, {"tracks.angle=0"}), "tracks.angle", "must not be 0"));
    CHECK(parse(filmed, {"tracks.angle=-180 deg"}).tracks->angle == Approx(-3.14159265358979));
    CHECK(parse(filmed, {"tracks.bead_radius=1 mm", "measure.order_cutoff=3 a"}).measure->order_cutoff ==
          3e-3);
}
