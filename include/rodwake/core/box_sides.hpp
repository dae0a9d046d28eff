#pragma once
// The sides of a periodic box as one thing: checked, in other units, in messages.

#include "rodwake/core/periodic.hpp"

#include <string>

namespace rodwake {

/// Both above 0 and finite.
inline bool valid_sides(const PeriodicBox& box) {
    return box.x > 0.0 && box.y > 0.0 && std::isfinite(box.x) && std::isfinite(box.y);
}

constexpr PeriodicBox operator*(const PeriodicBox& box, double factor) {
    return {box.x * factor, box.y * factor};
}
constexpr PeriodicBox operator/(const PeriodicBox& box, double divisor) {
    return {box.x / divisor, box.y / divisor};
}

/// For messages: "20" of a square, "20 x 30".
std::string to_string(const PeriodicBox& box);

} // namespace rodwake
