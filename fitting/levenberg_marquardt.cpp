#include "diagnostics.hpp"
#include "search.hpp"

#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

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
    for (bool clipped = true; clipped;) {
        std::vector<Eigen::Index> movable;
        for (Eigen::Index k = 0; k < n; ++k)
            if (!held[static_cast<std::size_t>(k)])
                movable.push_back(k);
        if (movable.empty())
            break;

        // Damped least squares in these columns, by QR of the augmented system: unlike the normal equations
        // it does not square the condition number.
        Eigen::VectorXd fixed_part = step;
        fixed_part(movable).setZero();
        const auto columns = static_cast<Eigen::Index>(movable.size());
        Eigen::MatrixXd augmented = Eigen::MatrixXd::Zero(rows + columns, columns);
        augmented.topRows(rows) = a(Eigen::all, movable);
        for (Eigen::Index k = 0; k < columns; ++k)
            augmented(rows + k, k) = std::sqrt(lambda) * weights[movable[k]];
        Eigen::VectorXd right = Eigen::VectorXd::Zero(rows + columns);
        right.head(rows) = -(b + a * fixed_part);
        step = fixed_part;
        step(movable) = augmented.householderQr().solve(right);

        // Coordinates that left the box are moved to its side and held there.
        clipped = false;
        for (Eigen::Index k = 0; k < n; ++k) {
            const double to = u[k] + step[k];
            if (held[k] || (to >= space.lower[k] && to <= space.upper[k]))
                continue;
            step[k] = (to < space.lower[k] ? space.lower[k] : space.upper[k]) - u[k];
            held[k] = clipped = true;
        }
    }
    return {step, -(2.0 * gradient.dot(step) + (a * step).squaredNorm())};
}

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr long patience = 20;
constexpr double tight = 1e-6; // standard errors, far below anything that matters

struct LevenbergMarquardt {
    Evaluator& evaluator;
    SearchPoint here;
    Weighted model{};
    Eigen::VectorXd weights{};          ///< lengths of the columns, by which steps are measured
    double lambda = 1e-3, growth = 2.0; ///< of the damping, by Nielsen's rule
    long iterations = 0;
};

bool inside(const SearchSpace& space, const Eigen::VectorXd& u) {
    return (u.array() > space.lower.array()).all() && (u.array() < space.upper.array()).all();
}

/// Geodesic acceleration (Transtrum and Sethna, arXiv:1201.5885): half the second-order correction of the
/// step, from the residuals' second derivative along it. In long curved valleys it is worth its evaluation
/// many times over, so it is tried once the search has proved to be long. Zero if it cannot be trusted.
Eigen::VectorXd acceleration(LevenbergMarquardt& run, const Eigen::VectorXd& step) {
    constexpr double h = 0.1;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(step.size()), &u = run.here.u;
    const SearchSpace& space = run.evaluator.space();
    if (run.iterations <= patience || !inside(space, u) || !inside(space, u + step))
        return none;
    const SearchPoint ahead = run.evaluator(u + h * step, false);
    if (!ahead.finite())
        return none;
    const Eigen::VectorXd bend = 2.0 / h * ((ahead.r - run.here.r) / h - run.here.jacobian * step);
    const Eigen::VectorXd half =
        0.5 * damped_step({run.model.a, bend.cwiseProduct(run.model.roots), run.model.roots}, space, u,
                          run.weights, run.lambda)
                  .step;
    return half.cwiseProduct(run.weights).norm() <= 0.375 * step.cwiseProduct(run.weights).norm() ? half
                                                                                                  : none;
}

/// Tries steps from `here`, ever shorter, until one is better. Returns false if there is none.
bool advance(LevenbergMarquardt& run, long max_iterations) {
    while (run.iterations < max_iterations) {
        ++run.iterations;
        const DampedStep step =
            damped_step(run.model, run.evaluator.space(), run.here.u, run.weights, run.lambda);
        const Eigen::VectorXd to =
            run.evaluator.space().clamp(run.here.u + step.step + acceleration(run, step.step));
        const bool tiny = ((to - run.here.u).array().abs() <= eps * run.here.u.array().abs()).all();
        if (!(step.predicted > 0.0) || tiny)
            return false;
        const bool measurable = step.predicted > 4.0 * eps * run.here.objective;
        SearchPoint there = run.evaluator(to, true);
        if (run.evaluator.stopped())
            return false;
        if (there.objective < run.here.objective) {
            const double root = 2.0 * (run.here.objective - there.objective) / step.predicted - 1.0;
            run.lambda = std::max(1e-20, run.lambda * std::clamp(1.0 - root * root * root, 1.0 / 10.0, 2.0));
            run.growth = 2.0;
            run.here = std::move(there);
            return true;
        }
        if (!measurable)
            return false;
        run.lambda *= run.growth;
        run.growth *= 2.0;
    }
    return false;
}

/// Takes last steps whose objectives differ by rounding only, hardly damped, as long as each leaves less than
/// 0.8 of the improvement that the linear model still promises.
void refine(LevenbergMarquardt& run) {
    const double worst = run.here.objective * (1.0 + 4.0 * eps);
    const SearchSpace& space = run.evaluator.space();
    const auto next = [&](const LevenbergMarquardt& at) {
        return damped_step(at.model, space, at.here.u, run.weights, 1e-15);
    };
    DampedStep step = next(run);
    for (int i = 0; i < 50 && step.predicted > 0.0; ++i) {
        LevenbergMarquardt there{run.evaluator, run.evaluator(space.clamp(run.here.u + step.step), true)};
        if (!(there.here.objective <= worst))
            return;
        there.model = run.evaluator.weighted(there.here);
        const DampedStep after = next(there);
        if (!(after.predicted < 0.8 * step.predicted))
            return;
        run.here = std::move(there.here);
        run.model = std::move(there.model);
        step = after;
    }
}

} // namespace

SearchResult levenberg_marquardt(Evaluator& evaluator, const Eigen::VectorXd& start, long max_iterations) {
    LevenbergMarquardt run{evaluator, evaluator(start, true)};
    if (!run.here.finite())
        return {start, run.here.objective,
                evaluator.stopped() ? Termination::interrupted : Termination::failed,
                "polish: " + (evaluator.stopped() ? std::string("interrupted") : evaluator.trouble())};
    do {
        run.model = evaluator.weighted(run.here);
        run.weights = run.model.a.colwise().stableNorm().transpose();
        for (double& weight : run.weights)
            weight = weight > 0.0 ? weight : 1.0;
    } while (start.size() > 0 && run.here.objective > 0.0 && advance(run, max_iterations));
    if (start.size() > 0 && run.here.objective > 0.0 && !evaluator.stopped())
        refine(run);

    SearchResult end{run.here.u, run.here.objective, Termination::roundoff, {}};
    const Stationarity s = stationarity(run.evaluator, run.here);
    if (run.evaluator.best() < run.here.objective * (1.0 - 8.0 * eps)) { // a probe, just before a stop
        end.u = run.evaluator.best_u();
        end.objective = run.evaluator.best();
    }
    const char* words = "no smaller value to be found in double precision";
    if (run.iterations >= max_iterations) {
        end.termination = Termination::budget;
        words = "out of iterations";
    } else if (run.evaluator.stopped()) {
        end.termination = Termination::interrupted;
        words = "interrupted";
    } else if (s.distance <= tight || s.newton <= tiny_change) {
        end.termination = Termination::converged;
        words = "stationary";
    }
    end.reason = fmt::format("polish: {} after {} steps", words, run.iterations);
    return end;
}

} // namespace rodwake::fitting
