#include "normal_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::granular {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

double impulse_to_turn(const NormalMotion& motion, double rate) {
    if (motion.velocity >= 0.0)
        return 0.0;
    return rate > 0.0 ? -motion.velocity / rate : never;
}

/// Smallest p >= 0 with velocity p + rate p^2/2 = wanted, without cancellation for either sign of rate.
double impulse_to_regain(const NormalMotion& motion, double rate, double wanted) {
    const double square = motion.velocity * motion.velocity + 2.0 * rate * wanted;
    return square < 0.0 ? never : 2.0 * wanted / (motion.velocity + std::sqrt(square));
}

void advance(NormalMotion& motion, double rate, double impulse) {
    motion.regained += impulse * (motion.velocity + 0.5 * rate * impulse);
    motion.velocity += rate * impulse;
}

} // namespace

void NormalMotion::turn() {
    velocity = 0.0;
    compression -= std::min(regained, 0.0);
    regained = std::max(regained, 0.0);
}

Piece follow_straight(NormalMotion& motion, double rate, double length, double restitution) {
    const double compressing = impulse_to_turn(motion, rate);
    if (compressing > length) {
        advance(motion, rate, length);
        return {length, false};
    }
    if (motion.velocity < 0.0) {
        motion.regained += 0.5 * motion.velocity * compressing;
        motion.turn();
    }
    const double wanted = motion.wanted(restitution);
    const double restoring = wanted > 0.0 ? impulse_to_regain(motion, rate, wanted) : 0.0;
    if (compressing + restoring <= length)
        return {compressing + restoring, true};
    advance(motion, rate, length - compressing);
    return {length, false};
}

} // namespace rodwake::granular
