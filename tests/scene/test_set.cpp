#include "support.hpp"

#include "rodwake/scene/read.hpp"
#include "rodwake/scene/set.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace scene_test;
using namespace rodwake::scene;

namespace {

/// The message of compile_setter; empty: it can be set.
std::string why_not(const Scene& scene, const std::vector<std::string>& keys) {
    try {
        (void)compile_setter(scene, keys);
    } catch (const rodwake::InputError& error) {
        return error.what();
    }
    return "";
}

std::string wrong(Scene scene, const std::string& key, const Value& value) {
    return compile_setter(scene, key).set(scene, value).value_or("");
}

} // namespace

TEST_CASE("what follows from a key is kept right") {
    Scene scene = parse(complete);
    CHECK(wrong(scene, "medium.alpha", 0.25) == "");
    REQUIRE_FALSE(compile_setter(scene, "medium.alpha").set(scene, 0.25));
    CHECK(scene.medium->xi == 4.0);
    REQUIRE_FALSE(compile_setter(scene, "rods_run.rtol").set(scene, 1e-6));
    CHECK(scene.rods_run->atol == 1e-6 / 100.0);
    REQUIRE_FALSE(compile_setter(scene, "rods_run.atol").set(scene, 1e-7));
    REQUIRE_FALSE(compile_setter(scene, "rods_run.rtol").set(scene, 1e-5));
    CHECK(scene.rods_run->atol == 1e-7); // given now
    REQUIRE_FALSE(compile_setter(scene, "rods_run.t_end").set(scene, 10.0));
    CHECK(scene.rods_run->output_times.size() == 200);
    CHECK(scene.rods_run->output_times.back() == 10.0);
    REQUIRE_FALSE(compile_setter(scene, "granular.beads").set(scene, std::int64_t{40}));
    CHECK_FALSE(scene.granular->phi_b);
    REQUIRE_FALSE(compile_setter(scene, "granular.rods.1.kind").set(scene, "apolar"));
    CHECK(scene.granular->rods[1].shape.spheres == 13);
}

TEST_CASE("several keys are set at once, alternatives among them together") {
    Scene scene = parse(complete);
    const std::vector<std::string> keys{"medium.mu", "rods.1.position.1", "medium.lame_lambda",
                                        "rods.0.heading"};
    const ValueSetter setter = compile_setter(scene, keys);
    const std::vector<Value> values{0.5, 7.0, 1.0, 2.0};
    REQUIRE_FALSE(setter.set(scene, values));
    CHECK(scene.medium->eta == 3.0);
    CHECK(scene.rods[1].position == std::vector{0.0, 7.0});
    CHECK(scene.rods[0].heading == 2.0);
    CHECK(setter.set(scene, 1.0) == "1 values for 4 keys");
    CHECK(why_not(scene, {"granular.phi_b", "granular.beads"}) ==
          "granular gives phi_b and beads: give one of phi_b | beads | start_file");
    CHECK(why_not(scene, {"medium.mu"}).starts_with("medium gives mu: give one of eta"));
    CHECK(why_not(scene, {"medium.xi", "medium.xi"}) != "");
}

TEST_CASE("keys that cannot be set say why") {
    const Scene scene = parse(complete);
    CHECK(why_not(scene, {"coupling.kapa"})
              .starts_with("[coupling] unknown key \"kapa\" (did you mean \"kappa\"?). Known keys: kappa, "));
    CHECK(why_not(scene, {"rods.1.headin"})
              .starts_with("[[rods]] unknown key \"headin\" (did you mean \"heading\"?)"));
    CHECK(why_not(scene, {"copling.kappa"})
              .starts_with("unknown table or key \"copling\" (did you mean \"coupling\"?)"));
    CHECK(why_not(scene, {"rods.2.heading"}) == "no entry 2: rods has 2 (numbered from 0)");
    CHECK(why_not(scene, {"rods.heading"}).starts_with("rods is a list"));
    CHECK(why_not(scene, {"rods.1"}).starts_with("rods is a list"));
    CHECK(why_not(scene, {"rods.1.position"}).starts_with("rods[1].position has several values"));
    CHECK(why_not(scene, {"rods.1.position.2"}) == "no entry 2: rods[1].position has 2 (numbered from 0)");
    CHECK(why_not(scene, {"coupling"}) == "coupling is a table: give a key in it");
    CHECK(why_not(scene, {"coupling.kappa.0"}) == "coupling.kappa is not a table");
    CHECK(why_not(scene, {"noise.rotational_diffusion"}) == "the scene has no [noise]");
    CHECK(why_not(scene, {"scan.seed"}) == "the scene has no [scan]");
    CHECK(why_not(scene, {"fit.start.etta"}).find("did you mean \"eta\"?") != std::string::npos);
    CHECK(why_not(scene, {"units"}).find("defines the units of the scene") != std::string::npos);
}

TEST_CASE("a wrong value is told and leaves the scene as it was") {
    Scene scene = parse(complete);
    const Scene before = scene;
    const std::vector<std::tuple<std::string, Value, std::string>> cases{
        {"coupling.kappa", std::nan(""), "coupling.kappa = nan: must be a finite number"},
        {"coupling.kappa", HUGE_VAL, "coupling.kappa = inf: must be a finite number"},
        {"coupling.kappa", "5", "coupling.kappa: expected a number, found \"5\" (string)"},
        {"coupling.kappa", true, "coupling.kappa: expected a number, found true"},
        {"rods.1.position.0", 1e13, "rods[1].position[0] = 10000000000000.0: must be within +-1e+12"},
        {"medium.eta", -1.0,
         "medium.eta = -1.0: must be > -1 and <= 1e+12: the longitudinal modulus 1 + eta must"},
        {"medium.alpha", 0.0, "medium.alpha = 0.0: must be >= 1e-12 and <= 1e+12"},
        {"granular.beads", 40.0, "granular.beads: expected an integer, found 40.0"},
        {"granular.runs", std::int64_t{0}, "granular.runs = 0: must be >= 1 and <= 1000000"},
        {"granular.phi_b", 0.91, "granular.phi_b = 0.91: must be > 0 and <= 0.9069: a layer of equal discs"},
        {"rods_run.method", "rk4", "rods_run.method = \"rk4\": must be one of auto, bdf, adams, erk"},
        {"medium.field", "dynamics",
         "medium.field = \"dynamics\": must be one of exact, table, measured, dynamic (did you mean"},
        {"rods_run.output_interval", 31.0,
         "rods_run.output_interval is 31 f/(mu v0): must be between t_end/1000000"},
        {"medium.fitted", true, "medium.eta is given together with medium.fitted = true"},
        {"measure.order", std::int64_t{1}, "measure.order: expected true or false, found 1"},
        {"title", "two\nlines", "title = \"two\\u000Alines\": must be one line"}};
    for (const auto& [key, value, message] : cases) {
        CAPTURE(key, message);
        const auto error = compile_setter(scene, key).set(scene, value);
        CHECK(error.value_or("").starts_with(message));
        CHECK(scene == before);
    }
    scene.coupling.reset();
    CHECK(compile_setter(before, "coupling.kappa").set(scene, 1.0) == "the scene has no [coupling]");
}

TEST_CASE("values as a file has them become what the scene holds") {
    const Scene scene = parse(replaced(complete, "schema = 1\n", "schema = 1\nunits = \"si\"\n"));
    const auto held = [&](const std::string& key, const Value& value) {
        return std::get<double>(compile_setter(scene, key).held(value));
    };
    CHECK(held("medium.xi", 0.5) == 0.5 / scene.scales->f_over_mu);
    CHECK(held("medium.xi", std::int64_t{2}) == 2.0 / scene.scales->f_over_mu);
    CHECK(held("medium.xi", "3 f/mu") == 3.0);
    CHECK(held("medium.eta", 0.5) == 0.5);
    CHECK(held("granular.duration", 0.5) == 0.5);
    CHECK(held("granular.box", "2 a") == 2.0 * 0.4e-3);
    CHECK(held("fit.box", 78.0) == 78.0);
    CHECK(std::get<std::string>(compile_setter(scene, "rods_run.method").held("bdf")) == "bdf");
    CHECK_THROWS_AS(held("medium.xi", "3 s"), rodwake::InputError);
    CHECK_THROWS_AS(held("medium.eta", "3"), rodwake::InputError);
}

TEST_CASE("validate tells what values do to each other, without lines") {
    Scene scene = parse(complete);
    CHECK(validate(scene).empty());
    scene.rods_run->contact_distance.reset();
    REQUIRE_FALSE(compile_setter(scene, "rods.1.position.1").set(scene, 2.5));
    const auto problems = validate(scene);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].key == "rods.1.position");
    CHECK(problems[0].text() == "x.toml: rods[0] and rods[1] start at the same point");
    scene.medium.reset();
    CHECK(mentions(validate(scene), "field", "[field] needs [medium]"));
}
