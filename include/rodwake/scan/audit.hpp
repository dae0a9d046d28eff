#pragma once
// What an adaptive scan may have missed: random places in cells that were not divided are tried. The share of
// them that have another outcome than their cell estimates how much of that area is wrong.

#include "rodwake/scan/refinement.hpp"

namespace rodwake::scan {

struct Audit {
    std::int64_t tried = 0, missed = 0;

    double rate() const;
    /// Upper end of the 95 % interval (one-sided, Clopper and Pearson 1934); 1 if nothing was tried.
    double upper_bound() const;
};

/// Places of round `round`, distinct, in undivided cells that are not mixed; never a corner of one. Fewer
/// than asked for where there are not enough.
std::vector<Point> audit_points(const Refinement& refinement, const Design& design, std::uint32_t round);

/// Whether a result differs from the cell it lies in.
bool is_missed(const Refinement& refinement, const Result& result);

} // namespace rodwake::scan
