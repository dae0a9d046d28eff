#pragma once
// One potential of the periodic box,
//
//   lap G + 2 c.grad G = -2 pi (delta_per - 1/(X Y)),    c = c (ux, uy), of zero mean over the box
//
// in the cell |x| <= X/2, |y| <= Y/2 about the rod, the sides in units of the shorter one. Far from the rod
// it is summed as columns or rows, whichever the place is farther from; near it, what it has more than the
// infinite plane's exp(-c.r) K0(c r) is.

#include "periodic_local.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace rodwake::elastic {

/// |x| and |y| below it: near.
inline constexpr double near_rod = 0.22;
inline bool is_near(double x, double y) { return std::max(std::abs(x), std::abs(y)) < near_rod; }

class PeriodicPotential {
public:
    PeriodicPotential(const WaveVector& c, const PeriodicBox& box);

    /// Far: the whole potential; near: without the infinite plane's.
    Jets at(double x, double y, Needed needed) const;

    double c() const { return c_.c; }

private:
    Jets far(double x, double y, Needed needed) const;
    Jets near(double x, double y, Needed needed) const;

    WaveVector c_;
    PeriodicBox box_;
    Rows columns_, rows_; ///< rows: with x and y exchanged
    std::optional<LocalRest> local_;
};

} // namespace rodwake::elastic
