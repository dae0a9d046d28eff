#include "rodwake/rods/couplings.hpp"

namespace rodwake::rods {

Couplings from_divergence_basis(double kappa, double gamma1, double gamma2) {
    return {kappa, 0.5 * gamma1, gamma2 + 0.5 * gamma1};
}

} // namespace rodwake::rods
