#include "oscillator_fit.hpp"

#include "blocks.hpp"

#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr std::size_t fewest_lags = 6, grid_points = 12;

/// Amplitude that fits best and the sum of squares that it leaves.
struct Projection {
    double amplitude = 0.0, squares = 0.0;
};

Projection project(std::span<const double> correlation, const std::vector<double>& shape) {
    double sf = 0.0, ss = 0.0, ff = 0.0;
    for (std::size_t i = 1; i < correlation.size(); ++i) {
        sf += shape[i] * correlation[i];
        ss += shape[i] * shape[i];
        ff += correlation[i] * correlation[i];
    }
    const double amplitude = ss > 0.0 ? sf / ss : 0.0;
    return {amplitude, ff - amplitude * sf};
}

/// Residuals against ln omega and ln gamma, with the best amplitude at each.
struct Residuals {
    using Scalar = double;
    using InputType = Eigen::VectorXd;
    using ValueType = Eigen::VectorXd;
    using JacobianType = Eigen::MatrixXd;
    static constexpr int InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic;

    std::span<const double> correlation;
    double step;

    int inputs() const { return 2; }
    int values() const { return static_cast<int>(correlation.size()) - 1; }
    int operator()(const Eigen::VectorXd& p, Eigen::VectorXd& out) const {
        const auto shape = oscillator_correlation({std::exp(p[0]), std::exp(p[1])}, step, correlation.size());
        const double amplitude = project(correlation, shape).amplitude;
        for (std::size_t i = 1; i < correlation.size(); ++i)
            out[static_cast<Eigen::Index>(i) - 1] = amplitude * shape[i] - correlation[i];
        return 0;
    }
};

} // namespace

std::vector<double> oscillator_correlation(const Oscillator& o, double step, std::size_t lags) {
    const double half = 0.5 * o.gamma, square = o.omega * o.omega - half * half;
    const double Omega = std::sqrt(std::abs(square)), x = Omega * step, damped = std::exp(-half * step);
    const double c = square > 0.0 ? std::cos(x) : std::cosh(x);
    const double s = x < 1e-8 ? step : (square > 0.0 ? std::sin(x) : std::sinh(x)) / Omega;
    std::vector<double> f(std::max<std::size_t>(lags, 2));
    f[0] = 1.0;
    f[1] = damped * (c - half * s);
    for (std::size_t i = 2; i < f.size(); ++i)
        f[i] = 2.0 * damped * c * f[i - 1] - damped * damped * f[i - 2];
    f.resize(lags);
    return f;
}

double slow_rate(const Oscillator& o) {
    const double half = 0.5 * o.gamma, square = half * half - o.omega * o.omega;
    return square > 0.0 ? o.omega * o.omega / (half + std::sqrt(square)) : half;
}

std::size_t fitted_lags(const Oscillator& o, double step, std::size_t lags) {
    const double wanted = std::ceil(3.0 / (slow_rate(o) * step)) + 1.0;
    return std::min(lags, static_cast<std::size_t>(std::clamp(wanted, 10.0, 1e9)));
}

OscillatorFit fit_oscillator(std::span<const double> correlation, double step, const Oscillator* start) {
    const OscillatorFit none{{NAN, NAN}, NAN};
    if (correlation.size() < fewest_lags)
        return none;
    Oscillator first = start ? *start : Oscillator{NAN, NAN};
    if (!start) {
        // The best of a grid from what just shows within the lags to what the steps just resolve.
        const double longest = step * static_cast<double>(correlation.size() - 1), shortest = 4.0 * step;
        double least = INFINITY;
        for (const double omega : log_range(0.5 / longest, 4.0 / shortest, grid_points))
            for (const double gamma : log_range(0.2 / longest, 4.0 / shortest, grid_points)) {
                const Projection fit =
                    project(correlation, oscillator_correlation({omega, gamma}, step, correlation.size()));
                if (fit.amplitude > 0.0 && fit.squares < least) {
                    least = fit.squares;
                    first = {omega, gamma};
                }
            }
    }
    if (!std::isfinite(first.omega))
        return none;
    Eigen::VectorXd p(2);
    p << std::log(first.omega), std::log(first.gamma);
    Eigen::NumericalDiff<Residuals, Eigen::Central> residuals(Residuals{correlation, step});
    Eigen::LevenbergMarquardt<decltype(residuals)> search(residuals);
    search.minimize(p);
    const Oscillator found{std::exp(p[0]), std::exp(p[1])};
    const double amplitude =
        project(correlation, oscillator_correlation(found, step, correlation.size())).amplitude;
    return std::isfinite(found.omega + found.gamma) && amplitude > 0.0 ? OscillatorFit{found, amplitude}
                                                                       : none;
}

} // namespace rodwake::measure
