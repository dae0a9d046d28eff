#pragma once
// The lattice on which an adaptive scan places its points: places, cells, and their numbers. It is finer than
// any resolution one will ask for, so a scan whose resolution is raised goes on with the points it has.

#include "rodwake/scan/design.hpp"

namespace rodwake::scan {

class Lattice {
public:
    static constexpr std::size_t max_axes = 3;
    using LatticePoint = std::array<std::int64_t, max_axes>; ///< steps along each axis; 0 beyond the axes

    explicit Lattice(const Design& design);

    std::size_t axes() const { return axes_.size(); }
    /// Halvings from the cells at the start to those at the finest.
    int levels() const { return levels_; }
    /// Steps across a cell of this level; 0 is that of the start.
    std::int64_t stride(int level) const { return std::int64_t{1} << (depth_ - level); }
    std::int64_t steps(std::size_t axis) const { return steps_[axis]; }

    std::int64_t id(const LatticePoint& position) const;
    LatticePoint place(std::int64_t id) const;
    /// 0 at one end of the axis, 1 at the other.
    double fraction(std::size_t axis, std::int64_t step) const {
        return static_cast<double>(step) / static_cast<double>(steps_[axis]);
    }
    Point point(const LatticePoint& place) const;
    /// Where on an edge: as `place`, but at fraction u of `axis`.
    Point point_on(const LatticePoint& place, std::size_t axis, double u) const;

private:
    std::vector<Axis> axes_;
    int levels_ = 0, depth_ = 0;
    LatticePoint steps_{};
};

} // namespace rodwake::scan
