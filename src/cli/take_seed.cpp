#include "take_seed.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <limits>

namespace rodwake::cli {

void take_seed(scene::Scene& scene, const Options& options) {
    if (!options.seed || (!scene.granular && !scene.fit))
        return;
    constexpr auto largest = static_cast<std::uint64_t>(std::numeric_limits<long>::max());
    if (*options.seed > largest)
        throw InputError(fmt::format("--seed {}: must be from 0 to {}", *options.seed, largest));
    if (scene.granular)
        scene.granular->seed = static_cast<long>(*options.seed);
    if (scene.fit)
        scene.fit->seed = static_cast<long>(*options.seed);
}

} // namespace rodwake::cli
