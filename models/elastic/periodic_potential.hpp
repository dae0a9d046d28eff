#pragma once
// One potential of the periodic box,
//
//   lap G + 2 c.grad G = -2 pi (delta_per - 1),    c = c (ux, uy), box side 1, of zero mean over the box
//
// in the cell |x|, |y| <= 1/2 about the rod. Far from the rod it is summed as columns or rows, whichever the
// place is farther from; near it, what it has more than the infinite plane's exp(-c.r) K0(c r) is.

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
    explicit PeriodicPotential(const WaveVector& c);

    /// Far: the whole potential; near: without the infinite plane's.
    Jets at(double x, double y, Needed needed) const;

    double c() const { return c_.c; }

private:
    Jets far(double x, double y, Needed needed) const;
    Jets near(double x, double y, Needed needed) const;

    WaveVector c_;
    Rows columns_, rows_; ///< rows: with x and y exchanged
    std::optional<LocalRest> local_;
};

} // namespace rodwake::elastic
