#include "rodwake/elastic/principal.hpp"

#include <cmath>

namespace rodwake::elastic {

PrincipalAxis extensional_axis(const SymmetricTensor& tensor) {
    const double half_difference = 0.5 * (tensor.xx - tensor.yy);
    return {std::hypot(half_difference, tensor.xy), 0.5 * std::atan2(tensor.xy, half_difference)};
}

} // namespace rodwake::elastic
