// A run folder: who may write in it, what of an earlier run stays, and what is refused.

#include "held_folder.hpp"
#include "scenes.hpp"

#include "rodwake/app/run.hpp"

#include <catch2/catch.hpp>
#include <sys/wait.h>
#include <unistd.h>

using namespace rodwake;
using namespace store_test;
using namespace app_test;
using app::RunFolder;
using app::Stage;

namespace {

/// What of these files is left when the stages begin in a folder that holds the records.
Names left_by_begin(const Scratch& scratch, const Names& files, const scene::Scene& scene,
                    const app::StageRecords& records, const Stages& asked, bool force) {
    hold(scratch, scene, records);
    for (const std::string& name : files)
        scratch.file("run/" + name, "old");
    scratch.file("run/manifest.json", R"({"files": {"figures/a.png": {}}})");
    const RunFolder folder(scratch / "run", scene, asked, force);
    begin(folder, scene);
    return files_of_run(scratch);
}

const Names granular_results = {"summary.json",     "runs.csv",        "table.csv",
                                "tracks.csv",       "trajectory.h5md", "trajectory.xyz",
                                "last_period.h5md", "final.rwc",       "measure.rwc"};
const Names granular_progress = {"checkpoint.rwc", "checkpoint.rwc.previous", "rows.log", "frames.log",
                                 "last_period.log"};
const Names rods_results = {"rods.csv", "outcome.json", "variants/v/rods.csv", "variants/v/outcome.json"};
const Names foreign = {"notes.log", "checkpoint.txt",   "trajectory.nc", "field_notes.csv",
                       "my.tmp",    "figures/mine.svg", "draft.tmp1"};

Names operator+(Names first, const Names& second) {
    first.insert(second.begin(), second.end());
    return first;
}

Names in_folder(const std::string& folder, const Names& names) {
    Names moved;
    for (const std::string& name : names)
        moved.insert(folder + name);
    return moved;
}

} // namespace

TEST_CASE("A new folder is made, with its parents") {
    const Scratch scratch;
    const RunFolder run(scratch / "a/b", pair(), Stages{Stage::rods}, false);
    CHECK(fs::is_directory(scratch / "a/b"));
    CHECK_FALSE(run.resumed());
    CHECK(app::run_status(run.path()).empty());
    CHECK(run.stages() == Stages{Stage::rods});
    run.write("variants/one/rods.csv", "t\n");
    CHECK(content(run.file("variants/one/rods.csv")) == "t\n");
}

TEST_CASE("A finished run is kept unless forced") {
    const Scratch scratch;
    hold(scratch, pair(), {{"rods", "finished"}});
    CHECK(
        has(refusal(scratch, pair(), {Stage::rods}), (scratch / "run").string() + ": holds a finished run"));
    const RunFolder forced(scratch / "run", pair(), Stages{Stage::rods}, true);
    CHECK(forced.stages() == Stages{Stage::rods});
    CHECK_FALSE(forced.resumed());
}

TEST_CASE("A stage of the same scene is added, one that is done is not done again") {
    const Scratch scratch;
    hold(scratch, pair(), {{"rods", "finished"}});
    const RunFolder added(scratch / "run", pair(), Stages{Stage::field, Stage::rods}, false);
    CHECK(added.stages() == Stages{Stage::field});
    CHECK(added.kept() == Stages{Stage::rods});
    CHECK(added.records("failed") == app::StageRecords{{"field", "failed"}, {"rods", "finished"}});
}

TEST_CASE("Stages of another scene are refused, however they ended") {
    const auto status = GENERATE(as<std::string>{}, "finished", "unfinished", "interrupted", "failed");
    const Scratch scratch;
    hold(scratch, pair(0.5), {{"rods", status}});
    CHECK(has(refusal(scratch, pair(0.6), {Stage::rods}),
              "of another scene (kappa = 0.5 there, kappa = 0.6 here)"));
    CHECK(has(refusal(scratch, pair(0.6), {Stage::field}), "of another scene"));
    CHECK(RunFolder(scratch / "run", pair(0.6), Stages{Stage::field}, true).kept().empty());
}

TEST_CASE("A run that did not finish is taken up") {
    const auto status = GENERATE(as<std::string>{}, "unfinished", "interrupted", "failed");
    const Scratch scratch;
    hold(scratch, pair(), {{"rods", status}});
    CHECK(RunFolder(scratch / "run", pair(), Stages{Stage::rods}, false).resumed());
    CHECK_FALSE(RunFolder(scratch / "run", pair(), Stages{Stage::rods}, true).resumed());
}

TEST_CASE("A variant of the theory alone leaves the beds what they are") {
    const Scratch scratch;
    hold(scratch, bed(), {{"granular", "finished"}});
    scene::Scene more = bed();
    more.title = "another";
    more.variants.push_back({"strong", "", {"title=\"strong\""}});
    CHECK(app::stage_key(bed(), Stage::granular) != app::stage_key(bed(0.6), Stage::granular));
    CHECK(RunFolder(scratch / "run", more, Stages{Stage::rods}, false).kept() == Stages{Stage::granular});
}

TEST_CASE("A bed of another scene does not go, even by force, unless it is the one that is asked for") {
    const Scratch scratch;
    hold(scratch, bed(0.5), {{"granular", "finished"}});
    CHECK(has(error_of<InputError>([&] { RunFolder(scratch / "run", bed(0.6), Stages{Stage::rods}, true); }),
              "does not replace even with --force"));
    CHECK(RunFolder(scratch / "run", bed(0.6), Stages{Stage::granular}, true).stages() ==
          Stages{Stage::granular});
}

TEST_CASE("A fit that was finished without the medium that is wanted now is done again") {
    const Scratch scratch;
    scene::Scene scene = pair();
    hold(scratch, scene, {{"fit", "finished"}});
    scene.medium->fitted = true;
    const Stages fit = {Stage::fit};
    CHECK(RunFolder(scratch / "run", scene, fit, false).stages() == fit);
    scratch.file("run/medium.json", "{}");
    CHECK(has(refusal(scratch, scene, fit), "holds a finished run"));
}

TEST_CASE("An ensemble grows, and what followed from it is dropped") {
    const Scratch scratch;
    hold(scratch, bed(0.5, 2), {{"granular", "finished"}, {"measure", "finished"}});
    const scene::Scene larger = bed(0.5, 4);
    const RunFolder grown(scratch / "run", larger, Stages{Stage::granular}, false);
    CHECK(grown.stages() == Stages{Stage::granular});
    CHECK(grown.kept().empty());
    CHECK_FALSE(grown.kept_runs().has_value());
}

TEST_CASE("An ensemble grows, and what is asked for with it is done again") {
    const Scratch scratch;
    hold(scratch, bed(0.5, 2), {{"granular", "finished"}, {"measure", "finished"}, {"fit", "finished"}});
    const Stages both{Stage::granular, Stage::measure};
    const RunFolder grown(scratch / "run", bed(0.5, 4), both, false);
    CHECK(grown.stages() == both);
    CHECK(grown.kept().empty()); // the fit was of the measures
}

TEST_CASE("Whoever is killed while a folder is begun leaves one that can be taken up") {
    const Scratch scratch;
    const auto killed = [&](const scene::Scene& scene, const Stages& asked, bool force, int at) {
        CHECK_THROWS_WITH(begin(RunFolder(scratch / "run", scene, asked, force), scene, at), "killed");
    };
    const int at = GENERATE(1, 2);
    SECTION("a new folder") {
        killed(pair(), {Stage::rods}, false, at);
        CHECK(RunFolder(scratch / "run", pair(), Stages{Stage::rods}, false).stages() == Stages{Stage::rods});
    }
    SECTION("a new folder, without its scene") {
        killed(pair(), {Stage::rods}, false, 2);
        fs::remove(scratch / "run/scene.toml");
        CHECK(RunFolder(scratch / "run", pair(), Stages{Stage::rods}, false).stages() == Stages{Stage::rods});
    }
    SECTION("a finished run that is replaced by another scene's: neither counts as the other's result") {
        hold(scratch, pair(), {{"rods", "finished"}});
        scratch.file("run/rods.csv", "old");
        scene::Scene other = pair();
        other.coupling->kappa += 1.0;
        killed(other, {Stage::rods}, true, 2);
        CHECK_FALSE(fs::exists(scratch / "run/rods.csv"));
        for (const scene::Scene& next : {pair(), other})
            CHECK(RunFolder(scratch / "run", next, Stages{Stage::rods}, false).stages() ==
                  Stages{Stage::rods});
    }
    SECTION("a run that is taken up") {
        hold(scratch, bed(), {{"granular", "interrupted"}});
        scratch.file("run/checkpoint.rwc", "state");
        killed(bed(), {Stage::granular}, false, at);
        const RunFolder next(scratch / "run", bed(), Stages{Stage::granular}, false);
        CHECK(next.resumed());
        begin(next, bed());
        CHECK(fs::exists(scratch / "run/checkpoint.rwc"));
    }
    SECTION("a checkpoint of a run that was being replaced is not taken for one's own") {
        hold(scratch, bed(), {{"granular", "interrupted"}});
        killed(bed(), {Stage::granular}, true, 2);
        scratch.file("run/checkpoint.rwc", "of the old one, not removed yet");
        begin(RunFolder(scratch / "run", bed(), Stages{Stage::granular}, false), bed());
        CHECK_FALSE(fs::exists(scratch / "run/checkpoint.rwc"));
    }
}

TEST_CASE("Files of others, and runs of another version, are kept unless forced") {
    const auto record = GENERATE(as<std::string>{}, "", "not JSON", "[]", "{}", R"({"status": 3})",
                                 R"({"status": "finished"})");
    const Scratch scratch;
    scratch.file("run/thesis.tex", "text");
    if (!record.empty())
        scratch.file("run/provenance.json", record);
    const std::string why = has(record, "finished") ? "earlier version" : "files that are not a rodwake run";
    CHECK(has(refusal(scratch, pair(), {Stage::rods}), why));
    const RunFolder forced(scratch / "run", pair(), Stages{Stage::rods}, true);
    begin(forced, pair());
    CHECK(content(scratch / "run/thesis.tex") == "text");
}

TEST_CASE("An empty folder may be used, a file may not") {
    const Scratch scratch;
    fs::create_directory(scratch / "empty");
    CHECK_NOTHROW(RunFolder(scratch / "empty", pair(), Stages{Stage::rods}, false));
    scratch.file("run", "");
    CHECK(has(refusal(scratch, pair(), {Stage::rods}), "is a file"));
    CHECK(
        has(error_of<RunError>([&] { RunFolder(scratch / "run/below", pair(), Stages{Stage::rods}, false); }),
            "cannot make the folder: Not a directory"));
}

TEST_CASE("A stage that begins removes its own results, figures and the report, and nothing else") {
    const Scratch scratch;
    const Names cut = {"field_cut_0.csv"}, drawn = {"report.html", "figures/a.png", "table.csv.tmp77"};
    CHECK(left_by_begin(scratch, rods_results + cut + drawn + foreign, pair(),
                        {{"rods", "finished"}, {"field", "finished"}}, {Stage::rods}, true) == cut + foreign);
}

TEST_CASE("The datasets of a stage that is kept stay in result.h5, those of none do not") {
    const Scratch one, other;
    const Names results = {"result.h5"};
    CHECK(left_by_begin(one, results, pair(), {{"rods", "finished"}}, {Stage::field}, false) == results);
    CHECK(left_by_begin(other, results, pair(), {{"rods", "failed"}}, {Stage::rods}, false).empty());
}

TEST_CASE(
    "A granular run that is taken up keeps what it goes on from, and the finished runs of an ensemble") {
    const auto status = GENERATE(as<std::string>{}, "unfinished", "interrupted", "failed");
    const Scratch scratch;
    const Names members =
        in_folder("runs/0001/", granular_results) + in_folder("runs/0002/", granular_progress);
    const Names beds =
        granular_results + granular_progress + foreign + members + in_folder("variants/v/", granular_results);
    CHECK(left_by_begin(scratch, beds, bed(), {{"granular", status}}, {Stage::granular}, false) == beds);
}

TEST_CASE("A granular run that is replaced leaves nothing of its own, and no empty folders") {
    const Scratch scratch;
    const Names own = granular_results + granular_progress;
    const Names others = foreign + in_folder("runs/0002/", foreign);
    CHECK(left_by_begin(scratch, own + others + in_folder("runs/0001/", own) + in_folder("runs/0002/", own),
                        bed(), {{"granular", "finished"}}, {Stage::granular}, true) == others);
    CHECK_FALSE(fs::exists(scratch / "run/runs/0001"));
    CHECK(fs::exists(scratch / "run/runs/0002"));
}

TEST_CASE("A fit that is taken up keeps the starts that are done, one that is replaced does not") {
    scene::Scene scene = bed();
    scene.fit.emplace().parameters = {"f_over_mu"};
    scene.fit->profiles.emplace_back().file = "ux.csv";
    const Names results = {"fit.json", "fit_profile_0.csv", "fit_curve_0.csv", "fit_trajectory_0.csv",
                           "medium.json"};
    const Names starts = {"fit.log"}, others = {"fit_notes.csv", "my_fit.json"};
    const Scratch one, other;
    CHECK(left_by_begin(one, results + starts + others, scene, {{"fit", "interrupted"}}, {Stage::fit},
                        false) == starts + others);
    CHECK(left_by_begin(other, results + starts + others, scene, {{"fit", "finished"}}, {Stage::fit}, true) ==
          others);
}

TEST_CASE("Two processes do not share a folder, and a lock that was left behind is taken over") {
    const Scratch scratch;
    int ready[2], done[2];
    REQUIRE(::pipe(ready) == 0);
    REQUIRE(::pipe(done) == 0);
    const pid_t child = ::fork();
    if (child == 0) {
        const RunFolder folder(scratch / "run", pair(), Stages{Stage::rods}, false);
        char byte = 1;
        (void)!::write(ready[1], &byte, 1);
        (void)!::read(done[0], &byte, 1);
        ::_exit(0); // the lock goes with the process, what stands in the file stays
    }
    char byte = 0;
    REQUIRE(::read(ready[0], &byte, 1) == 1);
    CHECK(has(refusal(scratch, pair(), {Stage::rods}), "process " + std::to_string(child) + " on host "));
    REQUIRE(::write(done[1], &byte, 1) == 1);
    REQUIRE(::waitpid(child, nullptr, 0) == child);
    {
        const RunFolder folder(scratch / "run", pair(), Stages{Stage::rods}, false);
        CHECK(has(folder.lock().taken_over(), "process " + std::to_string(child)));
    }
    CHECK(RunFolder(scratch / "run", pair(), Stages{Stage::rods}, false).lock().taken_over().empty());
}

// --- Files of a finished run that are gone: what is made again, what stays, and what is reported until then

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
