#pragma once
// Sums between points anywhere and the modes q = (2 pi/box)(m, n), |m|, |n| <= half, of a periodic square:
//
//   to_modes:   C_q = sum_a w_a e^(-i q.R_a)         to_points:   f_a = sum_q C_q e^(i q.R_a)
//
// Non-uniform fast Fourier transform: points are spread on (read off) a grid of at least 1.5 points a mode
// with the kernel e^(beta (sqrt(1 - s^2) - 1)), "exponential of semicircle", `width` points wide, whose
// transform is divided out of the modes (Barnett, Magland & af Klinteberg, SIAM J. Sci. Comput. 41, C479,
// 2019). Error: below 1e-12 of sum |w_a|, or of sum |C_q| (tests/medium/test_nonuniform_fft.cpp).
//
// Bits do not depend on the threads: each grid point adds up its points in their order. Cost: some
// 5 grid^2 log2(grid^2) operations and width^2 a point.

#include "fft.hpp"
#include "rodwake/core/parallel.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace rodwake::medium {

class NonuniformFft {
public:
    static constexpr std::size_t width = 18;

    /// `team` outlives it.
    NonuniformFft(double box, std::size_t half, Team& team);

    std::size_t grid() const { return fft_.size(); } ///< points a side
    std::size_t side() const { return side_; }       ///< modes a side, 2 half + 1

    /// Where the points are: x and y of point a are places[3 a] and places[3 a + 1] (layout of poses).
    void place(std::span<const double> places);

    /// C_q of the last placed points, at (m + half) side() + n + half.
    std::span<Complex> modes() { return modes_; }
    std::span<const Complex> modes() const { return modes_; }
    void to_modes(std::span<const Complex> weights);
    /// From modes().
    void to_points(std::span<Complex> values);

private:
    using Kernel = std::array<double, width>;
    struct Place {
        std::uint32_t row, column; ///< the first that the kernel covers
        Kernel x, y;
    };

    void spread_rows(std::size_t slab, std::span<const Complex> weights);
    Complex read(const Place& place) const;
    void lines_to_modes(std::size_t first);
    void columns_to_modes(std::size_t first);
    void modes_to_columns(std::size_t first);
    void lines_to_grid(std::size_t first);
    /// Row or column of mode `index` - half.
    std::size_t place_of(std::size_t index) const {
        return index >= half_ ? index - half_ : grid() + index - half_;
    }

    double per_length_; ///< grid points per length
    std::size_t half_, side_;
    Fft fft_;
    Team& team_;
    std::vector<double> inverse_;  ///< 1/transform of the kernel at each mode of a side
    std::vector<Complex> modes_;   ///< side x side
    std::vector<Complex> between_; ///< grid x side: one direction transformed
    std::vector<Complex> grid_;    ///< grid x grid
    std::vector<Place> places_;
    std::vector<std::vector<std::uint32_t>> slabs_; ///< points that reach into these rows of the grid
};

} // namespace rodwake::medium
