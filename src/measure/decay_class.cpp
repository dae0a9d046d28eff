#include "decay_fit.hpp"
#include "decay_rule.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/structure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double flattest = -1.0, steepest = 16.0; // exponents
constexpr std::size_t least_points = 4;

struct Fits {
    ShapeFit algebraic, exponential;
    double plateau = 0.0, plateau_error = 0.0;
};

/// Columns of the points that count.
struct Chosen {
    std::vector<std::size_t> index;
    std::vector<double> r, error;
};

Chosen choose(const DecayPoints& points, double from) {
    Chosen chosen;
    for (std::size_t i = 0; i < points.r.size(); ++i)
        if (points.r[i] >= from && points.r[i] > 0.0 && points.error[i] > 0.0) {
            chosen.index.push_back(i);
            chosen.r.push_back(points.r[i]);
            chosen.error.push_back(points.error[i]);
        }
    return chosen;
}

std::vector<double> pick(const std::vector<double>& all, const Chosen& chosen) {
    std::vector<double> values;
    for (const std::size_t i : chosen.index)
        values.push_back(all[i]);
    return values;
}

/// Weighted mean of the farther half.
void fit_plateau(const Points& points, Fits& fits) {
    double sum = 0.0, weights = 0.0;
    for (std::size_t i = points.r.size() / 2; i < points.r.size(); ++i) {
        const double weight = 1.0 / (points.error[i] * points.error[i]);
        sum += weight * points.value[i];
        weights += weight;
    }
    fits.plateau = sum / weights;
    fits.plateau_error = 1.0 / std::sqrt(weights);
}

double steepest_rate(const Points& points) { return 8.0 / points.r.front(); }

Fits fit(const Points& points, double box) {
    Fits fits;
    fits.algebraic = fit_shape(algebraic_shape, points, flattest, steepest, box);
    fits.exponential = fit_shape(exponential_shape, points, 0.0, steepest_rate(points), box);
    fit_plateau(points, fits);
    return fits;
}

/// The same near a fit of nearly the same points.
Fits fit_near(const Fits& known, const Points& points, double box) {
    Fits fits;
    const double eta = known.algebraic.k, rate = known.exponential.k, most = steepest_rate(points);
    fits.algebraic = refine_shape(algebraic_shape, points, std::max(flattest, eta - 1.0),
                                  std::min(steepest, eta + 1.0), box);
    fits.exponential = refine_shape(exponential_shape, points, std::max(0.0, rate - most / 16.0),
                                    std::min(most, rate + most / 16.0), box);
    fit_plateau(points, fits);
    return fits;
}

/// Error of a number from what it is with each block left out.
template<class Number>
double jackknife(const std::vector<Fits>& without, double growth, Number number) {
    const double n = static_cast<double>(without.size());
    double mean = 0.0, square = 0.0;
    for (const Fits& fits : without)
        mean += number(fits) / n;
    for (const Fits& fits : without)
        square += (number(fits) - mean) * (number(fits) - mean);
    return growth * std::sqrt((n - 1.0) / n * square);
}

void set_errors(const DecayPoints& points, const Chosen& chosen, Fits& fits) {
    if (points.without.size() < 2)
        return;
    std::vector<Fits> without;
    for (const auto& curve : points.without) {
        const std::vector<double> g = pick(curve, chosen);
        without.push_back(fit_near(fits, {chosen.r, g, chosen.error}, points.box));
    }
    const double growth = points.growth;
    fits.algebraic.error = jackknife(without, growth, [](const Fits& f) { return f.algebraic.k; });
    fits.exponential.error = jackknife(without, growth, [](const Fits& f) { return f.exponential.k; });
    fits.plateau_error = jackknife(without, growth, [](const Fits& f) { return f.plateau; });
}

double chi2_of_zero(const Points& points) {
    double sum = 0.0;
    for (std::size_t i = 0; i < points.r.size(); ++i)
        sum += points.value[i] * points.value[i] / (points.error[i] * points.error[i]);
    return sum;
}

Estimate length_of(const ShapeFit& rate, double farthest, std::size_t points) {
    if (!(rate.k * farthest > 1e-6))
        return {0.0, -1.0, points};
    const double error = rate.error >= 0.0 ? rate.error / (rate.k * rate.k) : -1.0;
    return {1.0 / rate.k, error, points};
}

} // namespace

DecayClass classify(const DecayPoints& points, double from) {
    if (points.g_B.size() != points.r.size() || points.error.size() != points.r.size())
        throw InputError(fmt::format("measure: g_B(r) with {} distances, {} values and {} errors",
                                     points.r.size(), points.g_B.size(), points.error.size()));
    const Chosen chosen = choose(points, from);
    DecayClass c;
    c.points = static_cast<long>(chosen.r.size());
    if (chosen.r.size() < least_points) {
        c.reason = fmt::format("{} points with known errors from {:.3g} m on: at least {} are needed",
                               c.points, from, least_points);
        return c;
    }
    const std::vector<double> g = pick(points.g_B, chosen);
    const Points data{chosen.r, g, chosen.error};
    Fits fits = fit(data, points.box);
    set_errors(points, chosen, fits);
    const std::size_t samples = points.without.size() < 2 ? chosen.r.size() : points.without.size();
    c.exponent = {fits.algebraic.k, fits.algebraic.error, samples};
    c.length = length_of(fits.exponential, chosen.r.back(), samples);
    c.plateau = {fits.plateau, fits.plateau_error, samples};
    c.chi2_algebraic = fits.algebraic.chi2;
    c.chi2_exponential = fits.exponential.chi2;
    c.chi2_constant = chi2_of_shape(algebraic_shape, data, 0.0, points.box);
    decide(c, chi2_probability(chi2_of_zero(data), c.points), chosen.r.back());
    return c;
}

DecayClass classify(std::span<const double> r, std::span<const double> g_B, std::span<const double> error,
                    double from) {
    return classify(
        {{r.begin(), r.end()}, {g_B.begin(), g_B.end()}, {error.begin(), error.end()}, {}, 1.0, 0.0}, from);
}

} // namespace rodwake::measure
