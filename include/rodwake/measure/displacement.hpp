#pragma once
// The displacement field U of the beads around a moving rod, in the frame that moves and turns with it
// (rod_grid.hpp), with a standard error in each bin. In a bed without rods a moving force stands for the rod
// (Layout::force): the frame is its centre's, x along the force.
//
// Convention, the paper's rho_0(r) = rho(r + U(r)): U at r is the displacement of what would be at r if the
// rod were not there. Both r and U are in the rod's frame. U is relative to its mean over the box (reference
// box: the zero Fourier mode removed, as in the periodic solution of docs/numerics.md) or to the beads
// farther than far_from from the rod (reference far). The drift of the crystal as a whole drops out of both.
//
// Estimators:
//   phase       Local phases of the crystal's Bragg peaks: bead i at r_i carries exp(i G_k.r_i), which is
//               exp(i G_k.u(r_i)), G_k the three first reciprocal vectors. Means of it in bins over time,
//               relative to the far field at each time, give G_k.U; three give U by least squares, unwrapped
//               from the far field inwards. Blind to slip by whole lattice vectors, hence robust. Outside
//               3.5 bead radii from the rod's centre its bias is below 2 % of the largest |U| there.
//   lagrangian  Displacement of each bead from its mean place before the rod came, the mean displacement of
//               all beads removed: U(x, y) - <U(x', y)>, x' over the zone ahead, 0.3 L < x' < 0.45 L, which
//               in a periodic box of 78 bead radii the images displace by 13 to 18 % of the largest |U|.
//               Relative to that its bias is below 3 % of the largest |U| beyond 4 bead radii. Needs no
//               lattice: for beds of several sizes, solid or liquid. Sees plastic slip as displacement.
//               Nothing relative to a bead's neighbours is formed, which would remove what the waves longer
//               than a cage contribute, and so the wake itself; rattling and diffusion are in sigma.
//   density     The same phases of the time-averaged density in the rod's frame: rho_0(r) = rho(r + U(r)),
//               rho_0 the far field's lattice. Needs a rod that keeps its place relative to the rows;
//               otherwise the mean smears out, which `coherence` shows. Blurred over 0.75 lattice spacings.
//
// In a window of a film (Layout::window) phase finds G_k in each block of time, and U is known up to a linear
// function of the place: it has none in the far field (models/measure/phase_cell.hpp); lagrangian is
// relative to the far field, density is refused.
//
// A value is a mean over one cell of the lattice around the bin's middle (phase_cell.hpp says why), so bins
// closer than two lattice spacings share data: their errors are not independent, a fit to a grid finer than
// the lattice must allow for it. Each bin's own sigma is right. Domain: gradients of U below 1.

#include "rodwake/measure/bragg.hpp"
#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/rod_grid.hpp"
#include "rodwake/measure/state_io.hpp"
#include "rodwake/measure/statistics.hpp"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rodwake::measure {

const char* to_string(DisplacementMethod method);

struct DisplacementOptions {
    DisplacementMethod method = DisplacementMethod::phase;
    Reference reference = Reference::box;
    std::size_t rod = 0;   ///< in whose frame
    double spacing = 0.0;  ///< wanted spacing of the grid, m; e.g. 1 a
    double far_from = 0.0; ///< m; 0: 0.3 L. Beads farther than this from every rod are the far field
    double block = 5.0;    ///< s; also ends when the rod has turned by 0.1 rad since the block began
    double from = 0.0;     ///< s; frames before this time are passed over (the wake must build up)
    bool mirror = false;   ///< average with the mirror image y -> -y: U_x even, U_y odd

    bool operator==(const DisplacementOptions&) const = default;
};

/// Sums over the frames of one run; what an estimator needs and no more.
class DisplacementAccumulator {
public:
    /// Throws InputError for options outside their domain, no such rod, or fewer than 50 beads.
    DisplacementAccumulator(const Layout& layout, const DisplacementOptions& options);
    ~DisplacementAccumulator();
    DisplacementAccumulator(const DisplacementAccumulator& other);
    DisplacementAccumulator& operator=(const DisplacementAccumulator& other);
    DisplacementAccumulator(DisplacementAccumulator&&) noexcept;
    DisplacementAccumulator& operator=(DisplacementAccumulator&&) noexcept;

    void add(const Frame& frame);
    void save(StateWriter& out) const;
    void load(StateReader& in);

    const Layout& layout() const;
    const DisplacementOptions& options() const;

private:
    struct Impl;
    friend struct DisplacementSums; ///< what the reductions see of it

    std::unique_ptr<Impl> impl_;
};

/// On the grid, [row y][column x]. Bins without data have count 0; their value is filled in smoothly from
/// their neighbours (discrete Laplace equation) so that the field can be interpolated, and their sigma is
/// the scatter of the whole field. With one block of time every sigma is unknown (core/estimate.hpp); nothing
/// else is NaN.
struct DisplacementField {
    RodGrid grid;
    DisplacementMethod method = DisplacementMethod::phase;
    std::vector<double> Ux, Uy, sigma_x, sigma_y; ///< m
    std::vector<double>
        count; ///< beads seen over all frames by a bin of the cell around the middle, on average
    std::vector<double>
        coherence; ///< |mean of exp(i phase)| over the three peaks; lagrangian: 1 where measured
    Reference reference = Reference::box;
    Vector2 offset;   ///< taken off so that the reference is zero, m
    BraggPeaks peaks; ///< phase and density
    std::size_t blocks = 0, frames = 0;
    double block_correlation = 0.0; ///< mean correlation of successive blocks; sigma allows for it
    double mean_speed = 0.0;        ///< of the rod along its heading, m/s
};

/// All runs together. Throws InputError without frames or with accumulators of different options; RunError if
/// there is no crystal to speak of (phase, density: largest Bragg peak below 20 times that of a liquid's
/// ring).
DisplacementField reduce(std::span<const DisplacementAccumulator> runs);

/// Values along a line parallel to an axis of the rod's frame; bins without data are left out.
struct Profile {
    std::string component;                          ///< "Ux" | "Uy"
    std::string along;                              ///< "x" | "y"
    double at = 0.0;                                ///< the other coordinate: middle of the row or column, m
    std::vector<double> place, value, sigma, count; ///< m
};
/// From the row or column of bins whose middle is nearest to `at`.
Profile profile(const DisplacementField& field, const std::string& component, const std::string& along,
                double at);

} // namespace rodwake::measure
