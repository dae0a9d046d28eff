#include "psi6.hpp"

#include "cells.hpp"
#include "delaunay.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/structure.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::measure {

namespace {

using Complex = std::complex<double>;

/// exp(6 i angle) by multiplication: no angle is made, and |.| is 1 to a few roundings. By hand, because
/// std::complex asks after infinities.
Complex sixfold(double dx, double dy) {
    const double size2 = dx * dx + dy * dy;
    const double c = (dx * dx - dy * dy) / size2, s = 2.0 * dx * dy / size2; // twice the angle
    return {c * (c * c - 3.0 * s * s), s * (3.0 * c * c - s * s)};
}

void want_places(const std::vector<double>& x, const std::vector<double>& y, double box) {
    if (x.size() != y.size())
        throw InputError(fmt::format("measure: {} x and {} y coordinates", x.size(), y.size()));
    for (const auto* places : {&x, &y})
        for (const double place : *places)
            if (!(place >= 0.0 && place < box))
                throw InputError(
                    fmt::format("measure: a bead at {} m, outside the box [0, {}): wrong box?", place, box));
}

/// Sums to means.
void divide(LocalOrder& order) {
    for (std::size_t i = 0; i < order.psi.size(); ++i)
        if (order.neighbours[i] > 0)
            order.psi[i] /= static_cast<double>(order.neighbours[i]);
}

double per_bead(double sum, std::size_t beads) { return beads == 0 ? 0.0 : sum / static_cast<double>(beads); }

} // namespace

double LocalOrder::mean_size() const {
    double sum = 0.0;
    for (const Complex& p : psi)
        sum += std::sqrt(std::norm(p));
    return per_bead(sum, psi.size());
}

double LocalOrder::mean_neighbours() const {
    double sum = 0.0;
    for (const int count : neighbours)
        sum += count;
    return per_bead(sum, psi.size());
}

double LocalOrder::global() const {
    Complex sum = 0.0;
    for (const Complex& p : psi)
        sum += p;
    return per_bead(std::abs(sum), psi.size());
}

LocalOrder order_by_cutoff(const std::vector<double>& x, const std::vector<double>& y, double box,
                           double cutoff) {
    want_places(x, y, box);
    if (!(cutoff > 0.0 && cutoff <= 0.5 * box))
        throw InputError(fmt::format("measure: cut-off {} m for neighbours: must be above 0 and at most half "
                                     "the box, {} m",
                                     cutoff, 0.5 * box));
    LocalOrder order{std::vector<Complex>(x.size()), std::vector<int>(x.size(), 0)};
    for_near_pairs(x, y, box, cutoff, [&](std::size_t i, std::size_t j, double dx, double dy) {
        const Complex bond = sixfold(dx, dy); // the same seen from either end: six is even
        order.psi[i] += bond;
        order.psi[j] += bond;
        ++order.neighbours[i];
        ++order.neighbours[j];
    });
    divide(order);
    return order;
}

LocalOrder order_by_delaunay(const std::vector<double>& x, const std::vector<double>& y, double box) {
    want_places(x, y, box);
    LocalOrder order{std::vector<Complex>(x.size()), std::vector<int>(x.size(), 0)};
    for (const Bond& bond : delaunay_bonds(x, y, box)) {
        order.psi[bond.from] += sixfold(bond.dx, bond.dy);
        ++order.neighbours[bond.from];
    }
    divide(order);
    return order;
}

std::vector<Complex> psi6_by_cutoff(const std::vector<double>& x, const std::vector<double>& y, double box,
                                    double cutoff) {
    return order_by_cutoff(x, y, box, cutoff).psi;
}

std::vector<Complex> psi6_by_delaunay(const std::vector<double>& x, const std::vector<double>& y,
                                      double box) {
    return order_by_delaunay(x, y, box).psi;
}

} // namespace rodwake::measure
