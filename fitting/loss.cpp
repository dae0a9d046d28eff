#include "loss.hpp"

#include <cmath>

namespace rodwake::fitting {

LossValue loss_of(const LossShape& shape, double s) {
    const double w2 = shape.width * shape.width;
    if (shape.loss == Loss::squares || (shape.loss == Loss::huber && s <= w2))
        return {s, 1.0, 0.0};
    if (shape.loss == Loss::huber) {
        const double root = std::sqrt(s);
        return {2.0 * shape.width * root - w2, shape.width / root, -0.5 * shape.width / (root * s)};
    }
    const double first = 1.0 / (1.0 + s / w2);
    return {w2 * std::log1p(s / w2), first, -first * first / w2};
}

} // namespace rodwake::fitting
