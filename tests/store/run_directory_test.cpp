// A run directory: who may write in it, and what the record beside the results says.

#include "rodwake/store/run_directory.hpp"

#include "rodwake/core/error.hpp"
#include "scratch.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <regex>

using namespace rodwake;
using namespace store_test;
using store::RunDirectory;

namespace {

using Names = std::set<std::string>;

std::string provenance(const std::string& status) { return R"({"status": ")" + status + "\"}"; }

std::string refusal(const fs::path& path) {
    return error_of<InputError>([&] { RunDirectory(path, false); });
}

/// Files in run/, seen from there.
Names files_of_run(const Scratch& scratch) {
    Names files;
    for (const std::string& name : scratch.entries())
        if (!fs::is_directory(scratch / name))
            files.insert(name.substr(4));
    return files;
}

/// Writes these files into run/, beside a record with this status, and begins a run there.
Names left_by_begin(const Scratch& scratch, const Names& files, const std::string& status, bool force) {
    for (const std::string& name : files)
        scratch.file("run/" + name, "old");
    scratch.file("run/provenance.json", provenance(status));
    RunDirectory(scratch / "run", force).begin(provenance("unfinished"));
    Names left = files_of_run(scratch);
    left.erase("provenance.json");
    return left;
}

const Names granular_results = {"summary.json",     "runs.csv",        "table.csv",
                                "tracks.csv",       "trajectory.h5md", "trajectory.xyz",
                                "last_period.h5md", "final.rwc",       "measure.rwc"};
const Names litter = {"table.csv.tmp77"};
const Names granular_progress = {"checkpoint.rwc", "checkpoint.rwc.previous", "rows.log", "frames.log",
                                 "last_period.log"};
const Names foreign = {"notes.log", "log.txt", "checkpoint.txt", "trajectory.gsd"};

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
    const RunDirectory run(scratch / "a/b", false);
    CHECK(fs::is_directory(scratch / "a/b"));
    CHECK_FALSE(run.resumed());
    CHECK(store::run_status(run.path()).empty());
    run.write("variants/one/rods.csv", "t\n");
    CHECK(content(run.file("variants/one/rods.csv")) == "t\n");
}

TEST_CASE("A finished run is kept unless forced") {
    const Scratch scratch;
    scratch.file("run/provenance.json", provenance("finished"));
    CHECK(has(refusal(scratch / "run"), (scratch / "run").string() + ": holds a finished run"));
    CHECK_FALSE(RunDirectory(scratch / "run", true).resumed());
}

TEST_CASE("A run that did not finish is taken over") {
    const auto status = GENERATE(as<std::string>{}, "unfinished", "interrupted", "failed");
    const Scratch scratch;
    scratch.file("run/provenance.json", provenance(status));
    CHECK(store::run_status(scratch / "run") == status);
    CHECK(RunDirectory(scratch / "run", false).resumed());
    CHECK_FALSE(RunDirectory(scratch / "run", true).resumed());
}

TEST_CASE("Files of others are kept unless forced") {
    const auto record = GENERATE(as<std::string>{}, "", "not JSON", "[]", "{}", R"({"status": 3})");
    const Scratch scratch;
    scratch.file("run/thesis.tex", "text");
    if (!record.empty())
        scratch.file("run/provenance.json", record);
    CHECK(has(refusal(scratch / "run"), "holds files that are not a rodwake run"));
    const RunDirectory forced(scratch / "run", true);
    forced.begin(provenance("unfinished"));
    CHECK(content(scratch / "run/thesis.tex") == "text");
    CHECK(store::run_status(scratch / "run") == "unfinished");
}

TEST_CASE("An empty folder may be used, a file may not") {
    const Scratch scratch;
    fs::create_directory(scratch / "empty");
    CHECK_NOTHROW(RunDirectory(scratch / "empty", false));
    scratch.file("file", "");
    CHECK(has(refusal(scratch / "file"), "is a file"));
    CHECK(has(error_of<RunError>([&] { RunDirectory(scratch / "file/run", false); }),
              "cannot make the folder: Not a directory"));
}

TEST_CASE("A run that begins removes the results of the one before, and only those") {
    const Scratch scratch;
    for (const char* result :
         {"result.h5", "rods.csv", "outcome.json", "report.html", "field_cut_0.csv", "figures/a.png",
          "variants/v/rods.csv", "variants/v/outcome.json", "result.h5.tmp123"})
        scratch.file("run/" + std::string(result), "old");
    const Names kept = {"notes.txt", "field_notes.csv", "my.tmp",
                        "log.txt",   "checkpoint.json", "variants/v/checkpoint.json"};
    for (const std::string& name : kept)
        scratch.file("run/" + name, "kept");
    scratch.file("run/provenance.json", provenance("finished"));
    const RunDirectory run(scratch / "run", true);
    CHECK(fs::exists(run.file("result.h5"))); // as long as the new run has not begun
    run.begin(provenance("unfinished"));
    const Names files = files_of_run(scratch);
    Names expected = kept;
    expected.insert("provenance.json");
    CHECK(files == expected);
    CHECK(store::run_status(run.path()) == "unfinished");
}

TEST_CASE(
    "A granular run that is taken up keeps what it goes on from, and the finished runs of an ensemble") {
    const auto status = GENERATE(as<std::string>{}, "unfinished", "interrupted", "failed");
    const Scratch scratch;
    const Names members =
        in_folder("runs/0001/", granular_results) + in_folder("runs/0002/", granular_progress);
    const Names beds =
        granular_results + granular_progress + foreign + members + in_folder("variants/v/", granular_results);
    // what the measure stage made of them is made again, what was recorded on the way is not
    const Names measured = {"measure.json", "gB.csv", "profile_Ux_x.csv", "series.csv",
                            "variants/v/flow.vti"};
    CHECK(left_by_begin(scratch, beds + measured + litter, status, false) == beds);
}

TEST_CASE("A fit that is taken up keeps the starts that are done, one that is replaced does not") {
    const Scratch one, other;
    const Names results = {
        "fit.json", "fit.txt", "fit_profile_0.csv", "fit_curve_0.csv", "fit_trajectory_0.csv", "medium.json"};
    const Names starts = {"fit_starts.log"}, others = {"fit_notes.csv", "my_fit.json"};
    CHECK(left_by_begin(one, results + starts + others, "interrupted", false) == starts + others);
    CHECK(left_by_begin(other, results + starts + others, "finished", true) == others);
}

TEST_CASE("A granular run that is replaced leaves nothing of its own") {
    const auto status = GENERATE(as<std::string>{}, "finished", "unfinished", "interrupted", "failed");
    const Scratch scratch;
    const Names own = granular_results + granular_progress + litter;
    const Names others = foreign + in_folder("runs/0002/", foreign);
    CHECK(left_by_begin(scratch, own + others + in_folder("runs/0001/", own) + in_folder("runs/0002/", own),
                        status, true) == others);
    CHECK_FALSE(fs::exists(scratch / "run/runs/0001"));
    CHECK(fs::exists(scratch / "run/runs/0002"));
}

TEST_CASE("A replaced ensemble leaves no empty folders") {
    const Scratch scratch;
    CHECK(left_by_begin(scratch, in_folder("runs/0001/", granular_results), "finished", true).empty());
    CHECK_FALSE(fs::exists(scratch / "run/runs"));
}

TEST_CASE("Provenance says who, what, with what and when") {
    const std::string text =
        store::provenance_json({"rodwake run \"a b\".toml", "a b.toml", "finished", 1ULL << 63, 1.5});
    const auto json = nlohmann::json::parse(text);
    CHECK(json.at("program") == "rodwake");
    CHECK(json.at("status") == "finished");
    CHECK(json.at("command") == "rodwake run \"a b\".toml");
    CHECK(json.at("scene") == "a b.toml");
    CHECK(json.at("seed") == (1ULL << 63));
    CHECK(json.at("wall_seconds") == 1.5);
    CHECK(std::regex_match(json.at("date").get<std::string>(),
                           std::regex(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ)")));
    for (const char* key : {"version", "git", "compiler", "build"})
        CHECK_FALSE(json.at(key).get<std::string>().empty());
    CHECK_FALSE(json.at("cpu").at("model").get<std::string>().empty());
    CHECK(json.at("cpu").at("features").is_array());
    CHECK(json.at("libraries").contains("SUNDIALS"));
}

TEST_CASE("Provenance is JSON even if a file name is not UTF-8") {
    const auto json = nlohmann::json::parse(
        store::provenance_json({"rodwake run \xE9.toml", "\xE9.toml", "finished", 0, 0.0}));
    CHECK(json.at("scene") == "\xEF\xBF\xBD.toml"); // the replacement character
}
