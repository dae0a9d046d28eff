#pragma once
// A refinement against the full lattice at its resolution.

#include "maps.hpp"

namespace scan_test {

/// Refined to the end on the map; audits and boundaries are another matter.
inline Refinement refined(const Design& design, const Map& map) {
    Refinement refinement(design);
    for (auto points = refinement.next(); !points.empty(); points = refinement.next())
        for (const Point& point : points)
            refinement.learn(result_of(map, point));
    return refinement;
}

/// The finest cells, as numbers of cells along each axis.
class FineCells {
public:
    explicit FineCells(const Lattice& lattice)
        : axes_(lattice.axes()), side_(lattice.stride(lattice.levels())) {
        for (std::size_t k = 0; k < lattice.axes(); ++k)
            count_[k] = lattice.steps(k) / side_;
    }

    std::int64_t total() const { return count_[0] * count_[1] * count_[2]; }
    std::int64_t count(std::size_t axis) const { return count_[axis]; }
    std::size_t number(const Lattice::LatticePoint& cell) const {
        return static_cast<std::size_t>((cell[0] * count_[1] + cell[1]) * count_[2] + cell[2]);
    }
    /// Calls `each` with every finest cell of a leaf; corners too: with every finest place in it.
    template<class Each>
    void in(const Leaf& leaf, bool places, Each each) const {
        const auto end = [&](std::size_t k) {
            return k < axes_ ? (leaf.low[k] + leaf.side) / side_ + (places ? 1 : 0) : 1;
        };
        for (std::int64_t i = leaf.low[0] / side_; i < end(0); ++i)
            for (std::int64_t j = leaf.low[1] / side_; j < end(1); ++j)
                for (std::int64_t k = leaf.low[2] / side_; k < end(2); ++k)
                    each(Lattice::LatticePoint{i, j, k});
    }
    Lattice::LatticePoint place(const Lattice::LatticePoint& cell) const {
        return {cell[0] * side_, cell[1] * side_, cell[2] * side_};
    }

private:
    std::size_t axes_;
    std::int64_t side_;
    std::array<std::int64_t, 3> count_{1, 1, 1};
};

/// Places of the full lattice that the cells get wrong: in a cell of one outcome and with another, or cells
/// that are mixed and not of the finest size.
inline std::int64_t wrong_places(const Lattice& lattice, const std::vector<Leaf>& leaves, const Map& map) {
    const FineCells cells(lattice);
    std::int64_t wrong = 0;
    for (const Leaf& leaf : leaves) {
        if (leaf.mixed) {
            wrong += leaf.side != lattice.stride(lattice.levels());
            continue;
        }
        cells.in(leaf, true, [&](const Lattice::LatticePoint& cell) {
            wrong += std::max(map(lattice.point(cells.place(cell)).at), -1) != leaf.outcome;
        });
    }
    return wrong;
}

/// Side of the leaf over each finest cell, by its number; empty unless each is covered exactly once.
inline std::vector<std::int64_t> tiling(const Lattice& lattice, const std::vector<Leaf>& leaves) {
    const FineCells cells(lattice);
    std::vector<std::int64_t> side(static_cast<std::size_t>(cells.total()), 0);
    bool once = true;
    for (const Leaf& leaf : leaves)
        cells.in(leaf, false, [&](const Lattice::LatticePoint& cell) {
            once = once && side[cells.number(cell)] == 0;
            side[cells.number(cell)] = leaf.side;
        });
    if (!once || std::ranges::count(side, 0) > 0)
        side.clear();
    return side;
}

/// Cells that touch along a face differ by a factor of two at most.
inline bool is_balanced(const Lattice& lattice, const std::vector<Leaf>& leaves) {
    const FineCells cells(lattice);
    const std::vector<std::int64_t> side = tiling(lattice, leaves);
    bool balanced = !side.empty();
    for (const Leaf& leaf : leaves)
        cells.in(leaf, false, [&](const Lattice::LatticePoint& cell) {
            for (std::size_t k = 0; k < lattice.axes(); ++k) {
                Lattice::LatticePoint next = cell;
                if (++next[k] >= cells.count(k))
                    continue;
                const std::int64_t a = side[cells.number(cell)], b = side[cells.number(next)];
                balanced = balanced && a <= 2 * b && b <= 2 * a;
            }
        });
    return balanced;
}

} // namespace scan_test
