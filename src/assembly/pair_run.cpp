#include "pair_run.hpp"

#include <algorithm>

namespace rodwake::assembly {

namespace {

/// From t = 0 on: the rods are held before.
measure::PairTrack track_of(const RunTables& run) {
    const std::vector<Column> all = run.tracks({"t", "x0", "y0", "theta0", "x1", "y1", "theta1"});
    std::vector<Column> kept(all.size());
    for (std::size_t i = 0; i < all[0].size(); ++i)
        if (all[0][i] >= -1e-12)
            for (std::size_t k = 0; k < all.size(); ++k)
                kept[k].push_back(all[k][i]);
    return {kept[0], {kept[1], kept[4]}, {kept[2], kept[5]}, {kept[3], kept[6]}};
}

} // namespace

double contact_distance(const scene::Scene& scene) {
    if (scene.measure && scene.measure->contact_distance)
        return *scene.measure->contact_distance;
    double longest = 0.0;
    for (const scene::GranularRod& rod : scene.granular->rods)
        longest = std::max(longest, rod.shape.length);
    return 0.5 * longest;
}

measure::PairRun pair_run(const scene::Scene& scene, const RunTables& run) {
    measure::PairOptions options;
    options.box = scene.granular->box;
    options.contact_distance = contact_distance(scene);
    return measure::follow_pair(track_of(run), options);
}

} // namespace rodwake::assembly
