// Displacement by local phases, on wakes whose field is known.

#include "measured_wake.hpp"

#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace rodwake;
using namespace rodwake::measure;
using namespace measure_test;
using synthetic::reduced;
using synthetic::saved;

namespace {

/// Noise-free: what the method itself does wrong. 3.5: outside it 2 % hold for all media of the long test;
/// the next bins in, whose cells reach to 1.6 from the rod, see up to 3.5 %.
void check_bias(const Comparison& outer, const Comparison& inner) {
    CHECK(outer.bias_x < 0.02);
    CHECK(outer.bias_y < 0.02);
    CHECK(inner.bias_x < 0.036);
    CHECK(inner.bias_y < 0.02);
    CHECK(outer.rms < 0.0015);
    CHECK(std::abs(outer.mean_x) < 0.001); // the core's part of the box's mean: 7 of 6084 bins
    CHECK(outer.bins > 6000.0);
}

void check_unbiased(const WakeSetup& setup, std::size_t frames) {
    const SyntheticWake wake(setup);
    const auto field = measured(wake, {}, frames);
    INFO("eta " << setup.medium.eta << " xi " << setup.medium.xi << " f/mu " << setup.strength << " rows "
                << setup.lattice_angle << " heading " << setup.heading);
    check_bias(compare(field, truth_of(wake), 3.5), compare(field, truth_of(wake), 3.0));
    CHECK(field.mean_speed == Approx(setup.speed).epsilon(1e-9)); // constant speed
}

WakeSetup noisy() {
    WakeSetup setup;
    setup.noise = 0.1;
    setup.medium = {1.3, 20.0};
    return setup;
}

} // namespace

TEST_CASE("phase recovers the field without bias", "[displacement]") {
    WakeSetup setup;
    setup.medium = {1.3, 20.0};
    check_unbiased(setup, 200);
    setup.lattice_angle = M_PI / 6.0;
    setup.heading = M_PI / 2.0;
    setup.medium = {5.0, 5.0};
    setup.strength = 3.0;
    check_unbiased(setup, 200);
}

TEST_CASE("phase is unbiased for all media, strengths, lattices and headings", "[.][long]") {
    for (const double eta : {0.3, 1.3, 5.0})
        for (const double strength : {1.0, 2.2, 3.0})
            for (const double xi : {5.0, 20.0})
                for (const double angle : {0.0, M_PI / 6.0})
                    for (const double heading : {0.0, M_PI / 2.0, M_PI}) {
                        WakeSetup setup;
                        setup.medium = {eta, xi};
                        setup.strength = strength;
                        setup.lattice_angle = angle;
                        setup.heading = heading;
                        check_unbiased(setup, 200);
                    }
}

TEST_CASE("the field does not depend on the spacing of its grid", "[displacement]") {
    WakeSetup setup;
    setup.medium = {1.3, 20.0};
    const SyntheticWake wake(setup);
    DisplacementOptions options;
    options.spacing = 2.0; // of the other tests 1, which hides what is not scaled
    const auto field = measured(wake, options, 200);
    const Comparison outer = compare(field, truth_of(wake), 3.5);
    CHECK(outer.bins > 1400.0);
    CHECK(outer.bias_x < 0.02); // as displacement.hpp says
    CHECK(outer.bias_y < 0.02);
}

TEST_CASE("phase states its errors, and the comparison sees what is wrong", "[displacement]") {
    const SyntheticWake wake(noisy());
    const auto field = measured(wake, {}, 400);
    const auto good = compare(field, truth_of(wake), 3.5);
    // 12 blocks and 4 borrowed: mean of t^2 with 15 degrees of freedom 1.15; some 1500 independent cells:
    // 0.04
    CHECK(good.chi2_x > 0.7);
    CHECK(good.chi2_x < 1.5);
    CHECK(good.chi2_y > 0.7);
    CHECK(good.chi2_y < 1.5);
    CHECK(good.rms < 0.012);
    CHECK(field.coherence[0] == Approx(std::exp(-0.5 * 0.01 * 3.4 * 3.4)).margin(0.02)); // exp(-(G s)^2/2)
    const auto mirrored = compare(field, truth_of(wake, 1.0, -1.0), 3.5);
    CHECK(mirrored.chi2_y > 10.0);
    CHECK(mirrored.bias_y > 0.2);
    const auto strong = compare(field, truth_of(wake, 1.1), 3.5);
    CHECK(strong.chi2_x > 2.0);
    CHECK(strong.bias_x > 0.05);
}

TEST_CASE("a rod that keeps its place between the rows makes no difference", "[displacement]") {
    WakeSetup setup = noisy();
    setup.drift_x = setup.drift_y = 0.0; // rows along x: no bead between them but by noise
    const SyntheticWake wake(setup);
    const auto good = compare(measured(wake, {}, 400), truth_of(wake), 3.5);
    CHECK(good.rms < 0.012);
    CHECK(good.bias_x < 0.05);
    CHECK(good.bias_y < 0.05);
    CHECK(good.bins > 6000.0); // those between the rows too
}

TEST_CASE("what a rod sees, a force that moves alike sees too", "[displacement]") {
    WakeSetup setup;
    setup.heading = M_PI / 2.0;
    const SyntheticWake wake(setup);
    const RodPosition first = wake.frame(0).rods[0], later = wake.frame(10).rods[0];
    const double time = wake.frame(10).time - wake.frame(0).time;
    Layout layout = wake.layout();
    layout.rods = 0;
    layout.headings.clear();
    const double vx = (later.x - first.x) / time, vy = (later.y - first.y) / time, t0 = wake.frame(0).time;
    layout.force = MovingForce{first.x - vx * t0, first.y - vy * t0, vx, vy, first.heading};
    const Frames frames = frames_of(wake, 60);
    for (const auto method : {DisplacementMethod::phase, DisplacementMethod::lagrangian}) {
        DisplacementOptions options;
        options.method = method;
        options.spacing = 2.0;
        DisplacementAccumulator of_rod(wake.layout(), options), of_force(layout, options);
        layout.force->x += 4.0; // seen from elsewhere
        DisplacementAccumulator elsewhere(layout, options);
        layout.force->x -= 4.0;
        for (Frame frame : frames) {
            of_rod.add(frame);
            frame.rods.clear();
            of_force.add(frame);
            elsewhere.add(frame);
        }
        const DisplacementField rod = reduced(of_rod), force = reduced(of_force), moved = reduced(elsewhere);
        CHECK(force.mean_speed == Approx(rod.mean_speed));
        REQUIRE(force.grid.bins() == rod.grid.bins());
        double largest = 0.0;
        for (std::size_t j = 0; j < rod.grid.bins(); ++j)
            largest = std::max(largest, std::hypot(rod.Ux[j], rod.Uy[j]));
        CHECK(largest > 0.1);
        const auto bins_apart = [&](const DisplacementField& other) {
            std::size_t apart = 0;
            for (std::size_t j = 0; j < rod.grid.bins(); ++j)
                apart += std::hypot(other.Ux[j] - rod.Ux[j], other.Uy[j] - rod.Uy[j]) > 1e-6 * largest;
            return apart;
        };
        // places differ by rounding, so a bead on the edge of a bin may change sides: of few bins that counts
        CHECK(bins_apart(force) < rod.grid.bins() / 50);
        CHECK(bins_apart(moved) > rod.grid.bins() / 2);
    }
    layout.force.reset();
    CHECK_THROWS_AS(DisplacementAccumulator(layout, {}), InputError);
}

TEST_CASE("mirror images halve the variance and keep the signs", "[displacement]") {
    const SyntheticWake wake(noisy());
    const Frames frames = frames_of(wake, 200);
    DisplacementOptions options;
    const auto single = compare(measured(wake, options, frames), truth_of(wake), 3.5);
    options.mirror = true;
    const auto field = measured(wake, options, frames);
    const auto both = compare(field, truth_of(wake), 3.5);
    CHECK(both.rms == Approx(single.rms / std::sqrt(2.0)).epsilon(0.1)); // 1500 independent cells: 2 %
    CHECK(both.chi2_y < 1.6);
    for (const double u : profile(field, "Uy", "x", 0.0).value)
        CHECK(u == 0.0);
}

TEST_CASE("reference far: the far field's mean is 0 and the field differs by a constant", "[displacement]") {
    WakeSetup setup;
    const SyntheticWake wake(setup);
    const Frames frames = frames_of(wake, 100);
    DisplacementOptions options;
    const auto box = measured(wake, options, frames);
    options.reference = Reference::far;
    const auto far = measured(wake, options, frames);
    double sum = 0.0, count = 0.0;
    for (std::size_t j = 0; j < far.grid.bins(); ++j)
        if (std::hypot(far.grid.x_of(j), far.grid.y_of(j)) > 0.3 * 78.0) {
            sum += far.Ux[j];
            count += 1.0;
        }
    CHECK(std::abs(sum / count) < 1e-12); // rounding
    const std::size_t a = 10 * far.grid.columns + 20, b = 60 * far.grid.columns + 55;
    CHECK(far.Ux[a] - box.Ux[a] ==
          Approx(far.Ux[b] - box.Ux[b]).margin(1e-3)); // places shift by the constant
    CHECK(std::abs(far.Ux[a] - box.Ux[a]) > 0.01);
}

TEST_CASE("an accumulator goes on to the bit after it was saved", "[displacement]") {
    const SyntheticWake wake(noisy());
    const Frames frames = frames_of(wake, 80);
    for (const auto method :
         {DisplacementMethod::phase, DisplacementMethod::lagrangian, DisplacementMethod::density}) {
        DisplacementOptions options;
        options.method = method;
        options.spacing = 2.0;
        DisplacementAccumulator whole(wake.layout(), options), parts = whole;
        for (std::size_t k = 0; k < frames.size(); ++k) {
            if (k == 37) {
                CHECK(saved(parts) == saved(whole));
                parts = synthetic::through_packing(parts, DisplacementAccumulator(wake.layout(), options));
            }
            whole.add(frames[k]);
            if (k == 37)
                CHECK(saved(parts) != saved(whole));
            parts.add(frames[k]);
        }
        CHECK(saved(parts) == saved(whole));
        CHECK(reduced(parts).Ux == reduced(whole).Ux);
    }
}

TEST_CASE("runs of different lattices and headings are put together", "[displacement]") {
    WakeSetup setup = noisy();
    const SyntheticWake along(setup);
    setup.lattice_angle = M_PI / 6.0;
    setup.heading = M_PI / 2.0;
    setup.beads = static_cast<long>(along.layout().beads);
    const SyntheticWake across(setup);
    REQUIRE(across.layout() == along.layout());
    const DisplacementAccumulator runs[] = {accumulator_of(along, {}, frames_of(along, 200)),
                                            accumulator_of(across, {}, frames_of(across, 200))};
    const auto both = compare(reduce(runs), truth_of(along), 3.5);
    const auto one = compare(reduced(runs[0]), truth_of(along), 3.5);
    CHECK(both.rms == Approx(one.rms / std::sqrt(2.0)).epsilon(0.15)); // 1500 independent cells: 2 %
    CHECK(both.chi2_x < 1.5);
}

TEST_CASE("profiles are rows and columns of the grid", "[displacement]") {
    const SyntheticWake wake(noisy());
    const auto field = measured(wake, {}, 50);
    const auto line = profile(field, "Uy", "x", 4.1);
    CHECK(line.place.size() == 78);
    const auto at = static_cast<std::size_t>(std::ranges::find(line.place, -7.0) - line.place.begin());
    REQUIRE(at < line.place.size());
    const std::size_t bin = (39 + 4) * 78 + (39 - 7);
    CHECK(line.value[at] == field.Uy[bin]);
    CHECK(line.sigma[at] == field.sigma_y[bin]);
    CHECK(profile(field, "Ux", "y", 0.0).value[10] == field.Ux[10 * 78 + 39]);
    CHECK_THROWS_AS(profile(field, "U", "x", 0.0), InputError);
    CHECK_THROWS_AS(profile(field, "Ux", "z", 0.0), InputError);
    CHECK_THROWS_AS(profile(field, "Ux", "x", 100.0), InputError);
}

// --- Displacement of beads from their places before, and by the density's phases: where they work and where
// not

namespace {

/// What beads are displaced by since they were 0.3 L to 0.45 L ahead of the rod, at the same y; mean over the
/// box 0.
Truth since_zone(const SyntheticWake& wake) {
    const double box = wake.layout().box.x;
    const auto zone = [&wake, box](double y) {
        elastic::Vector mean;
        for (int k = 0; k < 15; ++k) {
            const auto u = wake.truth((0.305 + 0.01 * k) * box, y);
            mean.x += u.x / 15.0;
            mean.y += u.y / 15.0;
        }
        return mean;
    };
    elastic::Vector all;
    for (int k = 0; k < 78; ++k) {
        all.x += zone(k * box / 78.0).x / 78.0;
        all.y += zone(k * box / 78.0).y / 78.0;
    }
    return [&wake, zone, all](double x, double y) {
        const auto u = wake.truth(x, y), before = zone(y);
        return elastic::Vector{u.x - before.x + all.x, u.y - before.y + all.y};
    };
}

/// A rod that moves by one lattice spacing along the rows from frame to frame.
WakeSetup locked() {
    WakeSetup setup;
    setup.medium = {1.3, 20.0};
    setup.drift_x = setup.drift_y = 0.0;
    setup.speed = 78.0 / 37.0 / setup.interval;
    return setup;
}

WakeSetup quick_passes() {
    WakeSetup setup;
    setup.medium = {1.3, 20.0};
    setup.speed = 7.9;
    return setup;
}

DisplacementField measured_by(DisplacementMethod method, const WakeSetup& setup, std::size_t frames) {
    DisplacementOptions options;
    options.method = method;
    return measured(SyntheticWake(setup), options, frames);
}

double mean_coherence(const DisplacementField& field) {
    double sum = 0.0, count = 0.0;
    for (std::size_t j = 0; j < field.grid.bins(); ++j)
        if (field.count[j] > 0.0) {
            sum += field.coherence[j];
            count += 1.0;
        }
    return sum / count;
}

/// Mean U_x on the rod's line, 10 to 20 behind it.
double behind(const DisplacementField& field) {
    double sum = 0.0;
    const auto line = profile(field, "Ux", "x", 0.0);
    for (std::size_t k = 0; k < line.place.size(); ++k)
        sum += line.place[k] >= -20.0 && line.place[k] <= -10.0 ? line.value[k] / 11.0 : 0.0;
    return sum;
}

} // namespace

namespace {

/// Beads of two sizes that rattle in their cages, with a memory of three frames.
WakeSetup rattling(double noise, std::uint64_t seed) {
    WakeSetup setup = quick_passes();
    setup.two_sizes = true;
    setup.beads = 1000; // phi_b = 0.76
    setup.noise = noise;
    setup.noise_time = 0.3;
    setup.seed = seed;
    return setup;
}

/// A measured field, less its mean over the zone ahead at the same y.
Truth since_zone(const DisplacementField& field) {
    const RodGrid& grid = field.grid;
    std::vector<Vector2> zone(grid.rows);
    for (std::size_t row = 0; row < grid.rows; ++row) {
        double count = 0.0;
        for (std::size_t k = row * grid.columns; k < (row + 1) * grid.columns; ++k)
            if (grid.x_of(k) > 0.3 * grid.box.x && grid.x_of(k) < 0.45 * grid.box.x) {
                zone[row].x += field.Ux[k];
                zone[row].y += field.Uy[k];
                count += 1.0;
            }
        zone[row] = {zone[row].x / count, zone[row].y / count};
    }
    Vector2 all;
    for (const Vector2& one : zone)
        all = {all.x + one.x / static_cast<double>(grid.rows),
               all.y + one.y / static_cast<double>(grid.rows)};
    return [&field, zone, all](double x, double y) {
        const std::size_t bin = *field.grid.bin(x, y);
        const Vector2& before = zone[bin / field.grid.columns];
        return elastic::Vector{field.Ux[bin] - before.x + all.x, field.Uy[bin] - before.y + all.y};
    };
}

} // namespace

TEST_CASE("lagrangian is relative to the place far ahead, which the box's images displace",
          "[displacement]") {
    const SyntheticWake wake(quick_passes());
    const auto field = measured_by(DisplacementMethod::lagrangian, quick_passes(), 400); // four passes
    const auto relative = compare(field, since_zone(wake), 4.0);
    CHECK(relative.rms < 0.005); // 0.003 is found, largest 0.021 and 0.008
    CHECK(relative.bias_x < 0.03);
    CHECK(relative.bias_y < 0.03);
    CHECK(relative.bins > 5600.0);                             // all but those at the zone's front edge
    const auto absolute = compare(field, truth_of(wake), 3.5); // its bias in a box of 78, as documented: 13 %
    CHECK(absolute.bias_x > 0.1);
    CHECK(absolute.bias_x < 0.18);
}

TEST_CASE("lagrangian needs no lattice: beds of two sizes", "[displacement]") {
    for (const std::uint64_t seed : {1, 2}) {
        const WakeSetup setup = rattling(0.01, seed);
        const SyntheticWake wake(setup);
        const auto found =
            compare(measured_by(DisplacementMethod::lagrangian, setup, 400), since_zone(wake), 4.0);
        CHECK(found.bias_x < 0.03); // the issue of the estimator asks for 3 %
        CHECK(found.bias_y < 0.03);
        CHECK(found.bins > 5600.0);
    }
    CHECK_THROWS_AS(measured_by(DisplacementMethod::phase, rattling(0.0, 1), 5), RunError);
}

/// With 12 blocks and 4 borrowed the mean of t^2 with 15 degrees of freedom is 1.15, and 1500 independent
/// cells scatter by 0.04, two seeds of them by 0.03; found is 0.95 (slow noise) to 1.25. It was 1.7 in x
/// while beads in the zone were compared with their mean place so far.
void check_calibrated(double speed, double noise_time, std::size_t frames, std::uint64_t seeds) {
    double chi2_x = 0.0, chi2_y = 0.0;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        WakeSetup setup = rattling(0.2, seed);
        setup.speed = speed;
        setup.noise_time = noise_time;
        const SyntheticWake wake(setup);
        const auto found =
            compare(measured_by(DisplacementMethod::lagrangian, setup, frames), since_zone(wake), 4.0);
        chi2_x += found.chi2_x / static_cast<double>(seeds);
        chi2_y += found.chi2_y / static_cast<double>(seeds);
    }
    CAPTURE(speed, noise_time);
    for (const double chi2 : {chi2_x, chi2_y}) {
        CHECK(chi2 > 0.85);
        CHECK(chi2 < 1.35);
    }
}

TEST_CASE("lagrangian states its errors where beads rattle", "[displacement]") {
    check_calibrated(7.9, 0.0, 400, 2);
}

TEST_CASE("lagrangian states its errors over many seeds, and where beads diffuse", "[.][long]") {
    check_calibrated(7.9, 0.3, 200, 20);
    check_calibrated(4.8, 0.3, 200, 20);
    check_calibrated(7.9, 3.0, 200, 20);
}

TEST_CASE("in a crystal lagrangian agrees with phase, which takes part in the zone off", "[displacement]") {
    WakeSetup setup = rattling(0.1, 1);
    setup.two_sizes = false;
    const auto phase = measured_by(DisplacementMethod::phase, setup, 300);
    const auto lagrangian = measured_by(DisplacementMethod::lagrangian, setup, 300);
    const auto apart = compare(lagrangian, since_zone(phase), 4.0);
    CHECK(apart.chi2_x < 1.5);
    CHECK(apart.chi2_y < 1.5);
    CHECK(compare(lagrangian, [&phase](double x, double y) {
              const std::size_t bin = *phase.grid.bin(x, y);
              return elastic::Vector{phase.Ux[bin], phase.Uy[bin]};
          }).chi2_x > 2.0);
}

TEST_CASE("slip by lattice spacings: lagrangian sees it, phase does not", "[displacement]") {
    WakeSetup setup = quick_passes();
    const auto both_methods = [&] {
        const SyntheticWake wake(setup);
        const Frames frames = frames_of(wake, 200);
        return std::pair(behind(measured(wake, {.method = DisplacementMethod::phase}, frames)),
                         behind(measured(wake, {.method = DisplacementMethod::lagrangian}, frames)));
    };
    const auto [plain_phase, plain_lagrangian] = both_methods();
    setup.slip_within = 2.0;
    const auto [phase, lagrangian] = both_methods();
    CHECK(phase == Approx(plain_phase).margin(0.01)); // rows slip on at the rod, where no phase is
    CHECK(lagrangian - plain_lagrangian > 0.8 * SyntheticWake(setup).spacing());
}

TEST_CASE("density works for a rod locked to the rows", "[displacement]") {
    WakeSetup setup = locked();
    const SyntheticWake wake(setup);
    const auto field = measured_by(DisplacementMethod::density, setup, 60);
    const auto outer = compare(field, truth_of(wake), 8.0);
    CHECK(outer.bias_x < 0.02);
    CHECK(outer.bias_y < 0.02);
    const auto near = compare(field, truth_of(wake), 3.5); // blurred by its window, as documented: 4.4 %
    CHECK(near.bias_x > 0.025);
    CHECK(near.bias_x < 0.06);
    CHECK(mean_coherence(field) > 0.95);
}

TEST_CASE("density smears for a rod that is not locked, and says so", "[displacement]") {
    WakeSetup setup;
    setup.medium = {1.3, 20.0};
    const SyntheticWake wake(setup);
    const auto field = measured_by(DisplacementMethod::density, setup, 400);
    CHECK(mean_coherence(field) < 0.5);
    CHECK(compare(field, truth_of(wake), 8.0).bias_x > 0.1);
    CHECK(mean_coherence(measured_by(DisplacementMethod::phase, setup, 100)) > 0.95);
}
