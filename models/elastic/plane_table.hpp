#pragma once
// Where a place lies in the cells of a PlaneTable, and the polynomials there.

#include "rodwake/elastic/plane_table.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace rodwake::elastic {

inline constexpr std::size_t strain_components = 3, gradient_components = 6;

/// A CellTable with what is worked out once. Refers to the table.
class CellIndex {
public:
    CellIndex(const CellTable& table, int lowest_level, int degree, std::size_t components);

    struct LocatedCell {
        const double* coefficients; ///< null: exact
        double u, v;                ///< within the cell
        double scale;               ///< du/dx
    };
    /// Of a place in units of xi with y >= 0.
    LocatedCell find(double x, double y) const {
        const double m = std::max(std::abs(x), y);
        const int e = static_cast<int>(std::bit_cast<std::uint64_t>(m) >> 52U) - exponent_bias;
        const int k = e - lowest_;
        if (k < 0 || k >= static_cast<int>(levels_.size()))
            return {nullptr, 0.0, 0.0, 0.0};
        const Level& l = levels_[static_cast<std::size_t>(k)];
        const double i = (x + l.twice_unit) * l.per_length, j = y * l.per_length; // below 4 n and 2 n
        const int column = std::min(static_cast<int>(i), l.columns - 1);          // rounding may reach 4 n
        const int row = static_cast<int>(j);
        const std::int32_t number = l.polynomial_of[l.columns * row + column];
        return {number < 0 ? nullptr : coefficients_ + size_ * number, 2.0 * (i - column) - 1.0,
                2.0 * (j - row) - 1.0, 2.0 * l.per_length};
    }

private:
    static constexpr int exponent_bias = 1023;
    struct Level {
        double twice_unit, per_length; ///< 2 2^e, n/2^e
        int columns;                   ///< 4 n
        const std::int32_t* polynomial_of;
    };
    std::vector<Level> levels_;
    int lowest_;
    std::ptrdiff_t size_; ///< numbers of one polynomial
    const double* coefficients_;
};

/// Components and their derivatives by u and v.
template<std::size_t components>
struct CellValues {
    std::array<double, components> f{}, u{}, v{};
};

template<std::size_t components, int degree, bool derivatives>
CellValues<components> evaluate_cell(const double* c, double u, double v) {
    CellValues<components> sum;
    for (int i = degree; i >= 0; --i) {
        const double* row = c + static_cast<std::ptrdiff_t>(components) * (degree + 1) * i;
        std::array<double, components> p{}, slope{};
        for (int j = degree; j >= 0; --j)
            for (std::size_t k = 0; k < components; ++k) {
                if constexpr (derivatives)
                    slope[k] = slope[k] * v + p[k];
                p[k] = p[k] * v + row[components * j + k];
            }
        for (std::size_t k = 0; k < components; ++k) {
            if constexpr (derivatives) {
                sum.u[k] = sum.u[k] * u + sum.f[k];
                sum.v[k] = sum.v[k] * u + slope[k];
            }
            sum.f[k] = sum.f[k] * u + p[k];
        }
    }
    return sum;
}

template<std::size_t components, bool derivatives = false>
CellValues<components> evaluate_cell(int degree, const double* c, double u, double v) {
    switch (degree) {
    case 3:
        return evaluate_cell<components, 3, derivatives>(c, u, v);
    case 5:
        return evaluate_cell<components, 5, derivatives>(c, u, v);
    default:
        return evaluate_cell<components, 7, derivatives>(c, u, v);
    }
}

} // namespace rodwake::elastic
