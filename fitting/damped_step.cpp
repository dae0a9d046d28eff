#include "damped_step.hpp"

#include "stationarity.hpp"

#include <Eigen/QR>

#include <cmath>

namespace rodwake::fitting {

namespace {

/// Of the columns in `movable`: QR of the augmented system, which unlike the normal equations does not square
/// the condition number.
Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                      const std::vector<Eigen::Index>& movable, const Eigen::VectorXd& weights,
                      double lambda) {
    const Eigen::Index m = a.rows(), n = static_cast<Eigen::Index>(movable.size());
    Eigen::MatrixXd augmented = Eigen::MatrixXd::Zero(m + n, n);
    augmented.topRows(m) = a(Eigen::all, movable);
    for (Eigen::Index k = 0; k < n; ++k)
        augmented(m + k, k) = std::sqrt(lambda) * weights[movable[k]];
    Eigen::VectorXd right = Eigen::VectorXd::Zero(m + n);
    right.head(m) = -b;
    return augmented.householderQr().solve(right);
}

std::vector<Eigen::Index> not_held(const std::vector<bool>& held) {
    std::vector<Eigen::Index> movable;
    for (std::size_t k = 0; k < held.size(); ++k)
        if (!held[k])
            movable.push_back(static_cast<Eigen::Index>(k));
    return movable;
}

/// Puts coordinates that left the box on its side and holds them there; true if there were any.
bool clip(const SearchSpace& space, const Eigen::VectorXd& u, Eigen::VectorXd& step,
          std::vector<bool>& held) {
    bool any = false;
    for (Eigen::Index k = 0; k < u.size(); ++k) {
        const double to = u[k] + step[k];
        if (held[k] || (to >= space.lower()[k] && to <= space.upper()[k]))
            continue;
        step[k] = (to < space.lower()[k] ? space.lower()[k] : space.upper()[k]) - u[k];
        held[k] = any = true;
    }
    return any;
}

} // namespace

DampedStep damped_step(const Weighted& model, const SearchSpace& space, const Eigen::VectorXd& u,
                       const Eigen::VectorXd& weights, double lambda) {
    // Only the n x n triangle is needed from here on.
    const Eigen::Index n = u.size(), rows = std::min(n, model.a.rows());
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(model.a);
    const Eigen::MatrixXd a = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
    const Eigen::VectorXd b = Eigen::VectorXd(qr.householderQ().transpose() * model.b).head(rows);
    const Eigen::VectorXd gradient = a.transpose() * b;
    std::vector<bool> held = held_by_bounds(space, u, gradient);
    Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
    do {
        const auto movable = not_held(held);
        if (movable.empty())
            break;
        Eigen::VectorXd fixed_part = step;
        fixed_part(movable).setZero();
        step = fixed_part;
        step(movable) = solve(a, b + a * fixed_part, movable, weights, lambda);
    } while (clip(space, u, step, held));
    return {step, -(2.0 * gradient.dot(step) + (a * step).squaredNorm())};
}

} // namespace rodwake::fitting
