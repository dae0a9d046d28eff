#include "rodwake/elastic/tensor.hpp"

#include <cmath>

namespace rodwake::elastic {

Vector turned(const Vector& v, double cosine, double sine) {
    return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y};
}

SymmetricTensor turned(const SymmetricTensor& t, double cosine, double sine) {
    const double cc = cosine * cosine, ss = sine * sine, cs = cosine * sine;
    return {cc * t.xx - 2.0 * cs * t.xy + ss * t.yy, cs * (t.xx - t.yy) + (cc - ss) * t.xy,
            ss * t.xx + 2.0 * cs * t.xy + cc * t.yy};
}

PrincipalAxis extensional_axis(const SymmetricTensor& tensor) {
    const double half_difference = 0.5 * (tensor.xx - tensor.yy) + 0.0,
                 xy = tensor.xy + 0.0; // -0 is 0 to atan2
    return {std::hypot(half_difference, xy), 0.5 * std::atan2(xy, half_difference)};
}

} // namespace rodwake::elastic
