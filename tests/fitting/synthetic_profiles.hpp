#pragma once
// Profiles made up from known parameters, with Gaussian noise of known size.

#include "rodwake/fitting/wake.hpp"
#include "support/normal.hpp"

namespace fitting_test {

using rodwake::normal;

/// `count` even places from -reach to reach (none at 0 if count is even), errors all `sigma`; noise 0: exact
/// values.
inline rodwake::fitting::Profile made_up(const rodwake::fitting::WakeModel& model,
                                         const std::vector<rodwake::fitting::Parameter>& parameters,
                                         const std::vector<double>& truth, rodwake::fitting::Profile line,
                                         std::size_t count, double reach, double sigma,
                                         rodwake::RandomStream* noise = nullptr) {
    line.place.clear();
    for (std::size_t i = 0; i < count; ++i)
        line.place.push_back(-reach + 2.0 * reach * static_cast<double>(i) / static_cast<double>(count - 1));
    line.value = rodwake::fitting::predict(model, line, line.place, parameters, truth).value;
    for (double& value : line.value)
        value += noise ? sigma * normal(*noise) : 0.0;
    line.sigma.assign(count, sigma);
    return line;
}

} // namespace fitting_test
