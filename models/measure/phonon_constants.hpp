#pragma once
// From frequencies and dampings of modes to sound speeds, elastic constants and the rate of drag (formulas:
// rodwake/measure/phonons.hpp).

#include <vector>

namespace rodwake::measure {

/// What a mode tells, with the weights 1/error^2 of omega and gamma; NaN: not known, and left out.
struct ModeNumbers {
    int m = 0, n = 0;
    double qx = 0.0, qy = 0.0; ///< 1/m
    double omega_L = 0.0, omega_T = 0.0, gamma_L = 0.0, gamma_T = 0.0;
    double weight_omega_L = 0.0, weight_omega_T = 0.0, weight_gamma_L = 0.0, weight_gamma_T = 0.0;
};

/// As in PhononResult; NaN where the modes do not tell.
struct ElasticNumbers {
    double c_Lx, c_Ly, c_Ld, c_Tx, c_Ty, c_Td, C11, C22, C12, C66, bulk, mu, eta, spread_L, spread_T, drag,
        viscosity_L, viscosity_T;
};

/// `density` in kg/m^2.
ElasticNumbers elastic_numbers(const std::vector<ModeNumbers>& modes, double density);

/// rho c^2 of the quasi-longitudinal and the quasi-transverse wave along (cos, sin) of the angle, N/m.
struct WaveModuli {
    double longitudinal, transverse;
};
WaveModuli wave_moduli(double C11, double C22, double C12, double C66, double angle);

} // namespace rodwake::measure
