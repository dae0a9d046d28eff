// How many noisy runs are wanted: the rule, and the interval that is left of it.

#include "bed/granular_checkpoint.hpp"
#include "rodwake/app/granular.hpp"
#include "rodwake/app/replay.hpp"
#include "rodwake/app/rods.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/granular/simulation.hpp"
#include "rodwake/granular/start.hpp"
#include "rodwake/scan/proportion.hpp"
#include "rodwake/scene/read.hpp"
#include "store/scratch.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>

using namespace rodwake;
using Catch::Contains;

namespace {

app::NoisePlan plan_of(std::uint32_t runs, std::optional<double> error, std::uint32_t most) {
    return {{}, runs, error, most};
}

/// Runs of which every `every`-th is captured.
rods::NoiseSums captured_each(std::size_t runs, std::size_t every) {
    rods::NoiseSums sums;
    for (std::size_t i = 0; i < runs; ++i)
        sums.ends.push_back({false, i % every == 0 ? Ending::contact : Ending::escape, 1.0, 1.0, 0, 1});
    return sums;
}

double half_width(std::int64_t count, std::int64_t of) {
    const auto [low, high] = scan::Proportion{count, of}.wilson(scan::quantile_95);
    return 0.5 * (high - low);
}

} // namespace

TEST_CASE("Runs grow by half until the capture probability is known well enough") {
    CHECK(app::wanted_runs({}, 2, plan_of(20, {}, 1000)) == 20);
    CHECK(app::wanted_runs(captured_each(20, 2), 2, plan_of(20, {}, 1000)) == 20);
    const app::NoisePlan plan = plan_of(20, 0.1, 1000);
    CHECK(app::wanted_runs({}, 2, plan) == 20);
    CHECK(app::wanted_runs(captured_each(20, 2), 2, plan) == 30);
    CHECK(app::wanted_runs(captured_each(25, 2), 2, plan) == 30); // taken up in the middle
    CHECK(app::wanted_runs(captured_each(68, 2), 2, plan) == 102);
    CHECK(half_width(34, 68) > 0.1);
    CHECK(app::wanted_runs(captured_each(102, 2), 2, plan) == 102);
    CHECK(half_width(51, 102) <= 0.1);
    CHECK(app::wanted_runs(captured_each(20, 1), 2, plan) == 20); // all captured: +- 0.08
    CHECK(app::wanted_runs(captured_each(68, 2), 2, plan_of(20, 0.1, 70)) == 70);
    CHECK(app::wanted_runs(captured_each(70, 2), 2, plan_of(20, 0.1, 70)) == 70);
    CHECK(app::wanted_runs(captured_each(20, 2), 2, plan_of(20, 0.1, 10)) == 20); // most_runs below runs
    CHECK(app::wanted_runs(captured_each(20, 2), 1, plan) == 20);                 // none can be captured
    rods::NoiseSums failed = captured_each(20, 2);
    failed.ends[3].failed = true;
    CHECK(app::wanted_runs(failed, 2, plan) == 20);
}

TEST_CASE("The interval holds the true probability nearly as often as one of fixed runs") {
    // 95 % and what stopping costs: above 91 % at each probability (1000 sets: +- 0.7 %).
    constexpr int sets = 1000;
    for (const double p : {0.03, 0.2, 0.5, 0.9}) {
        int held = 0;
        std::set<std::size_t> sizes;
        for (int set = 0; set < sets; ++set) {
            RandomStream random(17, static_cast<std::uint32_t>(set));
            rods::NoiseSums sums;
            const app::NoisePlan plan = plan_of(20, 0.08, 10'000);
            while (sums.ends.size() < app::wanted_runs(sums, 2, plan))
                sums.ends.push_back(
                    {false, random.uniform() < p ? Ending::pursuit : Ending::undecided, 1.0, 1.0, 0, 1});
            const rods::CaptureCount captures = rods::count_captures(sums.ends, 2);
            const auto [low, high] = scan::Proportion{captures.count, captures.of}.wilson(scan::quantile_95);
            held += low <= p && p <= high;
            sizes.insert(sums.ends.size());
            CHECK(0.5 * (high - low) <= 0.08);
        }
        INFO("p = " << p << ": " << held << " of " << sets << ", most runs " << *sizes.rbegin());
        CHECK(held >= 910);
        CHECK(*sizes.rbegin() <= 153); // 20 grown by half five times; a half needs 146
    }
}

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
