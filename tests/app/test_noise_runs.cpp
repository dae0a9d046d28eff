// How many noisy runs are wanted: the rule, and the interval that is left of it.

#include "rodwake/app/rods.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/scan/proportion.hpp"

#include <catch2/catch.hpp>

#include <set>

using namespace rodwake;

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
