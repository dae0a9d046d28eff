#include "phonon_constants.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::measure {

namespace {

constexpr int longest_wave_used = 2; // waves along a side: where omega is still proportional to q
constexpr std::size_t directions = 91;

using Numbers = std::vector<ModeNumbers>;

/// c of omega = c q over the modes that `holds` names.
template<class Holds>
double speed(const Numbers& modes, double ModeNumbers::*omega, double ModeNumbers::*weight,
             const Holds& holds) {
    double products = 0.0, squares = 0.0;
    for (const ModeNumbers& k : modes) {
        const double q = std::hypot(k.qx, k.qy);
        if (!holds(k) || std::max(k.m, k.n) > longest_wave_used || !std::isfinite(k.*omega * k.*weight))
            continue;
        products += k.*weight * q * k.*omega;
        squares += k.*weight * q * q;
    }
    return squares > 0.0 ? products / squares : NAN;
}

/// gamma = drag + nu_L q^2, drag + nu_T q^2: weighted least squares over all modes.
void set_drag(ElasticNumbers& out, const Numbers& modes) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const auto add = [&](const Eigen::Vector3d& row, double gamma, double weight) {
        if (!std::isfinite(gamma * weight))
            return;
        normal += weight * row * row.transpose();
        right += weight * gamma * row;
    };
    double scale = 0.0; // of q^2, so that the columns are alike
    for (const ModeNumbers& k : modes)
        scale = std::max(scale, k.qx * k.qx + k.qy * k.qy);
    for (const ModeNumbers& k : modes) {
        const double q2 = (k.qx * k.qx + k.qy * k.qy) / scale;
        add({1.0, q2, 0.0}, k.gamma_L, k.weight_gamma_L);
        add({1.0, 0.0, q2}, k.gamma_T, k.weight_gamma_T);
    }
    const Eigen::FullPivLU<Eigen::Matrix3d> solver(normal);
    const Eigen::Vector3d found =
        solver.isInvertible() ? Eigen::Vector3d(solver.solve(right)) : Eigen::Vector3d::Constant(NAN);
    out.drag = found[0];
    out.viscosity_L = found[1] / scale;
    out.viscosity_T = found[2] / scale;
}

/// Christoffel's equation for C12 from one wave off the axes; the root that a stable medium near isotropy
/// has.
double coupling_constant(const ElasticNumbers& e, double modulus, double cx, double cy) {
    const double xx = e.C11 * cx * cx + e.C66 * cy * cy, yy = e.C66 * cx * cx + e.C22 * cy * cy;
    return std::sqrt((modulus - xx) * (modulus - yy)) / (cx * cy) - e.C66;
}

void set_isotropic(ElasticNumbers& e) {
    e.bulk = (e.C11 + e.C22 + 2.0 * e.C12) / 4.0;
    e.mu = (e.C11 + e.C22 - 2.0 * e.C12 + 4.0 * e.C66) / 8.0;
    e.eta = e.bulk / e.mu;
    double low_L = INFINITY, high_L = -INFINITY, low_T = INFINITY, high_T = -INFINITY;
    for (std::size_t i = 0; i < directions; ++i) {
        const double angle = 0.5 * std::numbers::pi * static_cast<double>(i) / (directions - 1);
        const WaveModuli moduli = wave_moduli(e.C11, e.C22, e.C12, e.C66, angle);
        low_L = std::min(low_L, moduli.longitudinal);
        high_L = std::max(high_L, moduli.longitudinal);
        low_T = std::min(low_T, moduli.transverse);
        high_T = std::max(high_T, moduli.transverse);
    }
    e.spread_L = std::isfinite(e.mu) ? (high_L - low_L) / (e.bulk + e.mu) : NAN;
    e.spread_T = std::isfinite(e.mu) ? (high_T - low_T) / e.mu : NAN;
}

} // namespace

WaveModuli wave_moduli(double C11, double C22, double C12, double C66, double angle) {
    const double cx = std::cos(angle), cy = std::sin(angle);
    const double xx = C11 * cx * cx + C66 * cy * cy, yy = C66 * cx * cx + C22 * cy * cy;
    const double half = 0.5 * (xx + yy), root = std::hypot(0.5 * (xx - yy), (C12 + C66) * cx * cy);
    return {half + root, half - root};
}

ElasticNumbers elastic_numbers(const Numbers& modes, double density) {
    const auto along_x = [](const ModeNumbers& k) { return k.n == 0; };
    const auto along_y = [](const ModeNumbers& k) { return k.m == 0; };
    const auto on_axis = [](const ModeNumbers& k) { return k.m == 0 || k.n == 0; };
    const auto diagonal = [](const ModeNumbers& k) { return k.m == k.n; };
    const auto L = &ModeNumbers::omega_L, wL = &ModeNumbers::weight_omega_L;
    const auto T = &ModeNumbers::omega_T, wT = &ModeNumbers::weight_omega_T;
    const auto modulus = [&](double c) { return density * c * c; };
    ElasticNumbers e{};
    e.c_Lx = speed(modes, L, wL, along_x);
    e.c_Ly = speed(modes, L, wL, along_y);
    e.c_Ld = speed(modes, L, wL, diagonal);
    e.c_Tx = speed(modes, T, wT, along_x);
    e.c_Ty = speed(modes, T, wT, along_y);
    e.c_Td = speed(modes, T, wT, diagonal);
    e.C11 = modulus(e.c_Lx);
    e.C22 = modulus(e.c_Ly);
    e.C66 = modulus(speed(modes, T, wT, on_axis));
    const auto oblique = std::ranges::find_if(modes, diagonal);
    const double q = oblique == modes.end() ? 0.0 : std::hypot(oblique->qx, oblique->qy);
    e.C12 = q > 0.0 ? coupling_constant(e, modulus(e.c_Ld), oblique->qx / q, oblique->qy / q) : NAN;
    set_isotropic(e);
    set_drag(e, modes);
    return e;
}

} // namespace rodwake::measure
