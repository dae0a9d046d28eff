#include "periodic_potential.hpp"

#include "bessel.hpp"

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace rodwake::elastic {

namespace {

constexpr double cutoff = 40.0;

/// Of a function of u = r^2/2 with three derivatives.
Jet radial(double f, double f1, double f2, double f3, double x, double y) {
    return {f,
            x * f1,
            y * f1,
            f1 + x * x * f2,
            x * y * f2,
            f1 + y * y * f2,
            x * (3.0 * f2 + x * x * f3),
            y * (f2 + x * x * f3),
            x * (f2 + y * y * f3),
            y * (3.0 * f2 + y * y * f3)};
}

// Near the rod, for wave numbers c of 6 over the box and more: the infinite plane's potentials of the images
// in the rod's own column, exp(-c.r) K0(c r) each.

/// One source at the origin; c r > 0.5, exponent = c r + c.r.
void add_source(Jets& sum, const WaveVector& c, double x, double y, double r, double exponent,
                Needed needed) {
    const double k = c.c, z = k * r, cx = k * c.ux, cy = k * c.uy, decay = std::exp(-exponent);
    const Bessel b = scaled_bessel(1.0 / z, std::sqrt(std::numbers::pi / (2.0 * z)));
    const double per_r = 1.0 / r, s = k * per_r, k2 = b.k0 + 2.0 * b.k1 / z, k3 = b.k1 + 4.0 * k2 / z;
    const Jet k0 = radial(b.k0, -s * b.k1, s * s * k2, -s * s * s * k3, x, y);
    sum.g += times_decay(decay, cx, cy, k0, needed.third);
    if (!needed.by_c)
        return;
    const Jet rk1 = radial(r * b.k1, -k * b.k0, k * s * b.k1, -k * s * s * k2, x, y);
    sum.by_c += times_decay(-decay, cx, cy, times_line(c.wx * x + c.wy * y, c.wx, c.wy, k0) + c.along() * rk1,
                            needed.third);
}

/// Those at (0, j Y), j != 0, as far as they exceed e^-40; |ux| >= |uy|, so that none lies in the wake of
/// all.
void add_column_images(Jets& sum, const WaveVector& c, double period, double x, double y, Needed needed) {
    for (const double side : {-1.0, 1.0})
        for (double j = side;; j += side) {
            const double dy = y - j * period, r = std::hypot(x, dy),
                         exponent = c.c * (r + c.ux * x + c.uy * dy);
            if (exponent > cutoff)
                break;
            add_source(sum, c, x, dy, r, exponent, needed);
        }
}

} // namespace

PeriodicPotential::PeriodicPotential(const WaveVector& c, const PeriodicBox& box)
    : c_(c), box_(box), columns_(c, box, near_rod), rows_(c.exchanged(), exchanged(box), near_rod) {
    if (c.c <= LocalRest::largest_c)
        local_.emplace(c, box, columns_, rows_);
}

Jets PeriodicPotential::at(double x, double y, Needed needed) const {
    return is_near(x, y) ? near(x, y, needed) : far(x, y, needed);
}

Jets PeriodicPotential::far(double x, double y, Needed needed) const {
    Jets sum;
    if (std::abs(x) >= std::abs(y)) {
        columns_.add_all(sum, x < 0.0 ? x + box_.x : x, y, needed);
        return sum;
    }
    rows_.add_all(sum, y < 0.0 ? y + box_.y : y, x, needed);
    return {exchanged(sum.g), needed.by_c ? exchanged(sum.by_c) : Jet{}};
}

/// Of the two directions of a column the one the rod heads across: wakes do not run along it.
Jets PeriodicPotential::near(double x, double y, Needed needed) const {
    Jets sum;
    if (local_) {
        local_->add(sum, x, y, needed);
        return sum;
    }
    if (std::abs(c_.ux) >= std::abs(c_.uy)) {
        columns_.add_others(sum, x, y, needed);
        add_column_images(sum, c_, box_.y, x, y, needed);
        return sum;
    }
    rows_.add_others(sum, y, x, needed);
    add_column_images(sum, c_.exchanged(), box_.x, y, x, needed);
    return {exchanged(sum.g), exchanged(sum.by_c)};
}

} // namespace rodwake::elastic
