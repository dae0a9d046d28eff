// Order, temperatures and the record of a run against direct formulas.

#include "beds.hpp"

#include "rodwake/granular/record.hpp"
#include "rodwake/granular/state.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

using namespace rodwake;
using namespace rodwake::granular;
using granular::State;

namespace {

const double a = GranularProblem{}.bead_radius;

} // namespace

TEST_CASE("the cut-off lies between the shells of the lattice of this density") {
    for (const double phi_b : {0.3, 0.7, 0.9}) {
        GranularProblem problem; // spacing d of N = L^2/(sqrt(3)/2 d^2) sites that cover phi_b
        const double d = std::sqrt(2.0 * M_PI / std::sqrt(3.0) / phi_b) * problem.bead_radius;
        const double cutoff = neighbour_cutoff(problem.bead_radius, phi_b);
        CHECK(cutoff == Approx(1.4 * d).epsilon(1e-5)); // 0.9069 is pi/sqrt(12) to 3e-6
        CHECK(cutoff > 1.2 * d);
        CHECK(cutoff < 1.6 * d); // the second shell is at 1.73 d
    }
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
    problem.time_step = 2e-5; // rods this fast push beads deep in a longer one
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
    const double half = problem.box.x / 2.0 / (speed * std::cos(0.2));
    CHECK(half < time);
    CHECK(record.sums().pair.half_box_time >= half * (1.0 - 1e-12));
    CHECK(record.sums().pair.half_box_time < half + 11 * problem.time_step); // a sample every ten steps
    CHECK(record.sums().pair.half_box_change ==
          Approx(2.0 * speed * record.sums().pair.half_box_time * std::sin(0.2)).epsilon(1e-11));
    REQUIRE(rows.track.size() == 2 * 11);
    CHECK(rows.track.back().speed == Approx(speed).epsilon(1e-9));
    CHECK(rows.track.back().heading == Approx(0.2).epsilon(1e-11)); // rounding of some 5000 turns
    CHECK(rows.track[0].speed == 0.0);                              // held still before t = 0
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
        resumed.restore(begun.sums(), begun.pressure_sums(), begun.rods(), begun.thrust(), begun.kinds());
        go_on(second, resumed, all, 1100);
        CAPTURE(stop);
        REQUIRE(all.table.size() == rows.table.size());
        REQUIRE(all.track.size() == rows.track.size());
        CHECK(std::memcmp(all.table.data(), rows.table.data(), rows.table.size() * sizeof(TableRow)) == 0);
        CHECK(std::memcmp(all.track.data(), rows.track.data(), rows.track.size() * sizeof(TrackPoint)) == 0);
        CHECK(std::memcmp(&record.sums(), &resumed.sums(), sizeof(RecordSums)) == 0);
        CHECK(std::memcmp(&record.pressure_sums(), &resumed.pressure_sums(), sizeof(PressureSums)) == 0);
        CHECK(std::memcmp(record.thrust().data(), resumed.thrust().data(), 2 * sizeof(RodThrust)) == 0);
    }
}

TEST_CASE("a free rod keeps what the plates give it and the beads do not take") {
    GranularProblem problem = two_rods(0.0);
    problem.rods.resize(1); // two would push each other
    problem.rods[0].imposed_speed = std::nullopt;
    Simulation run(problem, make_start(problem, 0));
    Record record(3.0 * a, 1);
    Written rows;
    go_on(run, record, rows, 100); // held until t = 0
    const Counters before = run.tallies();
    const Eigen::Vector3d velocity = run.rod(0).velocity;
    go_on(run, record, rows, 1100);
    const Eigen::Vector3d plates = run.tallies().impulse_from_plates[0] - before.impulse_from_plates[0],
                          beads = run.tallies().impulse_on_beads[0] - before.impulse_on_beads[0],
                          gained = make_clump(problem.rods[0].shape).mass * (run.rod(0).velocity - velocity);
    // rounding of some 1000 impulses; the height has gravity besides
    CHECK((plates - beads - gained).head<2>().norm() < 1e-11 * plates.norm());
    CHECK(beads.head<2>().norm() > 1e-3 * plates.norm());
    const double heading = record.rods()[0].heading; // hardly turned: along it as at the end
    CHECK(record.thrust()[0].impulse ==
          Approx(plates.x() * std::cos(heading) + plates.y() * std::sin(heading)).epsilon(0.1));
}

TEST_CASE("a bed that bounces in step with the plates is in an absorbing state, one that moves is not") {
    for (const double frequency : {150.0, 200.0}) { // at Gamma = 7 the first is absorbing
        GranularProblem problem;
        problem.box = 20 * a;
        problem.beads = 99;
        problem.plates.frequency = frequency;
        Simulation run(problem, make_start(problem, 0));
        CHECK_FALSE(in_absorbing_state(run.temperatures(), problem));
        run.advance(30'000);
        CHECK(in_absorbing_state(run.temperatures(), problem) == (frequency == 150.0));
    }
    GranularProblem problem;
    problem.beads = 1; // has no temperature
    CHECK_FALSE(in_absorbing_state({}, problem));
    problem.beads = 2;
    CHECK(in_absorbing_state({}, problem));
    problem.plates.gamma = 0.0; // at rest
    CHECK_FALSE(in_absorbing_state({}, problem));
}

// --- The hash sees every number of a state; headings are in (-pi, pi]

namespace {

State some_state() {
    State state;
    state.step = 7;
    state.beads.resize(3);
    for (auto* array : {&state.beads.x, &state.beads.y, &state.beads.z, &state.beads.vx, &state.beads.vy,
                        &state.beads.vz, &state.beads.wx, &state.beads.wy, &state.beads.wz})
        *array = {0.5, 0.25, 0.125};
    state.rods.resize(2);
    return state;
}

/// Pointers to all numbers of a state.
std::vector<double*> numbers(State& state) {
    std::vector<double*> all;
    auto& b = state.beads;
    for (auto* array : {&b.x, &b.y, &b.z, &b.vx, &b.vy, &b.vz, &b.wx, &b.wy, &b.wz})
        for (double& number : *array)
            all.push_back(&number);
    for (auto& rod : state.rods) {
        for (int k = 0; k < 3; ++k)
            all.insert(all.end(), {&rod.position[k], &rod.velocity[k], &rod.angular_momentum[k]});
        for (int k = 0; k < 4; ++k)
            all.push_back(&rod.orientation.coeffs()[k]);
    }
    return all;
}

granular::RodBody turned(double angle) {
    granular::RodBody rod;
    rod.orientation = Eigen::Quaterniond(std::cos(0.5 * angle), 0.0, 0.0, std::sin(0.5 * angle));
    return rod;
}

} // namespace

TEST_CASE("every number changes the hash, by its last bit") {
    State state = some_state();
    std::set<std::uint64_t> seen{state_hash(state)};
    CHECK(state_hash(some_state()) == *seen.begin());
    const auto all = numbers(state);
    REQUIRE(all.size() == 3 * 9 + 2 * 13);
    for (double* number : all) {
        const double before = *number;
        *number = std::nextafter(before, 2.0);
        CHECK(seen.insert(state_hash(state)).second);
        *number = before;
    }
    state.step = 8;
    CHECK(seen.insert(state_hash(state)).second);
    state.step = 7;
    state.beads.x[0] = 0.0;
    seen.insert(state_hash(state));
    state.beads.x[0] = -0.0; // equal as a number, not as a state
    CHECK(seen.insert(state_hash(state)).second);
}

TEST_CASE("resizing keeps all arrays of one length and fills with rest") {
    granular::Beads beads;
    beads.resize(5);
    for (const auto* array :
         {&beads.x, &beads.y, &beads.z, &beads.vx, &beads.vy, &beads.vz, &beads.wx, &beads.wy, &beads.wz})
        CHECK(*array == std::vector<double>(5, 0.0));
    beads.resize(2);
    CHECK(beads.size() == 2);
    CHECK(beads.wz.size() == 2);
}

TEST_CASE("a heading is the angle of the axis' shadow") {
    for (const double angle : {0.0, 0.3, -2.0, 3.0})
        CHECK(turned(angle).heading() == Approx(angle).margin(1e-15)); // rounding
    CHECK(turned(4.0).heading() == Approx(4.0 - 2.0 * M_PI));
    granular::RodBody back; // axis (-1, -0, 0) exactly: still +pi
    back.orientation = Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0);
    CHECK(back.heading() == M_PI);
    back.orientation = Eigen::Quaterniond(0.0, 0.0, 0.0, -1.0);
    CHECK(back.heading() == M_PI);
    auto pitched = turned(0.7); // thin end up by 0.2 rad: the shadow stays
    pitched.orientation = pitched.orientation * Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY());
    CHECK(pitched.axis().z() > 0.1);
    CHECK(pitched.heading() == Approx(0.7).epsilon(1e-14));
}

TEST_CASE("velocities of the spheres are the rates of their positions") {
    const std::vector<granular::Clump> clumps = {granular::make_clump({})};
    const granular::Clump& clump = clumps[0];
    State state;
    state.beads.resize(1);
    state.beads.x[0] = 0.3;
    state.beads.vy[0] = -0.2;
    granular::RodBody rod;
    rod.position = {0.1, 0.2, 0.3};
    rod.velocity = {0.01, -0.02, 0.03};
    rod.orientation = Eigen::Quaterniond(0.9, 0.1, -0.3, 0.2).normalized();
    rod.angular_momentum = clump.transverse_inertia * Eigen::Vector3d(2.0, -1.0, 3.0);
    state.rods = {rod};
    const Eigen::Vector3d axis = rod.axis(), L = rod.angular_momentum;
    const Eigen::Vector3d along = axis * axis.dot(L),
                          spin = along / clump.axial_inertia + (L - along) / clump.transverse_inertia;
    const auto at = [&](double time) {
        State moved = state;
        moved.beads.y[0] += time * state.beads.vy[0];
        moved.rods[0].position += time * rod.velocity;
        moved.rods[0].orientation =
            Eigen::AngleAxisd(time * spin.norm(), spin.normalized()) * rod.orientation;
        return sphere_positions(moved, clumps);
    };
    const double step = 1e-5;
    const auto before = at(-step), after = at(step), rates = sphere_velocities(state, clumps);
    REQUIRE(rates.size() == 3 * (1 + clump.offset.size()));
    REQUIRE(before.size() == rates.size());
    double worst = 0.0, turning = 0.0;
    for (std::size_t k = 0; k < rates.size(); ++k) {
        worst = std::max(worst, std::abs((after[k] - before[k]) / (2.0 * step) - rates[k]));
        turning = std::max(turning, k < 3 ? 0.0 : std::abs(rates[k] - rod.velocity[static_cast<int>(k % 3)]));
    }
    CHECK(worst < 1e-9);   // (spin step)^2 of turning is 1e-12, rounding of 0.3 over the step 1e-11
    CHECK(turning > 1e-3); // m/s: the spin counts
    CHECK(clump.sphere_mass() * static_cast<double>(clump.radius.size()) ==
          Approx(clump.mass).epsilon(1e-15));
}
