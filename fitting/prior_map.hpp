#pragma once
// Parameters as standard normal variables of their priors.

#include "rodwake/fitting/posterior.hpp"

namespace rodwake::fitting {

double normal_below(double z); ///< distribution function of the standard normal
double normal_quantile(double p);

/// Of draws by chain, of the values themselves.
double effective_samples(const std::vector<std::vector<double>>& chains);

class PriorMap {
public:
    /// Throws InputError.
    PriorMap(const Prior& prior, const std::string& name);

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
