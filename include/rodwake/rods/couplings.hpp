#pragma once
// How a rod turns in the strain of another rod's wake (paper Eqs. (21), (22)).
//
//   theta' = z.[n x v],   v = kappa eps.n + gamma1 A + gamma2 B
//
// kappa is apolar: it turns the rod's axis to the extensional axis (kappa > 0). A and B are vectors, for
// polar rods. Two choices of A and B stand in the paper:
//   laplacian  (paper, Fig. 10)      A = lap u,    B = grad div u       <- kept inside
//   divergence (text)                A = div eps,  B = grad tr eps
// Since div eps = (lap u + grad div u)/2: gamma1^lap = gamma1/2, gamma2^lap = gamma2 + gamma1/2.
//
// A coupling is a member of Couplings and a line of coupling_list, by which scans, fits, files and messages
// go. Whoever computes with couplings takes them apart, `const auto [kappa, gamma1, gamma2] = couplings`, so
// a new one does not compile until each of these places has its term. All couplings so far are linear in the
// field: sums over wakes, Fourier modes, Jacobian and bounds of the turning rate rely on it.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>

namespace rodwake::rods {

/// Laplacian basis. Reduced units: kappa stands for kappa f/(mu v0), gamma for gamma/v0 (lengths f/mu, times
/// f/(mu v0)).
struct Couplings {
    double kappa = 0.0;
    double gamma1 = 0.0;
    double gamma2 = 0.0;

    bool apolar() const;
    bool polar() const;
    bool any() const { return apolar() || polar(); }
    bool operator==(const Couplings&) const = default;
};

struct Coupling {
    std::string_view name; ///< in scenes, fits, files and Python
    double Couplings::*number;
    bool polar;             ///< multiplies derivatives of the strain, else the strain
    std::string_view unit;  ///< of the number in reduced units
    std::string_view words; ///< what it does, in lists of terms
};

inline constexpr Coupling coupling_list[] = {
    {"kappa", &Couplings::kappa, false, "v0 mu/f", "turning by strain"},
    {"gamma1", &Couplings::gamma1, true, "v0", "first polar turning"},
    {"gamma2", &Couplings::gamma2, true, "v0", "second polar turning"}};
static_assert(sizeof(Couplings) == std::size(coupling_list) * sizeof(double), "each coupling has its line");

inline bool Couplings::apolar() const {
    return std::ranges::any_of(coupling_list,
                               [&](const Coupling& c) { return !c.polar && this->*c.number != 0.0; });
}
inline bool Couplings::polar() const {
    return std::ranges::any_of(coupling_list,
                               [&](const Coupling& c) { return c.polar && this->*c.number != 0.0; });
}

/// nullptr if there is none of this name.
constexpr const Coupling* find_coupling(std::string_view name) {
    const auto at = std::ranges::find(coupling_list, name, &Coupling::name);
    return at == std::end(coupling_list) ? nullptr : at;
}

/// In a unit of length (f/mu) and a unit of time (f/(mu v0)): of a polar one length/time, else 1/time.
constexpr double in_units(const Coupling& coupling, double number, double length, double time) {
    return (coupling.polar ? number * length : number) / time;
}

/// Without those that are polar, or those that are not.
constexpr Couplings without(Couplings couplings, bool polar) {
    for (const Coupling& coupling : coupling_list)
        if (coupling.polar == polar)
            couplings.*coupling.number = 0.0;
    return couplings;
}

/// Numbers that turn rods besides those of coupling_list.
struct OtherTurning {
    std::string_view name, unit, words;
};
inline constexpr OtherTurning other_turning[] = {
    {"gamma_flow", "mu/f", "turning to the medium's velocity"},
    {"gamma_rows", "mu v0/f", "turning into the rows of a crystal"},
    {"rows_direction", "rad", "direction of these rows"}};

/// nullptr if there is none of this name.
constexpr const OtherTurning* find_other_turning(std::string_view name) {
    const auto at = std::ranges::find(other_turning, name, &OtherTurning::name);
    return at == std::end(other_turning) ? nullptr : at;
}

/// Whether a number of this name, by itself, turns rods in the wakes of others.
constexpr bool turns_in_wakes(std::string_view name) { return find_coupling(name) || name == "gamma_flow"; }

/// Whether it is the name of a diffusion coefficient of the rods (noise.hpp), where they are fitted.
constexpr bool is_noise(std::string_view name) { return name == "D_r" || name == "D_t"; }

/// "gamma1, gamma2"
std::string coupling_names(bool polar);

/// Turning to the medium's velocity, gamma_flow z.[n x d_t u], as polar couplings. Away from the rods zeta
/// d_t u = mu lap u + lambda grad div u, so with xi = mu/(zeta v0) the velocity is d_t u = v0 xi (lap u + eta
/// grad div u): exact wherever the field is that of the overdamped theory, in a box with the drift of its
/// mean. gamma_flow in mu/f.
constexpr Couplings with_flow(Couplings couplings, double gamma_flow, double eta, double xi) {
    couplings.gamma1 += gamma_flow * xi;
    couplings.gamma2 += gamma_flow * xi * eta;
    return couplings;
}

/// Rows of a crystal along `direction` and every sixth of a turn from it: theta' = -gamma sin 6(theta -
/// direction). gamma > 0 turns a rod into the nearest row, wherever it is and whatever the others do.
struct Rows {
    double gamma = 0.0;     ///< mu v0/f
    double direction = 0.0; ///< rad

    bool any() const { return gamma != 0.0; }
    double rate(double heading) const { return -gamma * std::sin(6.0 * (heading - direction)); }
    /// By the heading; by the direction it is the opposite.
    double rate_by_heading(double heading) const {
        return -6.0 * gamma * std::cos(6.0 * (heading - direction));
    }
    bool operator==(const Rows&) const = default;
};

/// Couplings from coefficients of div eps and grad tr eps.
Couplings from_divergence_basis(const Couplings& of_divergence);

} // namespace rodwake::rods
