#pragma once
// What `rodwake check` says of a granular bed.

#include "rodwake/scene/scene.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::cli {

/// One part of the physics and why it is in or out.
struct CheckLine {
    bool modelled;
    std::string text;
};

/// What is and what is not modelled of the bed, and what that will cost: empty for a scene without one.
/// Throws InputError for a bed that cannot be modelled.
struct BedReport {
    std::vector<CheckLine> lines;
    std::string cost;
};
BedReport check_bed(const scene::Scene& scene, std::optional<std::uint64_t> seed_override);

} // namespace rodwake::cli
