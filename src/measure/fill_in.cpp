#include "fill_in.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>

namespace rodwake::measure {

namespace {

constexpr double tolerance = 1e-12; // of the residual, relative

struct Around {
    std::array<std::size_t, 4> bins{};
    std::size_t count = 0;
};

Around around(std::size_t bin, std::size_t n) {
    Around found;
    const std::size_t column = bin % n, row = bin / n;
    if (column > 0)
        found.bins[found.count++] = bin - 1;
    if (column + 1 < n)
        found.bins[found.count++] = bin + 1;
    if (row > 0)
        found.bins[found.count++] = bin - n;
    if (row + 1 < n)
        found.bins[found.count++] = bin + n;
    return found;
}

} // namespace

void fill_in(std::vector<double>& values, const std::vector<bool>& known, std::size_t n) {
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
        const Around near = around(bins[static_cast<std::size_t>(k)], n);
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

} // namespace rodwake::measure
