#pragma once
// Samples at scattered places of the rod's frame: those near a point, and a quadratic through them.

#include "estimators.hpp"

#include <Eigen/Core>

#include <vector>

namespace rodwake::measure {

struct Near {
    std::size_t sample;
    double x, y; ///< from the point, in widths and heights of the grid's bins
};

/// Samples with data, found by their places; the box is periodic. Keeps references to what it is made from.
class Scattered {
public:
    Scattered(const BinSamples& samples, const std::vector<Vector2>& places, const RodGrid& grid);
    /// Within so many spacings of the middle of a bin, at most 4; in the order of bins and samples.
    std::vector<Near> around(std::size_t bin, double reach) const;
    const BinSamples& samples() const { return samples_; }

private:
    long column(double x) const;
    long row(double y) const;
    std::size_t cell(long i, long j) const;

    const BinSamples& samples_;
    const std::vector<Vector2>& places_;
    const RodGrid& grid_;
    std::vector<std::vector<std::size_t>> in_cell_;
};

/// U around a point, by least squares with weights count x coherence^2 x Gaussian of the distance.
class LocalFit {
public:
    static constexpr double reach = 2.2; ///< of the samples to give it, in spacings
    LocalFit(const std::vector<Near>& near, const BinSamples& samples);
    /// U at x, y from the point, in spacings.
    Vector2 at(double x, double y) const;
    /// U there minus U at the point.
    Vector2 difference(double x, double y) const;
    /// The same by the slope at the point alone.
    Vector2 linear_difference(double x, double y) const;

private:
    Eigen::Matrix<double, 6, 2> coefficients_;
};

} // namespace rodwake::measure
