#include "store/scratch.hpp"
#include "support.hpp"

#include "rodwake/scene/read.hpp"

#include <catch2/catch.hpp>

using namespace scene_test;
using rodwake::scene::apply_model;
using rodwake::scene::apply_variant;
using rodwake::scene::Fit;

namespace {

std::string with_set(const std::string& set) {
    return two_rods(
        "contact_distance = 0.5\n[coupling]\nkappa = 1.0\n[medium]\neta = 1\nalpha = 0.5\n[[variants]]\n"
        "name = \"v\"\nset = " +
        set + "\n");
}

} // namespace

TEST_CASE("settings are held as overrides, dotted or quoted, in order of writing") {
    const Scene scene = parse(with_set("{ \"coupling.kappa\" = -100.0, rods_run.t_end = 5, "
                                       "\"rods_run.method\" = \"bdf\", \"rods.1.position\" = [0.0, 2.0] }"));
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
    const auto message = [&](const std::string& setting) {
        return store_test::error_of<rodwake::scene::SceneError>([&] {
            (void)apply_variant(scene, {"v", "", {setting}});
        });
    };
    CHECK(message("coupling.kapa=1")
              .starts_with("-s coupling.kapa=1: [coupling] unknown key \"kapa\" (did you mean \"kappa\"?). "
                           "Known keys: kappa, "));
    CHECK(message("coupling.kappa=nan") ==
          "-s coupling.kappa=nan: coupling.kappa = nan: must be a finite number");
    CHECK(message("nonsense") != "");
    CHECK_NOTHROW(apply_variant(scene, {"v", "", {"coupling.kappa=2"}}));
}

TEST_CASE("a variant that is wrong by itself is reported where it stands") {
    CHECK(error_text(with_set("{ \"coupling.kapa\" = 1 }"))
              .starts_with(
                  "x.toml:16:9: with variants[0] applied: [coupling] unknown key \"kapa\" (did you mean"));
    CHECK(error_text(with_set("{ \"medium.eta\" = -2 }"))
              .starts_with("x.toml:16:9: with variants[0] applied: medium.eta"));
    says(with_set("{ \"rods.5.heading\" = 1 }"), "no entry 5: rods has 2");
    says(with_set("{ \"scan.start\" = 1 }"), "[scan] unknown key \"start\"");
    says(with_set("{ \"a..b\" = 1 }"), "is not a key");
    says(with_set("{ \"coupling.kappa\" = nan }"), "must be a finite number");
    says(with_set("{ \"coupling.kappa\" = 1, coupling.kappa = 2 }"), "\"coupling.kappa\" is set twice");
    says(with_set("[\"coupling.kappa=1\"]"), "expected a table such as");
}

TEST_CASE("an error of the scene is not repeated for its variants") {
    const auto problems =
        problems_of(replaced(with_set("{ \"medium.eta\" = 3 }"), "kappa = 1.0", "kappa = true"));
    CHECK(problems.size() == 1);
}

TEST_CASE("overrides replace values, entries of lists go by index") {
    const Scene scene = parse(
        complete, {"coupling.kappa=2", "rods.1.position.0=2.0", "rods.0.heading=0.3", "rods_run.method=adams",
                   "title=two words", "rods_run.t_end=5 f/(mu v0)", " medium.eta = 3 ", "field.x=[-1, 1]"});
    CHECK(scene.coupling->kappa == 2.0);
    CHECK(scene.rods[1].position == std::vector{2.0, -2.5});
    CHECK(scene.rods[0].heading == 0.3);
    CHECK(scene.rods_run->method == rodwake::integrate::Method::adams);
    CHECK(scene.title == "two words");
    CHECK(scene.rods_run->t_end == 5.0);
    CHECK(scene.medium->eta == 3.0);
    CHECK(scene.field->x == std::vector{-1.0, 1.0});
}

TEST_CASE("later overrides win, missing tables are made") {
    CHECK(parse(complete, {"coupling.kappa=2", "coupling.kappa=3"}).coupling->kappa == 3.0);
    CHECK(parse(two_rods(), {"coupling.kappa=2", "medium.eta=1", "medium.xi=2"}).medium->xi == 2.0);
}

TEST_CASE("an override of one form drops the others of the file") {
    CHECK(parse(complete, {"medium.xi=4"}).medium->xi == 4.0); // the file gives alpha
    CHECK(parse(complete, {"medium.poisson_ratio=0.0"}).medium->eta == 1.0);
    CHECK(parse(complete, {"medium.lame_lambda=1.0", "medium.mu=0.5"}).medium->eta == 3.0);
    CHECK(
        parse(two_rods("output_times = [1.0]\n"), {"rods_run.output_interval=0.5"}).rods_run->output_times ==
        std::vector{0.5, 1.0, 1.5, 2.0});
    const std::string lame = replaced(complete, "eta = 1.0", "lame_lambda = 1.0\nmu = 1.0");
    CHECK(parse(lame, {"medium.mu=0.5"}).medium->eta == 3.0);
    says(complete, "give one of xi | alpha", {"medium.xi=4", "medium.alpha=2"});
}

TEST_CASE("errors of overrides name the override") {
    CHECK(error_text(complete, {"coupling.kapa=1"})
              .starts_with("-s coupling.kapa=1: [coupling] unknown key \"kapa\" (did you mean \"kappa\"?). "
                           "Known keys: kappa, "));
    CHECK(error_text(complete, {"medium.eta=-2"})
              .starts_with("-s medium.eta=-2: medium.eta = -2: must be > -1"));
    CHECK(error_text(complete, {"rods.1.position.0=oops"})
              .starts_with("-s rods.1.position.0=oops: rods[1].position[0]: "));
    CHECK(error_text(complete, {"rods.2.heading=0"}) ==
          "-s rods.2.heading=0: no entry 2: rods has 2 (numbered from 0)");
    says(complete, "rods is a list: give an index from 0 after it", {"rods.-1.heading=0"});
    says(complete, "rods is a list", {"rods.99999999999999999999.heading=0"});
    says(complete, "rods is a list: give an index from 0 after it, not \"heading\"", {"rods.heading=0"});
    CHECK(error_text(complete, {"schema.x=0"}) == "-s schema.x=0: schema is not a table: 1 (integer)");
    CHECK(error_text("schema = 1\n", {"rods.0.heading=0"})
              .starts_with("-s rods.0.heading=0: no entry 0: the scene has no"));
    CHECK(error_text(complete, {"coupling.kappa=[1"})
              .starts_with("-s coupling.kappa=[1: the value is not valid TOML: "));
    CHECK(error_text(complete, {"coupling.kapa="}) ==
          "-s coupling.kapa=: nothing to unset: coupling has no kapa (did you mean \"kappa\"?)");
    CHECK(error_text(complete, {"rods.2="}) == "-s rods.2=: no entry 2: rods has 2 (numbered from 0)");
    CHECK(error_text(complete, {"nothing="}) == "-s nothing=: nothing to unset: the scene has no nothing");
    says(complete, "the scene needs the key schema", {"schema="});
    CHECK(error_text(complete, {"coupling.kappa=-1e400"}) ==
          "-s coupling.kappa=-1e400: -1e400 is too large for a number, which ends at 1.8e308");
    says(complete, "a value is one line", {"title=a\nb = 1"});
    for (const std::string bad : {"nothing", "=1", "a..b=1", ".a=1", "a.=1", ""})
        CHECK(error_text(complete, {bad}) ==
              "-s " + bad + ": expected table.key=value, for example coupling.kappa=0.5");
}

TEST_CASE("several wrong overrides and the file's own errors come together") {
    const std::string text = replaced(complete, "kappa = 0.5", "kapa = 0.5");
    const auto problems = problems_of(text, {"medium.eta=-2", "nonsense", "rods.7.heading=1"});
    CHECK(problems.size() == 4);
}

TEST_CASE("a key, a table and an entry of a list are taken out") {
    CHECK(parse(complete, {"coupling.kappa="}).coupling->kappa == 0.0);
    CHECK(!parse(two_rods("[coupling]\nkappa = 1\n[medium]\neta = 1\nxi = 1\n"), {"coupling= "}).coupling);
    CHECK(parse(two_rods(), {"rods.0="}).rods.size() == 1);
}

TEST_CASE("numbers that TOML writes otherwise") {
    CHECK(parse(complete, {"coupling.kappa=.5"}).coupling->kappa == 0.5);
    CHECK(parse(complete, {"coupling.kappa = 5."}).coupling->kappa == 5.0);
    says(replaced(complete, "kappa = 0.5", "kappa = 1e400"), "1e400 is too large for a number");
}

TEST_CASE("angles that were meant in degrees are pointed out") {
    using rodwake::scene::advice;
    CHECK(advice(parse(complete)).empty());
    CHECK(advice(parse(complete, {"rods.1.heading=6.28"})).empty());
    CHECK(advice(parse(complete, {"rods.1.heading=90 deg"})).empty());
    CHECK(advice(parse(complete, {"rods.1.heading=-90"})) ==
          std::vector<std::string>{"rods[1].heading = -90 rad is -14.3 turns; a plain number is in rad, "
                                   "degrees are written as \"90 deg\""});
}

TEST_CASE("beads and rods that the gap of the bed stops are pointed out") {
    using rodwake::scene::advice;
    const std::string bed = "schema = 1\n[granular]\nphi_b = 0.7\nbox = \"40 a\"\nduration = \"1 s\"\n"
                            "[[granular.rods]]\nposition = [\"20 a\", \"20 a\"]\n";
    CHECK(advice(parse(bed)).empty());
    CHECK(advice(parse(bed, {"granular.plates.gap=1.55 mm"})) ==
          std::vector<std::string>{
              "granular.rods[0].thick_diameter = 0.0011 m is 0.71 of granular.plates.gap = "
              "0.00155 m; a rod hardly walks below 0.8 of it, so try 0.0014 m"});
    CHECK(
        advice(parse(bed, {"granular.plates.gap=1.55 mm", "granular.rods.0.imposed_speed=1 mm/s"})).empty());
    CHECK(advice(parse(bed, {"granular.plates.gap=1.55 mm", "granular.plates.gamma=0"})).empty());
    CHECK(advice(parse(bed, {"granular.bead_radius=0.5 mm"})) ==
          std::vector<std::string>{
              "granular.plates.gap = 0.0012 m is 2.40 radii of the largest beads (0.0005 m), "
              "which hardly move below 2.5; 2.7 to 2.8 keep them moving"});
    const std::string spread = "granular.bead_spread=0.2", thick = "granular.rods.0.thick_diameter=1.4 mm";
    CHECK(advice(parse(bed, {spread, thick})).empty());
    CHECK(advice(parse(bed, {spread, thick, "granular.plates.gap=1.7 mm"})) ==
          std::vector<std::string>{
              "granular.plates.gap = 0.0017 m is 4.25 radii of the smallest beads (0.0004 m), which stack "
              "from 4 on: this bed is not one layer"});
}

// --- [[fit.models]]: what a rival of a fit is, and which are refused

namespace {

const std::string pair = "[[fit.trajectories]]\nfile = \"rods.csv\"\n";

std::string with_models(const std::string& models, const std::string& keys = "",
                        const std::string& data = pair) {
    return "schema = 1\n[fit]\nname = \"strain\"\nparameters = [\"kappa\"]\nstart = { kappa = 2.0 }\nfixed = "
           "{ eta = 1.3, alpha = 0.5 }\nlikelihood = [\"kappa\"]\n" +
           keys + data + models;
}

std::string model(const std::string& name, const std::string& set) {
    return "[[fit.models]]\nname = \"" + name + "\"\nset = { " + set + " }\n";
}

Fit rival(const std::string& set, const std::string& keys = "") {
    const Scene scene = parse(with_models(model("rival", set), keys));
    return *apply_model(scene, scene.fit->models[0]).fit;
}

} // namespace

TEST_CASE("a rival is the fit with its keys changed, and without what it does not use") {
    const Fit flow = rival("\"fit.parameters\" = [\"gamma_flow\"], \"fit.start.gamma_flow\" = 0.5");
    CHECK(flow.parameters == std::vector<std::string>{"gamma_flow"});
    CHECK(flow.start == std::map<std::string, double>{{"gamma_flow", 0.5}});
    CHECK(flow.likelihood.empty());
    CHECK(flow.fixed.at("alpha") == 0.5);
    CHECK(flow.models.empty());
    CHECK(flow.name == "rival");
    const Fit none = rival("\"fit.parameters\" = []");
    CHECK(none.parameters.empty());
    const Scene scene = parse(with_models(model("rival", "\"fit.parameters\" = [\"gamma1\", \"gamma2\"]")));
    check_round_trip(scene);
}

TEST_CASE("keys of medium and couplings hold what the rival's fit does not name") {
    const Fit stiff = rival("\"coupling.gamma1\" = 2, \"medium.eta\" = 4.0", "");
    CHECK(stiff.fixed.at("gamma1") == 2.0);
    CHECK(stiff.fixed.at("eta") == 1.3); // which the fit has
    const std::string data = "[[fit.profiles]]\nfile = \"ux.csv\"\n";
    const std::string text =
        "schema = 1\n[fit]\nparameters = [\"f_over_mu\", \"eta\", \"xi\"]\n" + data +
        model("no_drag", "\"fit.parameters\" = [\"f_over_mu\", \"eta\"], \"medium.xi\" = 1e6");
    const Scene scene = parse(text);
    CHECK(apply_model(scene, scene.fit->models[0]).fit->fixed.at("alpha") == Approx(1e-6));
}

TEST_CASE("rivals that are no rivals are refused") {
    const std::string flow = "\"fit.parameters\" = [\"gamma_flow\"]";
    says(with_models(model("a", flow) + model("b", flow)), "gives the same model as fit.models[0]");
    says(with_models(model("a", "\"fit.parameters\" = [\"kappa\"]")),
         "gives the same model as the fit as written");
    says(with_models(model("a", flow) + model("a", "\"fit.parameters\" = [\"gamma1\"]")),
         "the name \"a\" is taken");
    says(with_models(model("strain", flow)), "is already taken by the fit itself");
    says(with_models(model("a", "\"fit.parametres\" = [\"kappa\"]")), "with fit.models[0] applied");
    says(with_models(model("a", "\"fit.parameters\" = [\"gamma3\"]")), "gamma3");
    says(with_models(model("a", "\"fit.start.gamma1\" = 1.0")), "fit.start has gamma1");
    says(with_models(model("a", flow + ", \"fit.trajectories.0.file\" = \"other.csv\"")),
         "changes the data (fit.trajectories)");
    says(with_models(model("a", "\"fit.parameters\" = [\"rows_direction\"]")), "nothing turns the rods");
    says(with_models("[[fit.models]]\nname = \"a\"\n"), "set");
}

TEST_CASE("gamma_flow and the rows say what they cannot have") {
    const std::string coupled = "contact_distance = 0.5\n[medium]\neta = 1\nalpha = 0.5\n[coupling]\n";
    const Scene scene =
        parse(two_rods(coupled + "gamma_flow = 2.0\ngamma_rows = 0.1\nrows_direction = \"30 deg\"\n"));
    CHECK(scene.coupling->gamma_flow == 2.0);
    CHECK(scene.coupling->rows.gamma == 0.1);
    CHECK(scene.coupling->rows.direction == Approx(0.5235987755982988));
    check_round_trip(scene);
    const std::string dynamic =
        "contact_distance = 0.5\n[medium]\neta = 1\nalpha = 0.5\nfield = \"dynamic\"\n"
        "[medium.dynamic]\nbox = 40.0\nforce_width = 0.5\n";
    says(two_rods(dynamic + "[coupling]\ngamma_rows = 0.1\n"), "coupling.gamma_rows is not integrated");
    says(two_rods(dynamic + "inertia = 0.1\n[coupling]\ngamma_flow = 0.1\n"),
         "needs medium.dynamic.inertia = 0");
}
