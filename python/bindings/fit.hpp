#pragma once
// Data of a fit as the modules in rodwake/ hand them over, and the plan that they make with a scene.

#include "arrays.hpp"
#include "rodwake/app/fit.hpp"

#include <optional>
#include <tuple>

namespace rodwake::python {

using OptionalArray = std::optional<Array>;
/// place, value, sigma; the rest is in [[fit.profiles]].
using ProfileTuple = std::tuple<Array, Array, OptionalArray>;
/// t (T,), poses (T, N, 3), independent; the rest is in [[fit.trajectories]].
using TrackTuple = std::tuple<Array, Array, double>;
/// x, y, Ux, Uy, sigma_x, sigma_y; sides of the box; speed. The shapes are checked, NaN: not there.
using MapTuple = std::tuple<std::vector<Array>, std::pair<double, double>, double>;

app::FitPlan fit_plan(const scene::Scene& scene, const std::vector<ProfileTuple>& profiles,
                      const std::vector<TrackTuple>& tracks, const std::vector<MapTuple>& maps);

} // namespace rodwake::python
