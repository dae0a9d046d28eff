#include "mode_mesh.hpp"

#include "mode_displacement.hpp"
#include "rods/interaction.hpp"

#include <algorithm>
#include <array>

namespace rodwake::medium {

ModeMesh::ModeMesh(const ModalField& modes, double box, Team& team)
    : modes_(modes), team_(team), transform_(box, modes.rows() - 1, team) {}

void ModeMesh::place(integrate::State poses) {
    if (std::ranges::equal(placed_, poses))
        return;
    placed_.assign(poses.begin(), poses.end());
    transform_.place(poses);
}

void ModeMesh::force_row(std::size_t row, std::span<double> rates) {
    const std::size_t columns = modes_.columns(), half = modes_.rows() - 1, size = modes_.size();
    const std::span<const Complex> sums = transform_.modes();
    for (std::size_t column = 0, i = row * columns; column < columns; ++column, ++i) {
        const Complex plus = sums[(half + row) * columns + column];
        const Complex minus = conjugate(sums[(half - row) * columns + columns - 1 - column]);
        const Complex x = 0.5 * (plus + minus), y = -0.5 * times_i(plus - minus);
        const double f = modes_.force()[i], ux = modes_.unit_x()[i], uy = modes_.unit_y()[i];
        const Complex l = f * (ux * x + uy * y), t = f * (ux * y - uy * x);
        rates[i] = l.re;
        rates[size + i] = l.im;
        rates[2 * size + i] = t.re;
        rates[3 * size + i] = t.im;
    }
}

void ModeMesh::forces(integrate::State poses, std::span<double> rates) {
    place(poses);
    values_.resize(poses.size() / 3);
    for (std::size_t a = 0; a < values_.size(); ++a) {
        const rods::Direction n = rods::direction(poses, a);
        values_[a] = {n.cosine, n.sine};
    }
    transform_.to_modes(values_);
    team_.run(modes_.rows(), [&](std::size_t row) { force_row(row, rates); });
}

template<class Make>
void ModeMesh::fill_row(std::size_t row, const Make& make) {
    const std::size_t columns = modes_.columns(), half = modes_.rows() - 1;
    const std::span<Complex> sums = transform_.modes();
    for (std::size_t column = 0, i = row * columns; column < columns; ++column, ++i) {
        if (row == 0 && column <= half)
            continue; // the zero mode, and what its partner in the row fills
        const auto [a, b] = make(i, modes_.qx()[row], modes_.qy()[column]);
        sums[(half + row) * columns + column] = a + times_i(b);
        sums[(half - row) * columns + columns - 1 - column] = conjugate(a) + times_i(conjugate(b));
    }
    if (row == 0)
        sums[half * columns + half] = {};
}

/// (eps_xx - eps_yy)/2 and eps_xy, which are all of the strain that turns a rod.
void ModeMesh::strain(std::span<const double> field) {
    team_.run(modes_.rows(), [&](std::size_t row) {
        fill_row(row, [&](std::size_t i, double qx, double qy) {
            const Displacement u = displacement(modes_, i, field);
            return std::array{times_i(0.5 * qx * u.x - 0.5 * qy * u.y),
                              times_i(0.5 * qx * u.y + 0.5 * qy * u.x)};
        });
    });
    transform_.to_points(values_);
}

/// gamma1 lap u + gamma2 grad div u.
void ModeMesh::polar(std::span<const double> field, const rods::Couplings& couplings) {
    const auto [kappa, gamma1, gamma2] = couplings;
    team_.run(modes_.rows(), [&, gamma1 = gamma1, gamma2 = gamma2](std::size_t row) {
        fill_row(row, [&](std::size_t i, double qx, double qy) {
            const Displacement u = displacement(modes_, i, field);
            const double laplacian = -gamma1 * (qx * qx + qy * qy);
            const Complex divergence = -gamma2 * (qx * u.x + qy * u.y);
            return std::array{laplacian * u.x + qx * divergence, laplacian * u.y + qy * divergence};
        });
    });
    transform_.to_points(values_);
}

void ModeMesh::turning(integrate::State poses, std::span<const double> field,
                       const rods::Couplings& couplings, std::span<double> rates) {
    const auto& [kappa, gamma1, gamma2] = couplings; // the polar ones: polar()
    place(poses);
    values_.resize(poses.size() / 3);
    std::ranges::fill(rates, 0.0);
    if (couplings.apolar()) {
        strain(field);
        for (std::size_t a = 0; a < values_.size(); ++a) {
            const rods::Direction n = rods::direction(poses, a);
            const double twice_cosine = n.cosine * n.cosine - n.sine * n.sine,
                         twice_sine = 2.0 * n.sine * n.cosine;
            rates[a] += kappa * (values_[a].im * twice_cosine - values_[a].re * twice_sine);
        }
    }
    if (couplings.polar()) {
        polar(field, couplings);
        for (std::size_t a = 0; a < values_.size(); ++a) {
            const rods::Direction n = rods::direction(poses, a);
            rates[a] += n.cosine * values_[a].im - n.sine * values_[a].re;
        }
    }
}

} // namespace rodwake::medium
