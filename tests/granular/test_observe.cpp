// Order, temperatures and the record of a run against direct formulas.

#include "beds.hpp"

#include "rodwake/granular/record.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>

using namespace rodwake;
using namespace rodwake::granular;

namespace {

const double a = GranularProblem{}.bead_radius;

struct Points {
    std::vector<double> x, y;
    double box;
};

/// A perfect triangular lattice cannot close in a square; the triangles here are equilateral in a strip of
/// it.
Points triangle_patch(double spacing, double turn) {
    Points p;
    p.box = 100.0 * spacing;
    for (int i = -6; i <= 6; ++i)
        for (int j = -6; j <= 6; ++j) {
            const double u = spacing * (i + 0.5 * j), v = spacing * std::sqrt(0.75) * j;
            p.x.push_back(u * std::cos(turn) - v * std::sin(turn));
            p.y.push_back(u * std::sin(turn) + v * std::cos(turn));
        }
    return p;
}

Points random_points(std::size_t count, double box, std::uint64_t seed) {
    RandomStream random(seed);
    Points p{{}, {}, box};
    for (std::size_t i = 0; i < count; ++i) {
        p.x.push_back(random.uniform(-2.0 * box, 2.0 * box));
        p.y.push_back(random.uniform(-2.0 * box, 2.0 * box));
    }
    return p;
}

std::vector<std::complex<double>> plain_psi6(const Points& p, double cutoff) {
    std::vector<std::complex<double>> psi(p.x.size());
    for (std::size_t i = 0; i < p.x.size(); ++i) {
        int near = 0;
        for (std::size_t j = 0; j < p.x.size(); ++j) {
            const double dx = std::remainder(p.x[j] - p.x[i], p.box),
                         dy = std::remainder(p.y[j] - p.y[i], p.box);
            if (i == j || std::hypot(dx, dy) >= cutoff)
                continue;
            psi[i] += std::polar(1.0, 6.0 * std::atan2(dy, dx));
            ++near;
        }
        if (near > 0)
            psi[i] /= near;
    }
    return psi;
}

std::complex<double> mean(const std::vector<std::complex<double>>& psi) {
    std::complex<double> sum = 0.0;
    for (const auto& p : psi)
        sum += p;
    return sum / static_cast<double>(psi.size());
}

} // namespace

TEST_CASE("psi_6 is 1 inside a perfect crystal, whatever its direction") {
    for (const double turn : {0.0, 0.3, 1.0}) {
        const Points p = triangle_patch(1.0, turn);
        const auto psi = local_psi6(p.x, p.y, p.box, 1.4);
        for (const std::size_t middle : {84u, 70u}) { // all six neighbours are there
            CHECK(std::abs(std::abs(psi[middle]) - 1.0) < 1e-14);
            CHECK(std::abs(psi[middle] - std::polar(1.0, 6.0 * turn)) <
                  1e-13); // 6 x rounding of places up to 10
        }
        CHECK(std::abs(global_psi6(p.x, p.y, p.box, 1.4) - 1.0) <
              1e-14); // edges miss neighbours, not directions
    }
}

TEST_CASE("psi_6 equals the sum over all pairs") {
    for (const double box : {4.0, 10.0, 40.0}) {
        const Points p = random_points(200, box, 51);
        const auto psi = local_psi6(p.x, p.y, box, 1.5), wanted = plain_psi6(p, 1.5);
        double worst = 0.0;
        for (std::size_t i = 0; i < psi.size(); ++i)
            worst = std::max(worst, std::abs(psi[i] - wanted[i]));
        CHECK(worst < 1e-12); // 6 x rounding of places of 80 over bonds of 0.01 and more
        CHECK(global_psi6(p.x, p.y, box, 1.5) == Approx(std::abs(mean(wanted))).margin(1e-12));
    }
    const Points p = random_points(50, 10.0, 51);
    CHECK(std::abs(mean(plain_psi6(p, 1.5)) - mean(plain_psi6(p, 1.6))) > 1e-6); // the check can fail
}

TEST_CASE("places at random have psi_6 of about 1/sqrt(N)") {
    const std::size_t count = 2000;
    double squares = 0.0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Points p = random_points(count, 60.0, 100 + seed);
        squares += std::pow(global_psi6(p.x, p.y, 60.0, 2.0), 2) / 20.0;
    }
    const double rms = std::sqrt(squares) * std::sqrt(static_cast<double>(count));
    CHECK(rms > 0.5); // neighbours share bonds, so not exactly 1; 20 draws scatter by 16 %
    CHECK(rms < 2.0);
}

TEST_CASE("psi_6 of nothing is 0") {
    CHECK(global_psi6({}, {}, 1.0, 0.1) == 0.0);
    CHECK(global_psi6({0.5}, {0.5}, 1.0, 0.1) == 0.0);
    CHECK(local_psi6({0.5, 0.5}, {0.5, 0.5}, 1.0, 0.1)[0] == 0.0); // on the same spot: no direction
}

TEST_CASE("temperatures are variances about the motion of all") {
    GranularProblem problem;
    problem.beads = 300;
    problem.box = 45 * a;
    State state = make_start(problem, 0);
    for (std::size_t i = 0; i < 300; ++i)
        state.beads.vz[i] += 0.7; // all together
    const Beads& b = state.beads;
    const auto variance = [](const std::vector<double>& v) {
        long double sum = 0.0, squares = 0.0;
        for (const double x : v)
            sum += x;
        for (const double x : v)
            squares += (x - sum / v.size()) * (x - sum / v.size());
        return static_cast<double>(squares / v.size());
    };
    const Temperatures T = Simulation(problem, state).temperatures();
    CHECK(T.xy == Approx((variance(b.vx) + variance(b.vy)) / 2.0).epsilon(1e-13));
    CHECK(T.z == Approx(variance(b.vz)).epsilon(1e-12)); // rounding of 0.7 in velocities of 0.02
    for (std::size_t i = 0; i < 300; ++i) {
        state.beads.vz[i] = 0.1;
        state.beads.vx[i] = state.beads.vy[i] = 0.3;
    }
    const Temperatures cold = Simulation(problem, state).temperatures();
    CHECK(cold.xy >= 0.0);
    CHECK(cold.z >= 0.0);
    CHECK(cold.z < 1e-30);
}

TEST_CASE("energy adds up") {
    GranularProblem problem;
    problem.beads = 1;
    problem.rods.push_back(beds::long_rod(20 * a, 20 * a, 0.0));
    State state = make_start(problem, 0);
    state.beads.vx[0] = 0.3;
    state.beads.vy[0] = state.beads.vz[0] = 0.0;
    state.beads.wx[0] = 100.0;
    state.rods[0].velocity = {0.0, 0.2, 0.0};
    state.rods[0].angular_momentum = {0.0, 0.0, 1e-9};
    const Clump clump = make_clump(problem.rods[0].shape);
    const double m = 4.0 / 3.0 * M_PI * a * a * a * 2700.0;
    const Energy energy = Simulation(problem, state).energy();
    CHECK(energy.kinetic == Approx(m * 0.09 / 2 + 0.4 * m * a * a * 1e4 / 2 + clump.mass * 0.04 / 2 +
                                   1e-18 / clump.transverse_inertia / 2)
                                .epsilon(1e-12));
    CHECK(energy.potential ==
          Approx(9.81 * (m * state.beads.z[0] + clump.mass * state.rods[0].position.z())).epsilon(1e-12));
}

namespace {

GranularProblem two_rods(double speed) {
    GranularProblem problem;
    problem.beads = 100;
    problem.box = 40 * a;
    problem.rods = {beds::long_rod(20 * a, 14 * a, -0.2), beds::long_rod(20 * a, 26 * a, 0.2)};
    for (RodSpec& rod : problem.rods)
        rod.imposed_speed = speed; // motion that is known beforehand
    problem.equilibration_steps = 100;
    problem.steps = 1000;
    return problem;
}

struct Written {
    std::vector<TableRow> table;
    std::vector<TrackPoint> track;
};

void go_on(Simulation& run, Record& record, Written& rows, std::int64_t until) {
    while (run.step() < until) {
        run.advance(10);
        REQUIRE_FALSE(run.failure());
        record.sample(run);
        if (run.step() % 100 == 0) {
            for (const TrackPoint& point : record.track(run))
                rows.track.push_back(point);
            rows.table.push_back(record.row(run));
        }
    }
}

} // namespace

TEST_CASE("travel and separation of rods on known courses") {
    const double speed = 0.5;
    const GranularProblem problem = two_rods(speed);
    Simulation run(problem, make_start(problem, 0));
    Record record(3.0 * a, 2);
    Written rows;
    go_on(run, record, rows, 1100);
    const double time = 1000 * problem.time_step;
    for (const RodProgress& rod : record.rods())
        CHECK(rod.travelled == Approx(speed * time).epsilon(1e-11)); // rounding of 1000 sums
    CHECK(record.mean_advance() == Approx(speed * time).epsilon(1e-11));
    // rod 0 is below and heads down by 0.2 rad, rod 1 above and up: they part across the mean heading, +x
    CHECK(record.sums().pair.change == Approx(2.0 * speed * time * std::sin(0.2)).epsilon(1e-11));
    const double half = problem.box / 2.0 / (speed * std::cos(0.2));
    CHECK(half < time);
    CHECK(record.sums().pair.half_box_time >= half * (1.0 - 1e-12));
    CHECK(record.sums().pair.half_box_time < half + 11 * problem.time_step); // a sample every ten steps
    CHECK(record.sums().pair.half_box_change ==
          Approx(2.0 * speed * record.sums().pair.half_box_time * std::sin(0.2)).epsilon(1e-11));
    REQUIRE(rows.track.size() == 2 * 11);
    CHECK(rows.track.back().speed == Approx(speed).epsilon(1e-9));
    CHECK(rows.track.back().heading == Approx(0.2).epsilon(1e-12));
    CHECK(rows.track[0].speed == 0.0); // held still before t = 0
}

TEST_CASE("rows are means over their interval") {
    const GranularProblem problem = two_rods(0.0);
    Simulation run(problem, make_start(problem, 0));
    run.advance(100);
    Record record(3.0 * a, 2);
    record.sample(run);
    record.row(run);
    const std::int64_t overlaps = run.tallies().overlaps;
    double T_xy = 0.0, T_z = 0.0;
    for (int k = 0; k < 25; ++k) {
        run.advance(4);
        T_xy += run.temperatures().xy / 25.0;
        T_z += run.temperatures().z / 25.0;
        record.sample(run);
    }
    const TableRow row = record.row(run);
    CHECK(row.T_xy == Approx(T_xy).epsilon(1e-13));
    CHECK(row.T_z == Approx(T_z).epsilon(1e-13));
    CHECK(row.t == run.time());
    CHECK(row.contacts == static_cast<double>(run.tallies().overlaps - overlaps) / 100.0);
    CHECK(row.energy == run.energy().kinetic + run.energy().potential);
    CHECK(row.psi6 == run.psi6(3.0 * a));
    CHECK(record.sums().run.count == 26);
    CHECK(record.sums().run.T_z / 26.0 != Approx(row.T_z).epsilon(1e-6)); // with the first sample
}

TEST_CASE("a record that is stored and restored writes the same rows") {
    const GranularProblem problem = two_rods(0.05);
    const State start = make_start(problem, 0);
    Simulation run(problem, start);
    Record record(3.0 * a, 2);
    Written rows;
    go_on(run, record, rows, 1100);
    for (const std::int64_t stop : {50, 100, 130, 790}) {
        Simulation first(problem, start);
        Record begun(3.0 * a, 2);
        Written all;
        go_on(first, begun, all, stop);
        Simulation second(problem, first.state(), first.tallies());
        Record resumed(3.0 * a, 2);
        resumed.restore(begun.sums(), begun.rods());
        go_on(second, resumed, all, 1100);
        CAPTURE(stop);
        REQUIRE(all.table.size() == rows.table.size());
        REQUIRE(all.track.size() == rows.track.size());
        CHECK(std::memcmp(all.table.data(), rows.table.data(), rows.table.size() * sizeof(TableRow)) == 0);
        CHECK(std::memcmp(all.track.data(), rows.track.data(), rows.track.size() * sizeof(TrackPoint)) == 0);
        CHECK(std::memcmp(&record.sums(), &resumed.sums(), sizeof(RecordSums)) == 0);
    }
}
