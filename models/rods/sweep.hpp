#pragma once
// Rods in the order of one coordinate, so that near pairs are found without looking at all N(N - 1)/2.

#include "rodwake/rods/separation.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace rodwake::rods {

/// Two rods are at least as far apart as their coordinates along one axis, here that along which they are
/// spread widest. Going up from each rod, all that follow can be left out as soon as one is too far. Cost:
/// N log N, and the pairs that stay.
class Sweep {
public:
    /// Up to a few rods, or with a place that is not finite, nothing is sorted and all pairs are seen.
    Sweep(integrate::State y, Box box);

    /// Calls see(a, b), a < b, for pairs of rods, some twice, in no order to rely on. Left out are only pairs
    /// for which beyond(gap) holds, or held of a smaller gap: `gap` is at most their separation along the
    /// axis (on the plane equal to it to the bit). beyond() may come to hold for more gaps from one call to
    /// the next, never for fewer; so that it soon holds for most, next neighbours are seen first.
    template<class Beyond, class See>
    void pairs(const Beyond& beyond, const See& see) const {
        if (order_.empty()) {
            for (std::size_t a = 0; a < rods_; ++a)
                for (std::size_t b = a + 1; b < rods_; ++b)
                    see(a, b);
            return;
        }
        const std::size_t rods = order_.size();
        const auto up_from = [&](std::size_t i, std::size_t first, std::size_t last) {
            for (std::size_t k = first; k <= last; ++k) {
                const bool around = i + k >= rods;
                const std::size_t j = around ? i + k - rods : i + k;
                const double gap = at_[j] - at_[i] + (around ? around_ : 0.0) - rounding_;
                if (gap > farthest_ || beyond(gap))
                    return;
                see(std::min<std::size_t>(order_[i], order_[j]), std::max<std::size_t>(order_[i], order_[j]));
            }
        };
        for (std::size_t i = 0; i < rods; ++i)
            up_from(i, 1, 1);
        for (std::size_t i = 0; i < rods; ++i)
            up_from(i, 2, rods - 1);
    }

private:
    std::size_t rods_;
    std::vector<std::uint32_t> order_;                        ///< empty: not sorted
    std::vector<double> at_;                                  ///< coordinates, growing; in a box within it
    double around_ = std::numeric_limits<double>::infinity(); ///< side of the box along it
    double farthest_ = std::numeric_limits<double>::max();    ///< half of it: the other way round is nearer
    double rounding_ = 0.0; ///< what wrapping a coordinate into the box may change a gap by
};

} // namespace rodwake::rods
