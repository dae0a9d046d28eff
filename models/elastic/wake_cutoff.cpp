#include "wake_cutoff.hpp"

#include "rodwake/elastic/wake_bound.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::elastic {

namespace {

// Distances in steps of an eighth of a binade, found from the bits; the bound falls with the distance, so it
// holds all over a step if it holds at its beginning.
constexpr int step_bits = 49;
constexpr double nearest = 0x1p-100, farthest = 0x1p100;

std::size_t step_of(double distance) {
    return (std::bit_cast<std::uint64_t>(distance) >> step_bits) -
           (std::bit_cast<std::uint64_t>(nearest) >> step_bits);
}

double beginning(std::size_t step) {
    return std::bit_cast<double>((step + (std::bit_cast<std::uint64_t>(nearest) >> step_bits)) << step_bits);
}

/// Least r + x from which on the field is below the cutoff at this distance: by bisection, from above. It is
/// 2 r at most, ahead; infinite if the field there is too large.
double least_ahead(const WakeBound& bound, const Cutoff& cutoff, double distance) {
    const auto below = [&](double ahead) {
        return bound.strain(distance, ahead) <= cutoff.strain &&
               (!cutoff.with_polar || bound.polar(distance, ahead) <= cutoff.polar);
    };
    double low = 0.0, high = 4.0 * distance;
    if (below(low))
        return low;
    if (!below(high))
        return std::numeric_limits<double>::infinity();
    for (int k = 0; k < 20; ++k) {
        const double middle = 0.5 * (low + high);
        (below(middle) ? high : low) = middle;
    }
    return high;
}

} // namespace

WakeCutoff::WakeCutoff(const Medium& medium, const Cutoff& cutoff) : inverse_xi_(1.0 / medium.xi) {
    const WakeBound bound(medium);
    const std::size_t steps = step_of(farthest);
    for (std::size_t k = 0; k < steps; ++k) {
        const bool all = !least_.empty() && least_.back() == 0.0; // and so farther out
        least_.push_back(all ? 0.0 : least_ahead(bound, cutoff, beginning(k) * medium.xi) * inverse_xi_);
    }
}

bool WakeCutoff::skips(const KernelSource& source, const Circle& circle) const {
    constexpr double round_off = 1e-12;
    const double dx = circle.x - source.x, dy = circle.y - source.y, r = std::sqrt(dx * dx + dy * dy);
    const double distance = (r * (1.0 - round_off) - circle.radius) * inverse_xi_;
    if (!(distance > nearest && distance < farthest))
        return false;
    // r + x is convex: nowhere below its tangent plane, whose slope is sqrt(2 (1 + x/r))
    const double ahead = r + dx * source.cosine + dy * source.sine,
                 slope = std::sqrt(2.0 * std::max(ahead, 0.0) / r);
    return (ahead - circle.radius * slope - round_off * r) * inverse_xi_ >= least_[step_of(distance)];
}

namespace {

/// Round-off of the bound itself.
constexpr double margin = 1.0 + 1e-12;

/// What bounds the parts of one potential, as the header names it.
struct Bounds {
    double B, P, Q, R, N;
};

/// Largest w'^m exp(-a w') for w' >= w: at w, or at m/a if that is beyond.
double largest(double m, double a, double w) {
    const double at = std::max(w, m / a);
    return std::pow(at, m) * std::exp(-a * at);
}

Bounds bounds(double a, double s, double w) {
    const double b = std::sqrt(0.5 * std::numbers::pi / (a * s)), e0 = std::exp(-a * w),
                 e1 = largest(1.0, a, w) / s, half = largest(0.5, a, w) * std::sqrt(2.0 / s);
    return {b * e0, b * std::min(2.0 * e0, e1), b * std::min(e0, 2.0 * e1), b * std::min(e0, half),
            b * e0 * (a * s + 0.5) / (s * s)};
}

} // namespace

WakeBound::WakeBound(const Medium& medium) : c_shear_(0.5 / medium.xi), nu_(medium.nu()) { validate(medium); }

double WakeBound::strain(double distance, double ahead) const {
    const double s = distance * c_shear_, w = ahead * c_shear_, nn = nu_ * nu_;
    const Bounds t = bounds(1.0, s, w), l = bounds(nu_, s, w);
    const double D = nu_ * l.B / (2.0 * s), N = std::max(t.N, l.N);
    const double T = std::max(D, nn * l.P + nu_ * l.P / (2.0 * s));
    const double S = T + std::max(t.Q, nn * l.Q) + N, H = 2.0 * N + t.R + nn * l.P + D;
    return margin * c_shear_ * (0.5 * std::numbers::inv_pi) * std::sqrt(0.5 * (T * T + S * S + H * H));
}

double WakeBound::polar(double distance, double ahead) const {
    const double s = distance * c_shear_, w = ahead * c_shear_;
    const Bounds t = bounds(1.0, s, w), l = bounds(nu_, s, w);
    const double L = std::sqrt(5.0) * nu_ * (nu_ * nu_ * l.P + nu_ * l.B / (2.0 * s));
    const double gradient = nu_ * l.N + L;
    const double laplacian = std::max(t.N, l.N) + std::abs(1.0 - nu_) * l.N + L + t.Q + t.P + t.B / (2.0 * s);
    return margin * c_shear_ * c_shear_ * (0.5 * std::numbers::inv_pi) * std::max(gradient, laplacian);
}

} // namespace rodwake::elastic
