#include "periodic_cases.hpp"

#include "rodwake/elastic/field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::oracle {

using elastic::FieldValues;

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

elastic::Vector to_rod(double heading, double x, double y) {
    return elastic::turned(elastic::Vector{x, y}, std::cos(heading), -std::sin(heading));
}

} // namespace rodwake::oracle
