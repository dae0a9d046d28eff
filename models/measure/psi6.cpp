#include "psi6.hpp"

#include "delaunay.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/order.hpp"

#include <fmt/format.h>

namespace rodwake::measure {

namespace {

using Complex = std::complex<double>;

void want_places(const std::vector<double>& x, const std::vector<double>& y, const PeriodicBox& box) {
    if (x.size() != y.size())
        throw InputError(fmt::format("measure: {} x and {} y coordinates", x.size(), y.size()));
    for (const auto& [places, side] : {std::pair(&x, box.x), std::pair(&y, box.y)})
        for (const double place : *places)
            if (!(place >= 0.0 && place < side))
                throw InputError(
                    fmt::format("measure: a bead at {} m, outside the box [0, {}): wrong box?", place, side));
}

} // namespace

LocalOrder order_by_cutoff(const std::vector<double>& x, const std::vector<double>& y, const PeriodicBox& box,
                           double cutoff) {
    want_places(x, y, box);
    if (!(cutoff > 0.0 && cutoff <= 0.5 * box.shorter()))
        throw InputError(fmt::format("measure: cut-off {} m for neighbours: must be above 0 and at most half "
                                     "the box, {} m",
                                     cutoff, 0.5 * box.shorter()));
    return bond_order(x.size(), bonds_within(x, y, box, cutoff));
}

LocalOrder order_by_delaunay(const std::vector<double>& x, const std::vector<double>& y,
                             const PeriodicBox& box) {
    want_places(x, y, box);
    return bond_order(x.size(), delaunay_bonds(x, y, box));
}

std::vector<Complex> psi6_by_cutoff(const std::vector<double>& x, const std::vector<double>& y,
                                    const PeriodicBox& box, double cutoff) {
    return order_by_cutoff(x, y, box, cutoff).psi;
}

std::vector<Complex> psi6_by_delaunay(const std::vector<double>& x, const std::vector<double>& y,
                                      const PeriodicBox& box) {
    return order_by_delaunay(x, y, box).psi;
}

} // namespace rodwake::measure
