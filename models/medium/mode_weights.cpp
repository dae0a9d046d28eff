#include "mode_weights.hpp"

#include <cmath>

namespace rodwake::medium {

namespace {

struct StepFactors {
    Complex a, b;
    PhiDifferences d;
};

WaveWeights::Propagator propagator(const StepFactors& s, double decay, double inertia, double h) {
    const double size = std::exp(s.a.re), real = size * std::cos(s.a.im); // of e^a; E is real
    const double e = s.d.zero;
    return {real - s.a.re * e, h * e, -h * decay / inertia * e, real + s.b.re * e};
}

} // namespace

DecayWeights decay_weights(double decay, double h) {
    const double half = std::exp(-0.5 * h * decay);
    const Phi at_half = phi({-0.5 * h * decay, 0.0}, {half, 0.0}), at_full = doubled(at_half);
    return {half,
            std::exp(-h * decay),
            {0.5 * h * at_half.one.re, h * at_half.two.re, h * at_full.one.re, h * at_full.two.re,
             h * at_full.three.re}};
}

WaveWeights wave_weights(double decay, double inertia, double h) {
    // r_+ and r_-
    Complex plus, minus;
    const double root = 1.0 - 4.0 * inertia * decay;
    if (root >= 0.0) { // without the difference of nearly equal numbers
        const double sum = 1.0 + std::sqrt(root);
        plus = {-2.0 * decay / sum, 0.0};
        minus = {-0.5 * sum / inertia, 0.0};
    } else {
        plus = {-0.5 / inertia, 0.5 * std::sqrt(-root) / inertia};
        minus = {plus.re, -plus.im};
    }
    const auto factors = [&](double time) -> StepFactors {
        const Complex a = time * plus, b = time * minus;
        return {a, b, phi_differences(a, b)};
    };
    const StepFactors half = factors(0.5 * h), full = factors(h);
    const double v = h / inertia, u = v * h;
    return {propagator(half, decay, inertia, 0.5 * h),
            propagator(full, decay, inertia, h),
            {0.25 * u * half.d.one, 0.5 * u * half.d.two, u * full.d.one, u * full.d.two, u * full.d.three},
            {0.5 * v * half.d.zero, v * half.d.one, v * full.d.zero, v * full.d.one, v * full.d.two}};
}

} // namespace rodwake::medium
