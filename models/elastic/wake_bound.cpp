#include "rodwake/elastic/wake_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

/// Round-off of the bound itself.
constexpr double margin = 1.0 + 1e-12;

/// What bounds the parts of one potential, as the header names it.
struct PotentialBounds {
    double B, P, Q, R, N;
};

/// Largest w'^m exp(-a w') for w' >= w: at w, or at m/a if that is beyond.
double largest(double m, double a, double w) {
    const double at = std::max(w, m / a);
    return std::pow(at, m) * std::exp(-a * at);
}

PotentialBounds bounds(double a, double s, double w) {
    const double b = std::sqrt(0.5 * std::numbers::pi / (a * s)), e0 = std::exp(-a * w),
                 e1 = largest(1.0, a, w) / s, half = largest(0.5, a, w) * std::sqrt(2.0 / s);
    return {b * e0, b * std::min(2.0 * e0, e1), b * std::min(e0, 2.0 * e1), b * std::min(e0, half),
            b * e0 * (a * s + 0.5) / (s * s)};
}

} // namespace

WakeBound::WakeBound(const Medium& medium) : c_shear_(0.5 / medium.xi), nu_(medium.nu()) { validate(medium); }

double WakeBound::strain(double distance, double ahead) const {
    const double s = distance * c_shear_, w = ahead * c_shear_, nn = nu_ * nu_;
    const PotentialBounds t = bounds(1.0, s, w), l = bounds(nu_, s, w);
    const double D = nu_ * l.B / (2.0 * s), N = std::max(t.N, l.N);
    const double T = std::max(D, nn * l.P + nu_ * l.P / (2.0 * s));
    const double S = T + std::max(t.Q, nn * l.Q) + N, H = 2.0 * N + t.R + nn * l.P + D;
    return margin * c_shear_ * (0.5 * std::numbers::inv_pi) * std::sqrt(0.5 * (T * T + S * S + H * H));
}

double WakeBound::polar(double distance, double ahead) const {
    const double s = distance * c_shear_, w = ahead * c_shear_;
    const PotentialBounds t = bounds(1.0, s, w), l = bounds(nu_, s, w);
    const double L = std::sqrt(5.0) * nu_ * (nu_ * nu_ * l.P + nu_ * l.B / (2.0 * s));
    const double gradient = nu_ * l.N + L;
    const double laplacian = std::max(t.N, l.N) + std::abs(1.0 - nu_) * l.N + L + t.Q + t.P + t.B / (2.0 * s);
    return margin * c_shear_ * c_shear_ * (0.5 * std::numbers::inv_pi) * std::max(gradient, laplacian);
}

} // namespace rodwake::elastic
