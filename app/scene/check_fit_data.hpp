#pragma once
// [fit]: what the data must be for the parameters.

#include "rodwake/scene/scene.hpp"

#include <functional>
#include <string>

namespace rodwake::scene {

void check_fit_data(const Fit& fit,
                    const std::function<void(const std::string&, const std::string&)>& report);

} // namespace rodwake::scene
