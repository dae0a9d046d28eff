#pragma once
// How large the turning rate of a rod in another's wake can be about a place, also at complex displacements:
// by Cauchy's estimates a bound of all its derivatives. docs/numerics.md, section 4. Reduced units, as in
// rods/couplings.hpp; eta >= 0 on the infinite plane. Many places at once: turning_bound_inl.hpp.

#include "rodwake/elastic/medium.hpp"
#include "rodwake/rods/couplings.hpp"

namespace rodwake::rods {

class TurningBound {
public:
    TurningBound(const elastic::Medium& medium, const Couplings& couplings)
        : medium_(medium), couplings_(couplings) {}

    struct Value {
        double rate;  ///< |theta'| at most
        double parts; ///< what it is summed from: its rounding is some ulp of that
    };
    /// About a place at `distance` where r + x is `ahead` in the frame of the source: for all (w+, w-) within
    /// a relative `width` < 1 of those there, and imaginary parts of the angle between the headings up to
    /// ln(1 + width).
    Value at(double distance, double ahead, double width) const;
    /// A width at which the bound is still of the rate's own size.
    double suitable_width(double distance, double ahead) const;

private:
    elastic::Medium medium_;
    Couplings couplings_;
};

} // namespace rodwake::rods
