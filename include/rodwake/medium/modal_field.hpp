#pragma once
// Displacement fields as amplitudes of the modes of a periodic medium (dynamic_medium.hpp).
//
//   u(r) = sum_q u_q e^(i q.r),   u_q = l_q q/|q| + t_q z x q/|q|
//   d_t l_q = -((1 + eta) q^2/alpha) l_q + f_q n.q/|q|,   d_t t_q = -(q^2/alpha) t_q + f_q n.(z x q)/|q|
//   f_q = e^(-w^2 q^2/2) e^(-i q.R)/(alpha box^2)
//
// (with inertia beta d_tt l_q/alpha + d_t l_q on the left, t_q alike) for a rod at R with heading n. u is
// real, so half of the wave vectors are kept: rows m = 0 ... half, columns n = -half ... half, half =
// ceil(modes/2)
// - 1. In row 0 only n > 0 counts; the rest of it is 0.
//
// A field is 4 size() numbers: l_re, l_im, t_re, t_im, each of all modes, row by row; with inertia as many of
// their rates follow. A sum over the modes at
// a point is exact but for rounding: its error is below 1e-14 of the largest value. Everything is
// thread-safe.

#include "rodwake/elastic/field.hpp"
#include "rodwake/medium/dynamic_medium.hpp"
#include "rodwake/rods/model.hpp"

#include <span>
#include <vector>

namespace rodwake::medium {

/// e^(i q c) of each q.
struct PhaseFactors {
    std::vector<double> re, im;
};
using Phases [[deprecated("it is PhaseFactors")]] = PhaseFactors;
PhaseFactors phases(std::span<const double> q, double c);

struct ModalField {
    /// Throws InputError as validate does.
    ModalField(const elastic::Medium& elastic, const DynamicMedium& medium);

    double inertia;             ///< beta/alpha, f/(mu v0)
    std::vector<double> qx, qy; ///< of each row, and of each column, mu/f

    // Of each mode, row by row.
    std::vector<double> unit_x, unit_y;     ///< q/|q|
    std::vector<double> decay_longitudinal; ///< (1 + eta) q^2/alpha, mu v0/f
    std::vector<double> decay_transverse;   ///< q^2/alpha
    std::vector<double> force;              ///< e^(-w^2 q^2/2)/(alpha box^2), 0 of modes that do not count

    std::size_t rows() const { return qx.size(); }
    std::size_t columns() const { return qy.size(); }
    std::size_t size() const { return rows() * columns(); }
    std::size_t numbers() const { return (inertia > 0.0 ? 8 : 4) * size(); } ///< of a field

    /// Adds the field of a rod that has always walked straight:
    /// l_q = f_q n.q/|q| / ((1 + eta) q^2/alpha - (beta/alpha) (q.n)^2 - i q.n), t_q alike; d_t l_q = -i q.n
    /// l_q.
    void add_steady(const rods::Pose& rod, std::span<double> field) const;
    /// One row of it, columns first to last - 1; px and py are phases(qx, -rod.x) and phases(qy, -rod.y).
    void add_steady_row(std::size_t row, std::size_t first, std::size_t last, const rods::Pose& rod,
                        const PhaseFactors& px, const PhaseFactors& py, std::span<double> field) const;

    /// Displacement, strain and polar vectors as asked for (units of elastic/field.hpp), lab frame, of a
    /// field, or of its difference to another. No dipole, no gradients: InputError.
    elastic::FieldValues at(double x, double y, elastic::FieldRequest request, std::span<const double> field,
                            std::span<const double> minus = {}) const;
};

} // namespace rodwake::medium
