#pragma once
// What the field of all rods makes a rod turn by its own field, to first order in its turning: with one field
// for all it is taken off where self_field = false.
//
// A rod's own field turns it as it has turned before. With the medium's plane waves, in the frame of the rod,
// n = (1, 0), c = cos phi, s = sin phi of a wave vector's direction, D_i = (1 + eta)/alpha along and 1/alpha
// across it, and delta = theta(t) - theta(t - tau),
//
//   T(t) = int_0^inf A(tau) delta(tau) dtau
//   A = (1/alpha) int q dq dphi/(2 pi)^2 e^(-w^2 q^2/2 + i q c tau)
//       [ -G_L s D_L q/(D_L q - i c) e^(-D_L q^2 tau) + G_T (-c + i s^2/(D_T q - i c)) e^(-D_T q^2 tau) ]
//   G_L = i kappa q c s - (gamma1 + gamma2) q^2 s,   G_T = i kappa q (c^2 - s^2)/2 - gamma1 q^2 c
//
// of the plane: what a rod has left behind turns it by its strain there, and by where it lies. A is kept as
// sum_k a_k e^(-mu_k tau), fitted by least squares, so that T = sum_k a_k (theta P_k - Q_k) with
//
//   Q_k' = -mu_k Q_k + theta,   P_k' = -mu_k P_k + 1
//
// of each rod and once for all. From rest both are 0 at the start, from steady fields 1/mu_k of theta and 1.
//
// The rod's images in the box turn it as in their steady field of a heading that follows its own at the rate
// of the slowest mode, (2 pi/box)^2/alpha; from rest they are left in.
//
// Units of medium/simulate.hpp. Domain: no inertia. Error: of second order in delta; that of the images,
// whose fields do not follow as one; fit_error() gives that of the fit (studies/reports/medium.md has
// what comes of them).

#include "mode_weights.hpp"
#include "rodwake/integrate/ode.hpp"
#include "rodwake/medium/modal_field.hpp"
#include "rodwake/rods/couplings.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace rodwake::medium {

class OwnResponse {
public:
    static constexpr std::size_t terms = 14, kept = terms + 1; ///< the last for the images

    OwnResponse(const elastic::Medium& elastic, const DynamicMedium& medium, const rods::Couplings& couplings,
                const ModalField& modes);

    /// Numbers of the state: Q of each rod, then P.
    static std::size_t numbers(std::size_t rods) { return kept * (rods + 1); }
    void start(integrate::State poses, std::span<double> state) const;

    /// T of a rod and what its images do; but for these linear in the state.
    double turning(integrate::State poses, std::size_t rod, std::span<const double> state) const;

    /// The state at stage 1, 2, 3 or the end, 4, of a step of h; `stages`: poses at the start and at each
    /// stage so far.
    void advance(std::size_t stage, double h, const std::array<integrate::State, 4>& stages,
                 std::span<const double> from, std::span<double> to) const;

    /// Root mean square of what the fit is off, over that of A, both weighted by tau.
    double fit_error() const { return fit_error_; }
    /// int_0^inf A tau dtau: T over theta' of a rod that has always turned slowly.
    double slow() const;

private:
    void fit(const elastic::Medium& elastic, const DynamicMedium& medium, const rods::Couplings& couplings);

    bool steady_;
    std::array<double, kept> decay_{};
    std::array<double, terms> strength_{};
    std::vector<double> harmonics_; ///< of sin 4 theta, sin 8 theta, ... of the images
    double fit_error_ = 0.0;
};

} // namespace rodwake::medium
