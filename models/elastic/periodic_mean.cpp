#include "periodic_mean.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::elastic {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr int orders = 20; // (1/2 pi)^20 = 1e-16

/// B_n/n!
constexpr std::array<double, orders> bernoulli = {1.0,
                                                  -1.0 / 2.0,
                                                  1.0 / 12.0,
                                                  0.0,
                                                  -1.0 / 720.0,
                                                  0.0,
                                                  1.0 / 30240.0,
                                                  0.0,
                                                  -1.0 / 1209600.0,
                                                  0.0,
                                                  1.0 / 47900160.0,
                                                  0.0,
                                                  -691.0 / 1307674368000.0,
                                                  0.0,
                                                  1.0 / 74724249600.0,
                                                  0.0,
                                                  -3617.0 / 10670622842880000.0,
                                                  0.0,
                                                  43867.0 / 5109094217170944000.0,
                                                  0.0};

/// B_n(x)/n!
std::array<double, orders> bernoulli_polynomials(double x) {
    std::array<double, orders> power{1.0}, b{};
    for (int n = 1; n < orders; ++n)
        power[n] = power[n - 1] * x / n;
    for (int n = 0; n < orders; ++n)
        for (int k = 0; k <= n; ++k)
            b[n] += power[k] * bernoulli[n - k];
    return b;
}

Mean by_series(double z, double x) {
    const auto b = bernoulli_polynomials(x);
    Mean sum{};
    double power = two_pi, slope = 0.0; // 2 pi (-z)^j and its derivative by z
    for (int j = 0; j + 2 < orders; ++j) {
        sum.g += power * b[j + 2];
        sum.x += power * b[j + 1];
        sum.xx += power * b[j];
        sum.z += slope * b[j + 2];
        sum.xz += slope * b[j + 1];
        sum.xxz += slope * b[j];
        slope = -power - z * slope;
        power *= -z;
    }
    return sum;
}

/// (2 pi/z) [line - 1/z + E(x)], E = e^(-z x)/(1 - e^-z), `line` rising as x.
Mean closed(double z, double line, double x) {
    const double e = z > 0.0 ? std::exp(-z * x) / -std::expm1(-z) : std::exp(z * (1.0 - x)) / std::expm1(z);
    const double e_z = -e * (x + 1.0 / std::expm1(z)), scale = two_pi / z;
    const double g = scale * (line - 1.0 / z + e), g_x = scale * (1.0 - z * e);
    return {g,
            g_x,
            two_pi * z * e,
            scale * (1.0 / (z * z) + e_z) - g / z,
            -scale * (e + z * e_z) - g_x / z,
            two_pi * (e + z * e_z)};
}

} // namespace

Mean mean_of_all(double z, double x) { return std::abs(z) < 1.0 ? by_series(z, x) : closed(z, x - 0.5, x); }

Mean mean_of_others(double z, double x) {
    return z > 0.0 ? closed(z, x - 0.5, x + 1.0) : closed(z, x + 0.5, x);
}

} // namespace rodwake::elastic
