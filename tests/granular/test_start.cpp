// Starts: nothing overlaps (looked at pair by pair), the right numbers, and the same state for the same seed.

#include "rodwake/core/error.hpp"
#include "starts.hpp"

using namespace starts;

TEST_CASE("a bed settles slower the denser it is, and fastest from a lattice") {
    using granular::settling_time;
    using granular::Start;
    CHECK(settling_time(Start::lattice, 0.8) == 0.5);
    for (const auto& [phi_b, time] : {std::pair{0.0, 1.0},
                                      {0.60, 1.0},
                                      {0.65, 1.5},
                                      {0.70, 2.0},
                                      {0.71, 5.0},
                                      {0.72, 8.0},
                                      {0.76, 10.0},
                                      {0.78, 17.0},
                                      {0.80, 24.0},
                                      {0.9, 24.0}})
        CHECK(settling_time(Start::random, phi_b) == Approx(time).epsilon(1e-13)); // rounding of phi_b
}

TEST_CASE("a lattice start overlaps nowhere, from thin to nearly closest packing, at any angle") {
    for (const double phi : {0.05, 0.3, 0.7, 0.8, 0.88})
        for (const double orientation : {0.0, 0.5 * M_PI, 0.3}) {
            auto problem = bed(phi, Start::lattice);
            problem.orientation = orientation;
            check_start(problem);
        }
}

TEST_CASE("rods find room in a lattice") {
    for (const double phi : {0.05, 0.8, 0.88})
        for (const double heading : {0.0, 1.1}) {
            auto problem = bed(phi, Start::lattice);
            add_rod(problem, 20, 46.5, heading);
            add_rod(problem, 77, 1, -heading); // across the edge of the box
            problem.rods[1].imposed_speed = 1e-3;
            check_start(problem);
        }
}

TEST_CASE("a random start overlaps nowhere, with and without rods, in thick and thin layers") {
    for (const double phi : {0.05, 0.5, 0.8, 0.85}) {
        auto problem = bed(phi, Start::random);
        check_start(problem);
        add_rod(problem, 20, 46.5, 0.5);
        add_rod(problem, 0, 0, 2.0);
        check_start(problem);
    }
    auto thin = bed(0.8, Start::random);
    thin.plates.gap = 2.001 * a; // beads cannot pass over each other
    check_start(thin);
}

TEST_CASE("the search for overlaps sees beads, rods and plates") {
    auto problem = bed(0.5, Start::lattice, 30.0);
    add_rod(problem, 10, 10, 0.4);
    const State sound = make_start(problem, 0);
    REQUIRE(clearance(sound, problem) > 0.0);
    State state = sound;
    state.beads.x[3] = state.beads.x[0] + 1.999 * a + 5 * problem.box.x; // an image
    state.beads.y[3] = state.beads.y[0];
    CHECK(clearance(state, problem) < 0.0);
    state = sound;
    state.beads.x[3] = 10 * a;
    state.beads.y[3] = 10 * a;
    CHECK(clearance(state, problem) < -a);
    state = sound;
    state.beads.z[3] = floor_height(problem) + 0.999 * a;
    CHECK(clearance(state, problem) == Approx(-0.001 * a).epsilon(1e-9)); // rounding of z over 1e-3 a
    state = sound;
    state.rods[0].position.z() =
        floor_height(problem) + 0.66e-3; // 0.05 mm is free above the thick end at mid gap
    CHECK(clearance(state, problem) == Approx(-0.01e-3).epsilon(1e-9));
}

TEST_CASE("small boxes and single bodies start too") {
    for (const double phi : {0.05, 0.3, 0.6})
        check_start(bed(phi, Start::lattice, 8.0));
    check_start(bed(0.7, Start::random, 9.0));
    GranularProblem lone;
    add_rod(lone, 39, 39, 1.0);
    check_start(lone);
    auto crowd = bed(0.3, Start::lattice, 78.0);
    for (int i = 0; i < 5; ++i)
        for (int j = 0; j < 15; ++j)
            add_rod(crowd, 7.0 + 15 * i, 5 * j, i % 2 * M_PI);
    check_start(crowd);
}

TEST_CASE("what cannot be packed is said, with the density and what to try") {
    auto full = bed(0.9, Start::random, 30.0);
    full.plates.gap = 2.001 * a; // a flat random layer of 0.9 does not exist
    std::string words;
    try {
        make_start(full, 0);
    } catch (const RunError& error) {
        words = error.what();
    }
    CHECK_THAT(words, Catch::Contains("phi_b = 0.9") && Catch::Contains("bead radii") &&
                          Catch::Contains("start = \"lattice\""));
    CHECK_THROWS_AS(make_start(bed(0.95, Start::lattice), 0), InputError);
}

TEST_CASE("beads lie near the middle of the gap, wherever the plates are at the start") {
    for (const std::int64_t equilibration : {0, 30, 125, 1'000'000'007}) {
        auto problem = bed(0.7, Start::lattice);
        problem.equilibration_steps = equilibration;
        add_rod(problem, 20, 46.5, 0.7);
        const State state = make_start(problem, 0);
        // 1e9 steps are 4e6 periods: the phase is good to 4e6 * 2 pi * 1e-16
        const double middle = floor_height(problem) + 0.6e-3;
        CHECK(std::abs(state.rods[0].position.z() - middle) < 0.01 * 0.1e-3 + 1e-8 * middle);
        CHECK(state.rods[0].heading() == Approx(0.7).epsilon(1e-14));
        CHECK(state.rods[0].velocity.head<2>().norm() + std::abs(state.rods[0].angular_momentum.z()) == 0.0);
        CHECK(*std::max_element(state.beads.z.begin(), state.beads.z.end()) < middle + 0.01 * 0.2e-3 + 1e-12);
        CHECK(clearance(state, problem) > 0.0);
    }
}

TEST_CASE("velocities are normal, with the asked spread and no mean") {
    const auto problem = bed(0.8, Start::lattice, 200.0);
    const State state = make_start(problem, 0);
    const double n = static_cast<double>(problem.beads), s = problem.start_speed;
    for (const auto* v : {&state.beads.vx, &state.beads.vy, &state.beads.vz}) {
        CHECK(std::abs(mean(*v, 1)) < 1e-15 * s * n);                          // rounding of the sum
        CHECK(mean(*v, 2) == Approx(s * s).epsilon(4.0 * std::sqrt(2.0 / n))); // four standard errors
        CHECK(mean(*v, 4) == Approx(3.0 * s * s * s * s).epsilon(4.0 * std::sqrt(96.0 / n) / 3.0));
    }
    double product = 0.0;
    for (std::size_t i = 0; i < problem.beads; ++i)
        product += state.beads.vx[i] * state.beads.vy[i] / (n * s * s);
    CHECK(std::abs(product) < 4.0 / std::sqrt(n));
    CHECK(mean(state.beads.wx, 2) + mean(state.beads.wy, 2) + mean(state.beads.wz, 2) == 0.0);
}

TEST_CASE("a start depends on seed and run only") {
    for (const Start kind : {Start::lattice, Start::random}) {
        auto problem = bed(0.75, kind);
        add_rod(problem, 20, 46.5, 0.5);
        const auto first = state_hash(make_start(problem, 3));
        CHECK(state_hash(make_start(problem, 3)) == first);
        CHECK(state_hash(make_start(problem, 4)) != first);
        problem.seed = 2;
        CHECK(state_hash(make_start(problem, 3)) != first);
    }
}

TEST_CASE("rods lie a little off mid gap and move up or down, each in its own way in each run") {
    GranularProblem problem;
    add_rod(problem, 20, 20, 0.0);
    add_rod(problem, 20, 40, 1.0);
    problem.rods[1].imposed_speed = 1e-3;
    const double middle = floor_height(problem) + 0.6e-3, most = 0.01 * 0.1e-3; // 0.1 mm is free
    std::vector<double> height, speed, pitch, roll;
    const rodwake::granular::Clump clump = rodwake::granular::make_clump({});
    const double pitch_unit = clump.transverse_inertia * problem.start_speed / clump.reach();
    const double roll_unit = clump.axial_inertia * problem.start_speed / 0.55e-3;
    for (std::uint32_t run = 0; run < 500; ++run)
        for (const auto& rod : make_start(problem, run).rods) {
            const Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(rod.axis());
            pitch.push_back(rod.angular_momentum.dot(across) / pitch_unit);
            roll.push_back(rod.angular_momentum.dot(rod.axis()) / roll_unit);
            height.push_back((rod.position.z() - middle) / most);
            speed.push_back(rod.velocity.z() / problem.start_speed);
        }
    const double n = static_cast<double>(height.size());
    CHECK(*std::max_element(height.begin(), height.end()) < 1.0);
    CHECK(*std::min_element(height.begin(), height.end()) > -1.0);
    // Four standard errors of the moments of a uniform and of a normal number.
    CHECK(std::abs(mean(height, 1)) < 4.0 / std::sqrt(3.0 * n));
    CHECK(std::abs(mean(height, 2) - 1.0 / 3.0) < 4.0 * std::sqrt(4.0 / 45.0 / n));
    CHECK(std::abs(mean(speed, 1)) < 4.0 / std::sqrt(n));
    CHECK(std::abs(mean(speed, 2) - 1.0) < 4.0 * std::sqrt(2.0 / n));
    for (const auto* turning : {&pitch, &roll}) {
        CHECK(std::abs(mean(*turning, 1)) < 4.0 / std::sqrt(n));
        CHECK(std::abs(mean(*turning, 2) - 1.0) < 4.0 * std::sqrt(2.0 / n));
    }
    std::sort(speed.begin(), speed.end());
    CHECK(std::adjacent_find(speed.begin(), speed.end()) == speed.end());
    problem.start_speed = 0.0;
    CHECK(make_start(problem, 0).rods[1].velocity.norm() == 0.0);
    problem.seed = 2;
    CHECK(make_start(problem, 0).rods[1].position.z() != make_start(problem, 1).rods[1].position.z());
}

TEST_CASE("numbers of a bead do not depend on how many others there are") {
    auto few = bed(0.1, Start::random), many = bed(0.2, Start::random);
    const State small = make_start(few, 0), large = make_start(many, 0);
    for (std::size_t i = 1; i < few.beads; ++i) // differences: the means that are removed are not the same
        REQUIRE(small.beads.vx[i] - small.beads.vx[0] ==
                Approx(large.beads.vx[i] - large.beads.vx[0]).margin(1e-16));
}

TEST_CASE("a hundred thousand beads start at random", "[.][long]") {
    auto problem = bed(0.8, Start::random, 626.0);
    add_rod(problem, 300, 300, 0.5);
    REQUIRE(problem.beads > 99'000);
    check_start(problem);
}
