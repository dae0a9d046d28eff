#include "periodic_field.hpp"

#include <array>
#include <cmath>

namespace measure_test {

namespace {

using rodwake::elastic::Vector;

constexpr int terms = 16;       // e^(-pi n) at |x| = L/2
constexpr double small = 1e-10; // of the last image
constexpr long nodes = 24, edge = 2;

struct Term {
    double g, gx; // and its slope along x
};

/// 2 pi/(2 L s) [ e^(k- (x+L))/(1 - e^(k- L)) + e^(k+ (x-L))/(1 - e^(-k+ L)) ], n > 0.
Term term(double c, double q, double x, double box) {
    const double s = std::hypot(c, q), minus = -c - s, plus = q * q / (s + c), scale = M_PI / (box * s);
    const double behind = scale * std::exp(minus * (x + box)) / -std::expm1(minus * box);
    const double ahead = scale * std::exp(plus * (x - box)) / -std::expm1(-plus * box);
    return {behind + ahead, minus * behind + plus * ahead};
}

Term mean_term(double c, double x, double box) {
    const double behind = M_PI / (c * box) * std::exp(-2.0 * c * (x + box)) / -std::expm1(-2.0 * c * box);
    return {M_PI * x / (c * box * box) + behind - M_PI / (2.0 * c * box) - M_PI / (2.0 * c * c * box * box),
            M_PI / (c * box * box) - 2.0 * c * behind};
}

/// Cubic through four nodes at -1, 0, 1, 2.
std::array<double, 4> cubic(double t) {
    return {-t * (t - 1.0) * (t - 2.0) / 6.0, (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
            -(t + 1.0) * t * (t - 2.0) / 2.0, (t + 1.0) * t * (t - 1.0) / 6.0};
}

} // namespace

PeriodicField::PeriodicField(const rodwake::elastic::Medium& medium, double box) : field_(medium), box_(box) {
    for (long j = -edge; j <= nodes + edge; ++j)
        for (long i = -edge; i <= nodes + edge; ++i)
            table_.push_back(rest(box * (static_cast<double>(i) / nodes - 0.5),
                                  box * (static_cast<double>(j) / nodes - 0.5)));
}

/// Gradient of the series' potential; its value apart.
Vector PeriodicField::series(double c, double x, double y, double& value) const {
    const Term mean = mean_term(c, x, box_);
    value = mean.g;
    Vector slope{mean.gx, 0.0};
    for (int n = 1; n <= terms; ++n) {
        const double q = 2.0 * M_PI * n / box_;
        const Term one = term(c, q, x, box_);
        value += 2.0 * one.g * std::cos(q * y);
        slope.x += 2.0 * one.gx * std::cos(q * y);
        slope.y -= 2.0 * q * one.g * std::sin(q * y);
    }
    return slope;
}

/// All but the infinite plane's field of the rod itself.
Vector PeriodicField::rest(double x, double y) const {
    const double xi = field_.medium().xi, shear = 0.5 / xi, longitudinal = field_.medium().nu() * shear;
    double g_shear = 0.0, g_longitudinal = 0.0;
    const Vector t = series(shear, x, y, g_shear), l = series(longitudinal, x, y, g_longitudinal);
    Vector sum{(g_shear + xi * (t.x - l.x)) / (2.0 * M_PI), xi * (t.y - l.y) / (2.0 * M_PI)};
    for (int j = 1; std::exp(-longitudinal * (std::hypot(x, (j - 1.0) * box_) + x)) > small || j < 3; ++j)
        for (const int side : {-j, j}) {
            const auto image = field_.at(x, y + side * box_, {.displacement = true}).displacement;
            sum.x += image.x;
            sum.y += image.y;
        }
    return sum;
}

Vector PeriodicField::exact(double x, double y) const {
    const Vector other = rest(x, y), own = field_.at(x, y, {.displacement = true}).displacement;
    return {own.x + other.x, own.y + other.y};
}

Vector PeriodicField::interpolated(double x, double y) const {
    const auto place = [&](double v) {
        return std::min(std::max((v / box_ + 0.5) * nodes, 0.0), nodes - 1e-9);
    };
    const double u = place(x), v = place(y);
    const long i = static_cast<long>(u), j = static_cast<long>(v);
    const auto wx = cubic(u - static_cast<double>(i)), wy = cubic(v - static_cast<double>(j));
    Vector sum;
    for (long b = 0; b < 4; ++b)
        for (long a = 0; a < 4; ++a) {
            const auto& node = table_[static_cast<std::size_t>((j + b - 1 + edge) * (nodes + 2 * edge + 1) +
                                                               i + a - 1 + edge)];
            const double w = wx[static_cast<std::size_t>(a)] * wy[static_cast<std::size_t>(b)];
            sum.x += w * node.x;
            sum.y += w * node.y;
        }
    return sum;
}

Vector PeriodicField::at(double x, double y) const {
    x = std::remainder(x, box_);
    y = std::remainder(y, box_);
    const Vector other = interpolated(x, y), own = field_.at(x, y, {.displacement = true}).displacement;
    return {own.x + other.x, own.y + other.y};
}

} // namespace measure_test
