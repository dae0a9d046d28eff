#pragma once
// The likelihood of a displacement in one cell (phase.cpp has the equation).

#include "blocks.hpp"
#include "displacement_impl.hpp"
#include "regrid.hpp"

#include <array>
#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace rodwake::measure {

// The blocks of all runs of an estimator with phases, ready to be put together.

struct PhaseBlock {
    std::span<const double> sums; ///< [bin][PhaseAccumulator::channels]
    std::array<Vector2, 3> g;     ///< along the rod's axes
    std::array<int, 3> m{}, n{};  ///< of the lattice
    double heading = 0.0, frames = 0.0;
    Follows follows = Follows::nothing;
};

/// `smoothed` holds the sums of those that are made new: for `density` the far field's phases of each block
/// are taken off and the sums are averaged over a window wider than the lattice spacing; in a window of
/// tracks they are copies.
std::vector<PhaseBlock> phase_blocks(std::span<const DisplacementAccumulator> runs,
                                     std::vector<std::vector<double>>& smoothed);

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

/// Sums of all blocks over some bins, the phases of each bin taken back by what U differs there.
class PhaseCell {
public:
    PhaseCell(const std::vector<PhaseBlock>& blocks, const std::vector<CellPart>& parts);

    double total(std::size_t channel) const;
    /// Moves u to the maximum; stays where the likelihood is not concave.
    void solve(Vector2& u);
    /// What each block moves u by.
    std::vector<Vector2> pulls(const Vector2& u);
    /// Blocks with beads in the cell.
    std::vector<bool> present() const;
    /// Mean over the peaks of |mean exp(i phase)|, phases counted from g.u of the last call.
    double coherence() const;

private:
    using Sums = std::array<double, PhaseAccumulator::channels>;

    void look(const Vector2& u);
    std::optional<Vector2> inverse(const Vector2& v) const;

    const std::vector<PhaseBlock>& blocks_;
    std::vector<Sums> sums_;
    std::vector<Vector2> slopes_; ///< of each block's likelihood
    double xx_ = 0.0, xy_ = 0.0, yy_ = 0.0, in_phase_ = 0.0, longest_ = 0.0;
};

// In a window the crystal's lattice is known no better than the far field of a block of time tells it, and
// that is strained by the wake itself, otherwise in each block, as the rod is elsewhere. So each block has a
// linear function of its own in its displacements,
//
//   u_b(r) = U(r) + c_b + A_b r,
//
// which is found together with U, in turns, from what the blocks have in common. What remains unknown is one
// linear function for all: U is given such that it has none where it is far.

/// Takes c_b + A_b r off `sums`, which those of the blocks refer to. `u`: a first guess of U in each bin,
/// then U. Nearer to the rod than `from` nothing is fitted; `far_from`: where U has no linear function.
void take_off_strain(const std::vector<PhaseBlock>& blocks, std::vector<std::vector<double>>& sums,
                     const RodGrid& grid, double from, double far_from, std::vector<Vector2>& u);

} // namespace rodwake::measure
