#include "rodwake/measure/statistics.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

void check_blocks(std::span<const double> values, std::span<const double> weights) {
    if (!weights.empty() && weights.size() != values.size())
        throw InputError(fmt::format("measure: {} weights for {} values: must be as many, or none",
                                     weights.size(), values.size()));
    if (!std::ranges::all_of(values, [](double v) { return std::isfinite(v); }))
        throw InputError("measure: the mean of values that are not all finite");
    if (!std::ranges::all_of(weights, [](double w) { return std::isfinite(w) && w >= 0.0; }))
        throw InputError("measure: weights of a mean must be finite and not negative");
}

} // namespace

Estimate mean_of_blocks(std::span<const double> values, std::span<const double> weights) {
    check_blocks(values, weights);
    const auto weight = [&](std::size_t b) { return weights.empty() ? 1.0 : weights[b]; };
    Estimate mean;
    double total = 0.0, sum = 0.0;
    for (std::size_t b = 0; b < values.size(); ++b) {
        if (weight(b) == 0.0)
            continue;
        ++mean.samples;
        total += weight(b);
        sum += weight(b) * values[b];
    }
    if (mean.samples == 0)
        return mean;
    mean.value = sum / total;
    if (mean.samples < 2)
        return mean;
    double scatter = 0.0;
    for (std::size_t b = 0; b < values.size(); ++b) {
        const double part = weight(b) / total * (values[b] - mean.value);
        scatter += part * part;
    }
    const double n = static_cast<double>(mean.samples);
    mean.error = std::sqrt(scatter * n / (n - 1.0));
    return mean;
}

double successive_correlation(std::span<const double> values) {
    check_blocks(values, {});
    if (values.size() < 3)
        return 0.0;
    const double mean = mean_of_blocks(values).value;
    double products = 0.0, squares = 0.0;
    for (std::size_t b = 0; b < values.size(); ++b) {
        squares += (values[b] - mean) * (values[b] - mean);
        if (b > 0)
            products += (values[b - 1] - mean) * (values[b] - mean);
    }
    return squares > 0.0 ? std::clamp(products / squares, -1.0, 1.0) : 0.0;
}

double correlation_factor(double r) {
    const double capped = std::clamp(r, 0.0, 0.9);
    return std::sqrt((1.0 + capped) / (1.0 - capped));
}

} // namespace rodwake::measure
