#include "curvature.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

std::vector<bool> held_by_bounds(const SearchSpace& space, const Eigen::VectorXd& u,
                                 const Eigen::VectorXd& gradient) {
    std::vector<bool> held(static_cast<std::size_t>(u.size()));
    for (Eigen::Index k = 0; k < u.size(); ++k)
        held[k] = (u[k] <= space.lower()[k] && gradient[k] >= 0.0) ||
                  (u[k] >= space.upper()[k] && gradient[k] <= 0.0);
    return held;
}

Stationarity stationarity(const Evaluator& evaluator, const Point& point) {
    Weighted w = evaluator.weighted(point);
    const Eigen::VectorXd g = w.a.transpose() * w.b;
    const std::vector<bool> held = held_by_bounds(evaluator.space(), point.u, g);
    Eigen::VectorXd norms = w.a.colwise().norm().transpose();
    for (Eigen::Index k = 0; k < g.size(); ++k) {
        norms[k] = held[k] || norms[k] == 0.0 ? 0.0 : 1.0 / norms[k];
        w.a.col(k) *= norms[k];
    }
    if (norms.size() == 0 || norms.maxCoeff() == 0.0)
        return {};
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Eigen::MatrixXd(w.a),
                                                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd s = svd.singularValues();
    Eigen::VectorXd variance = Eigen::VectorXd::Zero(g.size()), step = variance;
    for (Eigen::Index i = 0; i < s.size() && s[i] > 1e-10 * s[0]; ++i) {
        variance += (svd.matrixV().col(i) / s[i]).cwiseAbs2();
        step += svd.matrixV().col(i) * (svd.matrixU().col(i).dot(w.b) / s[i]);
    }
    step.array() *= norms.array() / point.u.array().abs().max(1e-300);
    return {(g.array() * norms.array() * variance.array().sqrt()).matrix().norm(),
            step.cwiseAbs().maxCoeff()};
}

namespace {

constexpr double takes_part = 1e-6; // component of a unit vector; far above the rounding errors of the SVD

std::vector<bool> at_bounds(const SearchSpace& space, const Point& point, const Eigen::VectorXd& gradient) {
    std::vector<bool> held(static_cast<std::size_t>(point.u.size()));
    for (Eigen::Index k = 0; k < point.u.size(); ++k) {
        const double near = 1e-9 * std::max(1.0, std::abs(point.u[k]));
        const double above = point.u[k] - space.lower()[k], below = space.upper()[k] - point.u[k];
        held[k] = above <= 0.0 || below <= 0.0 || (above <= near && gradient[k] > 0.0) ||
                  (below <= near && gradient[k] < 0.0);
    }
    return held;
}

void add_errors(Curvature& c, const Eigen::VectorXd& per_length, double largest) {
    const Eigen::Index n = per_length.size();
    c.root = Eigen::MatrixXd::Zero(n, c.rank);
    for (Eigen::Index i = 0; i < c.rank; ++i)
        c.root.col(i) = c.directions.col(i) / (c.singular_values[i] * largest);
    c.standard_error = c.root.rowwise().stableNorm();
    for (Eigen::Index i = c.rank; i < c.scaled.cols(); ++i)
        for (Eigen::Index k = 0; k < n; ++k)
            if (std::abs(c.scaled(k, i)) > takes_part)
                c.standard_error[k] = infinite;
}

} // namespace

Curvature curvature(const SearchSpace& space, const Point& point, const Eigen::VectorXd& gradient,
                    double rank_tolerance) {
    Curvature c;
    c.held = at_bounds(space, point, gradient);
    const Eigen::VectorXd norms = point.jacobian.colwise().stableNorm().transpose();
    std::vector<Eigen::Index> used;
    for (Eigen::Index k = 0; k < norms.size(); ++k)
        if (!c.held[k])
            used.push_back(k);
    const auto n = static_cast<Eigen::Index>(used.size());
    c.scaled = c.directions = Eigen::MatrixXd::Zero(norms.size(), n);
    c.singular_values = Eigen::VectorXd::Zero(n);
    Eigen::VectorXd per_length = norms.unaryExpr([](double l) { return l > 0.0 ? 1.0 / l : 1.0; });
    double largest = 0.0;
    if (n > 0) {
        const Eigen::MatrixXd j = (point.jacobian * per_length.asDiagonal())(Eigen::all, used);
        const Eigen::MatrixXd r = j.householderQr().matrixQR().topRows(n).triangularView<Eigen::Upper>();
        const Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeFullV);
        c.scaled(used, Eigen::all) = svd.matrixV();
        c.directions = per_length.asDiagonal() * c.scaled;
        largest = svd.singularValues()[0];
        if (largest > 0.0)
            c.singular_values = svd.singularValues() / largest;
        c.rank = (c.singular_values.array() > rank_tolerance).count();
    }
    add_errors(c, per_length, largest);
    return c;
}

// Huber, Robust Statistics, section 7.6: C (n/(n - p)) mean(psi^2)/mean(psi')^2, psi = rho' r.
ErrorScale error_scale(const Problem& problem, const LossShape& loss, const Point& point, long dof) {
    const bool robust = loss.loss != Loss::squares;
    if (problem.sigma_known && !robust)
        return {};
    if (dof <= 0)
        return {infinite, infinite};
    double psi2 = 0.0, curvature = 0.0;
    for (const double r : point.r) {
        const LossValue value = loss_of(loss, r * r);
        psi2 += value.first * value.first * r * r;
        curvature += value.curvature(r * r);
    }
    const double bend = std::max(curvature / static_cast<double>(point.r.size()), 1e-3);
    const double variance = psi2 / static_cast<double>(dof) / (bend * bend);
    return {std::sqrt(variance), variance * bend};
}

} // namespace rodwake::fitting
