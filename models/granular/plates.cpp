#include "plates.hpp"

#include "rodwake/core/repeatable_math.hpp"

#include <numbers>

namespace rodwake::granular {

PlatePath floor_path(const Plates& plates, double gravity, double time) {
    const double amplitude = plates.amplitude(gravity), w = 2.0 * std::numbers::pi * plates.frequency;
    const auto [sine, cosine] = repeatable::sin_cos(w * time);
    const double c = amplitude * cosine, s = amplitude * sine;
    // cos(w t - w b) = cos wt cos wb + sin wt sin wb
    return {{c, s * w, -c * w * w / 2.0, -s * w * w * w / 6.0, c * w * w * w * w / 24.0,
             s * w * w * w * w * w / 120.0, -c * w * w * w * w * w * w / 720.0,
             -s * w * w * w * w * w * w * w / 5040.0}};
}

} // namespace rodwake::granular
