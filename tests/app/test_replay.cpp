#include "bed/granular_checkpoint.hpp"
#include "rodwake/app/granular.hpp"
#include "rodwake/app/replay.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/granular/simulation.hpp"
#include "rodwake/granular/start.hpp"
#include "rodwake/scene/read.hpp"
#include "store/scratch.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using Catch::Contains;

namespace {

constexpr const char* small_bed =
    "schema = 1\n[granular]\nphi_b = 0.6\nbox = \"12 a\"\nequilibrate = 0.0\nduration = 0.1\n";

/// Three states of a run, 500 steps apart.
app::GranularArchive kept_run() {
    const auto problem = app::granular_problem(scene::parse_scene(small_bed, "bed"));
    app::GranularArchive archive{small_bed, "test", problem.seed, 0, {granular::make_start(problem, 0)}};
    granular::Simulation simulation(problem, archive.states.front());
    for (int k = 0; k < 2; ++k) {
        simulation.advance(500);
        archive.states.push_back(simulation.state());
    }
    return archive;
}

} // namespace

TEST_CASE("An archive that is made again is the same to the bit", "[replay]") {
    const store_test::Scratch folder;
    app::write_archive(folder.path() / "archive.rwc", kept_run());
    const app::Verified found = app::verify(folder.path(), {});
    CHECK(found.stretches == 2);
    CHECK_FALSE(found.differs);
}

TEST_CASE("A bit that differs is found in its stretch", "[replay]") {
    const store_test::Scratch folder;
    app::GranularArchive archive = kept_run();
    double& x = archive.states[2].beads.x[3];
    x = std::nextafter(x, 1.0);
    app::write_archive(folder.path() / "archive.rwc", archive);
    const app::Verified found = app::verify(folder.path(), {});
    REQUIRE(found.differs);
    CHECK_THAT(*found.differs, Contains("bead 3 is at"));
    archive.states[2].beads.x[3] = std::nan("");
    archive.states[1].beads.wx[0] += 1.0; // also begins the second stretch otherwise
    app::write_archive(folder.path() / "archive.rwc", archive);
    CHECK_THAT(app::verify(folder.path(), {}).differs.value_or(""), Contains("spins or rods differ"));
}

TEST_CASE("The state before a step is the last one kept", "[replay]") {
    const app::GranularArchive archive = kept_run();
    CHECK(archive.before(-1) == nullptr);
    CHECK(archive.before(0)->step == 0);
    CHECK(archive.before(499)->step == 0);
    CHECK(archive.before(500)->step == 500);
    CHECK(archive.before(5000)->step == 1000);
}

TEST_CASE("What an archive or a checkpoint sizes loops and lists by is looked at first", "[replay]") {
    const store_test::Scratch folder;
    const auto file = folder.path() / "archive.rwc";
    const auto refused = [&](const char* why, const auto& damage) {
        app::GranularArchive archive = kept_run();
        damage(archive.states);
        app::write_archive(file, archive);
        CHECK_THROWS_WITH(app::verify(file, {}), Contains(file.string() + ": ") && Contains(why));
    };
    using States = std::vector<granular::State>;
    refused("a state of step 4611686018427387904", [](States& s) { s.back().step = std::int64_t{1} << 62; });
    refused("a state of step -1", [](States& s) { s.front().step = -1; });
    refused("is not in order", [](States& s) { s[2].step = 500; });
    refused("lists of the beads", [](States& s) { s[1].beads.wz.pop_back(); });
    refused("lists of the beads", [](States& s) { s[0].beads.x.clear(); });
    refused("beads and 0 rods at step 500", [](States& s) { s[1].beads.resize(3); });
    refused("beads and 1 rods at step 1000", [](States& s) { s[2].rods.resize(1); });
    refused("and its scene has", [](States& s) {
        for (granular::State& state : s)
            state.beads.resize(3);
    });
    app::GranularCheckpoint checkpoint;
    checkpoint.state = kept_run().states.back();
    checkpoint.progress.resize(2);
    app::write_checkpoint(folder.path() / "final.rwc", checkpoint);
    CHECK_THROWS_WITH(app::load_checkpoint(folder.path() / "final.rwc"), Contains("2 have a path"));
}
