#include "rest_slip.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::granular {

namespace {

/// a b - c d by Kahan's method: error of 1.5 units in the last place at most (Jeannerod, Louvet, Muller
/// 2013).
double difference_of_products(double a, double b, double c, double d) {
    const double cd = c * d;
    return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

} // namespace

double determinant(double xx, double xy, double yy) { return difference_of_products(xx, yy, xy, xy); }

Eigen::Vector2d solve(const Eigen::Matrix2d& a, const Eigen::Vector2d& b) {
    const Eigen::Vector2d adjugate(difference_of_products(a(1, 1), b.x(), a(0, 1), b.y()),
                                   difference_of_products(a(0, 0), b.y(), a(0, 1), b.x()));
    return adjugate / determinant(a(0, 0), a(0, 1), a(1, 1));
}

/// Newton on 1/|s(lambda)| - 1, concave and rising: from below it converges without overshoot, in three or
/// four steps. lambda >= |q| - mu tr A because |q| <= lambda + mu |A|.
Eigen::Vector2d resumed_direction(const ContactTerms& contact) {
    const Eigen::Matrix2d drag = contact.friction * contact.tangential;
    double lambda = std::max(0.0, contact.coupling.norm() - drag.trace());
    Eigen::Vector2d s;
    for (int k = 0; k < 100; ++k) { // every step at least halves the distance; ends at rounding long before
        const Eigen::Matrix2d shifted = drag + lambda * Eigen::Matrix2d::Identity();
        s = solve(shifted, contact.coupling);
        const double length = s.norm();
        const double step = (length - 1.0) * length * length / s.dot(solve(shifted, s));
        if (!(std::abs(length - 1.0) > 2.0 * std::numeric_limits<double>::epsilon() &&
              lambda + step > lambda))
            break;
        lambda += step;
    }
    return s.normalized();
}

} // namespace rodwake::granular
