// Drag of the bed from a push and a drift that are known.

#include "catch2/catch.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/mechanics.hpp"
#include "synthetic.hpp"

#include <cmath>

using namespace rodwake;
using namespace rodwake::measure;
using namespace rodwake::measure::synthetic;
using Catch::Matchers::Contains;

namespace {

constexpr double a = 4e-4, gamma_true = 10.0, drift = 0.2 * a, rod_speed = -6.0 * a, heading = 0.5;

struct Run {
    MechanicsAccumulator frames;
    RodPushes pushes;
};

/// A bed of 20 beads that drifts steadily and diffuses, by `noise` in 0.1 s, pushed as its drag wants it, the
/// rod backwards.
Run pushed(std::uint64_t seed, double from, double until, double noise = 0.0) {
    const Layout layout = synthetic::layout(20, 1);
    Normal normal(seed);
    Run run{MechanicsAccumulator(layout, {2.0}), {}};
    const double mass = 20.0 * layout.bead_mass, push = -gamma_true * mass * drift;
    double walk = 0.0;
    for (int i = 0; 0.1 * i < until + 0.05; ++i) {
        const double t = 0.1 * i, way = -drift * t + (walk += noise * normal());
        run.pushes.time.push_back(t);
        run.pushes.impulse_x.push_back(push * t * std::cos(heading));
        run.pushes.impulse_y.push_back(push * t * std::sin(heading));
        run.pushes.advance.push_back(rod_speed * t);
        std::vector<double> x, y;
        for (int b = 0; b < 20; ++b) {
            x.push_back((3.0 * b) * a + way * std::cos(heading));
            y.push_back((70.0 + b) * a + way * std::sin(heading));
        }
        if (t >= from)
            run.frames.add(frame_of(layout, t, x, y, {{0.0, 0.0, heading}}));
    }
    return run;
}

MechanicsResult reduced(const Run& run, const Estimate& shear_speed = {}) {
    return measure::reduce(std::span(&run.frames, 1), std::span(&run.pushes, 1), shear_speed);
}

} // namespace

TEST_CASE("mechanics: drift, drag rate and screening length of a rod pulled backwards") {
    const Run run = pushed(1, 7.0, 20.0);
    const MechanicsResult r = reduced(run, {120.0 * a, 1.2 * a, 8});
    CHECK(r.blocks == 7); // 13 s; the last one is half as long
    CHECK(r.drift.value == Approx(drift));
    CHECK(r.force.value == Approx(gamma_true * 20.0 * 7.2e-7 * drift));
    CHECK(r.drag_rate.value == Approx(gamma_true));
    CHECK(r.speed.value == Approx(rod_speed + drift));
    CHECK(r.screening.value == Approx(120.0 * 120.0 / (10.0 * 5.8) * a));
    CHECK(r.screening.error / r.screening.value == Approx(0.02).epsilon(1e-6)); // twice that of c_T
    CHECK(r.peclet.value == Approx(78.0 * a / r.screening.value));
    CHECK(r.before == Approx(42.0 * a));
    CHECK(r.along == Approx(78.0 * a));
    CHECK(r.wanted == Approx(39.0 * a)); // half the box: xi is longer
    CHECK(r.steady);
    CHECK_FALSE(reduced(pushed(1, 5.0, 20.0)).steady); // 30 a before the first frame
    CHECK_FALSE(reduced(pushed(1, 7.0, 13.0)).steady); // 36 a measured
    CHECK(reduced(run).screening.count == 0);
}

TEST_CASE("mechanics: errors are those of the drift") {
    int within = 0;
    double mean_error = 0.0;
    constexpr int sets = 200;
    for (int set = 0; set < sets; ++set) {
        const MechanicsResult r = reduced(pushed(static_cast<std::uint64_t>(set) + 1, 0.0, 24.0, 0.01 * a));
        within += std::abs(r.drag_rate.value - gamma_true) < r.drag_rate.error;
        mean_error += r.drag_rate.error / gamma_true / sets;
    }
    CHECK(mean_error == Approx(0.032).epsilon(0.1)); // 0.01 a x sqrt(240) of 4.8 a
    CHECK(within > 0.56 * sets);                     // 66 % of Student's t with 11 degrees, +- 3 x 3.3 %
    CHECK(within < 0.76 * sets);
}

TEST_CASE("mechanics: stored and read back, the same bits; what cannot be measured is said") {
    const Run run = pushed(3, 1.0, 9.0, a);
    CHECK(saved(through_packing(run.frames, MechanicsAccumulator(run.frames.layout(), {2.0}))) ==
          saved(run.frames));
    Run cut = pushed(3, 1.0, 9.0);
    cut.pushes.time.resize(50);
    CHECK_THROWS_WITH(reduced(cut), Contains("no row of tracks.csv at t = 5 s"));
    CHECK_THROWS_WITH(reduced(pushed(3, 9.0, 9.0)), Contains("at least 2 frames"));
    CHECK_THROWS_WITH(MechanicsAccumulator(run.frames.layout(), {0.0}), Contains("finite and positive"));
    const Run still = pushed(3, 0.0, 9.0);
    RodPushes none = still.pushes;
    none.impulse_x.assign(none.time.size(), 0.0);
    none.impulse_y = none.impulse_x;
    CHECK(measure::reduce(std::span(&still.frames, 1), std::span(&none, 1), {}).drag_rate.count == 0);
}
