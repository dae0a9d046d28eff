#include "regrid.hpp"

#include <Eigen/Cholesky>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace rodwake::measure {

namespace {

constexpr double tolerance = 1e-12; // of the residual, relative

} // namespace

void fill_in(std::vector<double>& values, const std::vector<bool>& known, std::size_t columns) {
    std::vector<Eigen::Index> unknown(values.size(), -1);
    std::vector<std::size_t> bins;
    for (std::size_t j = 0; j < values.size(); ++j)
        if (!known[j]) {
            unknown[j] = static_cast<Eigen::Index>(bins.size());
            bins.push_back(j);
        }
    if (bins.empty() || bins.size() == values.size())
        return;
    const auto size = static_cast<Eigen::Index>(bins.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (Eigen::Index k = 0; k < size; ++k) {
        const std::size_t bin = bins[static_cast<std::size_t>(k)], column = bin % columns;
        std::vector<std::size_t> near;
        if (column > 0)
            near.push_back(bin - 1);
        if (column + 1 < columns)
            near.push_back(bin + 1);
        if (bin >= columns)
            near.push_back(bin - columns);
        if (bin + columns < values.size())
            near.push_back(bin + columns);
        entries.emplace_back(k, k, static_cast<double>(near.size()));
        for (const std::size_t other : near)
            if (known[other])
                right[k] += values[other];
            else
                entries.emplace_back(k, unknown[other], -1.0);
    }
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver(matrix);
    solver.setTolerance(tolerance);
    const Eigen::VectorXd solved = solver.solve(right);
    for (Eigen::Index k = 0; k < size; ++k)
        values[bins[static_cast<std::size_t>(k)]] = solved[k];
}

namespace {

constexpr double own = 0.5, nearest_allowed = 0.75; // in spacings

} // namespace

void regrid(const BinSamples& samples, const std::vector<Vector2>& undisplaced, DisplacementField& field) {
    for (auto* values :
         {&field.Ux, &field.Uy, &field.sigma_x, &field.sigma_y, &field.coherence, &field.count})
        values->assign(field.grid.bins(), 0.0);
    const Scattered scattered(samples, undisplaced, field.grid);
    for (std::size_t bin = 0; bin < field.grid.bins(); ++bin) {
        const auto near = scattered.around(bin, LocalFit::reach);
        std::vector<NearSample> own_samples;
        std::optional<NearSample> nearest;
        const auto size = [](const NearSample& sample) {
            return std::max(std::abs(sample.x), std::abs(sample.y));
        };
        for (const NearSample& near_sample : near) {
            if (size(near_sample) <= own)
                own_samples.push_back(near_sample);
            if (!nearest || size(near_sample) < size(*nearest))
                nearest = near_sample;
        }
        if (own_samples.empty() && nearest && size(*nearest) <= nearest_allowed)
            own_samples.push_back(*nearest);
        if (own_samples.empty())
            continue;
        const LocalFit fit(near, samples);
        double total = 0.0;
        for (const NearSample& sample : own_samples) {
            const std::size_t k = sample.sample;
            const double w = samples.count[k];
            const Vector2 apart = fit.difference(sample.x, sample.y);
            field.Ux[bin] += w * (samples.value[k].x - apart.x);
            field.Uy[bin] += w * (samples.value[k].y - apart.y);
            field.sigma_x[bin] += w * samples.sigma[k].x; // neighbours share their cell: errors do not cancel
            field.sigma_y[bin] += w * samples.sigma[k].y;
            field.coherence[bin] += w * samples.coherence[k];
            total += w;
        }
        for (auto* values : {&field.Ux, &field.Uy, &field.sigma_x, &field.sigma_y, &field.coherence})
            (*values)[bin] /= total;
        field.count[bin] = total / static_cast<double>(own_samples.size());
    }
}

namespace {

constexpr double width = 0.8; // of the Gaussian, in spacings
constexpr double ridge_slope = 1e-6,
                 ridge_curvature = 1e-3; // of the weights' sum: rows in a line fix no slope

using Basis = Eigen::Matrix<double, 6, 1>;

Basis basis(double x, double y) { return {1.0, x, y, x * x, x * y, y * y}; }

} // namespace

Scattered::Scattered(const BinSamples& samples, const std::vector<Vector2>& positions, const RodGrid& grid)
    : samples_(samples), places_(positions), grid_(grid), in_cell_(grid.bins()) {
    for (std::size_t j = 0; j < positions.size(); ++j)
        if (samples.count[j] > 0.0) {
            const long column = static_cast<long>(std::floor(positions[j].x / grid.width + 0.5)),
                       row = static_cast<long>(std::floor(positions[j].y / grid.height + 0.5));
            in_cell_[cell(column + static_cast<long>(grid.columns / 2),
                          row + static_cast<long>(grid.rows / 2))]
                .push_back(j);
        }
}

std::size_t Scattered::cell(long i, long j) const {
    const long n = static_cast<long>(grid_.columns), m = static_cast<long>(grid_.rows);
    return static_cast<std::size_t>(((j % m + m) % m) * n + (i % n + n) % n);
}

std::vector<NearSample> Scattered::around(std::size_t bin, double reach) const {
    std::vector<NearSample> found;
    const double x = grid_.x_of(bin), y = grid_.y_of(bin);
    const PeriodicBox box{grid_.width * static_cast<double>(grid_.columns),
                          grid_.height * static_cast<double>(grid_.rows)};
    const long i = static_cast<long>(bin % grid_.columns), j = static_cast<long>(bin / grid_.columns);
    const long far = static_cast<long>(std::ceil(reach));
    for (long dj = -far; dj <= far; ++dj)
        for (long di = -far; di <= far; ++di)
            for (const std::size_t k : in_cell_[cell(i + di, j + dj)]) {
                const NearSample near{k, std::remainder(places_[k].x - x, box.x) / grid_.width,
                                      std::remainder(places_[k].y - y, box.y) / grid_.height};
                if (std::hypot(near.x, near.y) <= reach)
                    found.push_back(near);
            }
    return found;
}

LocalFit::LocalFit(const std::vector<NearSample>& near, const BinSamples& samples) {
    Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 2> right = Eigen::Matrix<double, 6, 2>::Zero();
    for (const NearSample& sample : near) {
        const double coherence = samples.coherence[sample.sample];
        const double w = samples.count[sample.sample] * coherence * coherence *
                         std::exp(-0.5 * (sample.x * sample.x + sample.y * sample.y) / (width * width));
        const Basis b = basis(sample.x, sample.y);
        matrix += w * b * b.transpose();
        right += w * b * Eigen::RowVector2d(samples.value[sample.sample].x, samples.value[sample.sample].y);
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
