// Steps with weights of the modes alone: with a mesh, and with inertia.

#include "reference_run.hpp"

#include "medium/exponential_step.hpp"
#include "medium/mode_step.hpp"
#include "rods/interaction.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

const elastic::Medium solid{0.7, 2.0}; // alpha = 1/2
const rods::Couplings couplings{4.0, 1.0, -0.5};

Coupled run(CoupledStep& method, Coupled state, double time, int steps) {
    std::vector<double> rates(state.poses.size());
    for (int i = 0; i < steps; ++i) {
        Coupled next;
        method.rates(state.poses, state.fields, rates);
        method.take(state, rates, time / steps, next);
        state = next;
    }
    return state;
}

} // namespace

TEST_CASE("forces and turning rates of a mesh are those of sums over the modes") {
    const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 47, .self_field = true};
    for (const rods::Couplings& c :
         {couplings, rods::Couplings{4.0, 0.0, 0.0}, rods::Couplings{0.0, 0.0, 2.0}}) {
        const ModalField modes(solid, medium);
        ThreadPool team(1);
        ModeMesh mesh(modes, medium.box, team);
        const std::vector<double> poses = tests::crowd(30, 12.0);
        std::vector<double> field(4 * modes.size()), forces(field.size()), sums(field.size()), rates(30),
            exact(30);
        for (std::size_t a = 0; a < 30; ++a) {
            const rods::Pose rod = rods::pose(poses, a);
            modes.add_steady(rod, field);
            const PhaseFactors x = phases(modes.qx, -rod.x), y = phases(modes.qy, -rod.y);
            const double nx = std::cos(rod.heading), ny = std::sin(rod.heading);
            for (std::size_t i = 0; i < modes.size(); ++i) {
                const Complex phase = Complex{x.re[i / modes.columns()], x.im[i / modes.columns()]} *
                                      Complex{y.re[i % modes.columns()], y.im[i % modes.columns()]};
                const double f = modes.force[i], ux = modes.unit_x[i], uy = modes.unit_y[i];
                sums[i] += f * (nx * ux + ny * uy) * phase.re;
                sums[modes.size() + i] += f * (nx * ux + ny * uy) * phase.im;
                sums[2 * modes.size() + i] += f * (ny * ux - nx * uy) * phase.re;
                sums[3 * modes.size() + i] += f * (ny * ux - nx * uy) * phase.im;
            }
        }
        mesh.forces(poses, forces);
        CHECK(tests::distance(forces, sums) < mesh_error * tests::largest(sums));
        mesh.turning(poses, field, c, rates);
        for (std::size_t a = 0; a < 30; ++a) {
            const rods::Direction n = rods::direction(poses, a);
            exact[a] = rods::turning_rate(
                modes.at(poses[3 * a], poses[3 * a + 1], rods::request_of(c, false), field), c,
                {n.cosine, n.sine});
        }
        CHECK(tests::distance(rates, exact) < mesh_error * tests::largest(exact));
    }
}

TEST_CASE(
    "steps with weights of modes alone are of order 4, without and with inertia, with and without a mesh") {
    for (const double inertia : {0.0, 0.2})
        for (const Evaluation way : {Evaluation::sums, Evaluation::mesh}) {
            const DynamicMedium medium{.box = 8.0,
                                       .force_width = 0.6,
                                       .modes = 16,
                                       .self_field = inertia > 0.0,
                                       .evaluation = way,
                                       .inertia = inertia};
            ModeStep method(solid, medium, couplings, 2, 1);
            const Coupled start = method.start({0.0, 1.5, -0.1, 0.3, -1.5, 0.2});
            const Coupled exact = run(method, start, 1.0, 320);
            const auto error = [&](int steps) {
                const Coupled end = run(method, start, 1.0, steps);
                return std::array{tests::distance(end.poses, exact.poses),
                                  tests::distance(end.fields, exact.fields)};
            };
            const auto middle = error(80), fine = error(160); // of coarser steps it is between 3 and 4
            for (std::size_t i = 0; i < 2; ++i) {
                CAPTURE(inertia, way == Evaluation::mesh, i, middle[i], fine[i]);
                CHECK(std::log2(middle[i] / fine[i]) == Approx(4.0).margin(0.4));
            }
        }
}

TEST_CASE("both frames of the force lead to the same rods and fields") {
    const DynamicMedium medium{.box = 8.0, .force_width = 0.6, .modes = 16};
    ModeStep fixed(solid, medium, couplings, 3, 1);
    ExponentialStep moving(solid, medium, couplings, 3, 1);
    const std::vector<double> poses{0.0, 1.5, -0.1, 0.3, -1.5, 0.2, 3.0, 0.0, 2.0};
    const Coupled one = run(fixed, fixed.start(poses), 1.0, 400),
                  two = run(moving, moving.start(poses), 1.0, 400);
    CHECK(fixed.start(poses).fields == moving.start(poses).fields);
    CHECK(tests::distance(one.poses, two.poses) < 1e-9); // of order h^4
    CHECK(tests::distance(one.fields, two.fields) < 1e-9);
}

TEST_CASE("with inertia the field of a rod that walks straight stays its steady one") {
    for (const double inertia : {0.01, 0.5, 4.0}) { // slower and faster than sound
        const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 48, .inertia = inertia};
        ModeStep method(solid, medium, {}, 1, 1);
        const double heading = 0.4, time = 1.0;
        const Coupled exact =
            method.start({1.0 + time * std::cos(heading), 2.0 + time * std::sin(heading), heading});
        const auto error = [&](int steps) {
            return tests::distance(run(method, method.start({1.0, 2.0, heading}), time, steps).fields,
                                   exact.fields);
        };
        const double middle = error(100), fine = error(200);
        CAPTURE(inertia, middle, fine);
        CHECK(std::log2(middle / fine) == Approx(4.0).margin(0.3));
        CHECK(fine < 1e-8 * tests::largest(exact.fields));
    }
}

TEST_CASE("free modes with inertia go on as damped waves, and lose energy") {
    const DynamicMedium medium{
        .box = 12.0, .force_width = 0.5, .modes = 24, .start = Start::rest, .inertia = 0.3};
    const ModalField modes(solid, medium);
    ModeStep method(solid, medium, {}, 1, 1);
    const Coupled rest = method.start({0.0, 0.0, 0.0});
    Coupled disturbed = rest;
    modes.add_steady({3.0, 4.0, 1.0}, disturbed.fields);
    const Coupled with = run(method, disturbed, 2.0, 4), without = run(method, rest, 2.0, 4);
    double error = 0.0, before = 0.0, after = 0.0;
    const std::size_t numbers = 4 * modes.size();
    for (std::size_t i = 0; i < numbers; ++i) {
        const auto decay = i / modes.size() < 2 ? modes.decay_longitudinal : modes.decay_transverse;
        const double k = decay[i % modes.size()], mass = modes.inertia;
        const std::complex<double> root = std::sqrt(std::complex<double>(1.0 - 4.0 * mass * k)),
                                   fast = (-1.0 - root) / (2.0 * mass), slow = (-1.0 + root) / (2.0 * mass);
        const double u = disturbed.fields[i], v = disturbed.fields[numbers + i];
        const auto exact =
            ((v - fast * u) * std::exp(2.0 * slow) - (v - slow * u) * std::exp(2.0 * fast)) / (slow - fast);
        const double u_end = with.fields[i] - without.fields[i],
                     v_end = with.fields[numbers + i] - without.fields[numbers + i];
        error = std::max(error, std::abs(u_end - exact.real()));
        before += k * u * u + mass * v * v;
        after += k * u_end * u_end + mass * v_end * v_end;
    }
    CHECK(error < 1e-13); // rounding of amplitudes of order 0.1
    CHECK(after < 0.9 * before);
    CHECK(after > 0.0);
}

TEST_CASE("threads change no bit of such a step", "[threads]") {
    for (const Evaluation way : {Evaluation::sums, Evaluation::mesh})
        for (const double inertia : {0.0, 0.2}) {
            const DynamicMedium medium{.box = 12.0,
                                       .force_width = 0.5,
                                       .modes = 48,
                                       .self_field = inertia > 0.0,
                                       .evaluation = way,
                                       .inertia = inertia};
            std::vector<Coupled> ends;
            for (const std::size_t threads : {1, 2, 3}) {
                ModeStep method(solid, medium, couplings, 20, threads);
                ends.push_back(run(method, method.start(tests::crowd(20, 12.0)), 0.1, 2));
            }
            for (const Coupled& end : ends) {
                CHECK(end.poses == ends.front().poses);
                CHECK(end.fields == ends.front().fields);
            }
        }
}

// --- The method by itself: what it does exactly, and its order

namespace {

constexpr double rounding = 1e-13; // of amplitudes of order 0.1 after a few steps

} // namespace

TEST_CASE("the field of a rod that walks straight is exact in steps of any length") {
    const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 48};
    ExponentialStep method(solid, medium, {}, 1, 1);
    const double heading = 0.4, time = 7.3;
    const Coupled end = run(method, method.start({1.0, 2.0, heading}), time, 2);
    const Coupled exact =
        method.start({1.0 + time * std::cos(heading), 2.0 + time * std::sin(heading), heading});
    CHECK(tests::distance(end.poses, exact.poses) < rounding);
    CHECK(tests::distance(end.fields, exact.fields) < rounding);
}

TEST_CASE("from rest each mode is its steady state less that of the start, decayed") {
    DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 48, .start = Start::rest};
    const ModalField modes(solid, medium);
    ExponentialStep from_rest(solid, medium, {}, 1, 1);
    medium.start = Start::steady;
    ExponentialStep steady(solid, medium, {}, 1, 1);
    const double time = 0.3;
    const Coupled end = run(from_rest, from_rest.start({0.0, 0.0, 0.0}), time, 3);
    const Coupled first = steady.start({0.0, 0.0, 0.0}), last = steady.start({time, 0.0, 0.0});
    std::vector<double> exact = last.fields;
    for (std::size_t i = 0; i < 4 * modes.size(); ++i) {
        const auto decay = i / modes.size() < 2 ? modes.decay_longitudinal : modes.decay_transverse;
        exact[i] -= std::exp(-decay[i % modes.size()] * time) * first.fields[i];
    }
    CHECK(tests::distance(end.fields, exact) < rounding);
}

TEST_CASE("what is left of another rod's field decays mode by mode, and loses energy") {
    const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 48, .start = Start::rest};
    const ModalField modes(solid, medium);
    ExponentialStep method(solid, medium, {}, 1, 1);
    const Coupled rest = method.start({0.0, 0.0, 0.0});
    Coupled disturbed = rest;
    modes.add_steady({3.0, 4.0, 1.0}, disturbed.fields);
    const double time = 2.0;
    const Coupled with = run(method, disturbed, time, 4), without = run(method, rest, time, 4);
    double before = 0.0, after = 0.0, error = 0.0; // solid energy: alpha decay |u_q|^2/2 a mode
    for (std::size_t i = 0; i < 4 * modes.size(); ++i) {
        const auto decay = i / modes.size() < 2 ? modes.decay_longitudinal : modes.decay_transverse;
        const double rate = decay[i % modes.size()], free = with.fields[i] - without.fields[i];
        before += rate * disturbed.fields[i] * disturbed.fields[i];
        after += rate * free * free;
        error = std::max(error, std::abs(free - std::exp(-rate * time) * disturbed.fields[i]));
    }
    CHECK(error < rounding);
    CHECK(after < before * std::exp(-2.0 * modes.decay_transverse[modes.size() / modes.rows() / 2 + 1] *
                                    time)); // the slowest
}

TEST_CASE("the method is of order 4") {
    for (const bool self_field : {false, true}) {
        const DynamicMedium medium{.box = 8.0, .force_width = 0.6, .modes = 16, .self_field = self_field};
        ExponentialStep method(solid, medium, {4.0, 1.0, -0.5}, 2, 1);
        const Coupled start = method.start({0.0, 1.5, -0.1, 0.3, -1.5, 0.2});
        const Coupled exact = run(method, start, 2.0, 1280);
        const auto error = [&](int steps) {
            const Coupled end = run(method, start, 2.0, steps);
            return std::array{tests::distance(end.poses, exact.poses),
                              tests::distance(end.fields, exact.fields)};
        };
        // coarser steps, of 1 over the fastest decay and more, are of order 3 to 4
        const auto coarse = error(80), middle = error(160), fine = error(320);
        for (std::size_t i = 0; i < 2; ++i) {
            CAPTURE(self_field, i, coarse[i], middle[i], fine[i]);
            CHECK(std::log2(coarse[i] / middle[i]) == Approx(4.0).margin(0.4));
            CHECK(std::log2(middle[i] / fine[i]) == Approx(4.0).margin(0.4));
        }
    }
}

TEST_CASE("threads change no bit of a step", "[threads]") {
    for (const bool self_field : {false, true}) {
        const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 48, .self_field = self_field};
        std::vector<Coupled> ends;
        for (const std::size_t threads : {1, 2, 3}) {
            ExponentialStep method(solid, medium, {4.0, 1.0, -0.5}, 3, threads);
            ends.push_back(
                run(method, method.start({0.0, 1.5, -0.1, 0.3, -1.5, 0.2, 4.0, 0.0, 3.0}), 1.0, 4));
        }
        for (const Coupled& end : ends) {
            CHECK(end.poses == ends.front().poses);
            CHECK(end.fields == ends.front().fields);
        }
    }
}
