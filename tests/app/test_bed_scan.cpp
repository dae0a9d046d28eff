// Scans of beds: runs of points, their means, and that neither threads nor interruptions change a byte.

#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/csv.hpp"
#include "run_files.hpp"

#include <catch2/catch.hpp>

#include <atomic>

using namespace rodwake;
using namespace store_test;
using app::Stage;
using app::StageEnd;
using app_test::json_of, app_test::undescribed;

namespace {

const std::string beads = "schema = 1\n[granular]\nbeads = 20\nbox = \"30 a\"\nduration = \"0.02 s\"\n"
                          "equilibrate = \"0 s\"\n";
const std::string outputs = "[granular.output]\nformats = []\nlast_period = false\n";
const std::string two_rods = "[[granular.rods]]\nposition = [\"15 a\", \"6 a\"]\n"
                             "[[granular.rods]]\nposition = [\"15 a\", \"-6 a\"]\n";
const std::string axes =
    "[scan]\n[[scan.axes]]\nkey = \"granular.beads\"\nvalues = [10, 30]\n"
    "[[scan.axes]]\nkeys = [\"granular.rods.0.position.1\", "
    "\"granular.rods.1.position.1\"]\nfactor = [0.5, -0.5]\nvalues = [\"10 a\", \"14 a\"]\n";

scene::Scene pairs(long runs = 2, const std::string& scan = axes) {
    return scene::parse_scene(beads + "runs = " + std::to_string(runs) + "\n" + outputs + two_rods + scan,
                              "bed.toml");
}

StageEnd run(const scene::Scene& scene, const fs::path& folder, const app::RunContext& context = {},
             Stage stage = Stage::scan) {
    const std::vector<Stage> stages = {stage};
    return app::run(app::plan_run(scene, stages, folder, context), folder, context);
}

app::RunContext on(std::size_t threads) {
    app::RunContext context;
    context.threads = threads;
    return context;
}

std::string tables(const fs::path& folder) {
    return content(folder / "scan.csv") + content(folder / "scan_runs.csv");
}

std::vector<double> column(const fs::path& file, const std::string& name) {
    const std::vector<std::string> names = {name};
    return *store::read_csv(file, names).find(name);
}

/// Of a column in the manifest's entry of a file.
std::string unit_of(const nlohmann::json& file, const std::string& name) {
    for (const auto& column : file.at("columns"))
        if (column.at("name") == name)
            return column.at("unit");
    return "no such column";
}

} // namespace

TEST_CASE("A scan of beds has a row a point and a row a run, and the manifest tells of all") {
    const Scratch scratch;
    CHECK(run(pairs(), scratch / "scan") == StageEnd::finished);
    const auto scan = json_of(scratch / "scan/scan.json");
    CHECK(scan.at("subject") == "beds");
    CHECK(scan.at("points") == 4);
    CHECK(scan.at("runs") == 2);
    CHECK(scan.at("requested") == 8);
    CHECK(scan.at("evaluated") == 8);
    CHECK(column(scratch / "scan/scan.csv", "runs") == std::vector<double>(4, 2.0));
    CHECK(column(scratch / "scan/scan_runs.csv", "run") == std::vector<double>{1, 2, 1, 2, 1, 2, 1, 2});
    CHECK(column(scratch / "scan/scan_runs.csv", "point") == std::vector<double>{1, 1, 2, 2, 3, 3, 4, 4});
    CHECK(undescribed(scratch / "scan").empty());
    const auto files = json_of(scratch / "scan/manifest.json").at("files");
    CHECK(files.at("points/0004/runs/0002/tracks.csv").at("stage") == "scan");
    CHECK(unit_of(files.at("scan.csv"), "min_separation") == "a");
    CHECK(unit_of(files.at("scan.csv"), "time_error") == "s");
    CHECK(unit_of(files.at("scan_runs.csv"), "granular.rods.0.position.1") == "m");
}

TEST_CASE("A run of a point is that of the ensemble of its scene") {
    const Scratch scratch;
    run(pairs(), scratch / "scan");
    const std::vector<std::string> point = {"granular.beads=30", "granular.rods.0.position.1=\"7 a\"",
                                            "granular.rods.1.position.1=\"-7 a\""};
    const scene::Scene scene = scene::parse_scene(
        beads + "runs = 2\n" + outputs + two_rods + "[measure]\npairs = true\n", "bed.toml", point);
    run(scene, scratch / "dem", {}, Stage::granular);
    for (const char* one : {"runs/0001", "runs/0002"})
        CHECK(content(scratch / "scan/points/0004" / one / "tracks.csv") ==
              content(scratch / "dem" / one / "tracks.csv"));
    run(scene, scratch / "dem", {}, Stage::measure);
    const auto separation = column(scratch / "dem/pairs.csv", "last_change"),
               found = column(scratch / "scan/scan_runs.csv", "last_change");
    CHECK(std::vector<double>(found.end() - 2, found.end()) == separation);
    const double mean = column(scratch / "scan/scan.csv", "last_change").back();
    CHECK(mean == Approx((separation[0] + separation[1]) / 2.0).epsilon(1e-14));
    CHECK(column(scratch / "scan/scan.csv", "last_change_error").back() ==
          Approx(std::abs(separation[0] - separation[1]) / 2.0).epsilon(1e-12));
}

TEST_CASE("Threads do not change a byte of a scan of beds", "[threads]") {
    const Scratch scratch;
    run(pairs(), scratch / "one", on(1));
    run(pairs(), scratch / "two", on(2));
    CHECK(tables(scratch / "one") == tables(scratch / "two"));
    run(pairs(3), scratch / "three", on(2));
    CHECK(tables(scratch / "one") != tables(scratch / "three")); // the comparison can fail
}

TEST_CASE("A scan of beds that is stopped inside its runs goes on to the same bytes", "[threads]") {
    const Scratch scratch;
    run(pairs(), scratch / "whole", on(1));
    int stops = 0;
    StageEnd end = StageEnd::interrupted;
    for (; end == StageEnd::interrupted && stops < 1000; ++stops) {
        std::atomic<int> asked{0};
        app::RunContext context = on(2);
        context.stop = [&] { return ++asked > 60; };
        end = run(pairs(), scratch / "stopped", context);
    }
    CHECK(end == StageEnd::finished);
    CHECK(stops > 3);
    CHECK(tables(scratch / "stopped") == tables(scratch / "whole"));
    CHECK_FALSE(fs::exists(scratch / "stopped/points/0001/runs/0001/checkpoint.rwc"));
}

TEST_CASE("More runs go on with a finished scan of beds") {
    const Scratch scratch;
    run(pairs(1), scratch / "grown");
    const auto before = fs::last_write_time(scratch / "grown/points/0002/runs/0001/summary.json");
    CHECK(run(pairs(3), scratch / "grown") == StageEnd::finished);
    CHECK(fs::last_write_time(scratch / "grown/points/0002/runs/0001/summary.json") == before);
    run(pairs(3), scratch / "whole");
    CHECK(tables(scratch / "grown") == tables(scratch / "whole"));
    CHECK_THROWS_AS(run(pairs(3), scratch / "grown"), InputError); // finished
}

TEST_CASE("A point that fails is a value, and evaluated again it goes on") {
    const Scratch scratch;
    const std::string near = "[scan]\n[[scan.axes]]\nkey = \"granular.rods.0.position.1\"\n"
                             "values = [\"-6 a\", \"6 a\"]\n"; // in the other rod
    CHECK(run(pairs(2, near), scratch / "scan") == StageEnd::incomplete);
    const auto scan = json_of(scratch / "scan/scan.json");
    CHECK(scan.at("failed") == 2);
    CHECK(scan.at("causes").size() == 1);
    CHECK(has(scan.at("causes").begin().key(), "overlap"));
    CHECK(column(scratch / "scan/scan.csv", "failed_runs") == std::vector<double>{2.0, 0.0});
    CHECK(has(content(scratch / "scan/scan.csv"), ",,,exception,0,2,"));
}

TEST_CASE("A run whose time is up is a value, and one that is given more goes on") {
    const Scratch scratch;
    run(pairs(1), scratch / "whole");
    scene::Scene hasty = pairs(1);
    hasty.scan->time_limit = 1e-9;
    CHECK(run(hasty, scratch / "scan") == StageEnd::incomplete);
    CHECK(has(content(scratch / "scan/scan_runs.csv"), "time_limit"));
    app::RunContext again;
    again.scan.rerun_failed = true;
    CHECK(run(pairs(1), scratch / "scan", again) == StageEnd::finished);
    CHECK(tables(scratch / "scan") == tables(scratch / "whole"));
}

TEST_CASE("Force does a scan of beds anew") {
    const Scratch scratch;
    run(pairs(3), scratch / "scan");
    app::RunContext force;
    force.force = true;
    CHECK(run(pairs(1), scratch / "scan", force) == StageEnd::finished);
    CHECK(column(scratch / "scan/scan.csv", "runs") == std::vector<double>(4, 1.0));
    CHECK_FALSE(fs::exists(scratch / "scan/points/0001/runs/0003"));
}

TEST_CASE("A bed without a pair has the means of its bed and rods") {
    const Scratch scratch;
    const scene::Scene scene = scene::parse_scene(
        beads + "runs = 2\n" + outputs + "[[granular.rods]]\nposition = [\"15 a\", \"15 a\"]\n" +
            "[scan]\n[[scan.axes]]\nkey = \"granular.plates.gamma\"\nvalues = [6.0, 7.0]\n",
        "bed.toml");
    CHECK(run(scene, scratch / "scan") == StageEnd::finished);
    const std::string header =
        content(scratch / "scan/scan.csv").substr(0, content(scratch / "scan/scan.csv").find('\n'));
    CHECK(has(header, "psi6,psi6_error"));
    CHECK(has(header, "mean_speed0,mean_speed0_error"));
    CHECK_FALSE(has(header, "contact"));
    CHECK(json_of(scratch / "scan/scan.json").at("outcomes").at("finished") == 4);
    CHECK(undescribed(scratch / "scan").empty());
}
