#include "nonuniform_fft.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::fourier {

namespace {

constexpr std::size_t slab_rows = 16;
constexpr double oversampling = 1.5; // grid points a mode, at least

/// 0.97 pi width (1 - 1/(2 oversampling)), Barnett et al., Eq. 4.5.
constexpr double shape =
    0.97 * std::numbers::pi * static_cast<double>(SpreadKernel::width) * (1.0 - 0.5 / oversampling);

double kernel(double s) {
    const double inside = 1.0 - s * s;
    return inside > 0.0 ? std::exp(shape * (std::sqrt(inside) - 1.0)) : 0.0;
}

/// Working space that each thread keeps: lines of `size`.
struct Lines {
    std::vector<Fft::Element> data, other;
};
Lines& lines(std::size_t size) {
    thread_local Lines kept;
    kept.data.resize(size);
    kept.other.resize(size);
    return kept;
}

/// What makes of the transform the one with the other sign, before and after it.
Complex swapped(Complex value) { return {value.im, value.re}; }

} // namespace

std::vector<double> powers_of(std::size_t terms, const std::function<double(double)>& f) {
    const auto n = static_cast<double>(terms);
    std::vector<double> sum(terms), before(terms), now(terms), next(terms);
    now[0] = 1.0; // of T_0
    for (std::size_t k = 0; k < terms; ++k) {
        double c = 0.0;
        for (std::size_t j = 0; j < terms; ++j) {
            const double angle = std::numbers::pi * (static_cast<double>(j) + 0.5) / n;
            c += f(std::cos(angle)) * std::cos(static_cast<double>(k) * angle) * (k == 0 ? 1.0 : 2.0) / n;
        }
        for (std::size_t j = 0; j < terms; ++j) {
            sum[j] += c * now[j];
            next[j] = (j > 0 ? (k == 0 ? 1.0 : 2.0) * now[j - 1] : 0.0) - (k == 0 ? 0.0 : before[j]);
        }
        before = now;
        now = next;
    }
    return sum;
}

SpreadKernel::SpreadKernel() : values_((width + 5) * row), twice_((width + 5) * pairs) {
    constexpr double wide = 0.5 * static_cast<double>(width);
    for (std::size_t i = 0; i < width; ++i) {
        const std::vector<double> c = powers_of(terms(), [&](double u) {
            return kernel((static_cast<double>(i) + 0.5 * (u + 1.0)) / wide - 1.0);
        });
        for (std::size_t k = 0; k < terms(); ++k)
            values_[k * row + i] = twice_[k * pairs + 2 * i] = twice_[k * pairs + 2 * i + 1] = c[k];
    }
    // s = sin t has no root at the ends, and there the kernel is small, so that the trapezoidal rule
    // converges exponentially
    constexpr int panels = 60;
    constexpr double step = std::numbers::pi / panels;
    for (int k = 1; k < panels; ++k) {
        const double t = -0.5 * std::numbers::pi + k * step, s = std::sin(t);
        quadrature_.push_back({s, wide * step * kernel(s) * std::cos(t)});
    }
}

double SpreadKernel::transform(double m, double grid) const {
    double sum = 0.0;
    for (const auto& [s, weight] : quadrature_)
        sum += weight * std::cos(std::numbers::pi * m * static_cast<double>(width) * s / grid);
    return sum;
}

void SpreadPlaces::resize(std::size_t count) {
    first_row.resize(count);
    first_column.resize(count);
    x.resize(count * SpreadKernel::row);
    y.resize(count * SpreadKernel::pairs);
}

std::size_t NonuniformFft::grid_of(std::size_t half) {
    const auto modes = static_cast<double>(2 * half + 1);
    return Fft::suitable(
        std::max(static_cast<std::size_t>(oversampling * modes) + 1, 2 * SpreadKernel::width + slab_rows));
}

NonuniformFft::NonuniformFft(double box, std::size_t half, ThreadPool& team)
    : half_(half), side_(2 * half + 1), fft_(grid_of(half)), team_(team), modes_(side_ * side_),
      between_(grid() * side_), places_{grid(), {}, {}, {}, {}},
      slabs_((grid() + slab_rows - 1) / slab_rows) {
    grid_.resize(grid() * line());
    const auto size = static_cast<double>(grid());
    per_length_ = size / box;
    inverse_.reserve(side_);
    for (std::size_t m = 0; m < side_; ++m)
        inverse_.push_back(1.0 / kernel_.transform(static_cast<double>(m) - static_cast<double>(half), size));
}

void NonuniformFft::place(std::span<const double> positions) {
    const std::size_t count = positions.size() / 3;
    places_.resize(count);
    constexpr std::size_t block = 64;
    team_.run((count + block - 1) / block, [&](std::size_t k) {
        cover_points(kernel_, per_length_, positions, k * block, std::min((k + 1) * block, count), places_);
    });
    for (auto& slab : slabs_)
        slab.clear();
    const auto give = [&](std::size_t point, std::size_t first_row, std::size_t last_row) {
        for (std::size_t slab = first_row / slab_rows; slab <= last_row / slab_rows; ++slab)
            slabs_[slab].push_back(static_cast<std::uint32_t>(point));
    };
    for (std::size_t a = 0; a < count; ++a) {
        const std::size_t first = places_.first_row[a], end = first + SpreadKernel::width;
        give(a, first, std::min(end, grid()) - 1);
        if (end > grid()) // the grid is longer than a kernel and a slab: not the same one
            give(a, 0, end - grid() - 1);
    }
}

void NonuniformFft::to_modes(std::span<const Complex> weights) {
    const std::size_t n = grid(), blocks_of_grid = (n + Fft::lanes - 1) / Fft::lanes,
                      blocks_of_modes = (side_ + Fft::lanes - 1) / Fft::lanes;
    team_.run(slabs_.size(), [&](std::size_t slab) { // spread the points on rows of the grid
        const std::size_t begin = slab * slab_rows, end = std::min(begin + slab_rows, n);
        std::fill(grid_.begin() + static_cast<std::ptrdiff_t>(begin * line()),
                  grid_.begin() + static_cast<std::ptrdiff_t>(end * line()), Complex{});
        for (const std::uint32_t a : slabs_[slab])
            spread_point(places_, a, weights[a], begin, end, line(), grid_.data());
        for (std::size_t row = begin; row < end; ++row)
            for (std::size_t j = n; j < line(); ++j) {
                Complex& wrapped = grid_[row * line() + j - n];
                wrapped = wrapped + grid_[row * line() + j];
            }
    });
    team_.run(blocks_of_grid, [&](std::size_t block) { // lines
        const std::size_t first = block * Fft::lanes, count = std::min(Fft::lanes, n - first);
        Lines& work = lines(n);
        for (std::size_t lane = 0; lane < Fft::lanes; ++lane)
            for (std::size_t j = 0; j < n; ++j)
                set_lane(work.data[j], lane, lane < count ? grid_[(first + lane) * line() + j] : Complex{});
        fft_.transform(work.data, work.other);
        for (std::size_t lane = 0; lane < count; ++lane)
            for (std::size_t j = 0; j < side_; ++j)
                between_[(first + lane) * side_ + j] = lane_of(work.data[place_of(j)], lane);
    });
    team_.run(blocks_of_modes, [&](std::size_t block) { // columns
        const std::size_t first = block * Fft::lanes, count = std::min(Fft::lanes, side_ - first);
        Lines& work = lines(n);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t lane = 0; lane < Fft::lanes; ++lane)
                set_lane(work.data[i], lane, lane < count ? between_[i * side_ + first + lane] : Complex{});
        fft_.transform(work.data, work.other);
        for (std::size_t i = 0; i < side_; ++i)
            for (std::size_t lane = 0; lane < count; ++lane)
                modes_[i * side_ + first + lane] =
                    inverse_[i] * inverse_[first + lane] * lane_of(work.data[place_of(i)], lane);
    });
}

void NonuniformFft::to_points(std::span<Complex> values) {
    const std::size_t n = grid(), blocks_of_grid = (n + Fft::lanes - 1) / Fft::lanes,
                      blocks_of_modes = (side_ + Fft::lanes - 1) / Fft::lanes;
    team_.run(blocks_of_modes, [&](std::size_t k) { // columns
        const std::size_t first = k * Fft::lanes, count = std::min(Fft::lanes, side_ - first);
        Lines& work = lines(n);
        std::ranges::fill(work.data, Fft::Element{});
        for (std::size_t i = 0; i < side_; ++i)
            for (std::size_t lane = 0; lane < count; ++lane)
                set_lane(work.data[place_of(i)], lane,
                         swapped(inverse_[i] * inverse_[first + lane] * modes_[i * side_ + first + lane]));
        fft_.transform(work.data, work.other);
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t lane = 0; lane < count; ++lane)
                between_[i * side_ + first + lane] = lane_of(work.data[i], lane); // still swapped
    });
    team_.run(blocks_of_grid, [&](std::size_t k) { // lines
        const std::size_t first = k * Fft::lanes, count = std::min(Fft::lanes, n - first);
        Lines& work = lines(n);
        std::ranges::fill(work.data, Fft::Element{});
        for (std::size_t lane = 0; lane < count; ++lane)
            for (std::size_t j = 0; j < side_; ++j)
                set_lane(work.data[place_of(j)], lane, between_[(first + lane) * side_ + j]);
        fft_.transform(work.data, work.other);
        for (std::size_t lane = 0; lane < count; ++lane) {
            Complex* const to = &grid_[(first + lane) * line()];
            for (std::size_t j = 0; j < n; ++j)
                to[j] = swapped(lane_of(work.data[j], lane));
            for (std::size_t j = n; j < line(); ++j)
                to[j] = to[j - n];
        }
    });
    constexpr std::size_t block = 64;
    team_.run((values.size() + block - 1) / block, [&](std::size_t first) {
        for (std::size_t a = first * block; a < std::min((first + 1) * block, values.size()); ++a)
            values[a] = read_point(places_, a, line(), grid_.data());
    });
}

} // namespace rodwake::fourier
