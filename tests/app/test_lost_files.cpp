// Files of a finished run that are gone: what is made again, what stays, and what is told so until then.

#include "held_folder.hpp"
#include "rodwake/app/run.hpp"
#include "scenes.hpp"

#include <catch2/catch.hpp>

using namespace app_test;

TEST_CASE("What follows from a stage stays while its lost files are made again, killed in between or not") {
    const Scratch scratch;
    scene::Scene scene = bed();
    scene.measure.emplace();
    hold(scratch, scene, {{"granular", "finished"}, {"measure", "finished"}});
    scratch.file("run/manifest.json", R"({"files": {"table.csv": {"stage": "granular"}}})");
    scratch.file("run/measure.h5", "kept");
    CHECK(app::stage_status(scratch / "run", Stage::granular) == "unfinished");
    for (int killed = 0; killed < 3; ++killed) {
        const RunFolder folder(scratch / "run", scene, Stages{Stage::granular}, false);
        CHECK(folder.stages() == Stages{Stage::granular});
        CHECK(folder.kept() == Stages{Stage::measure});
        begin(folder, scene, 10); // the folder's own records are of a stage under way, then it is killed
        CHECK(files_of_run(scratch) == Names{"measure.h5"});
        app::write_manifest(scratch / "run");
        CHECK(app::lost_files(scratch / "run").at("granular") == std::vector<std::string>{"table.csv"});
    }
    scratch.file("run/table.csv", "t\n");
    const RunFolder folder(scratch / "run", scene, Stages{Stage::granular}, false);
    CHECK(folder.records("finished") == app::StageRecords{{"granular", "finished"}, {"measure", "finished"}});
    CHECK(folder.records("interrupted").at("granular") == app::files_lost);
}

TEST_CASE("A stage that was not asked for keeps the record of its lost files, and their names") {
    const Scratch scratch;
    hold(scratch, pair(), {{"field", "finished"}, {"rods", "finished"}});
    scratch.file("run/manifest.json",
                 R"({"files": {"field_cut_0.csv": {"stage": "field"}, "rods.csv": {"stage": "rods"}}})");
    begin(RunFolder(scratch / "run", pair(), Stages{Stage::rods}, false), pair(), 10);
    app::write_manifest(scratch / "run");
    CHECK(app::lost_files(scratch / "run").at("field") == std::vector<std::string>{"field_cut_0.csv"});
    const RunFolder folder(scratch / "run", pair(), Stages{Stage::field}, false);
    CHECK(folder.stages() == Stages{Stage::field});
    CHECK_FALSE(folder.resumed());
}

TEST_CASE("A lost file of the fit removes nothing that was not asked for") {
    const Scratch scratch;
    const scene::Scene scene = scene::parse_scene(
        "schema = 1\n[medium]\nfitted = true\n[field]\nx = [-2.0, 2.0]\ny = [-2.0, 2.0]\nnx = 5\nny = 5\n"
        "[fit]\nparameters = [\"f_over_mu\", \"eta\", \"xi\"]\n"
        "[[fit.profiles]]\nfile = \"ux.csv\"\ncomponent = \"Ux\"\nalong = \"x\"\nat = 0.0\n",
        "fit.toml");
    hold(scratch, scene, {{"fit", "finished"}, {"field", "finished"}});
    scratch.file("run/manifest.json", R"({"files": {"fit.json": {"stage": "fit"}}})");
    scratch.file("run/medium.json", "{}");
    CHECK(has(refusal(scratch, scene, {Stage::fit}), "files of the fit are gone, and field follows from it"));
    const RunFolder folder(scratch / "run", scene, Stages{Stage::fit, Stage::field}, false);
    CHECK(folder.stages().size() == 2);
}

TEST_CASE("Files of shares, tries and other runs below are not this run's") {
    const Scratch scratch;
    hold(scratch, pair(), {{"rods", "finished"}});
    scratch.file("run/manifest.json", R"({"files": {"part-1-of-2/scan.csv": {"stage": "scan"},
        "tradeoff_bed/ways/1/rods.csv": {"stage": "rods"}, "mine/rods.csv": {"stage": "rods"},
        "odd.csv": {"stage": 7}, "variants/a/outcome.json": {"stage": "rods"}}})");
    CHECK(app::lost_files(scratch / "run") ==
          app::LostFiles{{"", {"odd.csv"}}, {"rods", {"variants/a/outcome.json"}}});
}
