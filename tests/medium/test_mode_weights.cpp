// Weights of damped waves against the exponential of a matrix, in long double: of
//
//   y' = h A y + z_1 e_2,  z_1' = z_2,  z_2' = z_3,  z_3' = 0
//
// whose exponential holds e^(h A) and phi_k(h A) e_2 (Al-Mohy & Higham, SIAM J. Sci. Comput. 33, 488, 2011).

#include "reference_run.hpp"

#include "medium/mode_mesh.hpp"
#include "medium/mode_weights.hpp"
#include "rods/interaction.hpp"
#include "rodwake/medium/dynamic_medium.hpp"

#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <unsupported/Eigen/MatrixFunctions>

#include <cmath>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

using Matrix = Eigen::Matrix<long double, 5, 5>;

Matrix truth(double decay, double inertia, double h) {
    Matrix m = Matrix::Zero();
    m(0, 1) = h;
    m(1, 0) = -static_cast<long double>(h) * decay / inertia;
    m(1, 1) = -static_cast<long double>(h) / inertia;
    m(1, 2) = m(2, 3) = m(3, 4) = 1.0L;
    return m.exp();
}

/// |a - b| of the two rates times h.
double apart(double decay, double inertia, double h) {
    return h * std::sqrt(std::abs(1.0 - 4.0 * inertia * decay)) / inertia;
}

void compare(double got, long double expected, double scale) {
    CHECK(std::abs(got - static_cast<double>(expected)) < 4e-14 * scale);
}

/// Errors of the differences are those of phi_k over |a - b|, or those of the derivatives where that is
/// small.
void compare(double decay, double inertia, double h) {
    CAPTURE(decay, inertia, h);
    const WaveWeights w = wave_weights(decay, inertia, h);
    const auto propagator = [&](const WaveWeights::Propagator& p, double step) {
        const Matrix e = truth(decay, inertia, step);
        const double scale = step / std::max(1.0, apart(decay, inertia, step));
        compare(p.uu, e(0, 0), 1.0);
        compare(p.uv, e(0, 1), scale);
        compare(p.vu, e(1, 0), scale * decay / inertia);
        compare(p.vv, e(1, 1), 1.0);
    };
    propagator(w.full, h);
    propagator(w.half, 0.5 * h);
    const Matrix full = truth(decay, inertia, h), half = truth(decay, inertia, 0.5 * h);
    const double v = h / inertia / std::max(1.0, apart(decay, inertia, h)), u = h * v;
    const double scale = h / inertia;
    compare(w.u.one, scale * full(0, 2), u);
    compare(w.u.two, scale * full(0, 3), u);
    compare(w.u.three, scale * full(0, 4), u);
    compare(w.v.one, scale * full(1, 2), v);
    compare(w.v.two, scale * full(1, 3), v);
    compare(w.v.three, scale * full(1, 4), v);
    compare(w.u.half_one, 0.5 * scale * half(0, 2), u);
    compare(w.u.half_two, scale * half(0, 3), u);
    compare(w.v.half_one, 0.5 * scale * half(1, 2), v);
    compare(w.v.half_two, scale * half(1, 3), v);
}

} // namespace

TEST_CASE("weights of damped waves are those of the matrix, overdamped, underdamped and near critical") {
    for (const double inertia : {1e-3, 0.1, 5.0})
        for (const double h : {1e-3, 0.05, 1.0}) {
            for (const double from_critical : {0.0, 1e-15, -1e-13, 1e-8, -1e-6, 1e-3, -0.02, 0.2, -0.9, 0.99})
                compare(0.25 * (1.0 + from_critical) / inertia, inertia, h);
            for (const double decay : {1e-4, 0.3, 20.0, 300.0})
                compare(decay, inertia, h);
        }
}

TEST_CASE("with little inertia the weights are those of decay alone, to first order in it") {
    constexpr double decay = 3.0, h = 0.2;
    const DecayWeights none = decay_weights(decay, h);
    double before = 0.0;
    for (const double inertia : {1e-4, 1e-5}) {
        const WaveWeights w = wave_weights(decay, inertia, h);
        const double off = std::max(
            {std::abs(w.full.uu - none.full), std::abs(w.u.one - none.force.one),
             std::abs(w.u.two - none.force.two), std::abs(w.u.three - none.force.three),
             std::abs(w.u.half_one - none.force.half_one), std::abs(w.u.half_two - none.force.half_two)});
        CHECK(off < 10.0 * inertia);
        CHECK(off > 0.1 * inertia);
        if (before > 0.0)
            CHECK(before / off == Approx(10.0).epsilon(0.02));
        before = off;
    }
}

// --- The mesh where its modes are many or their forces nothing, and its start

namespace {

std::vector<double> summed_start(const ModalField& modes, std::span<const double> poses) {
    std::vector<double> field(modes.numbers());
    for (std::size_t a = 0; a < poses.size() / 3; ++a)
        modes.add_steady(rods::pose(poses, a), field);
    return field;
}

} // namespace

TEST_CASE("the start of many rods is the sum of their steady fields") {
    const std::vector<double> poses = tests::crowd(200, 12.0);
    for (const double eta : {1.0, 0.3, -0.5, -0.9})
        for (const double xi : {10.0, 1.0, 0.1}) { // nearly all modes by harmonics, some, hardly any
            const elastic::Medium elastic{eta, xi};
            const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 47};
            const ModalField modes(elastic, medium);
            ThreadPool team(1);
            ModeMesh mesh(modes, medium.box, team);
            std::vector<double> field(modes.numbers());
            mesh.add_steady(poses, field);
            const std::vector<double> exact = summed_start(modes, poses);
            CAPTURE(eta, xi);
            CHECK(tests::distance(field, exact) < mesh_error * tests::largest(exact));
        }
}

TEST_CASE("modes whose force underflows carry nothing of the transform before") {
    const elastic::Medium elastic{1.0, 1.0};
    const rods::Couplings couplings{1.0, 0.0, 0.0};
    const DynamicMedium medium{.box = 12.0, .force_width = 3.0, .modes = 96, .self_field = true};
    const ModalField modes(elastic, medium);
    REQUIRE(modes.force.back() == 0.0);
    ThreadPool team(1);
    ModeMesh mesh(modes, medium.box, team);
    const std::vector<double> poses = tests::crowd(5, 12.0), field = summed_start(modes, poses);
    std::vector<double> forces(field.size()), rates(5), exact(5);
    mesh.forces(poses, forces);
    mesh.turning(poses, field, couplings, rates);
    for (std::size_t a = 0; a < 5; ++a) {
        const rods::Direction n = rods::direction(poses, a);
        exact[a] = rods::turning_rate(
            modes.at(poses[3 * a], poses[3 * a + 1], rods::request_of(couplings, false), field), couplings,
            {n.cosine, n.sine});
    }
    CHECK(tests::distance(rates, exact) < mesh_error * tests::largest(exact));
}
