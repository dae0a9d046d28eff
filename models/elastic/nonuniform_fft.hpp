#pragma once
// Sums between points anywhere and the modes q = (2 pi/box)(m, n), |m|, |n| <= half, of a periodic square:
//
//   to_modes:   C_q = sum_a w_a e^(-i q.R_a)         to_points:   f_a = sum_q C_q e^(i q.R_a)
//
// Non-uniform fast Fourier transform: points are spread on (read off) a grid of at least 1.5 points a mode
// with the kernel e^(beta (sqrt(1 - s^2) - 1)), "exponential of semicircle", 18 points wide, whose
// transform is divided out of the modes (Barnett, Magland & af Klinteberg, SIAM J. Sci. Comput. 41, C479,
// 2019). Between grid points the kernel is a polynomial of degree 22 for each of its points. Error: below
// 1e-12 of sum |w_a|, or of sum |C_q| (tests/elastic/test_nonuniform_fft.cpp).
//
// Bits do not depend on the threads, since each grid point adds up its points in their order, nor on the
// vectors of a machine. Cost: some 5 grid^2 log2(grid^2) operations and width^2 a point.

#include "complex.hpp"
#include "rodwake/core/parallel.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace rodwake::fourier {

// Discrete Fourier transforms of short lines, eight side by side:
//
//   X_k = sum_j x_j e^(-2 pi i j k/n),   n = 2^a 3^b 5^c
//
// Stockham's self-sorting algorithm with radices 4, 2, 3 and 5 (Swarztrauber, Parallel Comput. 1, 45, 1984;
// Van Loan, Computational Frameworks for the FFT, SIAM 1992, 1.7). Error: some 1e-16 sqrt(log n) of the root
// mean square of the x_j. Thread-safe.

class Fft {
public:
    static constexpr std::size_t lanes = 8;
    /// The same element of each line.
    struct alignas(64) Element {
        double re[lanes], im[lanes];
    };

    /// Throws InputError if another prime than 2, 3 and 5 divides `size` > 0.
    explicit Fft(std::size_t size);

    std::size_t size() const { return size_; }
    /// Replaces size() elements by their transform; `other` is working space of as many. The sum with +i
    /// comes of swapping real and imaginary parts before and after.
    void transform(std::vector<Element>& lines, std::vector<Element>& other) const;

    /// The least even size of at least `least` that can be had.
    static std::size_t suitable(std::size_t least);

private:
    std::size_t size_;
    std::vector<std::size_t> radices_;
    std::vector<Complex> turns_; ///< e^(-2 pi i k/n)
};

inline void set_lane(Fft::Element& element, std::size_t lane, Complex value) {
    element.re[lane] = value.re;
    element.im[lane] = value.im;
}
inline Complex lane_of(const Fft::Element& element, std::size_t lane) {
    return {element.re[lane], element.im[lane]};
}

/// Coefficients by powers of u of the polynomial through f at as many Chebyshev points.
std::vector<double> powers_of(std::size_t terms, const std::function<double(double)>& f);

/// The kernel as polynomials in u = 2 z - 1, where z in [0, 1) is how far the first point that it covers lies
/// beyond its edge. Rows are filled up to whole vectors with zeros.
class SpreadKernel {
public:
    static constexpr std::size_t width = 18, row = 24, pairs = 40;

    SpreadKernel();

    std::size_t terms() const { return values_.size() / row; }
    /// Coefficient k of the points of a row, and with each point twice, for its real and imaginary part.
    const double* values(std::size_t k) const { return values_.data() + k * row; }
    const double* twice(std::size_t k) const { return twice_.data() + k * pairs; }
    /// (width/2) int_-1^1 kernel(s) cos(pi m width s/grid) ds
    double transform(double m, double grid) const;

private:
    std::vector<double> values_, twice_;
    std::vector<std::array<double, 2>> quadrature_; ///< places s and weights of the transform
};

/// Where points lie on a grid of `grid` points a side, and what the kernel is there.
struct SpreadPlaces {
    std::size_t grid;
    std::vector<std::uint32_t> first_row, first_column;
    std::vector<double> x, y; ///< y: each number twice

    void resize(std::size_t count);
};

class NonuniformFft {
public:
    /// `team` outlives it.
    NonuniformFft(double box, std::size_t half, ThreadPool& team);

    std::size_t grid() const { return fft_.size(); } ///< points a side
    std::size_t side() const { return side_; }       ///< modes a side, 2 half + 1
    static std::size_t grid_of(std::size_t half);

    /// Where the points are: x and y of point a are places[3 a] and places[3 a + 1] (layout of poses).
    void place(std::span<const double> positions);

    /// C_q of the last placed points, at (m + half) side() + n + half.
    std::span<Complex> modes() { return modes_; }
    std::span<const Complex> modes() const { return modes_; }
    void to_modes(std::span<const Complex> weights);
    /// From modes().
    void to_points(std::span<Complex> values);

private:
    /// Row or column of mode `index` - half.
    std::size_t place_of(std::size_t index) const {
        return index >= half_ ? index - half_ : grid() + index - half_;
    }
    /// Numbers of a line of the grid: its end stands for its beginning once more, as far as a point reaches.
    std::size_t line() const { return grid() + SpreadKernel::pairs / 2; }

    double per_length_; ///< grid points per length
    std::size_t half_, side_;
    SpreadKernel kernel_;
    Fft fft_;
    ThreadPool& team_;
    std::vector<double> inverse_;  ///< 1/transform of the kernel at each mode of a side
    std::vector<Complex> modes_;   ///< side x side
    std::vector<Complex> between_; ///< grid x side: one direction transformed
    std::vector<Complex> grid_;    ///< grid x line
    SpreadPlaces places_;
    std::vector<std::vector<std::uint32_t>> slabs_; ///< points that reach into these rows of the grid
};

// By vectors (nonuniform_points.cpp).

/// Places of points `first` to `last` from their coordinates in grid points; layout of poses.
void cover_points(const SpreadKernel& kernel, double per_length, std::span<const double> poses,
                  std::size_t first, std::size_t last, SpreadPlaces& positions);
/// Adds a weighted point to rows of the grid from `begin` to `end`.
void spread_point(const SpreadPlaces& places, std::size_t point, Complex weight, std::size_t begin,
                  std::size_t end, std::size_t line, Complex* grid);
Complex read_point(const SpreadPlaces& places, std::size_t point, std::size_t line, const Complex* grid);

} // namespace rodwake::fourier
