#include "starts.hpp"

#include "rodwake/core/rng.hpp"
#include "search_space.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

/// Of start, or of a coin where both signs are possible.
double sign_of(const Parameter& p, RandomStream& random) {
    const double sign = p.start < 0.0 ? -1.0 : 1.0;
    const bool both = p.transform == Transform::linear && p.lower < 0.0 && p.upper > 0.0;
    return both && random.uniform() < 0.5 ? -sign : sign;
}

/// start times a factor in [1/spread, spread], even in the logarithm, within the bounds.
double by_factor(const Parameter& p, double spread, RandomStream& random) {
    const double sign = sign_of(p, random);
    const double size = std::abs(p.start);
    const double nearest = sign > 0.0 ? p.lower : -p.upper, farthest = sign > 0.0 ? p.upper : -p.lower;
    const double low = std::max(size / spread, nearest), high = std::min(size * spread, farthest);
    const double value = low < high ? random.log_uniform(low, high) : low;
    return std::clamp(sign * value, p.lower, p.upper);
}

double around_zero(const Parameter& p, double spread, RandomStream& random) {
    const double reach = spread * natural_scale(p);
    const bool box = std::isfinite(p.lower) && std::isfinite(p.upper);
    const double low = box ? p.lower : std::max(p.lower, -reach),
                 high = box ? p.upper : std::min(p.upper, reach);
    return std::clamp(random.uniform(low, high), p.lower, p.upper);
}

} // namespace

std::vector<double> start_values(const Problem& problem, const Method& method, std::size_t index) {
    RandomStream random(method.seed, static_cast<std::uint32_t>(index));
    std::vector<double> values;
    for (const std::size_t i : free_parameters(problem)) {
        const Parameter& p = problem.parameters[i];
        if (index == 0)
            values.push_back(p.start);
        else
            values.push_back(p.start != 0.0 ? by_factor(p, method.spread, random)
                                            : around_zero(p, method.spread, random));
    }
    return values;
}

} // namespace rodwake::fitting
