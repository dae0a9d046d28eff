#include "periodic_cases.hpp"

#include "rodwake/elastic/field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::oracle {

using elastic::FieldValues;

BoxPoint sample(RandomStream& random, int k, double largest_ratio) {
    BoxPoint p{};
    const bool square = k % 2 == 0;
    p.aspect = square ? 1.0 : random.log_uniform(0.25, 4.0);
    p.box = random.log_uniform(1e-2, 1e2);
    const double longer = p.sides().longer(), shorter = p.sides().shorter();
    p.xi = longer / random.log_uniform(square ? 1e-3 : 4e-3, largest_ratio);
    p.eta = k % 11 == 0 ? random.uniform(-0.5, 0.0) : random.log_uniform(1e-3, 1e3);
    p.heading = headings[k % 7];
    const double r = k % 3 ? random.uniform(0.02, square ? 0.7 : 0.5) * longer
                           : random.log_uniform(1e-2, 0.5) * shorter,
                 angle = random.uniform(-pi, pi);
    p.x = r * std::cos(angle);
    p.y = r * std::sin(angle);
    return p;
}

Norms norms(const FieldValues& f) {
    const auto& e = f.strain;
    return {std::hypot(f.displacement.x, f.displacement.y),
            std::sqrt(e.xx * e.xx + 2.0 * e.xy * e.xy + e.yy * e.yy),
            std::hypot(f.laplacian.x, f.laplacian.y),
            std::hypot(f.gradient_of_trace.x, f.gradient_of_trace.y), std::hypot(f.dipole.x, f.dipole.y)};
}

Norms distances(const FieldValues& a, const FieldValues& b) {
    FieldValues d;
    const auto less = [](elastic::Vector v, elastic::Vector w) {
        return elastic::Vector{v.x - w.x, v.y - w.y};
    };
    d.displacement = less(a.displacement, b.displacement);
    d.strain = {a.strain.xx - b.strain.xx, a.strain.xy - b.strain.xy, a.strain.yy - b.strain.yy};
    d.laplacian = less(a.laplacian, b.laplacian);
    d.gradient_of_trace = less(a.gradient_of_trace, b.gradient_of_trace);
    d.dipole = less(a.dipole, b.dipole);
    Norms n = norms(d);
    for (double& v : n)
        if (!std::isfinite(v))
            v = std::numeric_limits<double>::infinity();
    return n;
}

Norms largest_at(const elastic::PeriodicField& field, double r) {
    return largest_on_circle(r, [&](double x, double y) { return norms(field.at(x, y, plain)); });
}

double worst(const Norms& distances, const Norms& scale) {
    double w = 0.0;
    for (std::size_t q = 0; q < scale.size(); ++q)
        if (!(distances[q] <= w * scale[q]))
            w = scale[q] > 0.0 ? distances[q] / scale[q] : std::numeric_limits<double>::infinity();
    return w;
}

Norms sum(Norms a, const Norms& b, double times) {
    for (std::size_t q = 0; q < a.size(); ++q)
        a[q] += times * b[q];
    return a;
}

FieldValues by_place(const FieldValues& f, bool by_x) {
    FieldValues g;
    g.strain = by_x ? f.strain_x : f.strain_y;
    g.laplacian = by_x ? f.laplacian_x : f.laplacian_y;
    g.gradient_of_trace = by_x ? f.gradient_of_trace_x : f.gradient_of_trace_y;
    return g;
}

double angle_of_change(const BoxPoint& p) {
    const elastic::Vector at =
        elastic::turned(elastic::Vector{p.x, p.y}, std::cos(p.heading), std::sin(p.heading));
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = -5; i <= 5; ++i)
        for (int j = -5; j <= 5; ++j)
            if (i != 0 || j != 0)
                nearest = std::min(nearest, std::hypot(at.x - i * p.sides().x, at.y - j * p.sides().y));
    const double fastest = std::max(1.0, 1.0 / (1.0 + p.eta));
    return std::min({1.0, 2.0 * pi * p.xi / p.sides().longer() / fastest, nearest / std::hypot(p.x, p.y)});
}

elastic::Vector to_rod(double heading, double x, double y) {
    return elastic::turned(elastic::Vector{x, y}, std::cos(heading), -std::sin(heading));
}

} // namespace rodwake::oracle
