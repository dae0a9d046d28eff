#include "prior_map.hpp"

#include "rodwake/core/error.hpp"

#include <boost/math/special_functions/erf.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::fitting {

double normal_below(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double normal_quantile(double p) {
    return p <= 0.0 ? -HUGE_VAL : p >= 1.0 ? HUGE_VAL : -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * p);
}

PriorMap::PriorMap(const Prior& prior, const std::string& name)
    : prior_(prior), least_(prior.low.value_or(-HUGE_VAL)), most_(prior.high.value_or(HUGE_VAL)),
      low_(least_), high_(most_) {
    const auto refuse = [&](const char* why) {
        throw InputError(fmt::format("prior of {}: {}: low = {:g}, high = {:g}", name, why, least_, most_));
    };
    if (!(least_ < most_))
        refuse("low must be below high");
    if (prior.kind == PriorKind::normal) {
        if (!(prior.sd > 0.0))
            refuse("sd must be above 0");
        low_ = (least_ - prior.mean) / prior.sd, high_ = (most_ - prior.mean) / prior.sd;
        mass_ = low_ > 0.0 ? normal_below(-low_) - normal_below(-high_)
                           : normal_below(high_) - normal_below(low_);
        if (!(mass_ > 1e-290))
            refuse("nothing of the normal prior lies between its bounds");
        return;
    }
    if (!std::isfinite(low_) || !std::isfinite(high_))
        refuse("a prior without limits cannot be normalised: give both bounds");
    if (prior.kind == PriorKind::log_uniform) {
        if (!(low_ > 0.0))
            refuse("low must be above 0");
        low_ = std::log(low_), high_ = std::log(high_);
    }
}

double PriorMap::log_density(double value) const {
    if (!(value >= least_ && value <= most_))
        return -HUGE_VAL;
    if (prior_.kind == PriorKind::normal) {
        const double t = (value - prior_.mean) / prior_.sd;
        return -0.5 * t * t - log_root_2pi - std::log(prior_.sd * mass_);
    }
    return -std::log(high_ - low_) - (prior_.kind == PriorKind::log_uniform ? std::log(value) : 0.0);
}

// From the nearer end, which keeps the digits of both.
double PriorMap::value(double z) const {
    const double below = normal_below(z), above = normal_below(-z);
    if (prior_.kind == PriorKind::normal) {
        const double p = normal_below(low_) + mass_ * below, q = normal_below(-high_) + mass_ * above;
        const double t = p <= 0.5 ? normal_quantile(p) : -normal_quantile(q);
        return std::clamp(prior_.mean + prior_.sd * t, least_, most_);
    }
    const double c = z < 0.0 ? low_ + (high_ - low_) * below : high_ - (high_ - low_) * above;
    return std::clamp(prior_.kind == PriorKind::log_uniform ? std::exp(c) : c, least_, most_);
}

double PriorMap::coordinate(double value) const {
    const double c = prior_.kind == PriorKind::normal        ? (value - prior_.mean) / prior_.sd
                     : prior_.kind == PriorKind::log_uniform ? std::log(std::max(value, least_))
                                                             : value;
    double below = (c - low_) / (high_ - low_), above = (high_ - c) / (high_ - low_);
    if (prior_.kind == PriorKind::normal) {
        below = (normal_below(c) - normal_below(low_)) / mass_;
        above = (normal_below(-c) - normal_below(-high_)) / mass_;
    }
    constexpr double farthest = 6.0;
    return std::clamp(below < above ? normal_quantile(below) : -normal_quantile(above), -farthest, farthest);
}

} // namespace rodwake::fitting
