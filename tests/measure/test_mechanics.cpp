// Drag of the bed from a push and a drift that are known.

#include "synthetic.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/measure/drift_decay.hpp"
#include "rodwake/measure/mechanics.hpp"

#include <catch2/catch.hpp>

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

// --- The inertia of a drift that is known: whole beds that obey a Langevin equation, with and without a
// rod's force.

namespace {

constexpr double inertia_true = 1.3, drag = 13.0, decay = drag / inertia_true, h = 5e-3, mass = 1e-3;
constexpr double fast = 150.0; // 1/s: spins follow velocities
constexpr Estimate drag_rate{drag, 0.0, 8};

/// A component of a drift: m* M V' = F - drag M V + noise, and a part that is gone at once. Noise such that
/// the slow part has the variance 0.8 and the fast one 0.2, in (m/s)^2; F of variance (drag M)^2 times
/// `force`^2, memory 0.2 s.
struct Component {
    std::vector<double> place{0.0}, impulse{0.0};

    Component(Normal& normal, std::size_t frames, double force, double steady) {
        const double keep = std::exp(-decay * h), keep_fast = std::exp(-fast * h),
                     keep_force = std::exp(-5.0 * h);
        const auto next = [&normal](double value, double kept, double rms) {
            return kept * value + rms * std::sqrt(1.0 - kept * kept) * normal();
        };
        double slow = std::sqrt(0.8) * normal(), quick = std::sqrt(0.2) * normal(), f = force * normal(),
               before = slow + quick;
        for (std::size_t i = 1; i < frames; ++i) {
            slow = next(slow, keep, std::sqrt(0.8)) + (1.0 - keep) * (steady + f);
            quick = next(quick, keep_fast, std::sqrt(0.2));
            impulse.push_back(impulse.back() + h * drag * mass * (steady + f));
            place.push_back(place.back() + 0.5 * h * (before + slow + quick));
            before = slow + quick;
            f = next(f, keep_force, force);
        }
    }
};

/// Runs of `seconds` each; with a force along x, its impulses are reported.
std::vector<DriftPath> runs_of(std::uint64_t seed, std::size_t count, double seconds, double force = 0.0) {
    Normal normal(seed);
    std::vector<DriftPath> runs(count);
    for (DriftPath& run : runs) {
        const auto frames = static_cast<std::size_t>(std::lround(seconds / h)) + 1;
        const Component x(normal, frames, force, 0.5), y(normal, frames, 0.0, 0.0);
        for (std::size_t i = 0; i < frames; ++i)
            run.time.push_back(1.0 + h * static_cast<double>(i));
        run.x = x.place;
        run.y = y.place;
        if (force > 0.0) {
            run.impulse_x = x.impulse;
            run.impulse_y.assign(frames, 0.0);
        }
    }
    return runs;
}

DriftDecay decay_of(const std::vector<DriftPath>& runs, const Estimate& d = drag_rate) {
    return drift_decay(runs, mass, d, {});
}

/// How often the truth lies within an error, and the mean of m*.
struct Coverage {
    double within = 0.0, mean = 0.0, error = 0.0;
};

Coverage coverage(int sets, std::size_t count, double seconds, double force) {
    Coverage c;
    for (int set = 0; set < sets; ++set) {
        const DriftDecay r = decay_of(runs_of(static_cast<std::uint64_t>(set) + 1, count, seconds, force));
        REQUIRE(r.inertia.count == count * static_cast<std::size_t>(seconds / 5.0));
        c.within += (std::abs(r.inertia.value - inertia_true) < r.inertia.error ? 1.0 : 0.0) / sets;
        c.mean += r.inertia.value / sets;
        c.error += r.inertia.error / sets;
    }
    return c;
}

} // namespace

TEST_CASE("drift decay: the inertia of a free drift, and its error") {
    constexpr int sets = 150;
    const Coverage c = coverage(sets, 2, 20.0, 0.0);
    INFO(c.mean << " +- " << c.error << ", within " << c.within);
    // 2 % of a ratio whose parts scatter by a tenth, and 3 errors of the mean
    CHECK(std::abs(c.mean - inertia_true) < 0.02 * inertia_true + 3.0 * c.error / std::sqrt(sets));
    CHECK(c.error < 0.2 * inertia_true);
    CHECK(c.within > 0.53); // 65 % of Student's t with 7 degrees, +- 3 x 3.9 %
    CHECK(c.within < 0.77);
}

TEST_CASE("drift decay: a rod's force that fluctuates slowly is part of the balance") {
    constexpr int sets = 100;
    const Coverage c = coverage(sets, 2, 40.0, 0.7);
    INFO(c.mean << " +- " << c.error << ", within " << c.within);
    CHECK(std::abs(c.mean - inertia_true) < 0.02 * inertia_true + 3.0 * c.error / std::sqrt(sets));
    CHECK(c.within > 0.52); // 66 % with 15 degrees, +- 3 x 4.7 %
    CHECK(c.within < 0.80);
}

TEST_CASE("drift decay: where the force is left out, or the drag is another, m* is wrong") {
    const std::vector<DriftPath> pushed = runs_of(7, 6, 60.0, 0.7);
    const DriftDecay whole = decay_of(pushed);
    CHECK(std::abs(whole.inertia.value - inertia_true) < 3.0 * whole.inertia.error);
    CHECK(whole.coupling > 0.1);
    std::vector<DriftPath> silent = pushed;
    for (DriftPath& run : silent) {
        run.impulse_x.assign(run.time.size(), 0.0); // the component along x alone, as with the force
        run.impulse_y = run.impulse_x;
    }
    const DriftDecay without = decay_of(silent);
    CHECK(without.inertia.value - inertia_true > 3.0 * without.inertia.error);
    const std::vector<DriftPath> free = runs_of(8, 6, 60.0);
    CHECK(decay_of(free, {2.0 * drag, 0.0, 8}).inertia.value - inertia_true > 3.0 * 0.1 * inertia_true);
    CHECK(decay_of(free, {2.0 * drag, 0.0, 8}).rate.value ==
          Approx(decay_of(free).rate.value)); // knows no drag
}

TEST_CASE("drift decay: the mean of a short run is made up for") {
    Coverage c;
    constexpr int sets = 40;
    for (int set = 0; set < sets; ++set) // 40 runs of 4 s: without it 15 % too fast
        c.mean += decay_of(runs_of(1000 + static_cast<std::uint64_t>(set), 40, 4.0)).rate.value / sets;
    CHECK(c.mean == Approx(decay).epsilon(0.03)); // 3 errors of 160 x 40 s, and the next order, 0.6 %
}

TEST_CASE("drift decay: the error of the drag goes in") {
    const std::vector<DriftPath> runs = runs_of(5, 4, 20.0);
    const double alone = decay_of(runs).inertia.error;
    const DriftDecay r = decay_of(runs, {drag, 0.3 * drag, 8});
    CHECK(r.inertia.error == Approx(std::hypot(alone, 0.3 * r.inertia.value)));
    CHECK(r.rate.error == Approx(decay_of(runs).rate.error));
}

TEST_CASE("drift decay: values that cannot be known are absent, with the reason") {
    std::vector<DriftPath> sparse = runs_of(3, 1, 20.0);
    for (double& t : sparse[0].time)
        t *= 10.0;
    CHECK(decay_of(sparse).rate.count == 0);
    CHECK_THAT(decay_of(sparse).absence, Contains("0.05 s apart") && Contains("shorten measure.interval"));
    CHECK_THAT(decay_of(runs_of(3, 1, 1.0)).absence, Contains("shorter than 2 s"));
    CHECK_THAT(decay_of(runs_of(3, 1, 20.0, 0.5), {}).absence, Contains("no drag rate"));
    std::vector<DriftPath> uneven = runs_of(3, 1, 20.0);
    uneven[0].time[9] += 1e-3;
    CHECK_THAT(decay_of(uneven).absence, Contains("evenly"));
    std::vector<DriftPath> still = runs_of(3, 1, 20.0);
    still[0].x.assign(still[0].time.size(), 0.0);
    still[0].y = still[0].x;
    CHECK_THAT(decay_of(still).absence, Contains("does not decay"));
    const DriftDecay undriven = decay_of(runs_of(3, 2, 20.0), {});
    CHECK(undriven.rate.count == 8);
    CHECK(undriven.inertia.count == 0); // no push
    std::vector<DriftPath> torn = runs_of(3, 1, 20.0);
    torn[0].y.pop_back();
    CHECK_THROWS_WITH(decay_of(torn), Contains("differ in length"));
    CHECK_THROWS_WITH(drift_decay(torn, mass, drag_rate, {0.0, 0.03}), Contains("finite and positive"));
}
