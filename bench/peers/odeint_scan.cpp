// The scan of bench/scan_peers.py as one would write it with boost::numeric::odeint: dopri5, a loop over
// points on threads, contact looked for after each step. Prints "contact" or "none" for each point of the
// CSV.
//
//   bench_odeint_scan POINTS.csv plain|rodwake THREADS
//
// `plain`: the right-hand side in Boost's Bessel functions; `rodwake`: that of the rods part.

#include "rodwake/rods/model.hpp"

#include <boost/math/special_functions/bessel.hpp>
#include <boost/numeric/odeint.hpp>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace {

using State = std::array<double, 6>;
constexpr double alpha = 1.0, eta = 1.0, t_end = 60.0, contact_distance = 0.1, tolerance = 1e-6;

struct Point {
    double kappa, x;
};

/// First and second derivatives of exp(-c x) K0(c r).
struct Derivatives {
    double x, y, xx, xy, yy;
};

Derivatives derivatives(double c, double x, double y) {
    using boost::math::cyl_bessel_k;
    const double r = std::hypot(x, y), e = std::exp(-c * x), cos = x / r, sin = y / r;
    const double K0 = e * cyl_bessel_k(0, c * r), K1 = e * cyl_bessel_k(1, c * r);
    const double K2 = K0 + 2.0 * K1 / (c * r);
    return {-c * (K0 + cos * K1), -c * sin * K1, c * c * (K0 + 2.0 * cos * K1 + cos * cos * K2) - c * K1 / r,
            c * c * sin * (K1 + cos * K2), c * c * sin * sin * K2 - c * K1 / r};
}

/// Rate of turn of a rod at (x, y) from another, whose heading is 0 there; `angle` is that between them.
double turning(double x, double y, double angle, double kappa) {
    constexpr double c = 0.5 * alpha;
    const Derivatives T = derivatives(c, x, y), L = derivatives(c / (1.0 + eta), x, y);
    const double xx = T.x + (T.xx - L.xx) / alpha, yy = (T.yy - L.yy) / alpha;
    const double xy = 0.5 * T.y + (T.xy - L.xy) / alpha;
    const double nx = std::cos(angle), ny = std::sin(angle);
    return kappa / (2.0 * std::numbers::pi) * (nx * (xy * nx + yy * ny) - ny * (xx * nx + xy * ny));
}

double turning_of(const State& s, std::size_t rod, double kappa) {
    const std::size_t at = 3 * rod, from = 3 - at;
    const double dx = s[at] - s[from], dy = s[at + 1] - s[from + 1];
    const double cos = std::cos(s[from + 2]), sin = std::sin(s[from + 2]);
    return turning(cos * dx + sin * dy, cos * dy - sin * dx, s[at + 2] - s[from + 2], kappa);
}

void plain(const State& s, State& rate, double kappa) {
    for (std::size_t rod = 0; rod < 2; ++rod) {
        rate[3 * rod] = std::cos(s[3 * rod + 2]);
        rate[3 * rod + 1] = std::sin(s[3 * rod + 2]);
        rate[3 * rod + 2] = turning_of(s, rod, kappa);
    }
}

template<class Rhs>
bool meets(const Point& point, const Rhs& rhs) {
    namespace odeint = boost::numeric::odeint;
    State s = {0.0, 0.0, 0.0, point.x, -4.0, 0.5 * std::numbers::pi};
    auto stepper = odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_dopri5<State>());
    double t = 0.0, step = 1e-2;
    while (t < t_end) {
        step = std::min(step, t_end - t);
        if (stepper.try_step([&](const State& at, State& rate, double) { rhs(at, rate, point.kappa); }, s, t,
                             step) == odeint::success &&
            std::hypot(s[0] - s[3], s[1] - s[4]) <= contact_distance)
            return true;
    }
    return false;
}

bool meets(const Point& point, bool is_plain) {
    if (is_plain)
        return meets(point, plain);
    const rodwake::rods::RodModel model(rodwake::elastic::exact_field({eta, alpha}), {.kappa = point.kappa},
                                        2);
    return meets(point, [&](const State& s, State& rate, double) { model.rhs(s, rate); });
}

std::vector<Point> read(const char* file) {
    std::ifstream in(file);
    std::vector<Point> points;
    char comma = 0;
    for (Point point{}; in >> point.kappa >> comma >> point.x;)
        points.push_back(point);
    return points;
}

} // namespace

int main(int argc, char** argv) {
    if (argc != 4)
        return std::fprintf(stderr, "usage: bench_odeint_scan POINTS.csv plain|rodwake THREADS\n"), 2;
    const std::vector<Point> points = read(argv[1]);
    const bool is_plain = std::string(argv[2]) == "plain";
    std::vector<char> met(points.size());
    std::atomic<std::size_t> next = 0;
    std::vector<std::jthread> threads;
    for (int k = 0; k < std::atoi(argv[3]); ++k)
        threads.emplace_back([&] {
            for (std::size_t i = next++; i < points.size(); i = next++)
                met[i] = meets(points[i], is_plain);
        });
    threads.clear();
    for (const char one : met)
        std::puts(one ? "contact" : "none");
}
