// [scan]: reading, writing, and what does not fit.

#include "rodwake/scene/read.hpp"
#include "rodwake/scene/scan.hpp"
#include "rodwake/scene/set.hpp"
#include "support.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;
using namespace rodwake::scene;

namespace {

const std::string kappa = "[[scan.axes]]\nkey = \"coupling.kappa\"\nfrom = 0.1\nto = 100.0\n";

/// Two rods that interact, with these lines of [scan].
std::string scan(const std::string& lines) {
    return two_rods("[medium]\neta = 1\nxi = 1\n[coupling]\nkappa = 1\n[scan]\n" + lines);
}

std::string axis(const std::string& lines) { return "[[scan.axes]]\n" + lines + "\n"; }

/// Checks that one thing is wrong with these lines of [scan], and that it is reported once.
void refuses(const std::string& lines, const std::string& part) {
    const std::string message = error_text(scan(lines));
    CAPTURE(lines, message);
    CHECK_THAT(message, Catch::Contains(part));
    CHECK(std::ranges::count(message, '\n') == 0);
}

} // namespace

TEST_CASE("a scan is read with its defaults") {
    const auto read = *parse(scan(kappa)).scan;
    CHECK(read.design == ScanDesign::grid);
    CHECK(read.resolution == 1024);
    CHECK(read.audited() == 1000);
    CHECK_FALSE(read.boundary_tolerance);
    CHECK_FALSE(read.time_limit);
    CHECK(read.max_points == 20'000'000);
    REQUIRE(read.axes.size() == 1);
    CHECK(read.axes[0].name() == "coupling.kappa");
    CHECK(read.axes[0].from == Value(0.1));
    CHECK(read.axes[0].spacing == ScanSpacing::linear);
    CHECK(read.axes[0].count == 64);
    CHECK_FALSE(parse(two_rods()).scan);
}

TEST_CASE("values of axes keep their kind: whole, real, words, flags, units") {
    const auto read =
        *parse(
             scan(
                 axis("key = \"rods.0.heading\"\nvalues = [1, 2.5, \"30 deg\", true]") +
                 axis("keys = [\"coupling.gamma1\", \"coupling.gamma2\"]\nfactor = [1.0, -2]\nfrom = \"-1\"\n"
                      "to = 3\nspacing = \"linear\"\ncount = 5")))
             .scan;
    CHECK(read.axes[0].values == std::vector<Value>{std::int64_t{1}, 2.5, "30 deg", true});
    CHECK(read.axes[1].name() == "coupling.gamma1");
    CHECK(read.axes[1].factor == std::vector<double>{1.0, -2.0});
    CHECK(read.axes[1].from == Value("-1"));
    CHECK(read.axes[1].to == Value(std::int64_t{3}));
}

TEST_CASE("scans survive being written and read") {
    check_round_trip(parse(scanned));
    check_round_trip(parse(scanned, {"units=si", "rods_run.contact_distance=0.01"}));
    check_round_trip(
        parse(scan(axis("key = \"rods.0.heading\"\nvalues = [1, 2.5, \"30 deg\", true, \"a \\\"b\\\"\"]"))));
    check_round_trip(parse(scan(axis("keys = [\"coupling.gamma1\", \"coupling.gamma2\"]\nfactor = [1.0, "
                                     "-2]\nfrom = \"10 deg\"\nto = 3"))));
    check_round_trip(parse(scan("design = \"list\"\nfile = \"points.csv\"\n")));
    check_round_trip(
        parse(scan("design = \"lhs\"\nsamples = 7\nseed = 3\ntime_limit = 2.5\ntrajectories = 0\n"
                   "max_points = 10\n" +
                   kappa)));
    check_round_trip(
        parse(scan("design = \"adaptive\"\nresolution = 256\naudit = 0\nboundary_tolerance = 1e-8\n" + kappa +
                   "[[scan.refine]]\nobservable = \"min_separation\"\nstep = 0.25\n")));
}

TEST_CASE("scans that differ are not equal") {
    const Scene scene = parse(scanned);
    const auto differs = [&](const std::string& setting) { return !(parse(scanned, {setting}) == scene); };
    for (const char* setting :
         {"scan.resolution=512", "scan.audit=5", "scan.axes.0.from=0.2", "scan.axes.0.count=32",
          "scan.refine.0.step=0.1", "scan.axes.0.spacing=log", "scan.time_limit=1"}) {
        INFO(setting);
        CHECK(differs(setting));
    }
    CHECK_FALSE(differs("scan.resolution=256"));
}

TEST_CASE("a scan needs rods that can meet, and axes") {
    says("schema = 1\n[medium]\neta = 1\nxi = 1\n[field]\nx = [-1, 1]\ny = [-1, 1]\n[scan]\n" + kappa,
         "[scan] needs [[rods]] with [rods_run], or [granular]");
    says("schema = 1\n[[rods]]\nposition = [0, 0]\n[rods_run]\nt_end = 1\n[scan]\n" +
             axis("key = \"rods.0.heading\"\nfrom = 0\nto = 1"),
         "[scan] of rods needs two or more [[rods]]");
    says("schema = 1\n[rods_random]\ncount = 101\nextent = 60\n[rods_run]\nt_end = 1\n[scan]\n" +
             axis("key = \"coupling.kappa\"\nfrom = 0\nto = 1"),
         "of at most 100 rods, and this scene has 101");
    refuses("", "x.toml:13:1: [scan] has no axes: give [[scan.axes]] with key, from and to");
    says(scan(kappa) + "[[variants]]\nname = \"v\"\nset = { \"medium.eta\" = 2 }\n",
         "[scan] and [[variants]] do not go together: make the variants an axis");
    says(replaced(scan(kappa), "eta = 1\nxi = 1\n", "fitted = true\n") +
             "[fit]\nparameters = [\"eta\", \"xi\"]\n[[fit.profiles]]\nfile = \"u.csv\"\n",
         "[scan] needs a medium of its own");
}

TEST_CASE("an axis names its keys in one way, and keys that points depend on") {
    const std::string range = "from = 0.1\nto = 1.0\n";
    refuses(axis(range), "x.toml:13:1: scan.axes[0]: give key, or keys for several that vary together");
    refuses(axis("key = \"coupling.kappa\"\nkeys = [\"coupling.gamma1\"]\n" + range),
            "scan.axes[0]: give key, or keys");
    refuses(axis("keys = [\"coupling.gamma1\", \"coupling.gamma2\"]\nfactor = [1.0]\n" + range),
            "scan.axes[0].factor has 1 numbers for 2 keys");
    refuses(axis("key = \"coupling.kappa\"\nfactor = [2.0]\n" + range),
            "scan.axes[0].factor has 1 numbers for 0 keys");
    for (const std::string key : {"scan.resolution", "figures.0.cut", "variants.0.name", "field.nx",
                                  "granular.phi_b", "measure.order", "fit.seed", "title", "schema"})
        refuses(axis("key = \"" + key + "\"\n" + range),
                "scan.axes[0]: " + key + " is not what a scan can vary");
    refuses(kappa + axis("keys = [\"medium.eta\", \"scan.seed\"]\n" + range),
            "scan.axes[1]: scan.seed is not");
}

TEST_CASE("an axis has two ends or values") {
    const std::string key = "key = \"coupling.kappa\"\n";
    for (const std::string lines : {"", "from = 1.0\n", "to = 1.0\n", "from = 1.0\nvalues = [1.0]\n",
                                    "from = 1.0\nto = 2.0\nvalues = [1.0]\n"})
        refuses(axis(key + lines), "scan.axes[0]: give from and to, or values");
    refuses(axis(key + "from = 2\nto = 2.0\n"), "scan.axes[0]: from and to are both 2: the axis is empty");
    refuses(axis(key + "from = 0\nto = 2.0\nspacing = \"log\"\n"),
            "scan.axes[0]: spacing \"log\" needs ends of one sign, found 0 and 2");
    refuses(axis(key + "from = -1.0\nto = 2.0\nspacing = \"log\"\n"), "found -1 and 2");
    CHECK(error_text(scan(axis(key + "from = -1.0\nto = -100\nspacing = \"log\"\n"))) == "");
    refuses(axis(key + "from = 1.0\nto = 2.0\ncount = 1\n"), "scan.axes[0].count = 1 would use only");
    CHECK(error_text(scan(axis(key + "values = [1.0]\n"))) == "");
}

TEST_CASE("each design takes what is its own") {
    const std::string values = axis("key = \"coupling.kappa\"\nvalues = [1.0, 2.0]"),
                      refine = "[[scan.refine]]\nobservable = \"time\"\nstep = 1.0\n";
    for (const std::string design : {"lhs", "sobol", "adaptive"})
        refuses("design = \"" + design + "\"\nresolution = 64\n" + values,
                "only design = \"grid\" or \"critical\" takes listed values");
    refuses("design = \"list\"\n", "design = \"list\" needs scan.file, a CSV whose header names the keys");
    refuses("design = \"list\"\nfile = \"p.csv\"\n" + kappa, "with scan.file the axes are its columns");
    refuses("file = \"p.csv\"\n" + kappa, "scan.file needs design = \"list\"");
    refuses("boundary_tolerance = 1e-6\n" + kappa, "scan.boundary_tolerance needs design = \"adaptive\"");
    refuses(kappa + refine, "[[scan.refine]] needs design = \"adaptive\"");
    CHECK(error_text(scan("design = \"list\"\nfile = \"p.csv\"\n")) == "");
    CHECK(error_text(scanned_critical) == "");
    refuses("solve_for = \"medium.eta\"\n" + kappa, "scan.solve_for needs design = \"critical\"");
    refuses("design = \"critical\"\n" + kappa, "design = \"critical\" needs solve_for");
}

TEST_CASE("the resolution of an adaptive scan is the count of its axes, doubled some times") {
    const auto adaptive = [](long count, long resolution, const std::string& more = "") {
        return "design = \"adaptive\"\nresolution = " + std::to_string(resolution) + "\n" + kappa +
               "count = " + std::to_string(count) + "\n" + more;
    };
    for (const auto& [count, resolution] : {std::pair{64L, 64L}, {64L, 1024L}, {48L, 96L}, {1L, 2L}})
        CHECK(error_text(scan(adaptive(count, resolution))) == "");
    for (const auto& [count, resolution] : {std::pair{64L, 32L}, {64L, 192L}, {64L, 100L}, {48L, 1024L}})
        refuses(adaptive(count, resolution),
                "scan.axes[0].count = " + std::to_string(count) + ": with design = \"adaptive\"");
    refuses(adaptive(64, 1024, axis("key = \"medium.eta\"\nfrom = 1\nto = 2\ncount = 32")),
            "scan.axes[1].count = 32: with design = \"adaptive\" all axes need the same count; the first has "
            "64");
    std::string three;
    for (const char* key : {"medium.eta", "medium.alpha", "rods.1.heading"})
        three += axis("key = \"" + std::string(key) + "\"\nfrom = 1\nto = 2");
    refuses(adaptive(64, 1024, three), "design = \"adaptive\" takes one, two or three axes");
}

TEST_CASE("ends of an axis are set as they are written, and no nan") {
    Scene scene = parse(scanned);
    const auto from = compile_setter(scene, "scan.axes.0.from");
    CHECK_FALSE(from.set(scene, Value("10 deg")));
    CHECK(scene.scan->axes[0].from == Value("10 deg"));
    CHECK(from.set(scene, Value(std::nan(""))));
    CHECK(scene.scan->axes[0].from == Value("10 deg"));
}

TEST_CASE("a scan of beds varies the bed, by designs that take random outcomes") {
    const std::string gamma = axis("key = \"granular.plates.gamma\"\nfrom = 1\nto = 7\ncount = 64");
    CHECK(error_text(bed("[scan]\n" + gamma)).empty());
    CHECK(scan_subject(parse(bed("[scan]\n" + gamma))) == ScanSubject::beds);
    const auto refused = [](const std::string& lines, const std::string& why) {
        says(bed("[scan]\n" + lines), why);
    };
    refused(kappa, "scan.axes[0]: coupling.kappa is not what a scan of beds can vary");
    for (const std::string key : {"granular.output.frames", "granular.restart_from", "measure.order"})
        refused(axis("key = \"" + key + "\"\nfrom = 1\nto = 2"),
                key + " is not what a scan of beds can vary");
    refused(axis("key = \"granular.runs\"\nfrom = 1\nto = 2"), "granular.runs is how many runs each point");
    refused("design = \"adaptive\"\n" + gamma, "outcomes of beds are random: take grid, list, lhs or sobol");
}

TEST_CASE("of a scene with rods and a bed the axes tell what is scanned") {
    const std::string both = scan("") + "[granular]\nphi_b = 0.5\nbox = \"20 a\"\nduration = \"1 s\"\n";
    const auto subject = [&](const std::string& key) {
        return scan_subject(
            parse_scene(both + axis("key = \"" + key + "\"\nfrom = 0.1\nto = 0.2"), "x.toml"));
    };
    CHECK(subject("coupling.kappa") == ScanSubject::rods);
    CHECK(subject("granular.phi_b") == ScanSubject::beds);
    CHECK(scan_subject(Scene()) == ScanSubject::rods);
}
