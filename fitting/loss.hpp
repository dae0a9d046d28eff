#pragma once
// Loss functions of the squared residual s = r^2; the objective is sum rho(s).

#include "rodwake/fitting/method.hpp"

namespace rodwake::fitting {

struct LossShape {
    Loss loss = Loss::squares;
    double width = 1.5;
};

/// rho and its first two derivatives in s. rho'(0) = 1.
struct LossValue {
    double rho = 0.0, first = 1.0, second = 0.0;

    /// Second derivative of rho/2 in r: what a residual adds to the curvature.
    double curvature(double s) const { return first + 2.0 * s * second; }
};

LossValue loss_of(const LossShape& shape, double s);

} // namespace rodwake::fitting
