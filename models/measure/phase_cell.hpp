#pragma once
// The likelihood of a displacement in one cell (phase_samples.hpp has the equation).

#include "cell_window.hpp"
#include "phase_blocks.hpp"

#include <array>
#include <complex>
#include <optional>
#include <vector>

namespace rodwake::measure {

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

    static void add(const PhaseBlock& block, const CellPart& part, Sums& to);
    void look(const Vector2& u);
    void look(const Vector2& g, const std::complex<double>& z, Vector2& slope);
    std::optional<Vector2> inverse(const Vector2& v) const;

    const std::vector<PhaseBlock>& blocks_;
    std::vector<Sums> sums_;
    std::vector<Vector2> slopes_; ///< of each block's likelihood
    double xx_ = 0.0, xy_ = 0.0, yy_ = 0.0, in_phase_ = 0.0, longest_ = 0.0;
};

} // namespace rodwake::measure
