#pragma once
// Rods in the displacement field that was measured around one rod of a bed: a WakeField made of data.
//
// With delta = U_measured - U_theory, U_theory in the box of the measurement with the rod along its side,
//
//   U(r; heading) = U_theory(r; heading) + sum over images of w(r) S[delta](r)          frame of the rod
//   w = s((|r| - core)/blend) s((edge - |x|)/blend) s((edge - |y|)/blend)
//   s(t) = t^4 (35 - 84 t + 70 t^2 - 20 t^3) between 0 and 1, constant outside
//
// (docs/numerics.md, Eq. 30). So U is the smoothed measured field where w = 1 and theory within the core
// and beyond the edge; in between both are mixed, and U is three times continuously differentiable
// everywhere but at the rod. S is a smoothing spline of degree 5 with weights 1/sigma^2
// (models/elastic/smoothing_spline.hpp); strain, polar vectors and their gradients are its derivatives. Bins
// without data count as delta = 0 with the sigma they are given. A constant in the measured field means
// nothing to rods; it is chosen so that the mixing at the edge makes the least strain.
//
// The domain of U_theory is that of the rods, plane or box, whatever the box of the measurement: theory
// makes the images, turned as the rod is, and delta goes with its rod. What that leaves out is how delta
// itself changes as the rod turns against the lattice and against its images: nothing where a rod keeps the
// heading of the measurement, and unknown otherwise.
//
// Errors: values are means under the window 1 - (d/window)^2, whose correlation is that of the
// cross-validation. Draws add to the data normal errors of the given sigma, white noise under the window
// 1 - (d/correlation)^2, and are smoothed alike: a
// bed's long waves go together over much more than a cell. The spline's own error
// on an exact field sampled at a tenth of xi is below 3e-3 of the strain xi or more from the rod (tests).
//
// Units f/mu, as elsewhere: multiply lengths of a bed in metres by mu/f. Thread-safe.

#include "rodwake/elastic/wake_field.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace rodwake::elastic {

/// A displacement field on a square grid around a rod that heads along +x, parallel to a side of the periodic
/// box that the grid covers. [row y][column x]; column k is at x = (k - n/2) spacing.
struct MeasuredGrid {
    std::size_t n = 0;
    double spacing = 0.0;                           ///< f/mu
    std::vector<double> Ux, Uy, sigma_x, sigma_y{}; ///< f/mu
    std::vector<bool> known{};                      ///< whether a bin has data

    double box() const { return static_cast<double>(n) * spacing; }
    double place(std::size_t k) const {
        const std::size_t middle = n / 2;
        return (static_cast<double>(k) - static_cast<double>(middle)) * spacing;
    }
};

struct MeasuredOptions {
    double core = 0.0;        ///< theory alone closer to the rod, f/mu
    double edge = 0.0;        ///< theory alone beyond |x| or |y| of this, f/mu
    double blend = 0.0;       ///< width over which both are mixed, f/mu
    double window = 0.0;      ///< radius of the means, f/mu; below the spacing: bins are independent
    double correlation = 0.0; ///< radius over which errors go together in draws, f/mu; at least the window
    std::optional<double> smoothing; ///< lambda of both components; absent: each by cross-validation
};

/// Throws InputError for lists that are not n^2 long, n odd or below 16, a sigma that is not above 0, options
/// that leave no place to the measured field or reach beyond the grid, a box in which what was measured would
/// meet its own image: a side <= edge sqrt(2).
void validate(const MeasuredGrid& grid, const MeasuredOptions& options, std::optional<PeriodicBox> box = {});

/// How a component was smoothed.
struct SmoothingReport {
    double lambda = 0.0;
    double trace = 0.0; ///< tr(H R): without correlation how many numbers the spline took from the data
    double chi2 = 0.0;  ///< of the residuals, over `points` values
    std::size_t points = 0;
};

class MeasuredDisplacement {
public:
    /// Throws InputError as validate does, and for an illegal medium.
    MeasuredDisplacement(const MeasuredGrid& grid, const Medium& theory, const MeasuredOptions& options);

    /// The wakes of rods, in this box or on the plane. No dipole, no derivatives by the medium.
    /// Throws InputError for a box that is too small.
    std::shared_ptr<const WakeField> field(std::optional<PeriodicBox> box = {}) const;
    /// The same from data to which errors were added; the draw depends on seed and sample alone.
    std::shared_ptr<const WakeField> drawn(std::uint64_t seed, std::uint32_t sample,
                                           std::optional<PeriodicBox> box = {}) const;

    const SmoothingReport& report_x() const;
    const SmoothingReport& report_y() const;

private:
    struct Impl;
    std::shared_ptr<const Impl> impl_;
};

} // namespace rodwake::elastic
