#pragma once
// Sound in the bed: correlations of the longitudinal and transverse currents of the beads, what a damped
// oscillator makes of them, and the elastic constants of an orthotropic medium that follow.
//
//   j(q, t)   = sum_i v_i exp(-i q.r_i),  r_i and v_i relative to the centre of mass of the beads, m/s
//   C_b(q, t) = <j_b(q, t0 + t) j_b*(q, t0)>/N,  b = L along q, T across it;  q = 2 pi (m/Lx, n/Ly)
//   T_b(q)    = C_b(q, 0), m^2/s^2: T_xy of the beads if they moved independently; energy is m T
//   C_b(t)    ~ that of u'' + gamma u' + omega^2 u = noise (models/measure/oscillator_fit.hpp), so omega is
//   the
//               frequency without damping, rho omega^2/q^2 the stiffness, also of overdamped modes
//   u(q)      = sum_i [r_i(t) - r_i(0)] exp(-i q.r_i(0))/N, variance in time: <|u|^2>, m^2. In white noise
//               N omega^2 <|u|^2> = T(q), whatever the noise is: omega_static
//
// Hansen and McDonald, Theory of Simple Liquids, ch. 8 (currents); Christoffel's equation of the plane:
//
//   det[ Gamma - rho omega^2/q^2 ] = 0,   Gamma_xx = C11 cx^2 + C66 cy^2,   Gamma_yy = C66 cx^2 + C22 cy^2,
//                                         Gamma_xy = (C12 + C66) cx cy,     (cx, cy) = q/|q|
//   rho = N m/(Lx Ly), beads only: rods count neither in rho nor in j
//
// Here rho is the bare mass. What moves has the inertia m* rho (drift_decay.hpp): the medium's constants are
// m* times those of PhononResult, its drag m* times the damping as q -> 0. The measure's kind puts m* in.
//
// Off the axes the modes are not quite along q: the correlations are turned by the angle that makes the cross
// correlation least (exact for two modes with orthogonal polarisations). (m, n) and (m, -n) are put together:
// this takes mirror symmetry about the axes of the box, which crystals with rows along x or y have.
// Domain: frames that resolve the modes, interval well below 1/omega and 1/gamma; small q (constants from the
// first two waves along a direction: the bend of the dispersion takes (q d)^2/24 off omega, d the spacing of
// rows, 0.5 % at most in a box of 78 a); errors by jackknife over blocks of time, which must be long against
// the longest lag.

#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/state_io.hpp"
#include "rodwake/measure/statistics.hpp"

#include <cmath>
#include <deque>
#include <span>
#include <vector>

namespace rodwake::measure {

struct PhononOptions {
    std::size_t shells = 4;   ///< modes with m^2 + n^2 <= shells^2
    double longest_lag = 1.0; ///< s; rounded down to whole intervals
    double block = 5.0;       ///< s; at least twice the longest lag

    bool operator==(const PhononOptions&) const = default;
};

class PhononAccumulator {
public:
    PhononAccumulator(const Layout& layout, const PhononOptions& options);

    void add(const Frame& frame);
    void save(StateWriter& out) const;
    void load(StateReader& in);

    struct Mode {
        int m = 0, n = 0; ///< m > 0, or m = 0 and n > 0
    };
    /// Sums over the frames of a block of time.
    struct PhononBlock {
        double number = 0.0, frames = 0.0;
        double temperature = 0.0;      ///< of single beads, (var vx + var vy)/2
        std::vector<double> origins;   ///< [lag]
        std::vector<double> currents;  ///< [lag][LL, TT, LT][mode], times N
        double displacements = 0.0;    ///< how often u was taken
        double travel = 0.0;           ///< mean square distance of a bead from its first place, m^2
        std::vector<double> amplitude; ///< [u_L, u_T as re, im; |u_L|^2, |u_T|^2][mode], u times N
    };

    const Layout& layout() const { return layout_; }
    const PhononOptions& options() const { return options_; }
    std::size_t frames() const { return times_.frames; }
    double interval() const { return times_.interval; }
    std::span<const Mode> modes() const { return modes_; }
    std::span<const PhononBlock> blocks() const { return blocks_; }
    std::size_t lags() const { return lags_; } ///< lag 0 included; 0 before the second frame

private:
    void take_displacements(const Frame& frame);
    void correlate(PhononBlock& block, double temperature) const;
    PhononBlock& block_at(double time);

    Layout layout_;
    PhononOptions options_;
    std::vector<Mode> modes_;
    FrameTimes times_;
    std::size_t lags_ = 0;
    double first_time_ = 0.0, first_temperature_ = 0.0; ///< s, m^2/s^2
    std::vector<double> first_x_, first_y_;             ///< unwrapped, m
    std::deque<std::vector<double>> history_; ///< [frame, newest last][L re, L im, T re, T im][mode]
    std::vector<PhononBlock> blocks_;
};

/// A branch of the modes (m, n) and (m, -n).
struct PhononBranch {
    Estimate omega, gamma; ///< 1/s
    Estimate temperature;  ///< m^2/s^2
    Estimate displacement; ///< <|u|^2>, m^2; count 0 where beads left their places
    /// 1/s; the same. Of u along and across q, whatever `polarisation` is: with m n != 0 it mixes the
    /// branches by sin^2(polarisation).
    Estimate omega_static;
    double share = 0.0;                      ///< of C(0) that is the oscillator's
    std::vector<double> correlation, fitted; ///< [lag] C(t)/C(0)
};

struct PhononMode {
    int m = 0, n = 0;
    double qx = 0.0, qy = 0.0; ///< 1/m
    double polarisation = 0.0; ///< of the longitudinal branch from q, rad, counter-clockwise
    PhononBranch longitudinal, transverse;

    double q() const { return std::hypot(qx, qy); }
};

struct PhononResult {
    std::vector<PhononMode> modes; ///< by rising q
    double step = 0.0;             ///< of the lags, s
    double density = 0.0;          ///< rho, kg/m^2
    Estimate temperature;          ///< T_xy of single beads, m^2/s^2
    // Sound speeds along x, along y and along the diagonal of the box, m/s.
    Estimate c_Lx, c_Ly, c_Ld, c_Tx, c_Ty, c_Td;
    Estimate C11, C22, C12, C66; ///< of the bare mass, N/m
    Estimate bulk, mu, eta;      ///< of the isotropic medium nearest to it: K, mu in N/m, eta = K/mu
    /// Largest less smallest over directions, in parts of the isotropic value, of rho c^2 of the branches.
    Estimate spread_L, spread_T;
    /// gamma = drag + nu q^2: damping of the bed by the plates zeta/(m* n m), 1/s; nu in m^2/s.
    Estimate drag, viscosity_L, viscosity_T;
    double travel = 0.0;      ///< root mean square distance of a bead from its first place, last block, m
    bool kept_places = false; ///< that is below half a spacing: displacements mean something
    std::size_t frames = 0, blocks = 0;
};

/// Throws InputError for fewer than 2 blocks or accumulators of different options, beds or intervals.
PhononResult reduce(std::span<const PhononAccumulator> runs);

} // namespace rodwake::measure
