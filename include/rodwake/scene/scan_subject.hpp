#pragma once
// What the points of a scan are.

#include "rodwake/scene/scene.hpp"

#include <string_view>

namespace rodwake::scene {

/// Encounters of rods of the theory, or granular runs.
enum class ScanSubject { rods, beds };

/// The beds of a scene that has no [rods_run]; of one that has both those if an axis varies [granular].
ScanSubject scan_subject(const Scene& scene);

/// Whether points of a scan of this subject depend on the key, so that it can be an axis.
bool can_vary(std::string_view key, ScanSubject subject);

} // namespace rodwake::scene
