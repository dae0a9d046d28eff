#pragma once
// What the keys of [[fit.maps]] must agree on.

#include "rodwake/scene/fit.hpp"

#include <functional>

namespace rodwake::scene {

/// Calls `report` with a key's path and what is wrong there.
void check_fit_maps(const Fit& fit,
                    const std::function<void(const std::string&, const std::string&)>& report);

} // namespace rodwake::scene
