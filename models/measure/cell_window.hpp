#pragma once
// Means over one cell of the crystal's lattice, around the middle of each bin.
//
// Where the rod keeps its place relative to the lattice, beads come to some places more than to others, and
// those that come to the others do so because they are displaced by more or less than the mean. What belongs
// to a place is therefore an average over all places of a cell. The window 1 - (r/R)^2 with R = 0.71 lattice
// spacings has no Fourier content at the first reciprocal vectors.
//
// It is gone through twice: plain means first, which belong to the centre of their data; then means from
// which the differences of the first ones across the window are taken out, which belong to the middle of the
// bin. Differences between single bins would not do: within a cell they are those of the beads that come
// there, not of U.

#include "local_fit.hpp"

#include <optional>
#include <vector>

namespace rodwake::measure {

struct CellPart {
    std::size_t bin;
    double weight;
    Vector2 difference; ///< U of this bin's mean place minus U of the middle
};

struct CellMean {
    std::vector<CellPart> parts;
    Vector2 guess;      ///< U at the middle
    Vector2 place;      ///< of the beads, from the middle, m
    double count = 0.0; ///< mean of the bins in the window: beads of a bin
};

/// Of a perfect triangular lattice with the bed's number of beads, m.
double lattice_spacing(const Layout& layout);

class CellWindow {
public:
    /// Parts are the bins; differences of U come from `smooth`, are 0 without. Keeps the references.
    CellWindow(const BinSamples& bins, const BinSamples* smooth, const RodGrid& grid, double lattice_spacing);
    /// No parts where the window is empty or, for differences, its data are all to one side.
    CellMean around(std::size_t bin) const;

private:
    const BinSamples& bins_;
    const BinSamples* smooth_;
    const RodGrid& grid_;
    Scattered scattered_;
    std::optional<Scattered> to_fit_;
    double radius_; ///< in spacings
};

} // namespace rodwake::measure
