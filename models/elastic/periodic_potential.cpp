#include "periodic_potential.hpp"

#include "periodic_images.hpp"

#include <cmath>

namespace rodwake::elastic {

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
