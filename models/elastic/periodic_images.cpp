#include "periodic_images.hpp"

#include "bessel.hpp"

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace rodwake::elastic {

namespace {

constexpr double cutoff = 40.0;

/// Of a function of u = r^2/2 with two derivatives.
Jet radial(double f, double f1, double f2, double x, double y) {
    return {f, x * f1, y * f1, f1 + x * x * f2, x * y * f2, f1 + y * y * f2};
}

} // namespace

void add_source(Jets& sum, double c, double ux, double uy, double x, double y, Needed needed) {
    const double r = std::hypot(x, y), z = c * r, along = ux * x + uy * y, cx = c * ux, cy = c * uy;
    const double decay = std::exp(-c * (r + along));
    const Bessel k = scaled_bessel(1.0 / z, std::sqrt(std::numbers::pi / (2.0 * z)));
    const double first = -c * k.k1 / r, k2 = k.k0 + 2.0 * k.k1 / z;
    const Jet k0 = radial(k.k0, first, c * c * k2 / (r * r), x, y);
    sum.g += times_decay(decay, cx, cy, k0);
    if (!needed.by_c)
        return;
    const Jet rk1 = radial(r * k.k1, -c * k.k0, c * c * k.k1 / r, x, y);
    sum.by_c += times_decay(-decay, cx, cy, times_line(along, ux, uy, k0) + rk1);
}

void add_column_images(Jets& sum, double c, double ux, double uy, double x, double y, Needed needed) {
    for (const double side : {-1.0, 1.0})
        for (double j = side;; j += side) {
            const double dy = y - j;
            if (c * (std::hypot(x, dy) + ux * x + uy * dy) > cutoff)
                break;
            add_source(sum, c, ux, uy, x, dy, needed);
        }
}

} // namespace rodwake::elastic
