// to_toml and back gives the same Scene, bit for bit.

#include "support.hpp"

#include "rodwake/scene/read.hpp"
#include "scene/node.hpp"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <random>

using namespace scene_test;
using rodwake::scene::to_toml;

namespace {

std::string number(std::mt19937_64& random) {
    std::uniform_real_distribution<double> mantissa(1.0, 10.0);
    std::uniform_int_distribution<int> exponent(-4, 3);
    return rodwake::scene::number_text(mantissa(random) * std::pow(10.0, exponent(random)));
}

/// Two rods without t_end.
const std::string open_end = replaced(two_rods(), "t_end = 2.0\n", "");

} // namespace

TEST_CASE("the complete scene survives, in every unit system") {
    check_round_trip(parse(complete));
    check_round_trip(parse(crowded, {"rods_random.spread=30 deg", "rods_run.turning_tolerance=1e-6"}));
    check_round_trip(parse(complete, {"units=si", "rods_run.contact_distance=0.01", "medium.alpha=0.3"}));
    check_round_trip(
        parse(complete, {"rods_run.output_times=[1.0, 2.5, 29]", "title=\"\\\"quoted\\\" \\\\ \u00e9\""}));
    check_round_trip(parse(complete, {"rods_run.output_interval=0.7", "variants.0.label=x"}));
    check_round_trip(parse(complete, {"medium.table.tolerance=1e-6", "noise.rotational_diffusion=0"}));
    check_round_trip(parse(two_rods()));
    check_round_trip(parse(open_end + "output_times = [0, 5, 10]\n")); // an even grid, and one that is not
    check_round_trip(parse(open_end + "output_times = [0, 5, 11]\n"));
}

TEST_CASE("equality notices a change") {
    const Scene scene = parse(complete);
    Scene other = scene;
    other.field->cuts[0].count += 1;
    CHECK_FALSE(other == scene);
    other = scene;
    other.variants[0].set[0] += "0";
    CHECK_FALSE(other == scene);
}

TEST_CASE("random numbers survive in SI scenes and mixed units") {
    std::mt19937_64 random(1);
    for (int i = 0; i < 200; ++i) {
        const std::string scales =
            "[scales]\nf_over_mu = " + number(random) + "\nv0 = " + number(random) + "\n";
        const std::string text =
            "schema = 1\nunits = \"si\"\n" + scales + "[medium]\nalpha = " + number(random) +
            "\nlame_lambda = " + number(random) + "\nmu = " + number(random) +
            "\n[coupling]\nkappa = " + number(random) + "\ngamma1 = -" + number(random) + "\ngamma2 = \"" +
            number(random) + " a/s\"\n[[rods]]\nposition = [" + number(random) + ", \"" + number(random) +
            " a\"]\nheading = \"" + number(random) + " deg\"\n[rods_run]\nt_end = " + number(random) + "\n";
        check_round_trip(parse(text));
    }
}

TEST_CASE("a resolved scene is readable: units kept, defaults written, absences said") {
    const std::string text = to_toml(parse(complete, {"units=si", "rods_run.contact_distance=0.01 mm"}));
    for (const std::string part :
         {"units = \"si\"", "[scales]", "kappa = 0.5\n", "rtol = 1e-08", "form = \"angle\"",
          "# output_interval: t_end / 200", "set = { \"coupling.kappa\" = -100.0 }"})
        CHECK_THAT(text, Catch::Contains(part));
    CHECK_THAT(to_toml(parse(two_rods())), Catch::Contains("# contact_distance: no stop"));
}

TEST_CASE("figures are written with the keys of their kind only") {
    const auto figure = [](const std::string& kind, const std::string& more) {
        const std::string text =
            to_toml(parse("schema = 1\n[medium]\neta = 1\nxi = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n"
                          "[[field.cuts]]\nfrom = 0\nto = 1\n[[figures]]\nname = \"f\"\nkind = \"" +
                          kind + "\"\n" + more));
        return text.substr(text.find("[[figures]]"));
    };
    const auto has = [](const std::string& text, const std::string& key) {
        return text.find("\n" + key + " = ") != std::string::npos;
    };
    for (const std::string key : {"cut", "component", "sqrt_scaled"}) {
        INFO(key);
        CHECK(has(figure("cut", ""), key));
        CHECK_FALSE(has(figure("extensional_axis", ""), key));
    }
    CHECK(has(figure("polar_streamlines", "gammas = [[1, 0]]\n"), "gammas"));
    CHECK(figure("extensional_axis", "") ==
          "[[figures]]\nname = \"f\"\nkind = \"extensional_axis\"\n# title: made from the data\n"
          "# x: fit to the data\n# y: fit to the data\n");
}

TEST_CASE("keys of [medium] stay in it beside [medium.table]") {
    const Scene scene = parse("schema = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n[medium]\neta = 1\nxi = 1\n"
                              "periodic = 78.0\n[medium.table]\ntolerance = 1e-6\n");
    check_round_trip(scene);
}

TEST_CASE("a rectangle of medium.periodic survives") {
    const Scene scene = parse("schema = 1\n[field]\nx = [0, 1]\ny = [0, 1]\n[medium]\neta = 1\nxi = 1\n"
                              "periodic = [78.0, 77.0]\n");
    CHECK(*scene.medium->periodic == rodwake::PeriodicBox(78.0, 77.0));
    check_round_trip(scene);
}

TEST_CASE("gammas of a figure have the scene's units, whatever the figure before shows") {
    const std::string streams =
                          "[[figures]]\nname = \"s\"\nkind = \"polar_streamlines\"\ngammas = [[1.0, 0.0]]\n",
                      snapshot = "[[figures]]\nname = \"b\"\nkind = \"snapshot\"\n";
    const std::string head = replaced(complete.substr(0, complete.find("[[figures]]")), "schema = 1\n",
                                      "schema = 1\nunits = \"si\"\n");
    const double first = parse(head + streams + snapshot).figures[0].gammas[0][0];
    CHECK(first == 1.0 / 2.8e-3); // m/s over v0
    CHECK(parse(head + snapshot + streams).figures[1].gammas[0][0] == first);
}

TEST_CASE("numbers are written as TOML floats and read back exactly") {
    using rodwake::scene::number_text;
    CHECK(number_text(5.0) == "5.0");
    CHECK(number_text(-0.0) == "-0.0");
    CHECK(number_text(1e300) == "1e+300");
    CHECK(number_text(0.1) == "0.1");
    CHECK(number_text(1.0 / 3.0) == "0.3333333333333333");
    std::mt19937_64 random(2);
    for (int i = 0; i < 1000; ++i) {
        const double value = std::bit_cast<double>(random());
        if (std::isfinite(value))
            CHECK(std::stod(number_text(value)) == value);
    }
}

TEST_CASE("output times: i * interval, t_end exact and last") {
    const auto times = [](const std::string& more) { return parse(two_rods(more)).rods_run->output_times; };
    CHECK(times("").size() == 200);
    CHECK(times("")[2] == 3 * (2.0 / 200.0));
    CHECK(times("").back() == 2.0);
    CHECK(times("output_interval = 0.75\n") == std::vector{0.75, 1.5, 2.0});
    CHECK(times("output_interval = 0.1\n").size() == 20);
    CHECK(times("output_interval = 0.1\n").back() == 2.0);
    CHECK(times("output_interval = 2\n") == std::vector{2.0});
    CHECK(times("output_times = [0.5]\n") == std::vector{0.5, 2.0});
    CHECK(times("output_times = [0.5, 2]\n") == std::vector{0.5, 2.0});
    CHECK(times("output_times = [0, 0.5, 2]\n") == std::vector{0.5, 2.0}); // the start is stored in any case
    CHECK(times("output_times = [0]\n") == std::vector{2.0});
    CHECK(times("output_interval = 2e-6\n").size() == 1000000);
    const std::pair<const char*, const char*> wrong[] = {
        {"output_interval = 3\n", "must be between t_end/1000000 and t_end = 2"},
        {"output_interval = 1e-6\n", "must be between"},
        {"output_times = [1.0, 1.0]\n", "entry 1 is 1"},
        {"output_times = [1.0, 2.5]\n", "entry 1 is 2.5"},
        {"output_times = [0.5, 0]\n", "entry 1 is 0"}};
    for (const auto& [more, said] : wrong)
        says(two_rods(more), said);
}

TEST_CASE("without t_end the run ends with the last of output_times") {
    const auto run = [](const std::string& more) { return *parse(open_end + more).rods_run; };
    CHECK(run("output_times = [0, 5, 10]\n").t_end == 10.0);
    CHECK(run("output_times = [0, 5, 10]\n").output_times == std::vector{5.0, 10.0});
    const auto wrong = [](const std::string& more) { return error_text(open_end + more); };
    const std::string forms = "t_end | t_end + output_interval | t_end + output_times | output_times";
    CHECK(wrong("") == "x.toml:6:1: rods_run needs one of " + forms);
    CHECK(wrong("output_interval = 1\n") ==
          "x.toml:7:1: rods_run gives output_interval (line 7): give one of " + forms);
    CHECK(wrong("output_times = [0]\n") ==
          "x.toml:7:16: rods_run.output_times has no entry above 0, so the run has no end: give t_end");
    says(open_end + "output_times = [5, 1]\n", "entry 0 is 5");
    says(open_end + "output_times = [-5]\n", "must be >= 0");
    CHECK(problems_of(open_end + "output_times = [-5]\n").size() == 1);
    CHECK(problems_of(open_end + "t_end = -1\n").size() == 1);
}

TEST_CASE("a variant of a run without t_end may change the times") {
    const auto t_end = [](const std::string& setting) {
        const Scene scene = parse(open_end + "output_times = [5, 10]\n[[variants]]\nname = \"v\"\nset = { " +
                                  setting + " }\n");
        return rodwake::scene::apply_variant(scene, scene.variants[0]).rods_run->t_end;
    };
    CHECK(t_end("\"rods_run.output_times\" = [5, 20]") == 20.0);
    CHECK(t_end("\"rods_run.t_end\" = 30") == 30.0);
}

TEST_CASE("a plain scene has every key and no comment, and means the same") {
    const rodwake::scene::Scene scene = parse(complete);
    const std::string plain = rodwake::scene::to_plain_toml(scene), full = rodwake::scene::to_toml(scene);
    CHECK_THAT(full, Catch::Contains("\n#"));
    CHECK_THAT(plain, !Catch::Contains("\n#"));
    CHECK_THAT(plain, Catch::Contains("kappa = 0.5\n"));
    CHECK(parse(plain) == scene);
    CHECK(rodwake::scene::to_plain_toml(parse(bed(), {"granular.plates.gap=1.2 mm"})) ==
          rodwake::scene::to_plain_toml(parse(bed())));
    CHECK(rodwake::scene::to_plain_toml(parse(bed("seed = 2\n"))) !=
          rodwake::scene::to_plain_toml(parse(bed())));
}
