// A run without a command line: scene -> plan -> stages -> files.

#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "run/catalogue.hpp"
#include "run_files.hpp"
#include "scenes.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace store_test;
using app::Stage;
using app::StageEnd;
using app_test::json_of, app_test::undescribed;

namespace {

StageEnd run(const scene::Scene& scene, std::vector<Stage> stages, const fs::path& folder,
             const app::RunContext& context = {}) {
    return app::run(app::plan_run(scene, stages, folder, context), folder, context);
}

} // namespace

TEST_CASE("A library user reads a scene and gets a run") {
    const Scratch scratch;
    CHECK(run(app_test::pair(), {Stage::field, Stage::rods}, scratch / "run") == StageEnd::finished);
    CHECK(app::run_status(scratch / "run") == "finished");
    CHECK(json_of(scratch / "run/outcome.json").contains("outcome"));
    CHECK(undescribed(scratch / "run").empty());
    const auto column = json_of(scratch / "run/manifest.json").at("files").at("rods.csv").at("columns").at(1);
    CHECK(column.at("name") == "x0");
    CHECK(column.at("unit") == "f/mu");
}

TEST_CASE("The search for files and columns that the manifest does not tell of can fail") {
    const Scratch scratch;
    run(app_test::pair(), {Stage::rods}, scratch / "run");
    scratch.file("run/stray.csv", "a,b\n");
    auto manifest = json_of(scratch / "run/manifest.json");
    manifest["files"]["rods.csv"]["columns"].erase(0);
    scratch.file("run/manifest.json", manifest.dump());
    CHECK(undescribed(scratch / "run") == std::set<std::string>{"rods.csv:t", "stray.csv"});
}

TEST_CASE("Stages add up in one folder to what one run makes", "[threads]") {
    const Scratch scratch;
    run(app_test::pair(), {Stage::field, Stage::rods}, scratch / "whole");
    run(app_test::pair(), {Stage::rods}, scratch / "parts");
    CHECK(run(app_test::pair(), {Stage::field}, scratch / "parts") == StageEnd::finished);
    for (const char* name : {"rods.csv", "outcome.json", "field_cut_0.csv"})
        CHECK(content(scratch / "parts" / name) == content(scratch / "whole" / name));
    CHECK(json_of(scratch / "parts/provenance.json").at("stages") ==
          nlohmann::json{{"field", "finished"}, {"rods", "finished"}});
    CHECK(json_of(scratch / "parts/manifest.json") == json_of(scratch / "whole/manifest.json"));
}

TEST_CASE("What is done already is not done again by a run of more") {
    const Scratch scratch;
    run(app_test::pair(), {Stage::rods}, scratch / "parts");
    const auto before = fs::last_write_time(scratch / "parts/rods.csv");
    CHECK(run(app_test::pair(), {Stage::field, Stage::rods}, scratch / "parts") == StageEnd::finished);
    CHECK(fs::last_write_time(scratch / "parts/rods.csv") == before);
}

TEST_CASE("A stage that fails does not undo those before it") {
    const Scratch scratch;
    scene::Scene scene = app_test::pair();
    scene.rods_run->max_steps = 2;
    CHECK(run(scene, {Stage::field, Stage::rods}, scratch / "run") == StageEnd::failed);
    CHECK(json_of(scratch / "run/provenance.json").at("stages") ==
          nlohmann::json{{"field", "finished"}, {"rods", "failed"}});
    scene.rods_run->max_steps = 1'000'000;
    CHECK(run(scene, {Stage::field, Stage::rods}, scratch / "run") == StageEnd::finished);
    CHECK(undescribed(scratch / "run").empty());
}

TEST_CASE("A caller can stop a run, and the same call goes on") {
    const Scratch scratch;
    app::RunContext context;
    context.stop = [] { return true; };
    CHECK(run(app_test::pair(), {Stage::rods}, scratch / "run", context) == StageEnd::interrupted);
    CHECK(app::run_status(scratch / "run") == "interrupted");
    CHECK(run(app_test::pair(), {Stage::rods}, scratch / "run") == StageEnd::finished);
    run(app_test::pair(), {Stage::rods}, scratch / "whole");
    CHECK(content(scratch / "run/rods.csv") == content(scratch / "whole/rods.csv"));
}

TEST_CASE("A caller hears messages and progress") {
    const Scratch scratch;
    app::RunContext context;
    std::string messages;
    double last = 0.0;
    context.log = [&](app::Severity, const std::string& text) { messages += text + "\n"; };
    context.progress = [&](const app::ProgressReport& report) { last = report.value / report.end; };
    CHECK(run(app_test::bed(), {Stage::granular}, scratch / "bed", context) == StageEnd::finished);
    CHECK(has(messages, "dem: beads 64"));
    CHECK(last == Approx(1.0));
    CHECK(undescribed(scratch / "bed").empty());
}

TEST_CASE("The seed of the context becomes that of the scene") {
    const Scratch scratch;
    app::RunContext context;
    context.seed = 7;
    const std::vector<Stage> stages = {Stage::granular};
    CHECK(app::plan_run(app_test::bed(), stages, scratch / "bed", context).beds.front().problem.seed == 7);
    context.seed = std::uint64_t{1} << 63;
    CHECK_THROWS_AS(app::plan_run(app_test::bed(), stages, scratch / "bed", context), InputError);
}

TEST_CASE("Names fit the patterns of the catalogue") {
    CHECK(app::fits("profile_Ux_x.csv", "profile_<k>_<k>.csv"));
    CHECK(app::fits("fit_profile_12.csv", "fit_profile_<k>.csv"));
    CHECK_FALSE(app::fits("fit_profile_.csv", "fit_profile_<k>.csv"));
    CHECK_FALSE(app::fits("field_cut_1.csv.old", "field_cut_<k>.csv"));
    CHECK_FALSE(app::fits("my_fit.json", "fit.json"));
    CHECK(app::kind_of("thesis.tex") == nullptr);
    for (const app::FileKind& kind : app::file_kinds()) {
        std::string name(kind.pattern);
        for (auto at = name.find("<k>"); at != std::string::npos; at = name.find("<k>"))
            name.replace(at, 3, "0");
        CHECK(app::kind_of(name) == &kind); // no pattern hides another
    }
}
