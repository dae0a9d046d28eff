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
    "schema = 1\n[granular]\nphi_b = 0.6\nbox = \"12 a\"\nequilibrate = 0.0\nduration = 0.05\n";

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
