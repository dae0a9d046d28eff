#include "decay_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr int scan = 48;        // values of k
constexpr int refinements = 40; // golden sections: 1e-8 of the interval, and chi2 is flat at its minimum

/// Sums over the points for the linear part.
struct Sums {
    double mm = 0.0, mg = 0.0, gg = 0.0;

    double amplitude() const { return mm > 0.0 ? mg / mm : 0.0; }
    double chi2() const { return std::max(0.0, gg - (mm > 0.0 ? mg * mg / mm : 0.0)); }
};

Sums sums_of(Shape shape, const Points& points, double k, const PeriodicBox& box) {
    Sums sums;
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

/// Golden section on [low, high], which holds one minimum.
template<class F>
double smallest(F f, double low, double high) {
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    double a = high - golden * (high - low), b = low + golden * (high - low), fa = f(a), fb = f(b);
    for (int step = 0; step < refinements; ++step) {
        if (fa <= fb) {
            high = b;
            b = a;
            fb = fa;
            fa = f(a = high - golden * (high - low));
        } else {
            low = a;
            a = b;
            fa = fb;
            fb = f(b = low + golden * (high - low));
        }
    }
    return 0.5 * (low + high);
}

/// Where chi2 has grown by 1, mean of both sides; the step approaches it.
template<class F>
double curvature_error(F chi2, double k, double step) {
    const double least = chi2(k);
    for (int round = 0; round < 6; ++round) {
        const double grown = 0.5 * (chi2(k - step) + chi2(k + step)) - least;
        if (!(grown > 0.0))
            return unknown_error;
        step *= std::min(1.0 / std::sqrt(grown), 4.0);
    }
    return step;
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
    const auto chi2 = [&](double k) { return chi2_of_shape(shape, points, k, box); };
    ShapeFit fit;
    fit.k = smallest(chi2, low, high);
    const Sums sums = sums_of(shape, points, fit.k, box);
    fit.chi2 = sums.chi2();
    fit.amplitude = sums.amplitude() / shape(points.r[0], fit.k, box);
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
    fit.error = curvature_error(chi2, fit.k, 0.1 * step);
    return fit;
}

} // namespace rodwake::measure
