#include "decay_fit.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double hexatic_bound = 0.25;   // eta_6 where the hexatic melts (KTHNY)
constexpr double least_exponent = 0.003; // what a crystal's shells and phonons leave at these distances
constexpr double clear_chi2 = 4.0;       // decides between two models of as many parameters
constexpr double by_chance = 0.01;

/// Sets decay and reason by the rule in order.hpp. `zero_chance`: probability of chi2 if g_B were 0;
/// `farthest`: distance of the last point, m.
void decide(DecayClass& c, double zero_chance, double farthest) {
    const double eta = c.exponent.value, error = c.exponent.error;
    const bool flat = eta < least_exponent || eta < 2.0 * error;
    const std::string shown = fmt::format("eta_6 = {:.4f} +- {:.4f}", eta, error);
    if (zero_chance > by_chance) {
        c.decay = Decay::exponential;
        c.reason = fmt::format("no order is left at these distances: g_B = 0 within errors (P = {:.2g})",
                               zero_chance);
    } else if (!c.exponent.known()) {
        c.reason = "the error of eta_6 is unknown: chi2 does not determine it";
    } else if (eta - error > hexatic_bound) {
        c.decay = Decay::exponential;
        c.reason = shown + " is above 1/4, where a hexatic melts (KTHNY)";
    } else if (flat && eta + 2.0 * error < hexatic_bound) {
        c.decay = Decay::long_range;
        c.reason = fmt::format("{}: {}, so g_B stays at {:.4f}", shown,
                               eta < least_exponent ? "below 0.003" : "0 within 2 errors", c.plateau.value);
    } else if (flat) {
        c.reason = shown + ": neither 0 nor 1/4 can be excluded; use more frames or a longer run";
    } else if (c.chi2_algebraic - c.chi2_exponential > clear_chi2 && c.length.known() &&
               c.length.value < farthest) {
        c.decay = Decay::exponential;
        c.reason = fmt::format("the exponential fits better (chi2 {:.3g} against {:.3g})", c.chi2_exponential,
                               c.chi2_algebraic);
    } else {
        c.decay = Decay::algebraic;
        c.reason = shown + ": above 0 and not above 1/4 within its error";
    }
}

constexpr double flattest = -1.0, steepest = 16.0; // exponents
constexpr std::size_t fewest_points = 4;

struct Fits {
    ShapeFit algebraic, exponential;
    double plateau = 0.0, plateau_error = 0.0;
};

/// Columns of the points that count.
struct Chosen {
    std::vector<std::size_t> index;
    std::vector<double> r, error;
};

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

/// Errors from fits with each block left out, near the fit of all: `growth` is that of successive blocks.
void set_errors(const DecayPoints& points, const Chosen& chosen, Fits& fits) {
    if (points.without.size() < 2)
        return;
    const double eta = fits.algebraic.k, rate = fits.exponential.k, most = 8.0 / chosen.r.front(),
                 n = static_cast<double>(points.without.size());
    std::vector<std::array<double, 3>> without;
    for (const auto& curve : points.without) {
        const std::vector<double> g = pick(curve, chosen);
        const Points data{chosen.r, g, chosen.error};
        Fits near;
        near.algebraic = refine_shape(algebraic_shape, data, std::max(flattest, eta - 1.0),
                                      std::min(steepest, eta + 1.0), points.box);
        near.exponential = refine_shape(exponential_shape, data, std::max(0.0, rate - most / 16.0),
                                        std::min(most, rate + most / 16.0), points.box);
        fit_plateau(data, near);
        without.push_back({near.algebraic.k, near.exponential.k, near.plateau});
    }
    double* const errors[] = {&fits.algebraic.error, &fits.exponential.error, &fits.plateau_error};
    for (std::size_t k = 0; k < 3; ++k) {
        double mean = 0.0, square = 0.0;
        for (const auto& numbers : without)
            mean += numbers[k] / n;
        for (const auto& numbers : without)
            square += (numbers[k] - mean) * (numbers[k] - mean);
        *errors[k] = points.growth * std::sqrt((n - 1.0) / n * square);
    }
}

} // namespace

const char* to_string(Decay decay) {
    switch (decay) {
    case Decay::exponential:
        return "exponential";
    case Decay::algebraic:
        return "algebraic";
    case Decay::long_range:
        return "long-range";
    case Decay::undetermined:
        break;
    }
    return "undetermined";
}

const char* phase_of(Decay decay) {
    switch (decay) {
    case Decay::exponential:
        return "liquid";
    case Decay::algebraic:
        return "hexatic";
    case Decay::long_range:
        return "crystal";
    case Decay::undetermined:
        break;
    }
    return "undetermined";
}

DecayClass classify(const DecayPoints& points, double from) {
    if (points.g_B.size() != points.r.size() || points.error.size() != points.r.size())
        throw InputError(fmt::format("measure: g_B(r) with {} distances, {} values and {} errors",
                                     points.r.size(), points.g_B.size(), points.error.size()));
    Chosen chosen;
    for (std::size_t i = 0; i < points.r.size(); ++i)
        if (points.r[i] >= from && points.r[i] > 0.0 && points.error[i] > 0.0) {
            chosen.index.push_back(i);
            chosen.r.push_back(points.r[i]);
            chosen.error.push_back(points.error[i]);
        }
    DecayClass c;
    c.points = static_cast<long>(chosen.r.size());
    if (chosen.r.size() < fewest_points) {
        c.reason = fmt::format("{} points with known errors from {:.3g} m on: at least {} are needed",
                               c.points, from, fewest_points);
        return c;
    }
    const std::vector<double> g = pick(points.g_B, chosen);
    const Points data{chosen.r, g, chosen.error};
    Fits fits;
    fits.algebraic = fit_shape(algebraic_shape, data, flattest, steepest, points.box);
    fits.exponential = fit_shape(exponential_shape, data, 0.0, 8.0 / chosen.r.front(), points.box);
    fit_plateau(data, fits);
    set_errors(points, chosen, fits);
    const std::size_t samples = points.without.size() < 2 ? chosen.r.size() : points.without.size();
    c.exponent = {fits.algebraic.k, fits.algebraic.error, samples};
    const double rate = fits.exponential.k;
    c.length = rate * chosen.r.back() > 1e-6
                   ? Estimate{1.0 / rate, fits.exponential.error / (rate * rate), samples}
                   : Estimate{0.0, unknown_error, samples};
    c.plateau = {fits.plateau, fits.plateau_error, samples};
    c.chi2_algebraic = fits.algebraic.chi2;
    c.chi2_exponential = fits.exponential.chi2;
    c.chi2_constant = chi2_of_shape(algebraic_shape, data, 0.0, points.box);
    double sum = 0.0;
    for (std::size_t i = 0; i < data.r.size(); ++i)
        sum += data.value[i] * data.value[i] / (data.error[i] * data.error[i]);
    decide(c, chi2_probability(sum, c.points), chosen.r.back());
    return c;
}

DecayClass classify(std::span<const double> r, std::span<const double> g_B, std::span<const double> error,
                    double from) {
    return classify(
        {{r.begin(), r.end()}, {g_B.begin(), g_B.end()}, {error.begin(), error.end()}, {}, 1.0, 0.0}, from);
}

namespace {

constexpr int scan = 48;        // values of k
constexpr int refinements = 40; // golden sections: 1e-8 of the interval, and chi2 is flat at its minimum

/// Sums over the points for the linear part.
struct LinearSums {
    double mm = 0.0, mg = 0.0, gg = 0.0;

    double chi2() const { return std::max(0.0, gg - (mm > 0.0 ? mg * mg / mm : 0.0)); }
};

LinearSums sums_of(Shape shape, const Points& points, double k, const PeriodicBox& box) {
    LinearSums sums;
    for (std::size_t i = 0; i < points.r.size(); ++i) {
        // relative to the first point: no amplitude is out of range
        const double m = shape(points.r[i], k, box) / shape(points.r[0], k, box) / points.error[i];
        const double g = points.value[i] / points.error[i];
        sums.mm += m * m;
        sums.mg += m * g;
        sums.gg += g * g;
    }
    return sums;
}

} // namespace

double algebraic_shape(double r, double eta, const PeriodicBox& box) {
    const double image = box.x > 0.0 ? M_PI * r * r / (2.0 * box.area()) : 0.0;
    return std::exp(-eta * (std::log(r) - image));
}

double exponential_shape(double r, double rate, const PeriodicBox& box) {
    if (!(box.x > 0.0))
        return std::exp(-rate * r);
    // By symmetry an eighth of the circle (of a rectangle a quarter); evenly spaced angles integrate a smooth
    // periodic function.
    constexpr int images = 2;
    const int angles = box.square() ? 4 : 8;
    const double part = box.square() ? 4.0 : 2.0;
    const auto size = [](double x, double y) { return std::sqrt(x * x + y * y); };
    double sum = 0.0;
    for (int k = 0; k < angles; ++k) {
        const double angle = (k + 0.5) * M_PI / (part * angles), x = r * std::cos(angle),
                     y = r * std::sin(angle);
        for (int m = -images; m <= images; ++m)
            for (int n = -images; n <= images; ++n)
                sum += std::exp(-rate * size(x + m * box.x, y + n * box.y));
    }
    return sum / angles;
}

double chi2_of_shape(Shape shape, const Points& points, double k, const PeriodicBox& box) {
    return sums_of(shape, points, k, box).chi2();
}

ShapeFit refine_shape(Shape shape, const Points& points, double low, double high, const PeriodicBox& box) {
    // Golden section.
    const auto chi2 = [&](double k) { return chi2_of_shape(shape, points, k, box); };
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    double a = high - golden * (high - low), b = low + golden * (high - low), fa = chi2(a), fb = chi2(b);
    for (int step = 0; step < refinements; ++step) {
        if (fa <= fb) {
            high = b;
            b = a;
            fb = fa;
            fa = chi2(a = high - golden * (high - low));
        } else {
            low = a;
            a = b;
            fa = fb;
            fb = chi2(b = low + golden * (high - low));
        }
    }
    ShapeFit fit;
    fit.k = 0.5 * (low + high);
    const LinearSums sums = sums_of(shape, points, fit.k, box);
    fit.chi2 = sums.chi2();
    fit.amplitude = (sums.mm > 0.0 ? sums.mg / sums.mm : 0.0) / shape(points.r[0], fit.k, box);
    return fit;
}

ShapeFit fit_shape(Shape shape, const Points& points, double low, double high, const PeriodicBox& box) {
    const auto chi2 = [&](double k) { return chi2_of_shape(shape, points, k, box); };
    const double step = (high - low) / scan;
    int best = 0;
    double least = chi2(low);
    for (int i = 1; i <= scan; ++i)
        if (const double c = chi2(low + i * step); c < least) {
            least = c;
            best = i;
        }
    ShapeFit fit = refine_shape(shape, points, low + std::max(0, best - 1) * step,
                                low + std::min(scan, best + 1) * step, box);

    // The error is where chi2 has grown by 1, mean of both sides; the step approaches it.
    const double lowest = chi2(fit.k);
    double error = 0.1 * step;
    for (int round = 0; round < 6; ++round) {
        const double grown = 0.5 * (chi2(fit.k - error) + chi2(fit.k + error)) - lowest;
        if (!(grown > 0.0))
            return fit;
        error *= std::min(1.0 / std::sqrt(grown), 4.0);
    }
    fit.error = error;
    return fit;
}

} // namespace rodwake::measure
