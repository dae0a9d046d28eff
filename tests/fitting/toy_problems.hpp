#pragma once
// Small least-squares problems with known answers.

#include "rodwake/core/rng.hpp"
#include "rodwake/fitting/report.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace toy {

using rodwake::fitting::Method;
using rodwake::fitting::Parameter;
using rodwake::fitting::Problem;
using rodwake::fitting::Report;
using rodwake::fitting::Transform;

inline Parameter parameter(const std::string& name, double start) {
    Parameter p;
    p.name = name;
    p.start = start;
    return p;
}

inline Parameter positive(const std::string& name, double start) {
    Parameter p = parameter(name, start);
    p.transform = Transform::log;
    return p;
}

inline Parameter bounded(const std::string& name, double start, double lower, double upper) {
    Parameter p = parameter(name, start);
    p.lower = lower;
    p.upper = upper;
    return p;
}

/// Standard normal deviate (Box and Muller).
inline double normal(rodwake::RandomStream& random) {
    const double radius = std::sqrt(-2.0 * std::log(random.uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * random.uniform());
}

/// Rosenbrock's valley: 10 (y - x^2), 1 - x; minimum 0 at (1, 1).
inline Problem rosenbrock(double x, double y) {
    Problem problem;
    problem.parameters = {parameter("x", x), parameter("y", y)};
    problem.residuals = 2;
    problem.evaluate = [](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                          Eigen::MatrixXd* jacobian) {
        r << 10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0];
        if (jacobian)
            *jacobian << -20.0 * p[0], 10.0, -1.0, 0.0;
    };
    return problem;
}

/// a exp(-x/b) + c at `points` places x in [0, 5], true values 2, 1.5, 0.5, sigma 0.1, noise of `seed` (0:
/// none).
inline Problem decay(std::size_t points = 40, std::uint64_t seed = 0) {
    Problem problem;
    problem.parameters = {parameter("a", 1.0), positive("b", 1.0), parameter("c", 0.1)};
    problem.residuals = points;
    std::vector<double> x, y;
    rodwake::RandomStream random(seed);
    for (std::size_t i = 0; i < points; ++i) {
        x.push_back(5.0 * static_cast<double>(i) / static_cast<double>(points - 1));
        y.push_back(2.0 * std::exp(-x[i] / 1.5) + 0.5 + (seed == 0 ? 0.0 : 0.1 * normal(random)));
    }
    problem.evaluate = [x, y](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                              Eigen::MatrixXd* jacobian) {
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double e = std::exp(-x[i] / p[1]);
            r[static_cast<Eigen::Index>(i)] = (p[0] * e + p[2] - y[i]) / 0.1;
            if (jacobian)
                jacobian->row(static_cast<Eigen::Index>(i)) << e / 0.1, p[0] * e * x[i] / (p[1] * p[1]) / 0.1,
                    1.0 / 0.1;
        }
    };
    return problem;
}

/// Straight line a + b x through y at x = 0, 1, 2, ... with sigma 1: everything is known in closed form.
inline Problem line(const std::vector<double>& y) {
    Problem problem;
    problem.parameters = {parameter("a", 0.0), parameter("b", 0.0)};
    problem.residuals = y.size();
    problem.evaluate = [y](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                           Eigen::MatrixXd* jacobian) {
        for (std::size_t i = 0; i < y.size(); ++i) {
            const double x = static_cast<double>(i);
            r[static_cast<Eigen::Index>(i)] = p[0] + p[1] * x - y[i];
            if (jacobian)
                jacobian->row(static_cast<Eigen::Index>(i)) << 1.0, x;
        }
    };
    return problem;
}

/// One parameter in [-10, 10], three minima of which that at x = 2 is the deepest: (x - 2)/4 and 1 - cos(3 (x
/// - 2)).
inline Problem waves(double start) {
    Problem problem;
    problem.parameters = {bounded("x", start, -10.0, 10.0), bounded("y", 0.5, -1.0, 1.0)};
    problem.residuals = 3;
    problem.evaluate = [](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                          Eigen::MatrixXd* jacobian) {
        const double d = p[0] - 2.0;
        r << 0.25 * d, 1.0 - std::cos(3.0 * d), p[1] - 0.25;
        if (jacobian)
            *jacobian << 0.25, 0.0, 3.0 * std::sin(3.0 * d), 0.0, 0.0, 1.0;
    };
    return problem;
}

/// Points of a line with scatter, at x = 0, 1, ...
inline const std::vector<double> ys{1.2, 2.9, 5.1, 6.8, 9.3, 10.7};

/// Residuals of the problem times a factor, as if sigma were smaller by it.
inline Problem times(Problem problem, double factor) {
    problem.evaluate = [factor, inner = problem.evaluate](std::span<const double> p,
                                                          Eigen::Ref<Eigen::VectorXd> r,
                                                          Eigen::MatrixXd* jacobian) {
        inner(p, r, jacobian);
        r *= factor;
        if (jacobian)
            *jacobian *= factor;
    };
    return problem;
}

inline bool says(const Report& report, const std::string& words) {
    return std::ranges::any_of(report.diagnostics,
                               [&](const std::string& r) { return r.find(words) != std::string::npos; });
}

inline Report reported(const Problem& problem, const Method& method = {}) {
    return report(problem, fit(problem, method));
}

} // namespace toy
