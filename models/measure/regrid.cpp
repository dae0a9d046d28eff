#include "regrid.hpp"
#include "local_fit.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace rodwake::measure {

namespace {

constexpr double tolerance = 1e-12; // of the residual, relative

struct Around {
    std::array<std::size_t, 4> bins{};
    std::size_t count = 0;
};

Around around(std::size_t bin, std::size_t n, std::size_t bins) {
    Around found;
    const std::size_t column = bin % n;
    if (column > 0)
        found.bins[found.count++] = bin - 1;
    if (column + 1 < n)
        found.bins[found.count++] = bin + 1;
    if (bin >= n)
        found.bins[found.count++] = bin - n;
    if (bin + n < bins)
        found.bins[found.count++] = bin + n;
    return found;
}

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
        const Around near = around(bins[static_cast<std::size_t>(k)], columns, values.size());
        entries.emplace_back(k, k, static_cast<double>(near.count));
        for (std::size_t i = 0; i < near.count; ++i)
            if (known[near.bins[i]])
                right[k] += values[near.bins[i]];
            else
                entries.emplace_back(k, unknown[near.bins[i]], -1.0);
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

std::vector<Near> behind(const std::vector<Near>& near) {
    std::vector<Near> found;
    std::optional<Near> nearest;
    const auto size = [](const Near& one) { return std::max(std::abs(one.x), std::abs(one.y)); };
    for (const Near& one : near) {
        if (size(one) <= own)
            found.push_back(one);
        if (!nearest || size(one) < size(*nearest))
            nearest = one;
    }
    if (found.empty() && nearest && size(*nearest) <= nearest_allowed)
        found.push_back(*nearest);
    return found;
}

void put(std::size_t bin, const std::vector<Near>& own_samples, const LocalFit& fit,
         const BinSamples& samples, DisplacementField& field) {
    double total = 0.0;
    for (const Near& one : own_samples) {
        const std::size_t k = one.sample;
        const double w = samples.count[k];
        const Vector2 apart = fit.difference(one.x, one.y);
        field.Ux[bin] += w * (samples.value[k].x - apart.x);
        field.Uy[bin] += w * (samples.value[k].y - apart.y);
        field.sigma_x[bin] += w * samples.sigma[k].x; // neighbours share their cell, so errors do not cancel
        field.sigma_y[bin] += w * samples.sigma[k].y;
        field.coherence[bin] += w * samples.coherence[k];
        total += w;
    }
    for (auto* values : {&field.Ux, &field.Uy, &field.sigma_x, &field.sigma_y, &field.coherence})
        (*values)[bin] /= total;
    field.count[bin] = total / static_cast<double>(own_samples.size());
}

} // namespace

void regrid(const BinSamples& samples, const std::vector<Vector2>& undisplaced, DisplacementField& field) {
    for (auto* values :
         {&field.Ux, &field.Uy, &field.sigma_x, &field.sigma_y, &field.coherence, &field.count})
        values->assign(field.grid.bins(), 0.0);
    const Scattered scattered(samples, undisplaced, field.grid);
    for (std::size_t bin = 0; bin < field.grid.bins(); ++bin) {
        const auto near = scattered.around(bin, LocalFit::reach);
        const auto own_samples = behind(near);
        if (!own_samples.empty())
            put(bin, own_samples, LocalFit(near, samples), samples, field);
    }
}

} // namespace rodwake::measure
