#pragma once
// The inner unit of `rodwake design` (commands/rodwake_commands/design.py): the rival models of a fit, one of
// which makes the tracks of an experiment that is not done yet, and all of which are then weighed on them.
//
// The model that makes the tracks draws parameters from its priors, noise of the rods if it has some, and
// errors of sigma_position and sigma_heading. Runs of a design begin alike. Rods that do not diffuse are as
// informative in R runs as in one run with errors smaller by sqrt(R), so that run alone is made; of rods that
// diffuse there are R tracks.

#include "rodwake/app/fit.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace rodwake::app {

class DesignModels {
public:
    /// Takes the models of the scene with the settings "key=value". Throws InputError for a scene without
    /// rods, rivals or priors, or whose fit cannot be made; SceneError for settings that make no scene.
    DesignModels(const scene::Scene& scene, const std::vector<std::string>& settings, long runs);

    /// The fit as written and its rivals.
    std::vector<std::string> names() const;
    std::uint64_t seed_of_scene() const { return models_.front().keys.search.seed; }

    /// Logarithm of the evidence of each model (fitting::curvature_evidence) on tracks that model `by` makes.
    /// Sets of equal number have the same random numbers in all designs, so that differences between designs
    /// are known better.
    std::vector<double> log_evidence(std::size_t by, std::uint64_t seed, std::uint32_t set) const;

private:
    using States = std::vector<std::vector<double>>;
    struct Model {
        scene::Fit keys;
        FitTrackData track; ///< each of its rows is the start
        std::size_t tracks = 1;

        FitPlan plan_of(const std::vector<States>& data) const;
    };

    static Model model_of(const scene::Scene& scene, long runs);

    std::vector<Model> models_;
};

} // namespace rodwake::app
