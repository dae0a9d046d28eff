#include "evaluator.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::fitting {

LossValue loss_of(const LossShape& shape, double s) {
    const double w2 = shape.width * shape.width;
    if (shape.loss == Loss::squares || (shape.loss == Loss::huber && s <= w2))
        return {s, 1.0, 0.0};
    if (shape.loss == Loss::huber) {
        const double root = std::sqrt(s);
        return {2.0 * shape.width * root - w2, shape.width / root, -0.5 * shape.width / (root * s)};
    }
    const double first = 1.0 / (1.0 + s / w2);
    return {w2 * std::log1p(s / w2), first, -first * first / w2};
}

Evaluator::Evaluator(const Problem& problem, const SearchSpace& space, LossShape loss,
                     std::function<bool()> stop)
    : problem_(problem), space_(space), loss_(loss), stop_(std::move(stop)) {}

bool Evaluator::guarded(std::span<const double> values, SearchPoint& point, Eigen::MatrixXd* in_values) {
    try {
        problem_.evaluate(values, point.r, in_values);
    } catch (const std::bad_alloc&) {
        stopped_ = out_of_memory_ = true;
        return false;
    } catch (const std::exception& error) {
        trouble_ = error.what();
        return false;
    } catch (...) {
        trouble_ = "an exception of unknown type";
        return false;
    }
    for (Eigen::Index i = 0; i < point.r.size(); ++i) {
        const bool fine = std::isfinite(point.r[i]);
        if (fine && (!in_values || in_values->row(i).allFinite()))
            continue;
        const auto index = static_cast<std::size_t>(i);
        const std::string name =
            problem_.residual_name ? problem_.residual_name(index) : fmt::format("{}", index);
        trouble_ = fmt::format("{}residual {} is not a finite number", fine ? "a derivative of " : "", name);
        return false;
    }
    return true;
}

SearchPoint Evaluator::operator()(const Eigen::VectorXd& u, bool with_jacobian) {
    SearchPoint point;
    point.u = u;
    stopped_ = stopped_ || (stop_ && stop_());
    if (stopped_)
        return point;
    ++evaluations_;
    const std::vector<double> values = space_.values(u);
    const auto rows = static_cast<Eigen::Index>(problem_.residuals);
    point.r = Eigen::VectorXd::Zero(rows);
    if (with_jacobian)
        in_values_ = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(values.size()));
    if (!guarded(values, point, with_jacobian ? &in_values_ : nullptr))
        return point;
    if (with_jacobian)
        point.jacobian = space_.chain(in_values_, values);

    // In extended precision: the last steps of Levenberg-Marquardt are judged by the last digits of the sum.
    long double exact = 0.0L;
    for (const double r : point.r)
        exact += loss_of(loss_, r * r).rho;
    const auto sum = static_cast<double>(exact);
    if (!std::isfinite(sum) || !point.jacobian.allFinite()) {
        trouble_ = "the sum of squares is beyond the range of doubles";
        return point;
    }
    point.objective = sum;
    if (sum < best_) {
        best_ = sum;
        best_u_ = u;
    }
    return point;
}

// Outliers of a robust loss bend the objective less than its slope says, or the other way; a tenth of the
// usual reweighting is kept so that the curvature stays positive.
Weighted Evaluator::weighted(const SearchPoint& point) const {
    Weighted w{point.jacobian, point.r, Eigen::VectorXd::Ones(point.r.size())};
    if (loss_.loss == Loss::squares)
        return w;
    for (Eigen::Index i = 0; i < point.r.size(); ++i) {
        const double s = point.r[i] * point.r[i];
        const LossValue value = loss_of(loss_, s);
        const double root = std::sqrt(std::max(value.curvature(s), 0.1 * value.first));
        w.roots[i] = root;
        w.a.row(i) *= root;
        w.b[i] *= value.first / root;
    }
    return w;
}

Eigen::VectorXd Evaluator::gradient(const SearchPoint& point) const {
    Eigen::VectorXd slope = point.r;
    for (double& r : slope)
        r *= 2.0 * loss_of(loss_, r * r).first;
    return point.jacobian.transpose() * slope;
}

} // namespace rodwake::fitting
