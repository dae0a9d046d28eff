#include "rodwake/medium/modal_field.hpp"

#include "rodwake/core/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::medium {

namespace {

/// One row of complex numbers; a VectorRow has one for each Cartesian component of u.
struct ComplexRow {
    std::vector<double> re, im;
};
using VectorRow = std::array<ComplexRow, 2>;

/// Adds one row of a field.
void load_row(const ModalField& modes, std::size_t row, std::span<const double> field, double sign,
              VectorRow& out) {
    const std::size_t n = modes.columns(), size = modes.size(), first = row * n;
    const double *ux = &modes.unit_x[first], *uy = &modes.unit_y[first];
    for (std::size_t part = 0; part < 2; ++part) { // real, imaginary
        const double *l = &field[part * size + first], *t = &field[(2 + part) * size + first];
        double* x = (part == 0 ? out[0].re : out[0].im).data();
        double* y = (part == 0 ? out[1].re : out[1].im).data();
        for (std::size_t i = 0; i < n; ++i) {
            x[i] += sign * (ux[i] * l[i] - uy[i] * t[i]);
            y[i] += sign * (uy[i] * l[i] + ux[i] * t[i]);
        }
    }
}

} // namespace

PhaseFactors phases(std::span<const double> q, double c) {
    PhaseFactors p{std::vector<double>(q.size()), std::vector<double>(q.size())};
    for (std::size_t i = 0; i < q.size(); ++i) {
        p.re[i] = std::cos(q[i] * c);
        p.im[i] = std::sin(q[i] * c);
    }
    return p;
}

ModalField::ModalField(const elastic::Medium& elastic, const DynamicMedium& medium)
    : inertia(medium.inertia * elastic.xi) {
    validate(elastic, medium, 1);
    const std::size_t half = (medium.modes + 1) / 2 - 1;
    const double unit = 2.0 * std::numbers::pi / medium.box, alpha = 1.0 / elastic.xi;
    for (std::size_t m = 0; m <= half; ++m)
        qx.push_back(unit * static_cast<double>(m));
    for (std::size_t n = 0; n <= 2 * half; ++n)
        qy.push_back(unit * (static_cast<double>(n) - static_cast<double>(half)));
    for (const double x : qx)
        for (const double y : qy) {
            const double q2 = x * x + y * y, q = std::sqrt(q2);
            const bool kept = x > 0.0 || y > 0.0;
            unit_x.push_back(kept ? x / q : 1.0);
            unit_y.push_back(kept ? y / q : 0.0);
            decay_longitudinal.push_back((1.0 + elastic.eta) * q2 / alpha);
            decay_transverse.push_back(q2 / alpha);
            force.push_back(kept ? std::exp(-0.5 * medium.force_width * medium.force_width * q2) /
                                       (alpha * medium.box * medium.box)
                                 : 0.0);
        }
}

void ModalField::add_steady(const rods::Pose& rod, std::span<double> field) const {
    const PhaseFactors px = phases(qx, -rod.x), py = phases(qy, -rod.y);
    for (std::size_t row = 0; row < rows(); ++row)
        add_steady_row(row, 0, columns(), rod, px, py, field);
}

void ModalField::add_steady_row(std::size_t row, std::size_t first, std::size_t last, const rods::Pose& rod,
                                const PhaseFactors& px, const PhaseFactors& py,
                                std::span<double> field) const {
    const double nx = std::cos(rod.heading), ny = std::sin(rod.heading);
    const auto add = [&](std::size_t i, std::size_t block, double along, double decay, double qn, double re,
                         double im) {
        const double d = decay - inertia * qn * qn;
        const double scale = force[i] * along / (d * d + qn * qn); // of 1/(d - i qn)
        const double u_re = scale * (re * d - im * qn), u_im = scale * (re * qn + im * d);
        field[block * size() + i] += u_re;
        field[(block + 1) * size() + i] += u_im;
        if (inertia > 0.0) { // rates, -i qn u
            field[(block + 4) * size() + i] += qn * u_im;
            field[(block + 5) * size() + i] -= qn * u_re;
        }
    };
    for (std::size_t column = first; column < last; ++column) {
        const std::size_t i = row * columns() + column;
        if (force[i] == 0.0)
            continue;
        const double re = px.re[row] * py.re[column] - px.im[row] * py.im[column];
        const double im = px.re[row] * py.im[column] + px.im[row] * py.re[column];
        const double qn = qx[row] * nx + qy[column] * ny;
        add(i, 0, nx * unit_x[i] + ny * unit_y[i], decay_longitudinal[i], qn, re, im);
        add(i, 2, ny * unit_x[i] - nx * unit_y[i], decay_transverse[i], qn, re, im);
    }
}

elastic::FieldValues ModalField::at(double x, double y, elastic::FieldRequest request,
                                    std::span<const double> field, std::span<const double> minus) const {
    if (request.dipole || request.gradients)
        throw InputError(
            "a dynamic medium gives displacement, strain and polar vectors: no dipole, no gradients");
    const std::size_t powers = request.polar ? 3 : request.strain ? 2 : 1;
    const PhaseFactors px = phases(qx, x), py = phases(qy, y);

    // Sums over the rows of p u, q_x p u, q_x^2 p u (p = e^(i q_x x)), column by column.
    const ComplexRow zeros{std::vector<double>(columns()), std::vector<double>(columns())};
    std::vector<VectorRow> sums(powers, {zeros, zeros});
    VectorRow u;
    for (std::size_t row = 0; row < rows(); ++row) {
        u.fill(zeros);
        load_row(*this, row, field, 1.0, u);
        if (!minus.empty())
            load_row(*this, row, minus, -1.0, u);
        double weight = 1.0;
        for (std::size_t k = 0; k < powers; ++k, weight *= qx[row]) {
            const double re = weight * px.re[row], im = weight * px.im[row];
            for (std::size_t c = 0; c < 2; ++c) {
                const double *ur = u[c].re.data(), *ui = u[c].im.data();
                double *sr = sums[k][c].re.data(), *si = sums[k][c].im.data();
                for (std::size_t i = 0; i < columns(); ++i) {
                    sr[i] += re * ur[i] - im * ui[i];
                    si[i] += re * ui[i] + im * ur[i];
                }
            }
        }
    }

    // The sum of q_y^j p_y s over the columns of each, for j = 0, 1, 2.
    struct {
        std::array<double, 3> re{}, im{};
    } s[3][2];
    for (std::size_t k = 0; k < powers; ++k)
        for (std::size_t c = 0; c < 2; ++c)
            for (std::size_t i = 0; i < columns(); ++i) {
                const double sum_re = sums[k][c].re[i], sum_im = sums[k][c].im[i];
                const double re = py.re[i] * sum_re - py.im[i] * sum_im,
                             im = py.re[i] * sum_im + py.im[i] * sum_re;
                double weight = 1.0;
                for (std::size_t j = 0; j < 3; ++j, weight *= qy[i]) {
                    s[k][c].re[j] += weight * re;
                    s[k][c].im[j] += weight * im;
                }
            }
    // twice the real part, as the other half of the modes is the conjugate; s[k][c].re[j]: d_x^k d_y^j of u_c
    elastic::FieldValues values = elastic::unrequested();
    if (request.displacement)
        values.displacement = {2.0 * s[0][0].re[0], 2.0 * s[0][1].re[0]};
    if (request.strain)
        values.strain = {-2.0 * s[1][0].im[0], -(s[0][0].im[1] + s[1][1].im[0]), -2.0 * s[0][1].im[1]};
    if (request.polar) {
        values.laplacian = {-2.0 * (s[2][0].re[0] + s[0][0].re[2]), -2.0 * (s[2][1].re[0] + s[0][1].re[2])};
        values.gradient_of_trace = {-2.0 * (s[2][0].re[0] + s[1][1].re[1]),
                                    -2.0 * (s[1][0].re[1] + s[0][1].re[2])};
    }
    return values;
}

} // namespace rodwake::medium
