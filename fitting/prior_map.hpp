#pragma once
// Parameters as standard normal variables of their priors.

#include "rodwake/fitting/prior.hpp"

#include <cmath>
#include <numbers>
#include <string>

namespace rodwake::fitting {

inline const double log_root_2pi = 0.5 * std::log(2.0 * std::numbers::pi);

double normal_below(double z); ///< distribution function of the standard normal
double normal_quantile(double p);

class PriorMap {
public:
    /// Throws InputError.
    PriorMap(const Prior& prior, const std::string& name);

    /// -infinity outside.
    double log_density(double value) const;
    double value(double z) const;
    /// Kept within what a double can tell from the ends.
    double coordinate(double value) const;

private:
    Prior prior_;
    double least_, most_;           ///< of the value
    double low_ = 0.0, high_ = 0.0; ///< of the value, its logarithm, or in sd from the mean
    double mass_ = 1.0;             ///< of the uncut normal
};

} // namespace rodwake::fitting
