#include "smoothing_spline.hpp"

#include "rodwake/core/error.hpp"

#include <boost/math/tools/minima.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::elastic {

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

Matrix sparse(std::size_t rows, std::size_t columns, const Triplets& entries) {
    Matrix matrix(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

} // namespace

SmoothingSpline::SmoothingSpline(const QuinticKnots& knots, const SplinePoints& points)
    : root_weights_(static_cast<Eigen::Index>(points.x.size())),
      factor_(std::make_unique<Eigen::SimplicialLLT<Matrix>>()) {
    for (Eigen::Index i = 0; i < root_weights_.size(); ++i)
        root_weights_[i] = 1.0 / points.sigma[static_cast<std::size_t>(i)];
    mean_weight_ = root_weights_.squaredNorm() / static_cast<double>(points.x.size());
    root_weights_ /= std::sqrt(mean_weight_);
    const std::size_t side = knots.functions();
    Triplets entries;
    for (std::size_t row = 0; row < points.x.size(); ++row) {
        const QuinticValues along = values_at(knots, points.x[row]), across = values_at(knots, points.y[row]);
        for (std::size_t j = 0; j < across.by[0].size(); ++j)
            for (std::size_t i = 0; i < along.by[0].size(); ++i)
                entries.emplace_back(
                    static_cast<int>(row), static_cast<int>((across.first + j) * side + along.first + i),
                    root_weights_[static_cast<Eigen::Index>(row)] * along.by[0][i] * across.by[0][j]);
    }
    design_ = sparse(points.x.size(), side * side, entries);
    normal_ = design_.transpose() * design_;

    // The penalty is D^T D, D the third differences along both axes.
    constexpr std::array stencil = {-1.0, 3.0, -3.0, 1.0};
    Triplets differences;
    std::size_t row = 0;
    const auto add = [&](std::size_t first, std::size_t step) {
        for (std::size_t k = 0; k < stencil.size(); ++k)
            differences.emplace_back(static_cast<int>(row), static_cast<int>(first + k * step), stencil[k]);
        ++row;
    };
    for (std::size_t line = 0; line < side; ++line)
        for (std::size_t k = 0; k + stencil.size() <= side; ++k) {
            add(line * side + k, 1);
            add(k * side + line, side);
        }
    const Matrix third = sparse(row, side * side, differences);
    penalty_ = third.transpose() * third;
    factor_->analyzePattern(Matrix(normal_ + penalty_));
}

void SmoothingSpline::set_lambda(double lambda) {
    factor_->factorize(Matrix(normal_ + lambda * penalty_));
    if (factor_->info() != Eigen::Success)
        throw InputError("smoothing spline: too few points where it has to be known");
}

Eigen::VectorXd SmoothingSpline::scaled(std::span<const double> values) const {
    return root_weights_.cwiseProduct(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

std::vector<double> SmoothingSpline::fit(std::span<const double> values) const {
    const Eigen::VectorXd c = factor_->solve(design_.transpose() * scaled(values));
    return {c.begin(), c.end()};
}

double SmoothingSpline::chi2(std::span<const double> values, std::span<const double> coefficients) const {
    const Eigen::Map<const Eigen::VectorXd> c(coefficients.data(),
                                              static_cast<Eigen::Index>(coefficients.size()));
    return mean_weight_ * (design_ * c - scaled(values)).squaredNorm();
}

double SmoothingSpline::trace(const Eigen::MatrixXd& probes) const {
    const Eigen::MatrixXd images = design_.transpose() * probes;
    const double points = static_cast<double>(probes.rows());
    // over z.z instead of its expectation: what is common to both scatters less
    return points * images.cwiseProduct(factor_->solve(images)).sum() / probes.squaredNorm();
}

/// Decades first, then between the neighbours of the best, roughly: the score is flat at its least.
double SmoothingSpline::choose(std::span<const double> values, const Eigen::MatrixXd& probes) {
    const auto score_at = [&](double decade) {
        set_lambda(std::pow(10.0, decade));
        const double points = static_cast<double>(values.size()), left = 1.0 - trace(probes) / points;
        return chi2(values, fit(values)) / (left * left);
    };
    constexpr double lowest = -8.0, highest = 8.0;
    double best = lowest, least = score_at(lowest);
    for (double decade = lowest + 1.0; decade <= highest; decade += 1.0)
        if (const double s = score_at(decade); s < least) {
            best = decade;
            least = s;
        }
    constexpr int bits = 5; // of the decade's number
    const auto found = boost::math::tools::brent_find_minima(score_at, best - 1.0, best + 1.0, bits);
    const double lambda = std::pow(10.0, found.first);
    set_lambda(lambda);
    return lambda;
}

namespace {

constexpr std::size_t degree = QuinticKnots::degree, pieces = degree + 1;
using Weights = std::array<double, pieces>;

} // namespace

QuinticValues values_at(const QuinticKnots& knots, double x) {
    const double s = (x - knots.first) / knots.width;
    const double interval = std::clamp(std::floor(s), 0.0, static_cast<double>(knots.intervals - 1));

    // b[p][j] is B_p(u + j) for j = 0 ... p, where B_p is the B-spline of degree p with knots 0, 1, ..., p +
    // 1: p B_p(t) = t B_{p-1}(t) + (p + 1 - t) B_{p-1}(t - 1) (de Boor, A Practical Guide to Splines, ch.
    // IX).
    const double u = s - interval;
    std::array<Weights, pieces> b{};
    b[0][0] = 1.0;
    for (std::size_t p = 1; p <= degree; ++p)
        for (std::size_t j = 0; j <= p; ++j) {
            const double t = u + static_cast<double>(j), top = static_cast<double>(p) + 1.0;
            const double here = j < p ? t * b[p - 1][j] : 0.0;
            const double before = j > 0 ? (top - t) * b[p - 1][j - 1] : 0.0;
            b[p][j] = (here + before) / static_cast<double>(p);
        }

    // Derivatives by B_p'(t) = B_{p-1}(t) - B_{p-1}(t - 1).
    QuinticValues values;
    values.first = static_cast<std::size_t>(interval);
    double scale = 1.0;
    for (std::size_t k = 0; k < values.by.size(); ++k, scale /= knots.width) {
        Weights d = b[degree - k];
        for (std::size_t times = 0; times < k; ++times)
            for (std::size_t j = pieces; --j > 0;)
                d[j] -= d[j - 1];
        for (std::size_t i = 0; i < pieces; ++i) // function first + i began degree - i intervals before
            values.by[k][i] = scale * d[degree - i];
    }
    return values;
}

Jet spline_at(const QuinticKnots& knots, std::span<const double> coefficients, double x, double y) {
    const QuinticValues along = values_at(knots, x), across = values_at(knots, y);
    std::array<std::array<double, 4>, 4> d{}; // [by x][by y]
    for (std::size_t j = 0; j < pieces; ++j) {
        const double* row = coefficients.data() + (across.first + j) * knots.functions() + along.first;
        for (std::size_t k = 0; k < 4; ++k) {
            double sum = 0.0;
            for (std::size_t i = 0; i < pieces; ++i)
                sum += along.by[k][i] * row[i];
            for (std::size_t l = 0; k + l < 4; ++l)
                d[k][l] += across.by[l][j] * sum;
        }
    }
    return {d[0][0], d[1][0], d[0][1], d[2][0], d[1][1], d[0][2], d[3][0], d[2][1], d[1][2], d[0][3]};
}

} // namespace rodwake::elastic
