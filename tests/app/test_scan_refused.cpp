// Scans that are refused before anything is computed.

#include "scan_scenes.hpp"

using namespace app_test;

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
