#pragma once
// The memory kernel of what holds a bead, over the whole range of s that frames and run allow (paper Sec.
// III.B). A tagged bead obeys
//
//   m dv/dt = -Gamma v - int_0^t k(t - t') (x(t') - x(0)) dt' + noise,   T = m T_xy,
//
// so its mean-square displacement Delta (microrheology.hpp) gives
//
//   total(s) = 4 m T_xy/(s Delta~(s)) = m s^2 + Gamma s + k~(s),   N/m, s > 0 in 1/s.
//
// Identifiability. One curve is measured, the total, and the split is a choice.
//   m s^2    The bare mass m, whatever the bead does besides. T_xy is the mean square of the bead's velocity,
//            so s -> inf gives Delta~ -> 4 T_xy/s^3 and the total m s^2 as an identity. Rolling does not
//            change that. The floor spins up a bead only after some impacts; the inertia of its spin is part
//            of k~(s) and is not removed. (If the energy of the spin counted in T, total and k~ would grow
//            together by one factor, at most 7/5 for spheres that never slip.)
//   Gamma s  Only the sum Gamma s + k~ is measured: plates and neighbours brake one bead alike. Gamma has
//            to be measured apart, as the drag on a whole bed that drifts, in which neighbours cancel: Gamma
//            = m times its drag rate. Without it `with_drag` = Gamma s + k~ is all that is known.
//   T        One temperature at every s, as in equilibrium. Slow modes of a vibrated bed are colder than T_xy
//            (phonons.hpp): k~ at low s is then too large by T_xy/T, an effective stiffness.

#include "rodwake/core/estimate.hpp"
#include "rodwake/core/record.hpp"

#include <optional>
#include <vector>

namespace rodwake::measure {

/// 1/(s Delta~(s)), 1/m^2, from one over the longest lag to one over the frame interval, 12 points a decade.
///
/// Delta~ is that of a Delta which is smooth in ln Delta against ln t. `bias` is what three other readings of
/// the same data would change, added up:
///   longest lag   Delta stays where it is in place of growing on at its last slope. Where the growth slows
///                 down (concave Delta: all that is bound, hindered or diffuses) the truth is between the
///                 two; hops that set in later are beyond the data.
///   first lag     Delta ~ t^2 below it, in place of the slope between the first lags;
///   between lags  power laws in place of cubics.
/// [low, high] is the longest stretch of s where the bias is at most `largest_bias` of the value.
struct StiffnessSpectrum {
    static constexpr double largest_bias = 0.02;
    std::vector<double> s, value, error, bias; ///< 1/s; 1/m^2
    std::optional<double> low, high;           ///< 1/s; absent: nowhere so good
};

/// `bias` is that of the transform and the same for all.
struct MemoryKernel {
    std::vector<double> s;
    std::vector<double> total, total_error, bias;
    std::vector<double> with_drag;            ///< error: total_error, since m and s are exact
    std::vector<double> kernel, kernel_error; ///< NaN without a drag rate

    static constexpr auto fields() {
        using R = MemoryKernel;
        return std::tuple{
            field("s", &R::s, {"1/s", "Laplace frequency"}),
            field("total", &R::total, {"N/m", "4 m T_xy/(s MSD~(s)) = m s^2 + Gamma s + k~(s)"}),
            field("total_error", &R::total_error,
                  {"N/m", "standard error, also of with_drag (empty: unknown)"}),
            field("bias", &R::bias,
                  {"N/m", "how far the length of the run and the frames may put these values off"}),
            field("with_drag", &R::with_drag, {"N/m", "k~(s) + Gamma s: total less m s^2"}),
            field("kernel", &R::kernel,
                  {"N/m", "memory kernel k~(s), less measure.bead_drag (empty: no drag was given)"}),
            field("kernel_error", &R::kernel_error, {"N/m", "standard error (empty: unknown)"})};
    }
};

/// Mass m in kg, T_xy in m^2/s^2, drag rate Gamma/m in 1/s. An unknown error of the drag rate makes those of
/// k~ unknown. The error of T_xy, one factor of the whole curve, is left out.
MemoryKernel memory_kernel(const StiffnessSpectrum& spectrum, double mass, double temperature,
                           const std::optional<Estimate>& drag_rate);

} // namespace rodwake::measure
