#include "local_fit.hpp"

#include <Eigen/Cholesky>

#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double width = 0.8; // of the Gaussian, in spacings
constexpr double ridge_slope = 1e-6,
                 ridge_curvature = 1e-3; // of the weights' sum: rows in a line fix no slope

using Basis = Eigen::Matrix<double, 6, 1>;

Basis basis(double x, double y) { return {1.0, x, y, x * x, x * y, y * y}; }

} // namespace

Scattered::Scattered(const BinSamples& samples, const std::vector<Vector2>& places, const RodGrid& grid)
    : samples_(samples), places_(places), grid_(grid), in_cell_(grid.bins()) {
    for (std::size_t j = 0; j < places.size(); ++j)
        if (samples.count[j] > 0.0)
            in_cell_[cell(column(places[j].x), row(places[j].y))].push_back(j);
}

long Scattered::column(double x) const {
    return static_cast<long>(std::floor(x / grid_.width + 0.5)) + static_cast<long>(grid_.columns / 2);
}

long Scattered::row(double y) const {
    return static_cast<long>(std::floor(y / grid_.height + 0.5)) + static_cast<long>(grid_.rows / 2);
}

std::size_t Scattered::cell(long i, long j) const {
    const long n = static_cast<long>(grid_.columns), m = static_cast<long>(grid_.rows);
    return static_cast<std::size_t>(((j % m + m) % m) * n + (i % n + n) % n);
}

std::vector<Near> Scattered::around(std::size_t bin, double reach) const {
    std::vector<Near> found;
    const double x = grid_.x_of(bin), y = grid_.y_of(bin);
    const PeriodicBox box{grid_.width * static_cast<double>(grid_.columns),
                          grid_.height * static_cast<double>(grid_.rows)};
    const long i = static_cast<long>(bin % grid_.columns), j = static_cast<long>(bin / grid_.columns);
    const long far = static_cast<long>(std::ceil(reach));
    for (long dj = -far; dj <= far; ++dj)
        for (long di = -far; di <= far; ++di)
            for (const std::size_t k : in_cell_[cell(i + di, j + dj)]) {
                const Near near{k, std::remainder(places_[k].x - x, box.x) / grid_.width,
                                std::remainder(places_[k].y - y, box.y) / grid_.height};
                if (std::hypot(near.x, near.y) <= reach)
                    found.push_back(near);
            }
    return found;
}

LocalFit::LocalFit(const std::vector<Near>& near, const BinSamples& samples) {
    Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 2> right = Eigen::Matrix<double, 6, 2>::Zero();
    for (const Near& one : near) {
        const double coherence = samples.coherence[one.sample];
        const double w = samples.count[one.sample] * coherence * coherence *
                         std::exp(-0.5 * (one.x * one.x + one.y * one.y) / (width * width));
        const Basis b = basis(one.x, one.y);
        matrix += w * b * b.transpose();
        right += w * b * Eigen::RowVector2d(samples.value[one.sample].x, samples.value[one.sample].y);
    }
    coefficients_.setZero();
    const double total = matrix(0, 0);
    if (!(total > 0.0))
        return;
    matrix.diagonal().segment<2>(1).array() += ridge_slope * total;
    matrix.diagonal().tail<3>().array() += ridge_curvature * total;
    coefficients_ = matrix.ldlt().solve(right);
}

Vector2 LocalFit::at(double x, double y) const {
    const Eigen::Vector2d u = coefficients_.transpose() * basis(x, y);
    return {u.x(), u.y()};
}

Vector2 LocalFit::difference(double x, double y) const {
    const Vector2 there = at(x, y), here = at(0.0, 0.0);
    return {there.x - here.x, there.y - here.y};
}

Vector2 LocalFit::linear_difference(double x, double y) const {
    const Eigen::RowVector2d u = x * coefficients_.row(1) + y * coefficients_.row(2);
    return {u.x(), u.y()};
}

} // namespace rodwake::measure
