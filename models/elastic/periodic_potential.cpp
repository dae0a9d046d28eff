#include "periodic_potential.hpp"

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

// Near the rod, for wave numbers c of 6 over the box and more: the infinite plane's potentials of the images
// in the rod's own column, exp(-c.r) K0(c r) each.

/// One source at the origin, heading (ux, uy); c r > 0.5.
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

/// Those at (0, j), j != 0, as far as they exceed e^-40; |ux| >= |uy|, so that none lies in the wake of all.
void add_column_images(Jets& sum, double c, double ux, double uy, double x, double y, Needed needed) {
    for (const double side : {-1.0, 1.0})
        for (double j = side;; j += side) {
            const double dy = y - j;
            if (c * (std::hypot(x, dy) + ux * x + uy * dy) > cutoff)
                break;
            add_source(sum, c, ux, uy, x, dy, needed);
        }
}

} // namespace

PeriodicPotential::PeriodicPotential(double c, double ux, double uy)
    : c_(c), ux_(ux), uy_(uy), columns_(c, ux, uy, near_rod), rows_(c, uy, ux, near_rod) {
    if (c <= LocalRest::largest_c)
        local_.emplace(c, ux, uy, columns_, rows_);
}

Jets PeriodicPotential::at(double x, double y, Needed needed) const {
    return is_near(x, y) ? near(x, y, needed) : far(x, y, needed);
}

Jets PeriodicPotential::far(double x, double y, Needed needed) const {
    Jets sum;
    if (std::abs(x) >= std::abs(y)) {
        columns_.add_all(sum, x < 0.0 ? x + 1.0 : x, y, needed);
        return sum;
    }
    rows_.add_all(sum, y < 0.0 ? y + 1.0 : y, x, needed);
    return {exchanged(sum.g), exchanged(sum.by_c)};
}

/// Of the two directions of a column the one the rod heads across: wakes do not run along it.
Jets PeriodicPotential::near(double x, double y, Needed needed) const {
    Jets sum;
    if (local_) {
        local_->add(sum, x, y, needed);
        return sum;
    }
    if (std::abs(ux_) >= std::abs(uy_)) {
        columns_.add_others(sum, x, y, needed);
        add_column_images(sum, c_, ux_, uy_, x, y, needed);
        return sum;
    }
    rows_.add_others(sum, y, x, needed);
    add_column_images(sum, c_, uy_, ux_, y, x, needed);
    return {exchanged(sum.g), exchanged(sum.by_c)};
}

} // namespace rodwake::elastic
