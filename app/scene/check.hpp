#pragma once
// What must hold between the values of a scene.

#include "diagnostics.hpp"
#include "node.hpp"
#include "rodwake/scene/fit.hpp"
#include "rodwake/scene/scene.hpp"

#include <functional>
#include <string>
#include <vector>

namespace rodwake::scene {

/// Reports tables and values that do not fit each other. `root` gives the places; without a document (null)
/// diagnostics are of scene.path as a whole. Comparisons of values are left out if `diagnostics` holds any
/// before: the values may be stand-ins.
void check(const Scene& scene, const Node* root, Diagnostics& diagnostics);

/// Receives the path of a key and a message for each contradiction.
using Report = std::function<void(const std::string& path, const std::string& message)>;

/// An axis of a window, [min, max].
void check_window(const std::vector<double>& range, const std::string& path, const Report& report);
void check_fit(const Scene& scene, const Report& report);  ///< [fit], and between it and the medium
void check_fit_data(const Fit& fit, const Report& report); ///< what the data must be for the parameters
void check_fit_maps(const Scene& scene, const Report& report);
void check_posterior(const Fit& fit, const Report& report);
/// Figures whose scene lacks what they show, and keys that mean nothing for their kind.
void check_figures(const Scene& scene, const Report& report);
/// What needs the geometry of rods (does it fit?) is left to granular::validate.
void check_granular(const Scene& scene, const Report& report);
void check_measure(const Scene& scene, const Report& report); ///< between [measure] and the bed
void check_tracks(const Scene& scene, const Report& report);  ///< [tracks]
/// Between [measure] and the tracks.
void check_measured_tracks(const Scene& scene, const Report& report);
void check_rods(const Scene& scene, const Report& report); ///< [rods_random], [rods_run], and with the medium
void check_medium(const Scene& scene, const Report& report); ///< measured or dynamic
/// Whether axes name keys of the scene is seen when they are looked up (compile_setter).
void check_scan(const Scene& scene, const Report& report);

} // namespace rodwake::scene
