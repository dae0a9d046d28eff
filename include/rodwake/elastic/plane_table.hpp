#pragma once
// The strain of a wake on the infinite plane as polynomials on cells, to a tolerance of one's own: faster
// than the exact field where little accuracy is needed (studies/reports/elastic.md says from where on it is
// not).
//
// In units of xi the field depends on eta alone, so a table serves every xi. A square ring
// 2^e <= max(|x|, |y|)/xi < 2^(e+1) is a level, its upper half cut into square cells (the lower half is its
// mirror image). A cell holds its components as polynomials in its own coordinates, of the table's degree in
// each. Strain and its gradient have cells of their own; the polar vectors are made of the gradient:
//
//   grad div u = grad tr eps,    lap u = 2 div eps - grad tr eps
//
// Outside the levels - near the singular core, and farther than they reach - and in cells whose polynomials
// miss the tolerance, as far ahead of the rod, where e^(-x/xi) falls within a cell, the field is exact.
//
// Error: at most the tolerance for eta from -0.99 to 100, for strain relative to the norm of the tensor at
// the place, for its gradient relative to the norm of the whole gradient (polar vectors: twice that).
// Gradients of the polar vectors are the derivatives of the polynomials of the gradient, and one to two
// digits worse. At the edges of cells values jump by as much as the error.
//
//   strain, gradient  eta = 0.1         eta = 1           eta = 100   (build/release/bench/bench_table)
//   1e-4              4.6e-5, 4.8e-5    4.6e-5, 4.9e-5    4.4e-5, 4.7e-5
//   1e-8              4.8e-9, 4.6e-9    4.6e-9, 4.7e-9    3.7e-9, 3.9e-9
//
// Nearly incompressible media miss it beside the rod, where the whole strain nearly vanishes: read
// strain_error.
//
// Degenerate input (tests/elastic/test_plane_table.cpp): InputError for a tolerance outside [1e-12, 0.1] or
// NaN, an illegal eta, a medium of another eta, the rod itself, a place that is not finite. xi from 1e-30 to
// 1e30.

#include "rodwake/elastic/wake_field.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace rodwake::elastic {

/// Polynomials of some components on the cells of all levels.
struct CellTable {
    std::vector<std::int32_t> cells_per_unit; ///< of each level from the lowest, in its unit 2^e
    /// Of all cells of all levels (4 n times 2 n, x first): number of the polynomial, -1: exact.
    std::vector<std::int32_t> polynomial_of;
    /// Of each polynomial (degree + 1)^2 rows of the components, for u^i v^j with j first; u, v in [-1, 1].
    std::vector<double> coefficients;

    bool operator==(const CellTable&) const = default;
};

/// A plain value, so that it can be stored. Lengths in units of xi.
struct PlaneTable {
    double eta = 0.0;
    double tolerance = 0.0;
    double strain_error = 0.0, gradient_error = 0.0; ///< largest at the points checked when it was made
    std::int64_t points_checked = 0;
    std::int32_t degree = 0;       ///< 3, 5 or 7
    std::int32_t lowest_level = 0; ///< its e
    CellTable strain;              ///< xx, xy, yy
    CellTable gradient;            ///< d/dx of xx, xy, yy, then d/dy

    bool operator==(const PlaneTable&) const = default;
};

/// 1e-12 <= tolerance <= 0.1, eta as for Medium; InputError otherwise. Deterministic whatever `threads`.
PlaneTable make_plane_table(double eta, double tolerance, std::size_t threads = 1);

/// The wakes of a medium from the table made for its eta; what the table does not hold (displacement, dipole,
/// derivatives by the medium) is exact. Throws InputError for another eta.
std::shared_ptr<const WakeField> table_field(std::shared_ptr<const PlaneTable> table, const Medium& medium);

/// Largest relative errors at `points` random points with r/xi from 1e-4 to 200, directions uniform.
struct TableErrors {
    double strain, gradient;
};
TableErrors plane_table_errors(const PlaneTable& table, std::int64_t points, std::uint64_t seed,
                               std::size_t threads = 1);

} // namespace rodwake::elastic
