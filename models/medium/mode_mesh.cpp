#include "mode_mesh.hpp"

#include "mode_displacement.hpp"
#include "rods/interaction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::medium {

ModeMesh::ModeMesh(const ModalField& modes, double box, ThreadPool& team)
    : modes_(modes), team_(team), transform_(box, modes.rows() - 1, team) {}

void ModeMesh::place(integrate::State poses) {
    if (std::ranges::equal(placed_, poses))
        return;
    placed_.assign(poses.begin(), poses.end());
    transform_.place(poses);
}

void ModeMesh::forces(integrate::State poses, std::span<double> rates) {
    place(poses);
    values_.resize(poses.size() / 3);
    for (std::size_t a = 0; a < values_.size(); ++a) {
        const rods::Direction n = rods::direction(poses, a);
        values_[a] = {n.cosine, n.sine};
    }
    transform_.to_modes(values_);
    const std::size_t columns = modes_.columns(), half = modes_.rows() - 1, size = modes_.size();
    const std::span<const Complex> sums = transform_.modes();
    team_.run(modes_.rows(), [&](std::size_t row) {
        for (std::size_t column = 0, i = row * columns; column < columns; ++column, ++i) {
            const Complex plus = sums[(half + row) * columns + column];
            const Complex minus = conjugate(sums[(half - row) * columns + columns - 1 - column]);
            const Complex x = 0.5 * (plus + minus), y = -0.5 * times_i(plus - minus);
            const double f = modes_.force[i], ux = modes_.unit_x[i], uy = modes_.unit_y[i];
            const Complex l = f * (ux * x + uy * y), t = f * (ux * y - uy * x);
            rates[i] = l.re;
            rates[size + i] = l.im;
            rates[2 * size + i] = t.re;
            rates[3 * size + i] = t.im;
        }
    });
}

template<class Make>
void ModeMesh::fill_row(std::size_t row, const Make& make) {
    const std::size_t columns = modes_.columns(), half = modes_.rows() - 1;
    const std::span<Complex> sums = transform_.modes();
    for (std::size_t column = 0, i = row * columns; column < columns; ++column, ++i) {
        if (row == 0 && column <= half)
            continue; // the zero mode, and what its partner in the row fills
        const auto [a, b] = make(i, modes_.qx[row], modes_.qy[column]);
        sums[(half + row) * columns + column] = a + times_i(b);
        sums[(half - row) * columns + columns - 1 - column] = conjugate(a) + times_i(conjugate(b));
    }
    if (row == 0)
        sums[half * columns + half] = {};
}

void ModeMesh::turning(integrate::State poses, std::span<const double> field,
                       const rods::Couplings& couplings, std::span<double> rates) {
    const auto [kappa, gamma1, gamma2] = couplings;
    place(poses);
    values_.resize(poses.size() / 3);
    std::ranges::fill(rates, 0.0);
    if (couplings.apolar()) {
        // (eps_xx - eps_yy)/2 and eps_xy, which are all of the strain that turns a rod.
        team_.run(modes_.rows(), [&](std::size_t row) {
            fill_row(row, [&](std::size_t i, double qx, double qy) {
                const Displacement u = displacement(modes_, i, field);
                return std::array{times_i(0.5 * qx * u.x - 0.5 * qy * u.y),
                                  times_i(0.5 * qx * u.y + 0.5 * qy * u.x)};
            });
        });
        transform_.to_points(values_);
        for (std::size_t a = 0; a < values_.size(); ++a) {
            const rods::Direction n = rods::direction(poses, a);
            const double twice_cosine = n.cosine * n.cosine - n.sine * n.sine,
                         twice_sine = 2.0 * n.sine * n.cosine;
            rates[a] += kappa * (values_[a].im * twice_cosine - values_[a].re * twice_sine);
        }
    }
    if (couplings.polar()) {
        // gamma1 lap u + gamma2 grad div u.
        team_.run(modes_.rows(), [&, gamma1 = gamma1, gamma2 = gamma2](std::size_t row) {
            fill_row(row, [&](std::size_t i, double qx, double qy) {
                const Displacement u = displacement(modes_, i, field);
                const double laplacian = -gamma1 * (qx * qx + qy * qy);
                const Complex divergence = -gamma2 * (qx * u.x + qy * u.y);
                return std::array{laplacian * u.x + qx * divergence, laplacian * u.y + qy * divergence};
            });
        });
        transform_.to_points(values_);
        for (std::size_t a = 0; a < values_.size(); ++a) {
            const rods::Direction n = rods::direction(poses, a);
            rates[a] += n.cosine * values_[a].im - n.sine * values_[a].re;
        }
    }
}

// The start of many rods: ModeMesh::add_steady.

namespace {

constexpr int most_harmonics = 48;
constexpr double least_term = 1e-13; // of a series

/// |r| of the header.
double ratio(double a) { return 1.0 / (std::sqrt(1.0 + a * a) + a); }

/// r^|k| over 2 sqrt(1 + a^2)
Complex term(double a, int k) {
    constexpr Complex powers_of_i[] = {{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
    return 0.5 * std::pow(ratio(a), k) / std::sqrt(1.0 + a * a) * powers_of_i[k & 3];
}

} // namespace

/// |r| of the part that decays more slowly, where the larger component of q is that of a mode.
double ModeMesh::largest_ratio(std::size_t row, std::size_t column) const {
    const double q = std::max(modes_.qx[row], std::abs(modes_.qy[column])), least = modes_.qx[1];
    const std::size_t first = modes_.columns() / 2 + 1; // of q = least
    const double decay = std::min(modes_.decay_longitudinal[first], modes_.decay_transverse[first]);
    return ratio(q * decay / (least * least));
}

/// Whether a mode is in the square of those with too long a series.
bool ModeMesh::summed(std::size_t row, std::size_t column) const {
    return std::pow(largest_ratio(row, column), most_harmonics) > least_term;
}

/// The first of the columns that are summed.
std::size_t ModeMesh::first_summed() const {
    std::size_t first = modes_.columns() / 2;
    while (first > 0 && summed(0, first - 1))
        --first;
    return first;
}

void ModeMesh::add_harmonic_row(std::size_t row, int k, std::span<double> field) const {
    const std::size_t columns = modes_.columns(), half = modes_.rows() - 1, size = modes_.size();
    const std::span<const Complex> sums = transform_.modes();
    for (std::size_t column = 0, i = row * columns; column < columns; ++column, ++i) {
        if (modes_.force[i] == 0.0 || summed(row, column))
            continue;
        const double q = std::hypot(modes_.qx[row], modes_.qy[column]);
        const double a_l = modes_.decay_longitudinal[i] / q, a_t = modes_.decay_transverse[i] / q;
        if (k > 1 && std::pow(ratio(std::min(a_l, a_t)), k - 1) < least_term)
            continue;
        const double angle = k * std::atan2(modes_.unit_y[i], modes_.unit_x[i]);
        const Complex back{std::cos(angle), -std::sin(angle)}, forth{back.re, -back.im};
        const Complex plus = back * sums[(half + row) * columns + column];
        const Complex partner = sums[(half - row) * columns + columns - 1 - column];
        const Complex minus = forth * Complex{partner.re, -partner.im}; // of harmonic -k
        const double f = modes_.force[i] / q;
        const Complex along = term(a_l, std::abs(k - 1)) + term(a_l, k + 1);
        const Complex across = -1.0 * times_i(term(a_t, std::abs(k - 1)) - term(a_t, k + 1));
        const Complex l = f * (along * (k == 0 ? plus : plus + minus));
        const Complex t = k == 0 ? Complex{} : f * (across * (plus - minus));
        field[i] += l.re;
        field[size + i] += l.im;
        field[2 * size + i] += t.re;
        field[3 * size + i] += t.im;
    }
}

void ModeMesh::add_steady(integrate::State poses, std::span<double> field) {
    // Modes with too long a series are summed over rods.
    constexpr std::size_t block = 128; // whose phases fit into memory
    const std::size_t columns = modes_.columns(), first = first_summed(), rods = poses.size() / 3;
    std::vector<PhaseFactors> px(block), py(block);
    for (std::size_t start = 0; start < rods; start += block) {
        const std::size_t count = std::min(block, rods - start);
        team_.run(count, [&](std::size_t k) {
            px[k] = phases(modes_.qx, -poses[3 * (start + k)]);
            py[k] = phases(modes_.qy, -poses[3 * (start + k) + 1]);
        });
        team_.run(modes_.rows(), [&](std::size_t row) {
            for (std::size_t k = 0; k < count && summed(row, columns / 2); ++k)
                modes_.add_steady_row(row, first, columns - first, rods::pose(poses, start + k), px[k], py[k],
                                      field);
        });
    }
    if (first == 0)
        return;

    // The others by their series.
    place(poses);
    values_.resize(poses.size() / 3);
    const double slowest = largest_ratio(0, first - 1); // of the series
    for (int k = 0; k < 2 || std::pow(slowest, k - 1) > least_term; ++k) {
        for (std::size_t a = 0; a < values_.size(); ++a)
            values_[a] = {std::cos(k * poses[3 * a + 2]), std::sin(k * poses[3 * a + 2])};
        transform_.to_modes(values_);
        team_.run(modes_.rows(), [&](std::size_t row) { add_harmonic_row(row, k, field); });
    }
}

} // namespace rodwake::medium
