#include "rodwake/core/bond_order.hpp"

#include "rodwake/core/cell_list.hpp"
#include "rodwake/core/periodic.hpp"

#include <cmath>
#include <numeric>

namespace rodwake {

namespace {

using Complex = std::complex<double>;

double per_bead(double sum, std::size_t beads) { return beads == 0 ? 0.0 : sum / static_cast<double>(beads); }

/// Bonds from either end, sorted by (from, to) in two passes: by `to`, then, keeping that order, by `from`.
/// As many lead to a bead as from it.
std::vector<Bond> sorted_from_either_end(const std::vector<Bond>& half, std::size_t beads) {
    std::vector<std::size_t> start(beads + 1, 0);
    for (const Bond& bond : half)
        for (const std::size_t end : {bond.from, bond.to})
            ++start[end + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<Bond> by_to(2 * half.size()), sorted(2 * half.size());
    std::vector<std::size_t> next = start;
    for (const Bond& bond : half) {
        by_to[next[bond.to]++] = bond;
        by_to[next[bond.from]++] = {bond.to, bond.from, -bond.dx, -bond.dy};
    }
    next = start;
    for (const Bond& bond : by_to)
        sorted[next[bond.from]++] = bond;
    return sorted;
}

} // namespace

std::vector<Bond> bonds_within(std::span<const double> x, std::span<const double> y, const PeriodicBox& box,
                               double cutoff) {
    const CellList cells(x, y, box, cutoff);
    std::vector<Bond> half;
    half.reserve(4 * x.size());
    cells.pairs([&](std::size_t p, std::size_t q) {
        const double dx = nearest_image_rounded(cells.x()[q] - cells.x()[p], box.x),
                     dy = nearest_image_rounded(cells.y()[q] - cells.y()[p], box.y), r2 = dx * dx + dy * dy;
        if (r2 < cutoff * cutoff && r2 > 0.0)
            half.push_back({cells.member()[p], cells.member()[q], dx, dy});
    });
    return sorted_from_either_end(half, x.size());
}

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

LocalOrder bond_order(std::size_t beads, std::span<const Bond> bonds) {
    LocalOrder order{std::vector<Complex>(beads), std::vector<int>(beads, 0)};
    for (const Bond& bond : bonds) {
        // exp(6 i angle) by multiplication: no angle is made, and |.| is 1 to a few roundings. By hand,
        // because std::complex asks after infinities.
        const double size2 = bond.dx * bond.dx + bond.dy * bond.dy;
        const double c2 = (bond.dx * bond.dx - bond.dy * bond.dy) / size2,
                     s2 = (bond.dx * bond.dy + bond.dy * bond.dx) / size2; // twice the angle
        const double c4 = c2 * c2 - s2 * s2, s4 = c2 * s2 + s2 * c2;
        order.psi[bond.from] += Complex{c4 * c2 - s4 * s2, c4 * s2 + s4 * c2};
        ++order.neighbours[bond.from];
    }
    for (std::size_t i = 0; i < beads; ++i)
        if (order.neighbours[i] > 0)
            order.psi[i] /= static_cast<double>(order.neighbours[i]);
    return order;
}

} // namespace rodwake
