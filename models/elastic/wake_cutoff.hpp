#pragma once
// Where a source may be left out of a sum, as a rule that costs a few nanoseconds: WakeBound worked out
// ahead.

#include "rod_tiles.hpp"

#include "rodwake/elastic/wake_bound.hpp"

namespace rodwake::elastic {

/// Largest contributions that may be left out; polar only where `with_polar`.
struct Cutoff {
    double strain, polar;
    bool with_polar;
};

class WakeCutoff {
public:
    WakeCutoff(const Medium& medium, const Cutoff& cutoff);

    /// Whether the source's field is below the cutoff everywhere in the circle.
    bool skips(const KernelSource& source, const Circle& circle) const;

private:
    double inverse_xi_;
    std::vector<double>
        least_; ///< (r + x)/xi from which on all is below the cutoff, by steps of the distance
};

} // namespace rodwake::elastic
