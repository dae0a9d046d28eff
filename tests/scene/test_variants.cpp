#include "support.hpp"

#include "rodwake/scene/read.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;
using rodwake::scene::apply_variant;

namespace {

std::string with_set(const std::string& set) {
    return two_rods(
        "contact_distance = 0.5\n[coupling]\nkappa = 1.0\n[medium]\neta = 1\nalpha = 0.5\n[[variants]]\n"
        "name = \"v\"\nset = " +
        set + "\n");
}

} // namespace

TEST_CASE("settings are held as overrides, dotted or quoted, in order of writing") {
    const Scene scene =
        parse(with_set("{ \"coupling.kappa\" = -100.0, rods_run.t_end = 5, \"rods_run.method\" = \"bdf\", "
                       "\"rods.1.position\" = [0.0, 2.0] }"));
    REQUIRE(scene.variants.size() == 1);
    CHECK(scene.variants[0].set == std::vector<std::string>{"coupling.kappa=-100.0", "rods_run.t_end=5",
                                                            "rods_run.method=\"bdf\"",
                                                            "rods.1.position=[0.0, 2.0]"});
}

TEST_CASE("a variant applies to the resolved scene") {
    const Scene scene =
        parse(with_set("{ \"coupling.kappa\" = -100.0, \"medium.alpha\" = 0.25, \"rods_run.t_end\" = 4 }"));
    const Scene varied = apply_variant(scene, scene.variants[0]);
    CHECK(varied.coupling->kappa == -100.0);
    CHECK(varied.medium->xi == 4.0); // the resolved scene is written with xi: the variant's alpha wins
    CHECK(varied.rods_run->t_end == 4.0);
    CHECK(varied.rods_run->output_times.size() == 200); // the default grid follows t_end
    CHECK(varied.variants.empty());
    Scene rest = varied;
    rest.coupling = scene.coupling;
    rest.medium = scene.medium;
    rest.rods_run = scene.rods_run;
    rest.variants = scene.variants;
    CHECK(rest == scene);
}

TEST_CASE("applying a variant gives what the overrides give") {
    const std::string set =
        "{ \"coupling.kappa\" = -100.0, \"medium.xi\" = 3, \"rods.1.position.1\" = 0.75 }";
    const Scene scene = parse(with_set(set));
    Scene direct = parse(with_set(set), scene.variants[0].set);
    direct.variants.clear();
    CHECK(apply_variant(scene, scene.variants[0]) == direct);
}

TEST_CASE("variants of values are the scenes that writing, overriding and reading gives") {
    using rodwake::scene::to_toml;
    for (const std::string set :
         {"{ \"coupling.kappa\" = -100, \"medium.alpha\" = 0.3, \"rods_run.rtol\" = 1e-6 }",
          "{ \"medium.lame_lambda\" = 1, \"medium.mu\" = 0.7, \"rods.1.position.1\" = 7.5, title = \"x\" }",
          "{ \"rods_run.t_end\" = 4, \"rods_run.output_interval\" = 0.3, \"rods_run.method\" = \"bdf\" }",
          "{ \"rods_run.t_end\" = \"7 f/(mu v0)\", \"rods.0.heading\" = \"30 deg\" }",
          "{ \"rods.1.position\" = [0.0, 2.0], \"coupling.gamma1\" = 3 }", // a list, by text
          "{ \"field.x\" = [0, 1], \"field.y\" = [0, 1] }"}) { // a table that is not there, by text
        CAPTURE(set);
        Scene scene = parse(with_set(set));
        const auto variant = scene.variants[0];
        const Scene varied = apply_variant(scene, variant);
        scene.variants.clear();
        CHECK(to_toml(varied) == to_toml(parse(to_toml(scene), variant.set)));
        CHECK(varied == parse(to_toml(scene), variant.set));
        CHECK_FALSE(varied == scene);
    }
}

TEST_CASE("a variant made by hand that is wrong throws what the override says") {
    const Scene scene = parse(two_rods("[coupling]\nkappa = 1.0\n[medium]\neta = 1\nxi = 1\n"));
    const auto message = [&](const std::string& setting) -> std::string {
        try {
            (void)apply_variant(scene, {"v", "", {setting}});
        } catch (const rodwake::scene::SceneError& error) {
            return error.what();
        }
        return "";
    };
    CHECK(message("coupling.kapa=1")
              .starts_with("-s coupling.kapa=1: [coupling] unknown key \"kapa\" (did you mean \"kappa\"?). "
                           "Known keys: kappa, "));
    CHECK(message("coupling.kappa=nan") ==
          "-s coupling.kappa=nan: coupling.kappa = nan: must be a finite number");
    CHECK(message("coupling.kappa=2") == "");
}

TEST_CASE("a variant that is wrong by itself is reported where it stands") {
    CHECK(error_text(with_set("{ \"coupling.kapa\" = 1 }"))
              .starts_with(
                  "x.toml:16:9: with variants[0] applied: [coupling] unknown key \"kapa\" (did you mean"));
    CHECK(error_text(with_set("{ \"medium.eta\" = -2 }"))
              .starts_with("x.toml:16:9: with variants[0] applied: medium.eta"));
    CHECK(error_text(with_set("{ \"rods.5.heading\" = 1 }")).find("no entry 5: rods has 2") !=
          std::string::npos);
    CHECK(error_text(with_set("{ \"scan.start\" = 1 }")).find("[scan] unknown key \"start\"") !=
          std::string::npos);
    CHECK(error_text(with_set("{ \"a..b\" = 1 }")).find("is not a key") != std::string::npos);
    CHECK(error_text(with_set("{ \"coupling.kappa\" = nan }")).find("must be a finite number") !=
          std::string::npos);
    CHECK(error_text(with_set("{ \"coupling.kappa\" = 1, coupling.kappa = 2 }"))
              .find("\"coupling.kappa\" is set twice") != std::string::npos);
    CHECK(error_text(with_set("[\"coupling.kappa=1\"]")).find("expected a table such as") !=
          std::string::npos);
}

TEST_CASE("an error of the scene is not repeated for its variants") {
    const auto problems =
        problems_of(replaced(with_set("{ \"medium.eta\" = 3 }"), "kappa = 1.0", "kappa = true"));
    CHECK(problems.size() == 1);
}

TEST_CASE("a hand-made variant that is wrong throws SceneError") {
    const Scene scene = parse(with_set("{ \"coupling.kappa\" = 2 }"));
    CHECK_THROWS_AS(apply_variant(scene, {"bad", "", {"coupling.kapa=1"}}), rodwake::scene::SceneError);
    CHECK_THROWS_AS(apply_variant(scene, {"bad", "", {"nonsense"}}), rodwake::scene::SceneError);
}
