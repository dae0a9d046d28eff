#include "stationarity.hpp"

#include <Eigen/SVD>

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

} // namespace rodwake::fitting
