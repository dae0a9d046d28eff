#pragma once
// Small least-squares problems with known answers.

#include "support/normal.hpp"

#include "rodwake/fitting/report.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace toy {

using rodwake::fitting::Method;
using rodwake::fitting::Parameter;
using rodwake::fitting::Problem;
using rodwake::fitting::Report;
using rodwake::fitting::Transform;

using rodwake::normal;

inline Parameter parameter(const std::string& name, double start) { return {.name = name, .start = start}; }

inline Parameter positive(const std::string& name, double start) {
    return {.name = name, .start = start, .transform = Transform::log};
}

inline Parameter bounded(const std::string& name, double start, double lower, double upper) {
    return {.name = name, .start = start, .lower = lower, .upper = upper};
}

/// Parameters that start at these values; those that are not named are fixed.
inline std::vector<Parameter> parameters(const std::map<std::string, double>& values,
                                         const std::vector<std::string>& free = {}) {
    std::vector<Parameter> all;
    for (const auto& [name, value] : values)
        all.push_back({.name = name, .start = value, .fixed = std::ranges::find(free, name) == free.end()});
    return all;
}

inline std::vector<double> starts(const std::vector<Parameter>& parameters) {
    std::vector<double> values;
    for (const Parameter& p : parameters)
        values.push_back(p.start);
    return values;
}

/// Residuals of the problem at p and, if asked for, their derivatives.
inline Eigen::VectorXd residuals(const Problem& problem, const std::vector<double>& p,
                                 Eigen::MatrixXd* jacobian = nullptr) {
    Eigen::VectorXd r(static_cast<Eigen::Index>(problem.residuals));
    if (jacobian)
        jacobian->setZero(r.size(), static_cast<Eigen::Index>(p.size()));
    problem.evaluate(p, r, jacobian);
    return r;
}

/// Worst error of a column of the Jacobian of a free parameter against differences of order 8, over the
/// column's largest entry.
inline double jacobian_error(const Problem& problem, const std::vector<double>& p) {
    Eigen::MatrixXd jacobian;
    residuals(problem, p, &jacobian);
    double worst = 0.0;
    for (std::size_t j = 0; j < p.size(); ++j) {
        if (problem.parameters[j].fixed)
            continue;
        Eigen::VectorXd slope = Eigen::VectorXd::Zero(jacobian.rows());
        const double h = 1e-3 * std::max(0.3, std::abs(p[j]));
        constexpr double weights[] = {0.8, -0.2, 4.0 / 105.0, -1.0 / 280.0};
        for (int k = 1; k <= 4; ++k)
            for (const int sign : {1, -1}) {
                std::vector<double> moved = p;
                moved[j] += sign * k * h;
                slope += sign * weights[k - 1] / h * residuals(problem, moved);
            }
        const auto column = jacobian.col(static_cast<Eigen::Index>(j));
        worst = std::max(worst, (column - slope).cwiseAbs().maxCoeff() / slope.cwiseAbs().maxCoeff());
    }
    return worst;
}

/// Rosenbrock's valley: 10 (y - x^2), 1 - x; minimum 0 at (1, 1).
inline Problem rosenbrock(double x, double y) {
    Problem problem;
    problem.parameters = {parameter("x", x), parameter("y", y)};
    problem.residuals = 2;
    problem.evaluate = [](auto p, auto r, Eigen::MatrixXd* jacobian) {
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
    problem.evaluate = [x, y](auto p, auto r, Eigen::MatrixXd* jacobian) {
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
    problem.evaluate = [y](auto p, auto r, Eigen::MatrixXd* jacobian) {
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
    problem.evaluate = [](auto p, auto r, Eigen::MatrixXd* jacobian) {
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
    problem.evaluate = [factor, inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        inner(p, r, jacobian);
        r *= factor;
        if (jacobian)
            *jacobian *= factor;
    };
    return problem;
}

/// The problem with one more parameter, on which the residuals do not depend.
inline Problem with_idle(Problem problem, const Parameter& idle) {
    problem.parameters.push_back(idle);
    problem.evaluate = [inner = problem.evaluate](auto p, auto r, Eigen::MatrixXd* jacobian) {
        Eigen::MatrixXd others = Eigen::MatrixXd::Zero(r.size(), static_cast<Eigen::Index>(p.size() - 1));
        inner(p.first(p.size() - 1), r, jacobian ? &others : nullptr);
        if (jacobian)
            jacobian->leftCols(others.cols()) = others;
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
