#pragma once
// How a rod turns in the strain of another rod's wake (paper Eqs. peq, thetaeq).
//
//   theta' = z.[n x v],   v = kappa eps.n + gamma1 A + gamma2 B
//
// kappa is apolar: it turns the rod's axis to the extensional axis (kappa > 0). A and B are vectors, for
// polar rods. Two choices of A and B stand in the paper:
//   laplacian  (figure sup_ufield)   A = lap u,    B = grad div u       <- kept inside
//   divergence (text)                A = div eps,  B = grad tr eps
// Since div eps = (lap u + grad div u)/2: gamma1^lap = gamma1/2, gamma2^lap = gamma2 + gamma1/2.

namespace rodwake::rods {

/// Laplacian basis. Reduced units: kappa stands for kappa f/(mu v0), gamma for gamma/v0 (lengths f/mu, times
/// f/(mu v0)).
struct Couplings {
    double kappa = 0.0;
    double gamma1 = 0.0;
    double gamma2 = 0.0;

    bool apolar() const { return kappa != 0.0; }
    bool polar() const { return gamma1 != 0.0 || gamma2 != 0.0; }
    bool any() const { return apolar() || polar(); }
};

/// Couplings from coefficients of div eps and grad tr eps.
Couplings from_divergence_basis(double kappa, double gamma1, double gamma2);

} // namespace rodwake::rods
