#pragma once
// From samples at scattered places to the middles of the bins.
//
// A bin's mean displacement belongs to the mean place of its beads, taken back by that displacement: so U at
// the undisplaced place needs no inversion, only that the samples' undisplaced places do not change order,
// which they keep while the gradients of U are below 1. A middle's value is the mean, weighted by beads, of
// the samples within half a spacing of it (else of the nearest, within 0.75), each moved by the difference of
// a local quadratic fit through its neighbourhood between its place and the middle. So each sample stands
// behind one value, hardly more, and errors of neighbours stay independent.

#include "estimators.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace rodwake::measure {

/// Overwrites the parts of `field` that belong to bins; count 0 and value 0 where there is no sample.
/// `undisplaced` are the samples' places.
void regrid(const BinSamples& samples, const std::vector<Vector2>& undisplaced, DisplacementField& field);

// Values of empty bins from those around them.

/// Solves the discrete Laplace equation in the bins of a grid of so many columns that are not known, with the
/// known ones as given and no flux through the edge. All stay as they are if none is known.
void fill_in(std::vector<double>& values, const std::vector<bool>& known, std::size_t columns);

// Samples at scattered places of the rod's frame: those near a point, and a quadratic through them.

struct NearSample {
    std::size_t sample;
    double x, y; ///< from the point, in widths and heights of the grid's bins
};

/// Samples with data, found by their places; the box is periodic. Keeps references to what it is made from.
class Scattered {
public:
    Scattered(const BinSamples& samples, const std::vector<Vector2>& positions, const RodGrid& grid);
    /// Within so many spacings of the middle of a bin, at most 4; in the order of bins and samples.
    std::vector<NearSample> around(std::size_t bin, double reach) const;

private:
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
    LocalFit(const std::vector<NearSample>& near, const BinSamples& samples);
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
