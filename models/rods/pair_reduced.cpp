#include "pair_reduced.hpp"

#include "interaction.hpp"

#include "rodwake/core/error.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::rods {

ScaledPair::ScaledPair(const elastic::Medium& medium, const Couplings& unscaled)
    : field((validate(medium), elastic::Medium{medium.eta, 1.0})), couplings(unscaled), xi(medium.xi) {
    for (const Coupling& coupling : coupling_list) {
        if (!std::isfinite(couplings.*coupling.number))
            throw InputError(std::string(coupling.name) + " must be a finite number");
        if (coupling.polar)
            couplings.*coupling.number /= xi;
    }
}

double turning(const ScaledPair& pair, double x, double y, double h) {
    return turning_rate(pair.field.at(x, y, request_of(pair.couplings, false)), pair.couplings,
                        {std::cos(h), std::sin(h)});
}

TurningRate turning_derivatives(const ScaledPair& pair, double x, double y, double h) {
    return turning_rate_derivatives(pair.field.at(x, y, request_of(pair.couplings, true)), pair.couplings,
                                    {std::cos(h), std::sin(h)});
}

Eigen::Vector3d rates_at(const ScaledPair& pair, const Pose& q) {
    const double c = std::cos(q.heading), s = std::sin(q.heading);
    const double w0 = turning(pair, -(c * q.x + s * q.y), s * q.x - c * q.y, -q.heading);
    return {c - 1.0 + w0 * q.y, s - w0 * q.x, turning(pair, q.x, q.y, q.heading) - w0};
}

PairFlow flow_at(const ScaledPair& pair, const Pose& q) {
    const double c = std::cos(q.heading), s = std::sin(q.heading);
    // Rod 1 in the frame of rod 0, and rod 0 in that of rod 1: place (X, Y), heading -h.
    const double X = -(c * q.x + s * q.y), Y = s * q.x - c * q.y;
    const TurningRate w1 = turning_derivatives(pair, q.x, q.y, q.heading);
    const TurningRate w0 = turning_derivatives(pair, X, Y, -q.heading);
    // The chain rule, with d(X, Y)/dx = (-c, s), d(X, Y)/dy = (-s, -c), d(X, Y)/dh = (Y, -X).
    const Eigen::RowVector3d by0{s * w0.by_y - c * w0.by_x, -s * w0.by_x - c * w0.by_y,
                                 Y * w0.by_x - X * w0.by_y - w0.by_phi};
    const Eigen::RowVector3d by1{w1.by_x, w1.by_y, w1.by_phi};
    PairFlow flow;
    flow.rates << c - 1.0 + w0.value * q.y, s - w0.value * q.x, w1.value - w0.value;
    flow.by_pose.row(0) = q.y * by0 + Eigen::RowVector3d{0.0, w0.value, -s};
    flow.by_pose.row(1) = -q.x * by0 + Eigen::RowVector3d{-w0.value, 0.0, c};
    flow.by_pose.row(2) = by1 - by0;
    flow.turning[0] = w0.value;
    flow.turning[1] = w1.value;
    return flow;
}

std::optional<PairEquilibrium> newton(const ScaledPair& pair, Pose q, double longest_first_step) {
    // Places are measured by the separation, so that a step is as large for the heading as for them. Far off
    // a step is cut to a fifth of the separation; the iteration has converged where it gains nothing more.
    double last = 1.0;
    for (int iteration = 0; iteration < 60; ++iteration) {
        const double r = std::hypot(q.x, q.y);
        if (!(r > 0.1 * least_searched && r < 10.0 * most_searched))
            return {};
        const PairFlow flow = flow_at(pair, q);
        const Eigen::Vector3d scale{r, r, 1.0};
        const Eigen::Vector3d step = (flow.by_pose * scale.asDiagonal()).partialPivLu().solve(-flow.rates);
        const double length = step.norm();
        if (!std::isfinite(length) || (iteration == 0 && length > longest_first_step))
            return {};
        const double part = std::min(1.0, 0.2 / length);
        q.x += part * step[0] * r;
        q.y += part * step[1] * r;
        q.heading += part * step[2];
        if (length < 1e-14 || (length < 1e-9 && length > 0.5 * last)) {
            // In line the Jacobian is singular, and the iteration may end in any distance.
            if (std::abs(q.y) < 1e-7 * r && std::abs(std::sin(0.5 * q.heading)) < 1e-7)
                return {};
            return described(pair, q);
        }
        last = length;
    }
    return {};
}

PairEquilibrium described(const ScaledPair& pair, const Pose& q) {
    const double xi = pair.xi, r = std::hypot(q.x, q.y);
    const PairFlow flow = flow_at(pair, q);
    // Similar to the Jacobian, with entries of one size however near the rods are.
    const Eigen::Vector3d scale{r, r, 1.0};
    const Eigen::Matrix3d balanced = scale.cwiseInverse().asDiagonal() * flow.by_pose * scale.asDiagonal();
    const Eigen::Vector3cd values = balanced.eigenvalues() / xi;
    PairEquilibrium found;
    found.separation[0] = found.separation[1] = r * xi;
    found.omega = 0.5 * (flow.turning[0] + flow.turning[1]) / xi;
    // Rods opposite each other: of -pi and pi the heading that others of this omega have the sign of.
    double heading = std::remainder(q.heading, 2.0 * std::numbers::pi);
    if (std::numbers::pi - std::abs(heading) < 1e-9)
        heading = std::copysign(std::numbers::pi, -found.omega);
    found.pose = {q.x * xi, q.y * xi, heading};
    if (std::abs(found.omega) * r * xi < 1e-9) {
        found.kind = EquilibriumKind::parallel;
        found.pose.heading = found.omega = 0.0;
    }
    std::copy(values.begin(), values.end(), found.eigenvalues.begin());
    std::sort(found.eigenvalues.begin(), found.eigenvalues.end(),
              [](std::complex<double> item, std::complex<double> other) {
                  return std::pair(-item.real(), -item.imag()) < std::pair(-other.real(), -other.imag());
              });
    return found;
}

Pose pose_of(Family family, Reduced at) {
    const double r = std::exp(at.u);
    return {-r * std::cos(at.b), r * std::sin(at.b), family == Family::orbit ? -2.0 * at.b : 0.0};
}

ReducedEquations reduced_equations(const ScaledPair& pair, Family family, Reduced at) {
    const double turns = family == Family::orbit ? 2.0 : 0.0; // dh/db
    const double r = std::exp(at.u), x = r * std::cos(at.b), y = r * std::sin(at.b);
    ReducedEquations equations;
    // r T+ and r T-, and how they change with u and b
    Eigen::Vector3d at_sign[2];
    for (const int k : {0, 1}) {
        const double sign = k == 0 ? 1.0 : -1.0;
        const TurningRate T = turning_derivatives(pair, sign * x, sign * y, turns * at.b);
        at_sign[k] = r * Eigen::Vector3d{T.value, T.value + sign * (x * T.by_x + y * T.by_y),
                                         sign * (x * T.by_y - y * T.by_x) + turns * T.by_phi};
    }
    const Eigen::Vector3d sum = at_sign[0] + at_sign[1];
    const Eigen::Vector3d circle{turns * std::sin(at.b), 0.0, turns * std::cos(at.b)};
    const Eigen::Vector3d difference = 0.5 * (at_sign[0] - at_sign[1]) - circle;
    equations.values << sum[0], difference[0];
    equations.by_place.row(0) = sum.tail<2>();
    equations.by_place.row(1) = difference.tail<2>();
    return equations;
}

double unequal_turning(const ScaledPair& pair, Family family, Reduced at) {
    const double r = std::exp(at.u), x = r * std::cos(at.b), y = r * std::sin(at.b);
    const double h = family == Family::orbit ? 2.0 * at.b : 0.0;
    return r * (turning(pair, x, y, h) + turning(pair, -x, -y, h));
}

} // namespace rodwake::rods
