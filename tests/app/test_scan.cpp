// From [scan] to a design, and from a point of it to a scene.

#include "scan_scenes.hpp"

#include "rodwake/app/scan_problem.hpp"

#include <numbers>

using namespace app_test;

TEST_CASE("A scan of two keys: axes, columns, and the scene of a point") {
    const auto made = plan(kappa + axis("key = \"rods.1.position.0\"\nfrom = -6\nto = 6.0\ncount = 3"));
    REQUIRE(made.design.axes.size() == 2);
    CHECK(made.design.kind == scan::Kind::grid);
    CHECK(made.design.axes[0].name == "coupling.kappa");
    CHECK(made.design.axes[0].spacing == scan::Spacing::log);
    CHECK(made.design.axes[0].count == 4);
    CHECK(made.design.axes[1].from == -6.0);
    CHECK(scan::size(made.design) == 12);
    CHECK(made.columns.outcomes ==
          std::vector<std::string>{"contact", "pursuit", "escape", "undecided", "orbit", "bound"});
    CHECK(made.columns.observables ==
          std::vector<std::string>{"time", "min_separation", "min_separation_time", "turn0", "turn1",
                                   "non_reciprocity", "final_separation", "final_angle", "steps",
                                   "rhs_evaluations", "separation", "omega", "certificate"});
    const auto scene = at(made, {7.5, -3.25});
    CHECK(scene.coupling->kappa == 7.5);
    CHECK(scene.rods[1].position[0] == -3.25);
    CHECK(scene.rods[1].position[1] == -2.5);
    CHECK(scene.rods[0].position[0] == 0.0);
}

TEST_CASE("The problem of a point is that of its scene, whichever way the values take") {
    const auto places = plan(kappa + axis("keys = [\"rods.1.position.0\", \"rods.0.heading\"]\n"
                                          "factor = [1.0, -0.5]\nfrom = -6\nto = 6.0\ncount = 3"));
    const auto medium = plan(kappa + axis("key = \"medium.alpha\"\nfrom = 1\nto = 6.0\ncount = 3"));
    for (const auto* made : {&places, &medium}) {
        app::PointProblem problems(*made);
        for (const double second : {3.25, 1.5, 3.25}) {
            const scan::Point point{0, {7.5, second}};
            const rods::RodProblem expected = app::rod_problem(at(*made, {7.5, second})),
                                   found = problems.at(point);
            CHECK(found.couplings.kappa == 7.5);
            CHECK(found.couplings.gamma1 == expected.couplings.gamma1);
            CHECK(found.medium->xi == expected.medium->xi);
            CHECK(found.t_end == expected.t_end);
            CHECK(found.contact_distance == expected.contact_distance);
            REQUIRE(found.rods.size() == expected.rods.size());
            for (std::size_t k = 0; k < found.rods.size(); ++k) {
                CHECK(found.rods[k].x == expected.rods[k].x);
                CHECK(found.rods[k].y == expected.rods[k].y);
                CHECK(found.rods[k].heading == expected.rods[k].heading);
            }
        }
    }
}

TEST_CASE("Tied keys go together, each with its factor") {
    const auto made = plan(axis("keys = [\"coupling.gamma1\", \"coupling.gamma2\", \"medium.alpha\"]\n"
                                "factor = [1.0, -1.0, 0.25]\nfrom = 1.0\nto = 4.0"));
    REQUIRE(made.design.axes.size() == 1);
    CHECK(made.design.axes[0].name == "coupling.gamma1");
    const auto scene = at(made, {3.0});
    CHECK(scene.coupling->gamma1 == 3.0);
    CHECK(scene.coupling->gamma2 == -3.0);
    CHECK(scene.medium->xi == Approx(1.0 / 0.75).epsilon(1e-15)); // one division
    const auto equal = plan(axis("keys = [\"coupling.gamma1\", \"coupling.gamma2\"]\nfrom = 1.0\nto = 4.0"));
    CHECK(at(equal, {3.0}).coupling->gamma2 == 3.0);
}

TEST_CASE("Ends may carry units; values are in the unit of plain numbers") {
    const auto turned = plan(axis("key = \"rods.1.heading\"\nfrom = \"10 deg\"\nto = \"90 deg\""));
    CHECK(turned.design.axes[0].from == Approx(std::numbers::pi / 18.0).epsilon(1e-15));
    CHECK(turned.design.axes[0].to == Approx(std::numbers::pi / 2.0).epsilon(1e-15));
    CHECK(at(turned, {0.7}).rods[1].heading == 0.7);
    const auto apart =
        plan(axis("key = \"rods.1.position.1\"\nfrom = \"18 a\"\nto = \"24 a\"")); // f/mu = 2 a
    CHECK(apart.design.axes[0].from == Approx(9.0).epsilon(1e-15));
    CHECK(at(apart, {9.0}).rods[1].position[1] == 9.0);
    const auto mixed = plan(axis("key = \"rods.1.position.1\"\nfrom = 3.0\nto = \"24 a\""));
    CHECK(mixed.design.axes[0].from == 3.0);
    CHECK(mixed.design.axes[0].to == Approx(12.0).epsilon(1e-15));
}

TEST_CASE("A scene in SI has axes in SI, and a point is that of the same text") {
    std::string text = pair_text.substr(0, pair_text.find("t_end = 30.0")) + "t_end = 3.0\n" +
                       pair_text.substr(pair_text.find("[[rods]]"));
    text.replace(text.find("[scales]"), 0, "units = \"si\"\n");
    for (const char* length : {"position = [0.0, 2.5]", "position = [0.0, -2.5]"})
        text.replace(text.find(length), std::string(length).size(),
                     std::string(length).find('-') == std::string::npos ? "position = [0.0, 0.004]"
                                                                        : "position = [0.0, -0.004]");
    const auto made = plan(axis("key = \"rods.1.position.0\"\nfrom = \"1 mm\"\nto = 0.008"), text);
    CHECK(made.design.axes[0].from == Approx(1e-3).epsilon(1e-15));
    CHECK(made.design.axes[0].to == 0.008);
    const auto written = overridden(text, "rods.1.position.0=0.005");
    CHECK(at(made, {0.005}).rods[1].position[0] == Approx(written.rods[1].position[0]).epsilon(1e-15));
}

TEST_CASE("Words are listed, and each point has one") {
    const auto made = plan(axis("key = \"rods_run.method\"\nvalues = [\"bdf\", \"adams\", \"erk\"]"));
    const scan::Axis& axis = made.design.axes[0];
    CHECK(axis.words == std::vector<std::string>{"bdf", "adams", "erk"});
    CHECK(axis.values == std::vector<double>{0.0, 1.0, 2.0});
    CHECK(scan::size(made.design) == 3);
    const auto written = overridden(pair_text, "rods_run.method=adams");
    CHECK(at(made, {1.0}).rods_run->method == written.rods_run->method);
}

TEST_CASE("Numbers may be listed, with units or without") {
    const auto made = plan(axis("key = \"rods.1.heading\"\nvalues = [0.0, \"180 deg\", 1]"));
    CHECK(made.design.axes[0].words.empty());
    REQUIRE(made.design.axes[0].values.size() == 3);
    CHECK(made.design.axes[0].values[1] == Approx(std::numbers::pi).epsilon(1e-15));
    CHECK(made.design.axes[0].values[2] == 1.0);
}

TEST_CASE("Keys of whole numbers get whole numbers") {
    const auto made = plan(axis("key = \"rods_run.max_steps\"\nfrom = 1000\nto = 2000\ncount = 4"));
    CHECK(made.design.axes[0].whole);
    const scan::PointList points(made.design);
    CHECK(points[1].at[0] == 1333.0);
    CHECK(at(made, {1333.0}).rods_run->max_steps == 1333);
    CHECK(has(refusal(axis("key = \"rods_run.max_steps\"\nfrom = 1000.5\nto = 2000")),
              "scan axis rods_run.max_steps: 1000.5 is not a whole number"));
    CHECK(has(refusal(axis("key = \"rods_run.max_steps\"\nvalues = [1000, 1000.5]")),
              "1000.5 is not a whole number"));
}

TEST_CASE("The end of the run may vary, beyond that of the scene and below") {
    const auto made = plan(axis("key = \"rods_run.t_end\"\nfrom = 5.0\nto = 100.0"));
    for (const double end : {5.0, 30.0, 100.0}) {
        const auto scene = at(made, {end});
        CHECK(scene.rods_run->t_end == end);
        for (const double time : scene.rods_run->output_times)
            CHECK(time <= end);
    }
}

TEST_CASE("A point does not depend on the one before it in the same scene") {
    const auto made = plan(axis("key = \"medium.alpha\"\nfrom = 0.1\nto = 10.0") + kappa);
    scene::Scene reused = made.base;
    for (const double alpha : {10.0, 0.1, 3.0}) {
        scan::Point point{0, {alpha, 2.0}};
        REQUIRE_FALSE(app::set_point(made, reused, point));
        CHECK(reused == at(made, {alpha, 2.0}));
    }
    scan::Point wrong{0, {-1.0, 2.0}};
    CHECK(app::set_point(made, reused, wrong));
    scan::Point right{0, {0.5, 2.0}};
    CHECK_FALSE(app::set_point(made, reused, right));
    CHECK(reused == at(made, {0.5, 2.0}));
}

TEST_CASE("More than sixteen keys fit into a point") {
    std::string text = pair_text, keys;
    for (int i = 0; i < 8; ++i) {
        text += "[[rods]]\nposition = [" + std::to_string(10 + i) + ".0, 5.0]\n";
        keys += (i ? ", " : "") + ("\"rods." + std::to_string(i + 2) + ".position.1\"");
    }
    std::string more = axis("keys = [" + keys + "]\nfrom = 5.0\nto = 9.0");
    std::string headings;
    for (int i = 0; i < 10; ++i)
        headings += (i ? ", " : "") + ("\"rods." + std::to_string(i) + ".heading\"");
    more += axis("keys = [" + headings + "]\nfrom = 0.0\nto = 1.0");
    const auto scene = at(plan(more, text), {6.0, 0.5});
    CHECK(scene.rods[9].position[1] == 6.0);
    CHECK(scene.rods[9].heading == 0.5);
}

TEST_CASE("An adaptive scan may have any lattice, but not so many cells at the start") {
    const auto adaptive = [](long count, long resolution) {
        std::string text = "design = \"adaptive\"\nresolution = " + std::to_string(resolution) + "\n";
        for (const char* key : {"coupling.kappa", "rods.1.position.0"})
            text += axis("key = \"" + std::string(key) +
                         "\"\nfrom = 1.0\nto = 6.0\ncount = " + std::to_string(count));
        return text;
    };
    CHECK(plan(adaptive(64, 1 << 20)).design.resolution == 1 << 20);
    const std::string text = refusal(adaptive(32768, 65536));
    CHECK(has(text, "1073807361 points at the start"));
    CHECK(has(text, "scan.max_points = 20000000"));
    CHECK(has(text, "6 to 60 CPU hours"));
}

TEST_CASE("Observables that drive refinement are columns") {
    const std::string design = "design = \"adaptive\"\nresolution = 64\n";
    const auto refine = [](const char* name) {
        return "[[scan.refine]]\nobservable = \"" + std::string(name) + "\"\nstep = 0.5\n";
    };
    const std::string fine = axis("key = \"coupling.kappa\"\nfrom = 1.0\nto = 6.0\ncount = 64");
    const auto made = plan(design + fine + refine("min_separation") + refine("turn1"));
    REQUIRE(made.design.drivers.size() == 2);
    CHECK(made.columns.observables[made.design.drivers[1].observable] == "turn1");
    CHECK(made.design.drivers[0].step == 0.5);
    CHECK(
        has(refusal(design + fine + refine("turn2")), "scan.refine: no column \"turn2\"; there are time, "));
}

TEST_CASE("A list is its columns and rows") {
    const auto made = list({{"coupling.kappa", "rods_run.max_steps"}, {{1.0, 1000}, {-2.0, 2000}}});
    CHECK(made.design.kind == scan::Kind::list);
    CHECK(scan::size(made.design) == 2);
    const scan::PointList points(made.design);
    const auto scene = at(made, {points[1].at[0], points[1].at[1]});
    CHECK(scene.coupling->kappa == -2.0);
    CHECK(scene.rods_run->max_steps == 2000);
}

TEST_CASE("What a ledger is of: the scene as far as points depend on it") {
    const auto description = [](const std::string& scan, const std::string& text = pair_text) {
        return plan(scan, text).description;
    };
    const std::string same = description(kappa);
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = pair_text;
        text.replace(text.find(from), from.size(), to);
        return description(kappa, text) != same;
    };
    CHECK(changed("eta = 1.0", "eta = 1.5"));
    CHECK(changed("t_end = 30.0", "t_end = 31.0"));
    CHECK(changed("contact_distance = 0.1", "contact_distance = 0.2"));
    CHECK(changed("output_interval = 1.0", "output_interval = 1.0\nrtol = 1e-6"));
    CHECK(changed("[0.0, 2.5]", "[0.0, 3.5]"));
    CHECK_FALSE(changed("output_interval = 1.0", "output_interval = 2.0"));
    CHECK_FALSE(
        changed("output_interval = 1.0", "output_interval = 1.0\nmax_steps = 77")); // raised where it was met
    CHECK_FALSE(changed("schema = 1", "schema = 1\ntitle = \"another\""));
    for (const char* key : {"trajectories = 5\n", "time_limit = 5.0\n", "max_points = 1000\n", "audit = 5\n"})
        CHECK(description(key + kappa) == same);
    CHECK(description(axis(
              "key = \"coupling.kappa\"\nfrom = 0.1\nto = 100.0\nspacing = \"log\"\ncount = 5")) != same);
    const std::string fine = axis("key = \"coupling.kappa\"\nfrom = 1.0\nto = 6.0\ncount = 64");
    const auto adaptive = [&](const char* keys) {
        return description(std::string("design = \"adaptive\"\n") + keys + fine);
    };
    CHECK(adaptive("resolution = 64\n") ==
          adaptive("resolution = 256\nseed = 5\nboundary_tolerance = 1e-6\n"));
    const auto sampled = [&](const char* keys) { return description(keys + kappa); };
    CHECK(sampled("design = \"sobol\"\nsamples = 10\n") ==
          sampled("design = \"sobol\"\nsamples = 20\nseed = 3\n"));
    CHECK(sampled("design = \"lhs\"\nsamples = 10\n") != sampled("design = \"lhs\"\nsamples = 20\n"));
    CHECK(sampled("design = \"lhs\"\nsamples = 10\n") !=
          sampled("design = \"lhs\"\nsamples = 10\nseed = 3\n"));
    CHECK(list({{"coupling.kappa"}, {{1.0}}}).description == list({{"coupling.kappa"}, {{1.0}}}).description);
    CHECK(list({{"coupling.kappa"}, {{1.0}}}).description != list({{"coupling.kappa"}, {{2.0}}}).description);
    CHECK(list({{"coupling.kappa"}, {{1.0}}}).description !=
          list({{"coupling.gamma1"}, {{1.0}}}).description);
}

TEST_CASE("The seed of the command line is that of the scan") {
    scene::Scene scene = read("design = \"lhs\"\n" + kappa);
    app::apply_seed(scene, 9);
    CHECK(app::plan_scan(scene, std::nullopt).design.seed == 9);
    CHECK_THROWS_AS(app::apply_seed(scene, std::uint64_t{1} << 63), InputError);
}

// --- Scans that are refused before anything is computed

TEST_CASE("Axes that are none are refused with their key") {
    CHECK(has(refusal(axis("key = \"coupling.kapa\"\nfrom = 0.0\nto = 1.0")),
              "scene.toml: scan axis coupling.kapa: "));
    CHECK(has(refusal(axis("key = \"coupling.kapa\"\nfrom = 0.0\nto = 1.0")), "did you mean \"kappa\"?"));
    CHECK(has(refusal(axis("key = \"noise.runs\"\nfrom = 1\nto = 2")), "noise"));
    CHECK(has(refusal(axis("key = \"rods.2.heading\"\nfrom = 0.0\nto = 1.0")), "no entry 2: rods has 2"));
    CHECK(has(refusal(axis("key = \"rods.1.position\"\nfrom = 0.0\nto = 1.0")), "rods[1].position"));
    CHECK(has(refusal(axis("key = \"medium\"\nfrom = 0.0\nto = 1.0")), "medium is a table"));
    CHECK(has(refusal(axis("key = \"scales.v0\"\nfrom = 1.0\nto = 2.0")), "defines the units of the scene"));
    CHECK(has(refusal(kappa + kappa), "coupling.kappa is set twice"));
    CHECK(
        has(refusal(axis("keys = [\"medium.alpha\", \"medium.xi\"]\nfrom = 1.0\nto = 2.0")), "give one of"));
}

TEST_CASE("Ends that are no numbers of the key are refused") {
    for (const char* lines :
         {"key = \"coupling.kappa\"\nfrom = \"much\"\nto = 1.0",
          "key = \"rods.1.heading\"\nfrom = \"5 s\"\nto = 1.0",
          "key = \"rods_run.max_steps\"\nfrom = \"few\"\nto = 1000",
          "key = \"rods_run.method\"\nfrom = \"bdf\"\nto = \"erk\"",
          "key = \"rods_run.method\"\nfrom = 1\nto = 2", "key = \"coupling.kappa\"\nfrom = true\nto = 1.0",
          "key = \"coupling.kappa\"\nvalues = [1.0, \"much\"]",
          "key = \"coupling.kappa\"\nvalues = [true, 1.0]",
          "key = \"rods_run.method\"\nvalues = [\"bdf\", 1.0]",
          "key = \"rods_run.method\"\nvalues = [\"euler\"]",
          "key = \"rods_run.method\"\nvalues = [1.0, 2.0]"}) {
        INFO(lines);
        CHECK(has(refusal(axis(lines)), "scene.toml: scan axis "));
    }
}

TEST_CASE("Values beyond the range of the key are refused, and the axis is named") {
    CHECK(has(refusal(axis("key = \"medium.alpha\"\nfrom = -1.0\nto = 1.0")),
              "scan axis medium.alpha: medium.alpha = -1.0: must be"));
    CHECK(has(refusal(axis("key = \"medium.alpha\"\nfrom = 1.0\nto = 1e300")), "scan axis medium.alpha: "));
    CHECK(
        has(refusal(axis("key = \"medium.alpha\"\nvalues = [1.0, -1.0, 2.0]")), "scan axis medium.alpha: "));
    CHECK(has(refusal(kappa + axis("key = \"medium.alpha\"\nfrom = -1.0\nto = 1.0")),
              "scan axis medium.alpha: "));
    CHECK(
        has(refusal(axis(
                "keys = [\"coupling.kappa\", \"medium.alpha\"]\nfactor = [1.0, -1.0]\nfrom = 1.0\nto = 2.0")),
            "scan axis coupling.kappa: medium.alpha = -"));
}

TEST_CASE("Empty axes and logarithms through 0 are refused, also with units") {
    const auto degrees = [](const char* from, const char* to, const char* more = "") {
        return refusal(axis(std::string("key = \"rods.1.heading\"\nfrom = ") + from + "\nto = " + to + more));
    };
    CHECK(has(degrees("\"10 deg\"", "\"10 deg\""), "the axis is empty"));
    CHECK(has(degrees("\"-10 deg\"", "\"10 deg\"", "\nspacing = \"log\""), "needs ends of one sign"));
    CHECK(has(degrees("\"0 deg\"", "\"10 deg\"", "\nspacing = \"log\""), "needs ends of one sign"));
}

TEST_CASE("More points than the limit are refused with their number and what they cost") {
    const auto x = [](const char* count) {
        return axis(std::string("key = \"rods.1.position.0\"\nfrom = -6.0\nto = 6.0\ncount = ") + count);
    };
    const auto y = axis("key = \"coupling.kappa\"\nfrom = 1.0\nto = 2.0\ncount = 10000");
    const std::string text = refusal(x("100000") + y);
    CHECK(has(text, "the scan has 1000000000 points, more than scan.max_points = 20000000"));
    CHECK(has(text, "5.6 to 56 CPU hours"));
    CHECK(has(refusal("max_points = 11\n" + x("12")),
              "the scan has 12 points, more than scan.max_points = 11"));
    CHECK_NOTHROW(plan("max_points = 12\n" + x("12")));
    CHECK(has(refusal("design = \"sobol\"\nsamples = 20000001\n" + x("2")), "20000001 points"));
    std::string six = x("10000000") + y;
    for (const char* key : {"coupling.gamma1", "coupling.gamma2", "rods.0.position.0", "rods.1.heading"})
        six += axis("key = \"" + std::string(key) + "\"\nfrom = 1.0\nto = 2.0\ncount = 10000000");
    CHECK(has(refusal(six), "more than 2^62 points"));
}

TEST_CASE("Resolutions beyond what three axes can have are refused at once") {
    std::string text = "design = \"adaptive\"\nresolution = 1048576\n";
    for (const char* key : {"coupling.kappa", "rods.1.position.0", "rods.1.heading"})
        text += axis("key = \"" + std::string(key) + "\"\nfrom = 1.0\nto = 6.0\ncount = 64");
    CHECK(has(refusal(text), "scan.resolution"));
}

TEST_CASE("Lists that cannot be points are refused before anything is computed") {
    CHECK(has(list_refusal({{"coupling.kapa"}, {{1.0}}}), "did you mean \"kappa\"?"));
    CHECK(has(list_refusal({{"coupling.kappa"}, {}}), "the scan has no points"));
    CHECK(has(list_refusal({{"coupling.kappa", "coupling.kappa"}, {{1.0, 2.0}}}), "set twice"));
    CHECK(has(list_refusal({std::vector<std::string>(7, "coupling.kappa"), {std::vector(7, 1.0)}}),
              "set twice"));
    CHECK(has(list_refusal({{"coupling.kappa"}, {{1.0}, {std::nan("")}, {2.0}}}),
              "scan axis coupling.kappa: "));
    CHECK(has(list_refusal({{"rods_run.max_steps"}, {{1000}, {1000.5}, {2000}}}),
              "1000.5 is not a whole number"));
    CHECK(has(list_refusal({{"medium.alpha"}, {{1.0}, {-1.0}, {2.0}}}), "scan axis medium.alpha: "));
    CHECK(has(list_refusal({{"rods_run.method"}, {{1.0}}}), "scan axis rods_run.method: "));
    CHECK(has(list_refusal({{"scan.resolution"}, {{64}}}), "scan.resolution"));
}
