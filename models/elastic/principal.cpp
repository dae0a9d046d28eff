#include "rodwake/elastic/principal.hpp"

#include <cmath>

namespace rodwake::elastic {

PrincipalAxis extensional_axis(const SymmetricTensor& tensor) {
    const double half_difference = 0.5 * (tensor.xx - tensor.yy) + 0.0,
                 xy = tensor.xy + 0.0; // -0 is 0 to atan2
    return {std::hypot(half_difference, xy), 0.5 * std::atan2(xy, half_difference)};
}

} // namespace rodwake::elastic
