// What strain of the crystal each block of time has of its own, in a window (phase_cell.hpp).

#include "phase_cell.hpp"
#include "plane_waves.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr int most_rounds = 40;
constexpr double settled = 1e-4; // of a bin, what a round still moves displacements by
constexpr std::size_t strain_channels = PhaseAccumulator::channels, least_bins = 10;

struct Linear {
    Eigen::Vector3d x = Eigen::Vector3d::Zero(), y = Eigen::Vector3d::Zero(); ///< of 1, x and y

    Vector2 at(double px, double py) const {
        return {x[0] + x[1] * px + x[2] * py, y[0] + y[1] * px + y[2] * py};
    }
};

double beads_of(const std::vector<double>& sums, std::size_t bin) {
    return sums[bin * strain_channels + PhaseAccumulator::beads];
}

double distance(const RodGrid& grid, std::size_t bin) { return std::hypot(grid.x_of(bin), grid.y_of(bin)); }

/// Least squares of the phases that U leaves in a block, weighted by their sums.
Linear linear_of_block(const PhaseBlock& block, const std::vector<double>& sums, const RodGrid& grid,
                       double from, const std::vector<Vector2>& u) {
    Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero(), row;
    std::size_t bins = 0;
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        if (beads_of(sums, j) == 0.0 || distance(grid, j) < from)
            continue;
        ++bins;
        const PhaseFactors back = plane_waves(block.g, -u[j].x, -u[j].y);
        const Eigen::Vector3d position(1.0, grid.x_of(j), grid.y_of(j));
        for (std::size_t k = 0; k < 3; ++k) {
            const auto z =
                times({sums[j * strain_channels + 2 * k], sums[j * strain_channels + 2 * k + 1]}, back[k]);
            row << block.g[k].x * position, block.g[k].y * position;
            matrix.noalias() += std::abs(z) * row * row.transpose();
            right += std::abs(z) * std::arg(z) * row;
        }
    }
    Linear linear;
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(matrix);
    if (bins < least_bins || solver.info() != Eigen::Success || !solver.isPositive())
        return linear;
    const Eigen::Matrix<double, 6, 1> found = solver.solve(right);
    if (found.allFinite()) {
        linear.x = found.head<3>();
        linear.y = found.tail<3>();
    }
    return linear;
}

/// Returns by how much displacements change at most.
double take_off(const PhaseBlock& block, std::vector<double>& sums, const RodGrid& grid,
                const Linear& linear) {
    double most = 0.0;
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        if (beads_of(sums, j) == 0.0)
            continue;
        const Vector2 v = linear.at(grid.x_of(j), grid.y_of(j));
        most = std::max(most, std::hypot(v.x, v.y));
        const PhaseFactors back = plane_waves(block.g, -v.x, -v.y);
        for (std::size_t k = 0; k < 3; ++k) {
            double* sum = &sums[j * strain_channels + 2 * k];
            const auto z = times({sum[0], sum[1]}, back[k]);
            sum[0] = z.real();
            sum[1] = z.imag();
        }
    }
    return most;
}

void solve_bins(const std::vector<PhaseBlock>& blocks, const std::vector<bool>& has,
                std::vector<Vector2>& u) {
    for (std::size_t j = 0; j < u.size(); ++j)
        if (has[j])
            PhaseCell(blocks, {{j, 1.0, {}}}).solve(u[j]);
}

/// Of U where it is far.
Linear linear_of_field(const RodGrid& grid, const std::vector<bool>& has, double far_from,
                       const std::vector<Vector2>& u) {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Linear right;
    std::size_t bins = 0;
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        if (!has[j] || distance(grid, j) < far_from)
            continue;
        ++bins;
        const Eigen::Vector3d position(1.0, grid.x_of(j), grid.y_of(j));
        matrix += position * position.transpose();
        right.x += u[j].x * position;
        right.y += u[j].y * position;
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(matrix);
    if (bins < least_bins || !solver.isPositive())
        return {};
    return {solver.solve(right.x), solver.solve(right.y)};
}

} // namespace

void take_off_strain(const std::vector<PhaseBlock>& blocks, std::vector<std::vector<double>>& sums,
                     const RodGrid& grid, double from, double far_from, std::vector<Vector2>& u) {
    std::vector<bool> has(grid.bins());
    for (std::size_t j = 0; j < grid.bins(); ++j)
        has[j] = std::ranges::any_of(sums, [&](const auto& of) { return beads_of(of, j) > 0.0; });
    double change = HUGE_VAL;
    for (int round = 0; round < most_rounds && change > settled * grid.width; ++round) {
        solve_bins(blocks, has, u);
        change = 0.0;
        for (std::size_t b = 0; b < blocks.size(); ++b)
            change = std::max(change, take_off(blocks[b], sums[b], grid,
                                               linear_of_block(blocks[b], sums[b], grid, from, u)));
    }
    solve_bins(blocks, has, u);
    const Linear common = linear_of_field(grid, has, far_from, u);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        take_off(blocks[b], sums[b], grid, common);
    for (std::size_t j = 0; j < grid.bins(); ++j) {
        const Vector2 v = common.at(grid.x_of(j), grid.y_of(j));
        u[j] = {u[j].x - v.x, u[j].y - v.y};
    }
}

} // namespace rodwake::measure
