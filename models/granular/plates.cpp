#include "plates.hpp"

#include "rodwake/core/repeatable_math.hpp"

#include <numbers>

namespace rodwake::granular {

PlateMotion::PlateMotion(const Plates& plates, double gravity)
    : amplitude_(plates.amplitude(gravity)), omega_(2.0 * std::numbers::pi * plates.frequency),
      gap_(plates.gap) {}

PlatePath PlateMotion::floor(double time) const {
    const auto [sine, cosine] = repeatable::sin_cos(omega_ * time);
    const double c = amplitude_ * cosine, s = amplitude_ * sine, w = omega_;
    // cos(w t - w b) = cos wt cos wb + sin wt sin wb
    return PlatePath({c, s * w, -c * w * w / 2.0, -s * w * w * w / 6.0, c * w * w * w * w / 24.0,
                      s * w * w * w * w * w / 120.0, -c * w * w * w * w * w * w / 720.0,
                      -s * w * w * w * w * w * w * w / 5040.0});
}

} // namespace rodwake::granular
