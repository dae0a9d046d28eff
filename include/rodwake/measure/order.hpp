#pragma once
// Order of the beads: pair correlation g(r), bond-orientational order psi_6 and its correlation g_B(r).
//
//   g(r)    = pairs at distance r / those of an ideal gas of the same density in the periodic box
//   psi_6,i = (1/N_i) sum_j exp(6 i theta_ij) over the N_i neighbours of bead i; 0 without any
//   psi_6   = (1/N) |sum_i psi_6,i|                                            (paper Sec. III.A)
//   g_B(r)  = <psi_6,i* psi_6,j>_r: mean over pairs at distance r, the paper's correlation over g(r)
//
// Normalisation: N(N-1)/2 pairs over the box's area L_x L_y, so an ideal gas has g = 1 without a finite-size
// term. Distances to nearest images, up to L/2. Angles from +x. Rods are no beads: they are holes here.
//
// Beads of several kinds p, q have a g_pq(r) for each pair of kinds, over N_p N_q pairs, or N_p (N_p - 1)/2
// within a kind.
//
// In a window (frame.hpp) the area is the window's, there are no images, and g(r) weights a pair by the share
// of the circle about either that lies inside (Ripley's correction), up to half the shorter side of the box
// that holds the window. Beads within a cut-off of the border may have neighbours that are not seen: they are
// left out of psi_6 and g_B(r).
//
// A camera that finds coordinates with a known standard error sigma_0 turns the bond between beads at
// distance r by an angle of variance 2 sigma_0^2/r^2, so that exp(6 i theta_ij) is exp(-36 sigma_0^2/r^2)
// times too small on average. The mean of that factor over the neighbours is taken out of psi_6, and twice
// out of g_B(r), r > 0; good to (6 sigma_0/r)^4. |psi_6,i| is left as it is: its noise adds to it as well.
//
// Neighbours: beads nearer than a cut-off, by default the first minimum of g(r) of the first frames
// (cutoff_frames of them; the frames wait until it is known), or those that share an edge of the Delaunay
// triangulation.

#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/state_io.hpp"
#include "rodwake/measure/statistics.hpp"

#include <complex>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::measure {

struct OrderOptions {
    Neighbours neighbours = Neighbours::cutoff;
    std::optional<double> cutoff;   ///< m; absent: first minimum of g(r)
    std::size_t cutoff_frames = 16; ///< whose g(r) gives the cut-off
    double bin = 0.0;               ///< of g(r), m; e.g. 0.05 a
    double order_bin = 0.0;         ///< of g_B(r), a whole multiple of bin, m; e.g. 1 a
    double block = 5.0;             ///< s; frames of a block count as one value in the errors
    double localisation = 0.0;      ///< sigma_0, of tracks, m

    bool operator==(const OrderOptions&) const = default;
};

/// psi_6 of each bead; places in [0, L).
std::vector<std::complex<double>> psi6_by_cutoff(const std::vector<double>& x, const std::vector<double>& y,
                                                 const PeriodicBox& box, double cutoff);
std::vector<std::complex<double>> psi6_by_delaunay(const std::vector<double>& x, const std::vector<double>& y,
                                                   const PeriodicBox& box);

/// Position of the first minimum of g(r) after its first peak, by a parabola through the bins around the
/// smallest one of the smoothed curve; nothing if there is none before r_max (an ideal gas).
std::optional<double> first_minimum(std::span<const double> r, std::span<const double> g, double bead_radius);

/// What beads are neighbours by. Where g(r) has no minimum (ideal gas), 1.4 spacings of the triangular
/// lattice of this density, at most half the box; by_spacing then says so.
struct Cutoff {
    double value = 0.0; ///< m
    bool by_spacing = false;
};

/// Sums over the frames of one run.
class OrderAccumulator {
public:
    /// Throws InputError for options outside their domain, or fewer than 2 beads.
    OrderAccumulator(const Layout& layout, const OrderOptions& options);

    void add(const Frame& frame);
    void save(StateWriter& out) const;
    void load(StateReader& in);

    struct OrderBlock {
        std::vector<double> pairs;       ///< per bin of g(r)
        std::vector<double> order_pairs; ///< per bin of g_B(r)
        std::vector<double> order;       ///< sum of Re psi_i* psi_j
        std::vector<double> fine_order;  ///< the same per bin of g(r), for the fit of the decay
        double psi6 = 0.0;               ///< sum over frames of the global psi_6
        double local = 0.0;              ///< sum over frames of the mean |psi_6,i|
        double neighbours = 0.0;         ///< sum over frames of the mean N_i
        double frames = 0.0;
        double full_frames = 0.0; ///< sum over frames of N(N-1), N beads seen, over that of the layout
        double at_border = 0.0;   ///< sum over frames of the share of beads left out of psi_6
        std::vector<double> weighted = {}; ///< pairs for g(r) per bin; empty: `pairs`, as without a window
        /// Pairs of beads per bin of g(r), one pair of kinds after the other, and the number of all
        /// pairs, both summed over frames; empty for one kind.
        std::vector<double> kind_pairs = {}, kind_pairs_in_all = {};
    };
    const Layout& layout() const { return layout_; }
    const OrderOptions& options() const { return options_; }
    /// The blocks; frames that still wait for a cut-off are counted in with that of their own g(r).
    std::vector<OrderBlock> blocks() const;
    /// In use, m; 0 with Delaunay neighbours or before it is known.
    double cutoff() const { return cutoff_.value; }
    /// The same, but if frames still wait, that of their own g(r).
    Cutoff settled_cutoff() const;

private:
    struct Waiting {
        double time;
        std::vector<double> x, y;
        std::vector<std::uint8_t> kind;
    };
    bool waits() const;
    void count_waiting();
    void count(const Waiting& frame);
    void count_kinds(const Waiting& frame, const std::vector<double>& all, OrderBlock& block) const;
    std::vector<double> pairs_for_g(const std::vector<double>& x, const std::vector<double>& y) const;

    Layout layout_;
    OrderOptions options_;
    Cutoff cutoff_;
    std::vector<Waiting> waiting_;
    std::vector<OrderBlock> blocks_;
    std::vector<double> block_number_; ///< floor(time/block) of each block
};

/// How g_B(r) decays. KTHNY: exponentially in a liquid, as r^(-eta_6) with eta_6 <= 1/4 in a hexatic, to a
/// constant in a crystal.
enum class Decay { undetermined, exponential, algebraic, long_range };
const char* to_string(Decay decay); ///< "undetermined", "exponential", "algebraic", "long-range"
const char* phase_of(Decay decay);  ///< "undetermined", "liquid", "hexatic", "crystal"

struct DecayClass {
    Decay decay = Decay::undetermined;
    Estimate exponent; ///< eta_6 of A r^(-eta_6)
    Estimate length;   ///< xi_6 of A exp(-r/xi_6), m; 0 with unknown error if nothing decays
    Estimate plateau;  ///< g_B far away: mean over the farther half of the points
    double chi2_algebraic = 0.0, chi2_exponential = 0.0, chi2_constant = 0.0;
    long points = 0;
    std::string reason; ///< one sentence: which numbers decided
};

/// g(r) of the beads of one kind around those of another: pairs over those of an ideal gas of as many.
struct KindCorrelation {
    std::size_t kind = 0, other = 0; ///< kind <= other
    std::vector<double> g, g_error;
};

struct OrderResult {
    std::vector<double> r, g, g_error;           ///< middles of the bins, m
    std::vector<KindCorrelation> kinds;          ///< of several: (0, 0), (0, 1), ..., (1, 1), ...
    std::vector<double> order_r, g_B, g_B_error; ///< bins with pairs only
    std::vector<double> order_pairs;             ///< how many stand behind g_B
    Estimate psi6, local_psi6, neighbours;
    std::optional<double> at_border;    ///< of a window: share of beads left out of psi_6 and g_B
    double cutoff = 0.0;                ///< mean over runs, m; 0 with Delaunay neighbours
    std::size_t cutoffs_by_spacing = 0; ///< runs whose g(r) had no minimum to take it from
    std::optional<double> g_minimum;    ///< first minimum of the mean g(r), m
    DecayClass decay;
    std::size_t frames = 0, blocks = 0;
};

/// All runs together. Throws InputError without frames, or accumulators of different options.
OrderResult reduce(std::span<const OrderAccumulator> runs);

/// g_B(r) at a few distances. Points of one run fluctuate together. If the same curve is known with each
/// block of the measurement left out, errors of the fitted numbers are those of a jackknife over the blocks,
/// which allows for it, times `growth` for blocks that correlate; otherwise the points count as independent.
struct DecayPoints {
    std::vector<double> r, g_B, error;        ///< m; errors <= 0 are unknown: such points are left out
    std::vector<std::vector<double>> without; ///< [block][point]
    double growth = 1.0;
    PeriodicBox box; ///< m; 0: the infinite plane
};

/// The class of a measured g_B(r) at r >= from. Least squares in g_B itself (values may be negative) of
///
///   algebraic    A exp(-eta s), s = ln r - pi r^2/(2 L_x L_y): what ln r is in the periodic box, the mean of
///                its Green's function over a circle of radius r, exact for r <= L/2
///   exponential  A sum over images of exp(-|r + n L|/xi), its mean over the same circle
///
/// Without images both would seem to level off towards L/2. The rule, in this order:
///
///   exponential   g_B = 0 within errors (chi2 probability above 1 %): no order is left
///   exponential   eta > 1/4 by its error: a hexatic melts there (KTHNY)
///   long-range    eta < 0.003, or 0 within 2 errors; and below 1/4 by 2 errors
///   undetermined  eta is 0 within 2 errors, but so may be 1/4
///   exponential   fits better by 4 in chi2, and xi is below the farthest r
///   algebraic     otherwise
///
/// 0.003 is a fall by 0.4 % between 8 a and 39 a. It was set on granular beds: what the windows leave of the
/// shells makes up to 0.001 of either sign in crystals (phi_b >= 0.74), 0.72 and 0.73 have 0.006 to 0.012.
/// Fewer than 4 points with errors: undetermined. chi2 takes points as independent; those of one run are not,
/// which makes chi2 smaller, so it decides rarely.
DecayClass classify(const DecayPoints& points, double from);

/// The same in the infinite plane for independent points.
DecayClass classify(std::span<const double> r, std::span<const double> g_B, std::span<const double> error,
                    double from);

} // namespace rodwake::measure
