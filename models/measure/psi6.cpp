#include "psi6.hpp"

#include "rodwake/core/cell_list.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/measure/order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::measure {

namespace {

using Complex = std::complex<double>;

void want_places(const std::vector<double>& x, const std::vector<double>& y, const PeriodicBox& box) {
    if (x.size() != y.size())
        throw InputError(fmt::format("measure: {} x and {} y coordinates", x.size(), y.size()));
    for (const auto& [places, side] : {std::pair(&x, box.x), std::pair(&y, box.y)})
        for (const double position : *places)
            if (!(position >= 0.0 && position < side))
                throw InputError(fmt::format("measure: a bead at {} m, outside the box [0, {}): wrong box?",
                                             position, side));
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

namespace {

constexpr double shortest_edge = 1e-7; // of the shorter side
constexpr double widest = 1.5; // of the longer side: no empty circle through a bead reaches beyond sqrt(2)

/// Beads around one bead, relative to it.
struct SurroundingBeads {
    std::vector<std::size_t> bead;
    std::vector<double> x, y;

    SurroundingBeads() { // room for a usual bead: growing costs more than looking
        bead.reserve(24);
        x.reserve(24);
        y.reserve(24);
    }
    void add(std::size_t b, double dx, double dy) {
        bead.push_back(b);
        x.push_back(dx);
        y.push_back(dy);
    }
    double size2(std::size_t k) const { return x[k] * x[k] + y[k] * y[k]; }
};

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// A neighbour and the circle through it, the bead in the middle and the next neighbour anticlockwise.
struct Turn {
    std::size_t next = none;
    double x = 0.0, y = 0.0; ///< centre of the circle
};

/// Centres of circles through 0 and p lie at p/2 + t (-p_y, p_x). The circle of the smallest t among the
/// beads left of p has none of them inside.
Turn turn_from(const SurroundingBeads& near, std::size_t p, std::vector<double>& t) {
    const double px = near.x[p], py = near.y[p];
    const std::size_t count = near.bead.size();
    t.resize(std::max(t.size(), count));
    for (std::size_t k = 0; k < count; ++k) {
        const double qx = near.x[k], qy = near.y[k], cross = px * qy - py * qx;
        const double along = (qx * (qx - px) + qy * (qy - py)) / (2.0 * cross);
        t[k] = cross > 0.0 ? along : std::numeric_limits<double>::infinity();
    }
    const auto least = std::min_element(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(count));
    if (!std::isfinite(*least))
        return {};
    return {static_cast<std::size_t>(least - t.begin()), 0.5 * px - *least * py, 0.5 * py + *least * px};
}

/// Appends the bonds of bead `from`; false if the beads within the reach do not tell.
bool follow(const SurroundingBeads& near, std::size_t from, double reach, const PeriodicBox& box,
            std::vector<Bond>& bonds, std::vector<double>& scratch) {
    std::size_t best = none;
    for (std::size_t b = 0; b < near.bead.size(); ++b)
        if (best == none || near.size2(b) < near.size2(best))
            best = b;
    const std::size_t first = best, before = bonds.size();
    if (first == none)
        return false;
    std::size_t at = first;
    Turn last;
    double first_x = 0.0, first_y = 0.0;
    const auto add = [&](std::size_t k, double edge_x, double edge_y) {
        if (std::sqrt(edge_x * edge_x + edge_y * edge_y) >= shortest_edge * box.shorter())
            bonds.push_back({from, near.bead[k], near.x[k], near.y[k]});
    };
    for (std::size_t step = 0; step <= near.bead.size(); ++step) {
        const Turn turn = turn_from(near, at, scratch);
        if (turn.next == none || 2.0 * std::sqrt(turn.x * turn.x + turn.y * turn.y) > reach)
            break;
        if (step == 0) {
            first_x = turn.x;
            first_y = turn.y;
        } else {
            add(at, turn.x - last.x, turn.y - last.y);
        }
        last = turn;
        at = turn.next;
        if (at == first) {
            add(first, first_x - last.x, first_y - last.y);
            return true;
        }
    }
    bonds.resize(before);
    return false;
}

void follow_farther(const std::vector<double>& x, const std::vector<double>& y, std::size_t i, double reach,
                    const PeriodicBox& box, std::vector<Bond>& bonds, std::vector<double>& scratch) {
    while (reach < widest * box.longer()) {
        reach = std::min(2.0 * reach, widest * box.longer());
        // All beads and images within the reach of a bead, straight from the list of all.
        SurroundingBeads near;
        const auto images = [&](double side) { // up to half the box nearest images are all there are
            return reach <= 0.5 * box.shorter() ? 0 : static_cast<int>(std::ceil(reach / side + 0.5));
        };
        const int most_m = images(box.x), most_n = images(box.y);
        for (int m = -most_m; m <= most_m; ++m)
            for (int n = -most_n; n <= most_n; ++n)
                for (std::size_t j = 0; j < x.size(); ++j) {
                    const double dx = nearest_image_once(x[j] - x[i], box.x) + m * box.x;
                    const double dy = nearest_image_once(y[j] - y[i], box.y) + n * box.y;
                    const double r2 = dx * dx + dy * dy;
                    if (r2 > 0.0 && r2 < reach * reach)
                        near.add(j, dx, dy);
                }
        if (follow(near, i, reach, box, bonds, scratch))
            return;
    }
    throw RunError("measure: no Delaunay triangulation of these beads");
}

} // namespace

std::vector<Bond> delaunay_bonds(const std::vector<double>& x, const std::vector<double>& y,
                                 const PeriodicBox& box) {
    std::vector<Bond> bonds;
    if (x.empty())
        return bonds;
    // A dozen beads, enough for most. Not beyond half the box, where nearest images are not all.
    const double reach =
        std::min(2.0 * box.mean_side() / std::sqrt(static_cast<double>(x.size())), 0.5 * box.shorter());
    std::vector<SurroundingBeads> near(x.size());
    std::vector<double> scratch;
    const CellList cells(x, y, box, reach);
    cells.pairs([&](std::size_t p, std::size_t q) {
        const std::size_t i = cells.member()[p], j = cells.member()[q];
        const double dx = nearest_image_once(cells.x()[q] - cells.x()[p], box.x);
        const double dy = nearest_image_once(cells.y()[q] - cells.y()[p], box.y);
        const double r2 = dx * dx + dy * dy;
        if (!(r2 < reach * reach && r2 > 0.0))
            return;
        near[i].add(j, dx, dy);
        near[j].add(i, -dx, -dy);
    });
    for (std::size_t i = 0; i < x.size(); ++i)
        if (!follow(near[i], i, reach, box, bonds, scratch))
            follow_farther(x, y, i, reach, box, bonds, scratch);
    return bonds;
}

double bond_loss(std::span<const double> r, std::span<const double> g, double cutoff, double localisation) {
    double sum = 0.0, bonds = 0.0;
    for (std::size_t k = 0; k < r.size() && r[k] < cutoff; ++k) {
        sum += g[k] * r[k] * std::exp(-36.0 * std::pow(localisation / r[k], 2));
        bonds += g[k] * r[k];
    }
    return bonds > 0.0 ? sum / bonds : 1.0;
}

} // namespace rodwake::measure
