#include "rodwake/measure/statistics.hpp"
#include "rodwake/core/error.hpp"

#include <boost/math/special_functions/gamma.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

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
        ++mean.count;
        total += weight(b);
        sum += weight(b) * values[b];
    }
    if (mean.count == 0)
        return mean;
    mean.value = sum / total;
    if (mean.count < 2)
        return mean;
    double scatter = 0.0;
    for (std::size_t b = 0; b < values.size(); ++b) {
        const double part = weight(b) / total * (values[b] - mean.value);
        scatter += part * part;
    }
    const double n = static_cast<double>(mean.count);
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

namespace {

using Values = std::span<const double>;

void check_points(Values x, Values y, Values error) {
    if (x.size() != y.size() || x.size() != error.size())
        throw InputError(fmt::format("measure: a line fit of {} x, {} y and {} errors: must be as many",
                                     x.size(), y.size(), error.size()));
    if (x.size() < 2)
        throw InputError(fmt::format("measure: a line fit needs at least 2 points, there are {}", x.size()));
    for (const auto& [what, values] : {std::pair("x", x), std::pair("y", y), std::pair("errors", error)})
        if (!std::ranges::all_of(values, [](double v) { return std::isfinite(v); }))
            throw InputError(fmt::format("measure: {} of a line fit that are not all finite", what));
    const auto bad = std::ranges::find_if(error, [](double e) { return !(e > 0.0); });
    if (bad != error.end())
        throw InputError(
            fmt::format("measure: an error of {:g} of a point of a line fit: must be positive", *bad));
    if (std::ranges::all_of(x, [&](double v) { return v == x[0]; }))
        throw InputError(
            fmt::format("measure: all {} points of a line fit have the same x, {:g}: needs 2 that differ",
                        x.size(), x[0]));
}

/// Weights over the largest, so that their squares neither overflow nor vanish.
std::vector<double> relative_weights(Values error, double smallest) {
    std::vector<double> weights;
    for (const double e : error)
        weights.push_back((smallest / e) * (smallest / e));
    return weights;
}

void want_lever(double xx) {
    if (!(xx > 0.0))
        throw InputError("measure: the points of a line fit do not fix its slope: all but one have "
                         "errors so large that they have no weight");
}

double chi2_of(Values x, Values y, Values error, const LineFit& fit) {
    double chi2 = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double off = (y[i] - fit.intercept.value - fit.slope.value * x[i]) / error[i];
        chi2 += off * off;
    }
    return chi2;
}

} // namespace

LineFit fit_line(Values x, Values y, Values error) {
    check_points(x, y, error);
    const double unit = *std::ranges::min_element(error);
    const std::vector<double> w = relative_weights(error, unit);
    double weight = 0.0, middle_x = 0.0, middle_y = 0.0, xx = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        weight += w[i];
        middle_x += w[i] * x[i];
        middle_y += w[i] * y[i];
    }
    middle_x /= weight;
    middle_y /= weight;
    for (std::size_t i = 0; i < x.size(); ++i) { // about the middle: no cancellation of large x
        xx += w[i] * (x[i] - middle_x) * (x[i] - middle_x);
        xy += w[i] * (x[i] - middle_x) * (y[i] - middle_y);
    }
    want_lever(xx);
    LineFit fit;
    const double slope = xy / xx;
    fit.slope = {slope, unit / std::sqrt(xx), x.size()};
    fit.intercept = {middle_y - slope * middle_x, unit * std::sqrt(1.0 / weight + middle_x * middle_x / xx),
                     x.size()};
    fit.covariance = -middle_x / xx * unit * unit;
    fit.chi2 = chi2_of(x, y, error, fit);
    fit.dof = static_cast<long>(x.size()) - 2;
    return fit;
}

LineFit fit_proportional(Values x, Values y, Values error) {
    check_points(x, y, error);
    const double unit = *std::ranges::min_element(error);
    const std::vector<double> w = relative_weights(error, unit);
    double xx = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += w[i] * x[i] * x[i];
        xy += w[i] * x[i] * y[i];
    }
    want_lever(xx);
    LineFit fit;
    fit.slope = {xy / xx, unit / std::sqrt(xx), x.size()};
    fit.intercept = {0.0, 0.0, x.size()};
    fit.chi2 = chi2_of(x, y, error, fit);
    fit.dof = static_cast<long>(x.size()) - 1;
    return fit;
}

double chi2_probability(double chi2, long dof) {
    if (!(chi2 >= 0.0) || dof < 0)
        throw InputError(fmt::format(
            "measure: chi2 {:g} with {} degrees of freedom: neither may be negative or not a number", chi2,
            dof));
    if (dof == 0)
        return 1.0;
    if (std::isinf(chi2))
        return 0.0;
    return boost::math::gamma_q(static_cast<double>(dof) / 2.0, chi2 / 2.0);
}

} // namespace rodwake::measure
