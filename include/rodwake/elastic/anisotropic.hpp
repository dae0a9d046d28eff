#pragma once
// Steady displacement around a rod in an orthotropic medium that fills a periodic box: a map at a time.
//
// In the frame of a rod that moves along +x at speed v against the medium, with e^{+i q.r},
//
//   [C(q) - i zeta v q_x - rho v^2 q_x^2 - i eta_s v q_x q^2] U_q = g(q) F(q)
//   F_x = f sinc(q_x l/2) - i p_xx q_x - q_xxx q_x^2 - q_xyy q_y^2 + i t_xxxx q_x^3 + 3 i t_xxyy q_x q_y^2
//         + h_xxxxx q_x^4 + 6 h_xxxyy q_x^2 q_y^2
//   F_y = - i p_yy q_y - 2 q_yxy q_x q_y
//   C_xx = c11 q_x^2 + c66 q_y^2,   C_yy = c66 q_x^2 + c22 q_y^2,   C_xy = (c12 + c66) q_x q_y
//   U(r) = 1/(Lx Ly) sum over q of U_q e^{i q.r},   q = 2 pi (m/Lx, n/Ly),   q = 0 left out
//
// from rho d_tt u + zeta d_t u = div stress + eta_s lap d_t u + forces with u = U(x - v t, y), so d_t = -v
// d_x. F is the multipole expansion of a force density f_i(r) that is mirror symmetric in y, about the
// origin: the force f, spread evenly over the rod's length l; the dipoles p_ii = int f_i r_i d2r (an
// inclusion), positive if they push outward; the second moments q_ijk = 1/2 int f_i r_j r_k d2r, of which
// symmetry leaves three, q_yxy = q_yyx; of the third ones t_ijkl = 1/6 int f_i r_j r_k r_l d2r and the fourth
// ones h_ijklm = 1/24 int f_i r_j r_k r_l r_m d2r two each, along x, which is all that shows of them outside:
// C times q_x xhat, q_y yhat and so on is a source that hides the others. q_xxx comes on top of the f l^2/24
// that sinc has. g = exp(-q^2 w^2/2) smooths every source, and so the field, by a Gaussian of width w. The
// zero mode is the drift of the medium as a whole: U is relative to its mean over the box, as in
// elastic/periodic.hpp, which this is for c11 = c22 = mu + lambda, c66 = mu, c12 + c66 = lambda, rho = eta_s
// = 0, l = w = 0 and zeta v = mu/xi.
//
// The axes of the crystal are those of the box and of the rod: c11 is the constant along the heading
// whichever row of the crystal that is. For a crystal turned by 90 degrees swap c11 with c22 and Lx with Ly.
// Then U_x is even and U_y odd in y, which the sums use.
//
// Outside the rod second moments show only two of their three combinations: the source q_xxx = rho v^2 - c11,
// q_xyy = -c66, q_yxy = -(c12 + c66)/2, p_xx = zeta v is the left side times xhat if eta_s = 0, so its field
// is the Gaussian g alone, and a constant for the zero mode. Hold one of q_xxx, q_xyy, q_yxy in a fit.
//
// Units: any coherent ones. c: force/length; zeta: force time/length^3; rho: mass/length^2; eta_s: force
// time/length; p: force length; q_ijk: force length^2; t_ijkl, h_ijklm: force
// length^3, length^4. Only ratios matter, so with c/rho = (sound speed)^2,
// zeta/rho = drag rate and f/rho the density may be 1.
//
// Degenerate input (tests/elastic/test_anisotropic.cpp): no places give an empty map, no source a map of 0,
// the place of the rod the smoothed field. A strength that is NaN gives NaN. InputError for a side <= 0 or
// infinite, a speed, place or constant that is not finite, a rod as long as the box, a width outside [longer
// side/1000, shorter side/4], constants <= 0 and a rod as fast as the waves.
//
// Error: modes up to q w = 6.5, which leaves out less than 1e-8 of the largest displacement (tests). In the
// isotropic limit 2.6e-7 f/mu off elastic/periodic.hpp, at L = 78 and w = 0.4 beyond 8 of the rod, the first
// term of the smoothing added (build/dev/tests/test_elastic, "isotropic limit"). Within a
// few w of the rod the field is the smoothed one; beyond, smoothing adds w^2/2 lap U. Domain: strongly
// elliptic constants (waves of every direction have a real speed) and v below the slowest of these speeds
// in the sense that the matrix at zeta = eta_s = 0 stays positive for every q; InputError otherwise.
//
// Cost: two products of matrices for each component, (columns) x (modes) x (modes) and (columns) x (modes) x
// (rows): 0.7 ms for 78 x 78 places and w = L/78, 6 ms for 156 x 156 and w = L/156
// (bench/anisotropic_bench.cpp).

#include <memory>
#include <span>
#include <vector>

namespace rodwake::elastic {

struct OrthotropicMedium {
    double c11 = 1.0, c22 = 1.0, c12 = 0.0, c66 = 1.0;
    double zeta = 0.0;  ///< drag per area
    double rho = 0.0;   ///< mass per area
    double eta_s = 0.0; ///< viscosity of shear and compression alike
};

/// Throws InputError unless the constants are those of a medium that is stable and has waves faster than v.
void validate(const OrthotropicMedium& medium, double speed);

struct RodSource {
    double force = 0.0, p_xx = 0.0, p_yy = 0.0, q_xxx = 0.0, q_xyy = 0.0, q_yxy = 0.0, t_xxxx = 0.0,
           t_xxyy = 0.0, h_xxxxx = 0.0, h_xxxyy = 0.0;
};

/// Box, rod and smoothing: what stays as the medium is varied.
struct RodFrame {
    double lx = 0.0, ly = 0.0; ///< sides of the box along and across the heading
    double speed = 0.0;        ///< v against the medium; negative: backwards
    double length = 0.0;       ///< l
    double width = 0.0;        ///< w; at least 1/1000 of the longer side
};

/// Sources first, then what the medium is made of.
enum class OrthotropicParameter {
    force,
    p_xx,
    p_yy,
    q_xxx,
    q_xyy,
    q_yxy,
    t_xxxx,
    t_xxyy,
    h_xxxxx,
    h_xxxyy,
    c11,
    c22,
    c12,
    c66,
    zeta,
    rho,
    eta_s
};

/// Values at places (x_k, y_j), [row y][column x].
struct DisplacementMap {
    std::vector<double> Ux, Uy;
};

class AnisotropicField {
public:
    /// Places in the rod's frame, rod at the origin. Throws InputError for an illegal frame.
    AnisotropicField(const RodFrame& frame, std::span<const double> x, std::span<const double> y);

    DisplacementMap displacement(const OrthotropicMedium& medium, const RodSource& source) const;

    /// d U/d parameter at fixed others. Those by force, dipoles and moments are the maps of unit sources,
    /// which is the basis that U is a linear combination of.
    DisplacementMap derivative(const OrthotropicMedium& medium, const RodSource& source,
                               OrthotropicParameter by) const;
    /// Along a change of the constants: the sum of d U/d constant times its change.
    DisplacementMap derivative(const OrthotropicMedium& medium, const RodSource& source,
                               const OrthotropicMedium& change) const;

    const RodFrame& frame() const;

private:
    struct Impl;
    std::shared_ptr<const Impl> impl_; ///< shared: copies are cheap, calls independent and thread-safe
};

} // namespace rodwake::elastic
