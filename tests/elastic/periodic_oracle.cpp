#include "periodic_oracle.hpp"

#include <boost/math/quadrature/gauss.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace rodwake::oracle {

namespace {

constexpr long double pi = std::numbers::pi_v<long double>;
constexpr long double vanished = 50.0L; // e^-50 = 2e-22

/// Derivatives of exp(-u^2/4t) by u: g_(n+1) = -(u g_n + n g_(n-1))/(2 t).
std::array<long double, 5> gaussian(long double u, long double t) {
    std::array<long double, 5> g{std::exp(-u * u / (4 * t))};
    g[1] = -u * g[0] / (2 * t);
    for (int n = 1; n < 4; ++n)
        g[n + 1] = -(u * g[n] + n * g[n - 1]) / (2 * t);
    return g;
}

} // namespace

PeriodicPotential::PeriodicPotential(const BoxPoint& at, long double c) {
    const long double box = at.sides().shorter(),
                      largest = 20 * box / std::max(c, 1 / box); // drift of 40 boxes
    const long double tau = std::min(box * box / 12, largest);
    add_waves(at, c, tau);
    add_images(at, c, tau);
}

void PeriodicPotential::add_waves(const BoxPoint& at, long double c, long double tau) {
    const long double side_x = at.sides().x, side_y = at.sides().y, area = side_x * side_y;
    const long double cosine = std::cos((long double)at.heading), sine = std::sin((long double)at.heading);
    const auto last = [&](long double side) {
        return static_cast<int>(side * std::sqrt(vanished / tau) / (2 * pi)) + 2;
    };
    for (int a = -last(side_x); a <= last(side_x); ++a)
        for (int b = -last(side_y); b <= last(side_y); ++b) {
            if (a == 0 && b == 0)
                continue;
            const long double px = 2 * pi * a / side_x, py = 2 * pi * b / side_y,
                              kx = px * cosine + py * sine, ky = py * cosine - px * sine;
            const std::complex<long double> decay(kx * kx + ky * ky, -2 * c * kx), i(0, 1);
            const std::complex<long double> wave =
                2 * pi / area * std::exp(i * (kx * at.x + ky * at.y) - tau * decay) / decay;
            std::complex<long double> x_part = wave;
            for (int m = 0; m < 5; ++m, x_part *= i * kx) {
                std::complex<long double> part = x_part;
                for (int n = 0; m + n < 5; ++n, part *= i * ky)
                    table_[m][n] += part.real();
            }
        }
    table_[0][0] -= 2 * pi * tau / area; // the images' share of the mean
}

/// The source of time -t sits 2 c t behind the image.
void PeriodicPotential::add_images(const BoxPoint& at, long double c, long double tau) {
    const long double side_x = at.sides().x, side_y = at.sides().y;
    const long double cosine = std::cos((long double)at.heading), sine = std::sin((long double)at.heading);
    const long double width = std::sqrt(4 * tau * vanished), drift = 2 * c * tau;
    const long double reach = std::hypot((long double)at.x, (long double)at.y) + width + drift;
    const int last_a = static_cast<int>(reach / side_x) + 1, last_b = static_cast<int>(reach / side_y) + 1;
    for (int a = -last_a; a <= last_a; ++a)
        for (int b = -last_b; b <= last_b; ++b) {
            const long double x = at.x - (a * side_x * cosine + b * side_y * sine),
                              y = at.y - (b * side_y * cosine - a * side_x * sine);
            const long double nearest = x + std::clamp(-x, 0.0L, drift); // of x + 2 c t
            if (std::hypot(nearest, y) <= width)
                add_image(x, y, c, tau);
        }
}

void PeriodicPotential::add_image(long double x, long double y, long double c, long double tau) {
    const long double r2 = x * x + y * y, depth = std::log(1 + 4 * tau * (vanished + c * std::sqrt(r2)) / r2);
    const int panels = static_cast<int>(depth * (2 + std::sqrt(c * std::sqrt(r2)))) + 4;
    using Rule = boost::math::quadrature::gauss<long double, 20>;
    for (int p = 0; p < panels; ++p)
        for (std::size_t k = 0; k < 2 * Rule::abscissa().size(); ++k) {
            const long double s = k % 2 ? -Rule::abscissa()[k / 2] : Rule::abscissa()[k / 2];
            const long double half = depth / (2 * panels), v = (2 * p + 1 + s) * half, t = tau * std::exp(-v);
            const long double weight = half * Rule::weights()[k / 2] / 2;
            const auto gx = gaussian(x + 2 * c * t, t), gy = gaussian(y, t);
            for (int m = 0; m < 5; ++m)
                for (int n = 0; m + n < 5; ++n)
                    table_[m][n] += weight * gx[m] * gy[n];
        }
}

elastic::FieldValues periodic_field(const BoxPoint& at) {
    const long double xi = at.xi, nu = 1 / (1 + (long double)at.eta), unit = 1 / (2 * pi);
    const PeriodicPotential shear(at, 1 / (2 * xi)), longitudinal(at, nu / (2 * xi));
    const auto d = [&](int i, int j) {
        return xi * (shear.derivative(i, j) - longitudinal.derivative(i, j));
    };
    const auto ux = [&](int i, int j) { return unit * (shear.derivative(i, j) + d(i + 1, j)); };
    const auto uy = [&](int i, int j) { return unit * d(i, j + 1); };
    /// y component of the field of a force along y: Green's tensor has the trace (G_T + nu G_L)/2 pi.
    const auto vy = [&](int i, int j) {
        return unit * (shear.derivative(i, j) + nu * longitudinal.derivative(i, j)) - ux(i, j);
    };
    const auto value = [](long double v) { return static_cast<double>(v); };
    elastic::FieldValues f;
    f.displacement = {value(ux(0, 0)), value(uy(0, 0))};
    f.strain = {value(ux(1, 0)), value((ux(0, 1) + uy(1, 0)) / 2), value(uy(0, 1))};
    f.laplacian = {value(ux(2, 0) + ux(0, 2)), value(uy(2, 0) + uy(0, 2))};
    f.gradient_of_trace = {value(ux(2, 0) + uy(1, 1)), value(ux(1, 1) + uy(0, 2))};
    f.dipole = {-value(uy(0, 1)), -value(vy(0, 1))};
    const auto strain = [&](int i, int j) {
        return elastic::SymmetricTensor{value(ux(1 + i, j)), value((ux(i, 1 + j) + uy(1 + i, j)) / 2),
                                        value(uy(i, 1 + j))};
    };
    const auto laplacian = [&](int i, int j) {
        return elastic::Vector{value(ux(2 + i, j) + ux(i, 2 + j)), value(uy(2 + i, j) + uy(i, 2 + j))};
    };
    const auto trace = [&](int i, int j) {
        return elastic::Vector{value(ux(2 + i, j) + uy(1 + i, 1 + j)),
                               value(ux(1 + i, 1 + j) + uy(i, 2 + j))};
    };
    f.strain_x = strain(1, 0);
    f.strain_y = strain(0, 1);
    f.laplacian_x = laplacian(1, 0);
    f.laplacian_y = laplacian(0, 1);
    f.gradient_of_trace_x = trace(1, 0);
    f.gradient_of_trace_y = trace(0, 1);
    return f;
}

} // namespace rodwake::oracle
