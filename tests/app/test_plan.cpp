// From scenes to problems, without files.

#include "rodwake/app/describe.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/simulate.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/scene/set.hpp"
#include "run/stage_kind.hpp"
#include "scene/fit_parameters.hpp"

#include <catch2/catch.hpp>

#include <set>
#include <string>

using namespace rodwake;
using app::Stage;

namespace {

const std::string rods_text = R"(schema = 1
[medium]
eta = 2.0
xi = 4.0
[coupling]
kappa = 0.5
gamma1 = 1.0
polar_basis = "divergence"
[rods_run]
t_end = 3.0
output_times = [1.0, 2.0, 3.0]
rtol = 1e-6
method = "bdf"
[[rods]]
position = [0.0, 1.0]
heading = 0.25
[[rods]]
position = [0.0, -1.0]
[[variants]]
name = "strong"
set = { coupling.kappa = 100.0 }
)";

const std::string bed_text = R"(schema = 1
[granular]
phi_b = 0.7
box = "30 a"
duration = "1 s"
runs = 3
[[granular.rods]]
kind = "apolar"
position = ["5 a", "6 a"]
[measure]
order = true
[[variants]]
name = "dense"
set = { granular.phi_b = 0.75 }
[[variants]]
name = "same"
label = "the same bed"
set = { measure.order = false }
)";

scene::Scene read(const std::string& text) { return scene::parse_scene(text, "scene.toml"); }

app::Plan plan(const std::string& text) { return app::make_plan(read(text), app::stages_of(read(text))); }

bool says(const app::Plan& plan, bool modelled, const std::string& text) {
    return std::ranges::any_of(app::describe(plan), [&](const app::PlanLine& line) {
        return line.modelled == modelled && line.text.find(text) != std::string::npos;
    });
}

} // namespace

TEST_CASE("Rods of a scene become a problem and options") {
    const auto plans = app::plan_rods(read(rods_text));
    REQUIRE(plans.size() == 2);
    const rods::RodProblem& p = plans[0].problem;
    CHECK(p.medium->eta == 2.0);
    CHECK(p.medium->xi == 4.0);
    CHECK(p.couplings.kappa == 0.5);
    const rods::Couplings converted = rods::from_divergence_basis({0.5, 1.0, 0.0});
    CHECK(p.couplings.gamma1 == converted.gamma1);
    CHECK(p.couplings.gamma2 == converted.gamma2);
    CHECK(p.rods[0].heading == 0.25);
    CHECK(p.output_times == std::vector{0.0, 1.0, 2.0, 3.0});
    CHECK(plans[0].options.ode.method == integrate::Method::bdf);
    CHECK(plans[0].options.ode.rtol == 1e-6);
    CHECK(plans[1].of.name == "strong");
    CHECK(plans[1].of.folder == "variants/strong/");
    CHECK(plans[1].problem.couplings.kappa == 100.0);
}

TEST_CASE("Every coupling is a key of scenes, turns the rods alone, and can be fitted") {
    for (const rods::Coupling& coupling : rods::coupling_list) {
        const std::string name(coupling.name);
        INFO(name);
        scene::Scene scene = read(rods_text);
        *scene.coupling = {};
        const auto wrong = scene::compile_setter(scene, "coupling." + name).set(scene, 2.5);
        CHECK_FALSE(wrong);
        const rods::Couplings set = app::couplings_of(scene);
        CHECK(set.*coupling.number == 2.5);
        CHECK(set == rods::without(set, !coupling.polar));
        CHECK_FALSE(rods::without(set, coupling.polar).any());
        CHECK(std::ranges::count(scene::fit_parameter_list(), name, &scene::FitParameter::name) == 1);
        const rods::RodProblem problem = app::rod_problem(scene);
        const auto result = rods::simulate(problem, {});
        CHECK(result.outcome.turn[0] != 0.0);
    }
    CHECK(rods::find_coupling("gamma3") == nullptr);
    CHECK(rods::coupling_names(true) == "gamma1, gamma2");
}

TEST_CASE("Beds of a scene: as written, and the variants that change it") {
    const app::Plan made = plan(bed_text);
    CHECK(made.stages == std::vector{Stage::granular, Stage::measure});
    REQUIRE(made.beds.size() == 2); // "same" changes no bed
    CHECK(made.beds[1].of.name == "dense");
    CHECK(made.beds[1].problem.beads > made.beds[0].problem.beads);
    CHECK(made.beds[0].problem.rods.at(0).shape.spheres == 13); // an odd number: docs/bed.md
    CHECK(made.beds[0].problem.steps == 10000);
    CHECK(made.beds[0].schedule.frame_every == 100);
    CHECK(made.beds[0].measures.has_value());
}

TEST_CASE("Frames become extended XYZ if asked for, or if that of all runs is short") {
    const auto writes = [](const std::string& formats, const std::string& keys) {
        return plan("schema = 1\n[granular]\nbeads = 1000\nbox = \"78 a\"\nduration = \"1 s\"\n" + keys +
                    "[granular.output]\n" + formats)
            .beds[0]
            .schedule;
    };
    CHECK(writes("", "").xyz);                 // 1000 beads, 101 frames, 140 bytes each: 14 MB
    CHECK_FALSE(writes("", "runs = 2\n").xyz); // 28 MB
    CHECK_FALSE(writes("frames = \"0.005 s\"", "").xyz);
    CHECK(writes("formats = [\"xyz\"]", "runs = 2\n").xyz);
    CHECK_FALSE(writes("formats = [\"h5md\"]", "").xyz);
    CHECK_FALSE(writes("formats = [\"xyz_if_short\"]", "").h5md);
    CHECK_FALSE(writes("formats = []", "").xyz);
}

TEST_CASE("The order of rods is a stage of its own, after the rods or the bed that it looks at") {
    const std::string order = "[rods_order]\nlink = 1.0\n";
    const app::Plan theory = plan(rods_text + order);
    CHECK(theory.stages.back() == Stage::order);
    CHECK(says(theory, true, "order of the rods; clusters by links of less than 1"));
    const std::string rods = "[[granular.rods]]\nposition = [\"10 a\", \"10 a\"]\n[[granular.rods]]\n"
                             "position = [\"10 a\", \"20 a\"]\n";
    const std::string bed =
        "schema = 1\n[granular]\nphi_b = 0.3\nbox = \"40 a\"\nduration = \"1 s\"\n" + rods;
    const app::Plan of_bed = plan(bed + "[rods_order]\nlink = \"2 a\"\n");
    CHECK(of_bed.stages == std::vector{Stage::granular, Stage::order});
    CHECK(of_bed.scene.rods_order->link == Approx(0.8e-3));
    CHECK(says(of_bed, true, "order of the motile rods of the bed; clusters by links of less than 2 a"));
}

TEST_CASE("What is described is what is planned") {
    CHECK(says(plan(rods_text), true, "2 rods to t = 3, 1 variants"));
    CHECK(says(plan(rods_text), false, "granular bed: no [granular] table"));
    CHECK(says(plan(bed_text), true, "3 runs"));
    CHECK(says(plan(bed_text), false, "rod dynamics"));
    CHECK_FALSE(says(plan(bed_text), true, "rod dynamics"));
    CHECK_FALSE(says(plan(bed_text), false, "gravity"));
    scene::Scene still = read(bed_text);
    still.granular->gravity = still.granular->plates.gamma = 0.0;
    CHECK(says(app::make_plan(still, app::stages_of(still)), false, "gravity: it is 0"));
    still.granular->plates.gamma = 7.0;
    CHECK_THROWS_WITH(app::make_plan(still, app::stages_of(still)),
                      Catch::Contains("gamma = 7 with gravity = 0"));
}

TEST_CASE("A stored trajectory takes the place of a granular run") {
    const std::string text =
        bed_text.substr(0, bed_text.find("[[variants]]")) + "trajectory = \"other.h5md\"\n";
    CHECK(app::stages_of(read(text)) == std::vector{Stage::measure});
}

TEST_CASE("What cannot be modelled is refused when it is planned") {
    scene::Scene full = read(bed_text);
    full.granular->phi_b.reset();
    full.granular->beads = 100000;
    const std::vector<Stage> stages = {Stage::granular};
    CHECK_THROWS_AS(app::make_plan(full, stages), InputError);
    CHECK_THROWS_AS(app::granular_problem(read(rods_text)), InputError);
}

TEST_CASE("Data that are not there yet leave the fit unplanned") {
    scene::Scene fit = read(rods_text);
    fit.fit.emplace();
    const std::vector<Stage> stages = {Stage::fit};
    app::FitInputs inputs;
    inputs.profiles.resize(1);
    CHECK_FALSE(inputs.complete());
    CHECK_FALSE(app::make_plan(fit, stages, {inputs, {}}).fit_plan.has_value());
}

TEST_CASE("every stage has a name of its own, a key, and files that are none of another stage's") {
    const scene::Scene rods = read(rods_text), bed = read(bed_text);
    std::set<std::string> names;
    std::set<std::string_view> patterns;
    for (const Stage stage : app::all_stages()) {
        const app::StageKind& kind = app::kind_of(stage);
        CHECK(kind.stage == stage);
        CHECK(names.insert(app::to_string(stage)).second);
        CHECK(kind.run != nullptr);
        CHECK_FALSE(app::stage_key(kind.has_table(bed) ? bed : rods, stage).empty());
        for (const app::FileKind& file : kind.files()) {
            INFO(file.pattern);
            CHECK(patterns.insert(file.pattern).second);
            const app::FileKind* known = app::kind_of(std::string(file.pattern));
            CHECK((known == nullptr || known->stage == stage)); // "<k>" in a pattern is no name
        }
        CHECK_FALSE(kind.files().empty());
    }
    CHECK(names == std::set<std::string>{"granular", "measure", "fit", "field", "rods", "order",
                                         "scan"}); // folders of earlier runs have these
}
