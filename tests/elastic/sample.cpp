#include "sample.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::oracle {

namespace {

struct Direction {
    double x, y;
};

Direction on_an_axis(RandomStream& random) {
    const double sign = random.uniform() < 0.5 ? -1.0 : 1.0;
    return random.uniform() < 0.5 ? Direction{sign, 0.0} : Direction{0.0, sign};
}

/// Close to an axis: exact zero crossings of the angle are met by Angle::axes.
Direction near_axis(RandomStream& random, double sign) {
    const double angle = random.log_uniform(1e-16, 1e-1);
    return {sign * std::cos(angle), random.uniform() < 0.5 ? -std::sin(angle) : std::sin(angle)};
}

/// Such that the faster of the two exponentials is exp(-n), n up to past the underflow at 745.
Direction with_exponent(RandomStream& random, double nu, double r_over_xi) {
    const double wanted = random.uniform(0.5, 760.0) / std::max(nu, 1.0);
    const double cosine = std::min(2.0 * wanted / r_over_xi - 1.0, 1.0);
    return {cosine, std::sqrt((1.0 - cosine) * (1.0 + cosine))};
}

Direction direction(RandomStream& random, Angle angle, double nu, double r_over_xi) {
    const double turn = random.uniform(-std::numbers::pi, std::numbers::pi);
    switch (angle) {
    case Angle::axes:
        return on_an_axis(random);
    case Angle::near_wake:
        return near_axis(random, -1.0);
    case Angle::near_front:
        return near_axis(random, 1.0);
    case Angle::large_exponent:
        return with_exponent(random, nu, r_over_xi);
    default:
        return {std::cos(turn), std::sin(turn)};
    }
}

double draw_eta(RandomStream& random, Stiffness stiffness) {
    if (stiffness == Stiffness::zero)
        return 0.0;
    return stiffness == Stiffness::negative ? random.uniform(-1.0, 0.0) : random.log_uniform(1e-6, 1e6);
}

} // namespace

Point random_point(RandomStream& random, Angle angle, Stiffness stiffness) {
    const double eta = draw_eta(random, stiffness), xi = random.log_uniform(1e-6, 1e6);
    const double smallest = angle == Angle::large_exponent ? 1e-1 : 1e-12;
    const double r_over_xi = random.log_uniform(smallest, 1e8);
    const Direction to = direction(random, angle, 1.0 / (1.0 + eta), r_over_xi);
    return {xi * r_over_xi * to.x, xi * r_over_xi * to.y, xi, eta};
}

Point random_point(RandomStream& random, int number) {
    // Two in three points have eta over the decades, the main range.
    constexpr Stiffness turns[] = {Stiffness::decades, Stiffness::negative, Stiffness::decades,
                                   Stiffness::decades, Stiffness::zero,     Stiffness::decades};
    return random_point(random, static_cast<Angle>(number % angles), turns[number / angles % 6]);
}

} // namespace rodwake::oracle
