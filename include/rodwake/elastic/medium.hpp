#pragma once
// The elastic continuum a rod walks through: an overdamped isotropic layer on a substrate.
//
//   zeta d_t u = mu lap u + lambda grad div u + forces                                     (paper Eq. (13))
//
// Here lambda is the coefficient of grad div in the equation of motion. From the free energy
// F = int [lambda_L (tr eps)^2 / 2 + mu tr(eps^2)] (paper Eq. free) it is lambda = lambda_L + mu, which in
// two dimensions is the bulk modulus K. The paper writes lambda for both.
//
// Degenerate input (tests/elastic/test_robustness.cpp):
//   eta <= -1, eta > 1e12, xi outside [1e-30, 1e30], NaN   InputError, by validate
//   mu <= 0 or NaN; moduli, a Poisson ratio out of range   InputError
//   alpha <= 0, infinite or NaN                            InputError
//   alpha -> 0                                             xi = (f/mu)/alpha, infinite below some 1e-308;
//                                                          validate refuses it above 1e30

namespace rodwake::elastic {

/// Steady medium as seen by a rod of speed v0. Lengths in the caller's unit (reduced: f/mu).
struct Medium {
    /// lambda/mu = (lambda_L + mu)/mu = K/mu, dimensionless; -1 < eta <= max_eta. Above 0 in a stable
    /// free-standing material; -1 < eta < 0 is admissible only mathematically (K < 0).
    double eta = 1.0;
    double xi = 1.0; ///< screening length mu/(zeta v0), min_xi <= xi <= max_xi

    /// Beyond this the medium is incompressible to every digit.
    static constexpr double max_eta = 1e12;
    /// Units so far off that powers of xi would overflow.
    static constexpr double min_xi = 1e-30, max_xi = 1e30;

    /// nu = 1/(1 + eta), ratio of shear to longitudinal modulus. (The paper prints 1 + 1/eta, which does not
    /// solve its own equation; docs/theory.md, slip 1.)
    double nu() const { return 1.0 / (1.0 + eta); }
};

/// Throws InputError unless -1 < eta <= max_eta and min_xi <= xi <= max_xi.
void validate(const Medium& medium);

/// eta from the Lame coefficients of the free energy: (lambda_L + mu)/mu. mu > 0, lambda_L > -2 mu.
double eta_from_lame(double lame_lambda, double mu);

/// eta from the 2-D bulk modulus: K/mu. mu > 0, K > -mu.
double eta_from_bulk_modulus(double bulk_modulus, double mu);

/// eta from the 2-D Poisson ratio lambda_L/(lambda_L + 2 mu): (1 + p)/(1 - p), -1 < p < 1, so eta > 0; p < 0
/// is auxetic (eta < 1), p -> 1 incompressible.
double eta_from_poisson_ratio(double poisson_ratio);

/// Inverse of eta_from_poisson_ratio: (eta - 1)/(eta + 1).
double poisson_ratio(double eta);

/// xi from alpha = (f/mu)/xi = f zeta v0/mu^2. The paper never defines alpha; with its fit f/mu = 2.2 a,
/// alpha = 0.1 this reading gives xi = 22 a, beside xi = 16 a of its other fit. alpha > 0,
/// f_over_mu > 0.
double xi_from_alpha(double alpha, double f_over_mu = 1.0);

} // namespace rodwake::elastic
