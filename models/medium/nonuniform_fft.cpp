#include "nonuniform_fft.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::medium {

namespace {

constexpr std::size_t slab_rows = 16;
constexpr double oversampling = 1.5; // grid points a mode, at least
constexpr auto points = static_cast<double>(NonuniformFft::width);

/// 0.97 pi width (1 - 1/(2 oversampling)), Barnett et al., Eq. 4.5.
constexpr double beta = 0.97 * std::numbers::pi * points * (1.0 - 0.5 / oversampling);

double kernel(double s) {
    const double inside = 1.0 - s * s;
    return inside > 0.0 ? std::exp(beta * (std::sqrt(inside) - 1.0)) : 0.0;
}

/// (width/2) int_-1^1 kernel(s) cos(pi m width s/grid) ds; s = sin t has no root at the ends, and there the
/// kernel is below 1e-15, so that the trapezoidal rule converges exponentially.
double transform(double m, double grid) {
    constexpr int panels = 200;
    constexpr double step = std::numbers::pi / panels;
    double sum = 0.0;
    for (int k = 1; k < panels; ++k) {
        const double t = -0.5 * std::numbers::pi + k * step, s = std::sin(t);
        sum += kernel(s) * std::cos(t) * std::cos(std::numbers::pi * m * points * s / grid);
    }
    return 0.5 * points * step * sum;
}

/// First grid point that the kernel covers, for a point at `at` grid spacings, and its values from there on.
std::uint32_t cover(double at, std::size_t grid, std::array<double, NonuniformFft::width>& values) {
    const double wrapped = at - static_cast<double>(grid) * std::floor(at / static_cast<double>(grid));
    const double first = std::ceil(wrapped - 0.5 * points);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = kernel((first + static_cast<double>(i) - wrapped) / (0.5 * points));
    const double row = first < 0.0 ? first + static_cast<double>(grid) : first;
    return static_cast<std::uint32_t>(row) % static_cast<std::uint32_t>(grid);
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

NonuniformFft::NonuniformFft(double box, std::size_t half, Team& team)
    : half_(half), side_(2 * half + 1),
      fft_(Fft::suitable(std::max(static_cast<std::size_t>(oversampling * static_cast<double>(side_)) + 1,
                                  2 * width + slab_rows))),
      team_(team), modes_(side_ * side_), between_(grid() * side_), grid_(grid() * grid()),
      slabs_((grid() + slab_rows - 1) / slab_rows) {
    const auto size = static_cast<double>(grid());
    per_length_ = size / box;
    inverse_.reserve(side_);
    for (std::size_t m = 0; m < side_; ++m)
        inverse_.push_back(1.0 / transform(static_cast<double>(m) - static_cast<double>(half), size));
}

void NonuniformFft::place(std::span<const double> places) {
    places_.resize(places.size() / 3);
    constexpr std::size_t block = 64;
    team_.run((places_.size() + block - 1) / block, [&](std::size_t first) {
        for (std::size_t a = first * block; a < std::min((first + 1) * block, places_.size()); ++a) {
            places_[a].row = cover(places[3 * a] * per_length_, grid(), places_[a].x);
            places_[a].column = cover(places[3 * a + 1] * per_length_, grid(), places_[a].y);
        }
    });
    for (auto& slab : slabs_)
        slab.clear();
    for (std::size_t a = 0; a < places_.size(); ++a)
        for (std::size_t i = 0, last = slabs_.size(); i < width; ++i)
            if (const std::size_t slab = (places_[a].row + i) % grid() / slab_rows; slab != last) {
                slabs_[slab].push_back(static_cast<std::uint32_t>(a));
                last = slab;
            }
}

void NonuniformFft::spread_rows(std::size_t slab, std::span<const Complex> weights) {
    const std::size_t n = grid(), first = slab * slab_rows, last = std::min(first + slab_rows, n);
    std::fill(grid_.begin() + static_cast<std::ptrdiff_t>(first * n),
              grid_.begin() + static_cast<std::ptrdiff_t>(last * n), Complex{});
    for (const std::uint32_t a : slabs_[slab]) {
        const Place& place = places_[a];
        const std::size_t straight = std::min(width, n - place.column); // before the grid's end
        for (std::size_t i = 0; i < width; ++i) {
            const std::size_t row = (place.row + i) % n;
            if (row < first || row >= last)
                continue;
            const Complex weight = place.x[i] * weights[a];
            Complex *to = &grid_[row * n + place.column], *wrapped = &grid_[row * n];
            for (std::size_t j = 0; j < straight; ++j)
                to[j] = to[j] + place.y[j] * weight;
            for (std::size_t j = straight; j < width; ++j)
                wrapped[j - straight] = wrapped[j - straight] + place.y[j] * weight;
        }
    }
}

Complex NonuniformFft::read(const Place& place) const {
    const std::size_t n = grid(), straight = std::min(width, n - place.column);
    Complex sum;
    for (std::size_t i = 0; i < width; ++i) {
        const Complex *wrapped = &grid_[(place.row + i) % n * n], *from = wrapped + place.column;
        Complex line;
        for (std::size_t j = 0; j < straight; ++j)
            line = line + place.y[j] * from[j];
        for (std::size_t j = straight; j < width; ++j)
            line = line + place.y[j] * wrapped[j - straight];
        sum = sum + place.x[i] * line;
    }
    return sum;
}

void NonuniformFft::lines_to_modes(std::size_t first) {
    const std::size_t n = grid(), count = std::min(Fft::lanes, n - first);
    Lines& work = lines(n);
    for (std::size_t lane = 0; lane < Fft::lanes; ++lane)
        for (std::size_t j = 0; j < n; ++j)
            set_lane(work.data[j], lane, lane < count ? grid_[(first + lane) * n + j] : Complex{});
    fft_.transform(work.data, work.other);
    for (std::size_t lane = 0; lane < count; ++lane)
        for (std::size_t j = 0; j < side_; ++j)
            between_[(first + lane) * side_ + j] = lane_of(work.data[place_of(j)], lane);
}

void NonuniformFft::columns_to_modes(std::size_t first) {
    const std::size_t n = grid(), count = std::min(Fft::lanes, side_ - first);
    Lines& work = lines(n);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t lane = 0; lane < Fft::lanes; ++lane)
            set_lane(work.data[i], lane, lane < count ? between_[i * side_ + first + lane] : Complex{});
    fft_.transform(work.data, work.other);
    for (std::size_t i = 0; i < side_; ++i)
        for (std::size_t lane = 0; lane < count; ++lane)
            modes_[i * side_ + first + lane] =
                inverse_[i] * inverse_[first + lane] * lane_of(work.data[place_of(i)], lane);
}

void NonuniformFft::modes_to_columns(std::size_t first) {
    const std::size_t n = grid(), count = std::min(Fft::lanes, side_ - first);
    Lines& work = lines(n);
    std::ranges::fill(work.data, Fft::Element{Eigen::Array4d::Zero(), Eigen::Array4d::Zero()});
    for (std::size_t i = 0; i < side_; ++i)
        for (std::size_t lane = 0; lane < count; ++lane)
            set_lane(work.data[place_of(i)], lane,
                     swapped(inverse_[i] * inverse_[first + lane] * modes_[i * side_ + first + lane]));
    fft_.transform(work.data, work.other);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t lane = 0; lane < count; ++lane)
            between_[i * side_ + first + lane] = lane_of(work.data[i], lane); // still swapped
}

void NonuniformFft::lines_to_grid(std::size_t first) {
    const std::size_t n = grid(), count = std::min(Fft::lanes, n - first);
    Lines& work = lines(n);
    std::ranges::fill(work.data, Fft::Element{Eigen::Array4d::Zero(), Eigen::Array4d::Zero()});
    for (std::size_t lane = 0; lane < count; ++lane)
        for (std::size_t j = 0; j < side_; ++j)
            set_lane(work.data[place_of(j)], lane, between_[(first + lane) * side_ + j]);
    fft_.transform(work.data, work.other);
    for (std::size_t lane = 0; lane < count; ++lane)
        for (std::size_t j = 0; j < n; ++j)
            grid_[(first + lane) * n + j] = swapped(lane_of(work.data[j], lane));
}

void NonuniformFft::to_modes(std::span<const Complex> weights) {
    const auto blocks = [](std::size_t count) { return (count + Fft::lanes - 1) / Fft::lanes; };
    team_.run(slabs_.size(), [&](std::size_t slab) { spread_rows(slab, weights); });
    team_.run(blocks(grid()), [&](std::size_t k) { lines_to_modes(k * Fft::lanes); });
    team_.run(blocks(side_), [&](std::size_t k) { columns_to_modes(k * Fft::lanes); });
}

void NonuniformFft::to_points(std::span<Complex> values) {
    const auto blocks = [](std::size_t count) { return (count + Fft::lanes - 1) / Fft::lanes; };
    team_.run(blocks(side_), [&](std::size_t k) { modes_to_columns(k * Fft::lanes); });
    team_.run(blocks(grid()), [&](std::size_t k) { lines_to_grid(k * Fft::lanes); });
    constexpr std::size_t block = 64;
    team_.run((places_.size() + block - 1) / block, [&](std::size_t first) {
        for (std::size_t a = first * block; a < std::min((first + 1) * block, places_.size()); ++a)
            values[a] = read(places_[a]);
    });
}

namespace {

using Element = Fft::Element;

Element operator+(const Element& a, const Element& b) { return {a.re + b.re, a.im + b.im}; }
Element operator-(const Element& a, const Element& b) { return {a.re - b.re, a.im - b.im}; }
Element operator*(Complex w, const Element& a) {
    return {w.re * a.re - w.im * a.im, w.re * a.im + w.im * a.re};
}
/// -i a
Element turned_back(const Element& a) { return {a.im, -a.re}; }

template<std::size_t radix>
using Elements = std::array<Element, radix>;

Elements<2> short_transform(const Elements<2>& x) { return {x[0] + x[1], x[0] - x[1]}; }

Elements<3> short_transform(const Elements<3>& x) {
    constexpr double sine = 0.86602540378443864676; // of 60 degrees
    const Element sum = x[1] + x[2], across = turned_back(Complex{sine, 0.0} * (x[1] - x[2]));
    const Element middle = x[0] - Complex{0.5, 0.0} * sum;
    return {x[0] + sum, middle + across, middle - across};
}

Elements<4> short_transform(const Elements<4>& x) {
    const Element even = x[0] + x[2], odd = x[1] + x[3], d = x[0] - x[2], across = turned_back(x[1] - x[3]);
    return {even + odd, d + across, even - odd, d - across};
}

Elements<5> short_transform(const Elements<5>& x) {
    constexpr Complex c1{0.30901699437494742410, 0.0}, c2{-0.80901699437494742410, 0.0}; // cos 72, 144
    constexpr Complex s1{0.95105651629515357212, 0.0}, s2{0.58778525229247312917, 0.0};  // sin 72, 144
    const Element p1 = x[1] + x[4], m1 = x[1] - x[4], p2 = x[2] + x[3], m2 = x[2] - x[3];
    const Element a = x[0] + c1 * p1 + c2 * p2, b = x[0] + c2 * p1 + c1 * p2;
    const Element u = turned_back(s1 * m1 + s2 * m2), v = turned_back(s2 * m1 - s1 * m2);
    return {x[0] + p1 + p2, a + u, b + v, b - v, a - u};
}

/// One pass over sub-transforms of `length`, `stride` of them side by side.
template<std::size_t radix>
void pass(std::size_t length, std::size_t stride, const std::vector<Complex>& turns,
          const std::vector<Element>& from, std::vector<Element>& to) {
    const std::size_t part = length / radix;
    for (std::size_t p = 0; p < part; ++p) {
        std::array<Complex, radix> turn;
        for (std::size_t k = 0; k < radix; ++k)
            turn[k] = turns[k * p * stride];
        for (std::size_t q = 0; q < stride; ++q) {
            Elements<radix> x;
            for (std::size_t k = 0; k < radix; ++k)
                x[k] = from[q + stride * (p + part * k)];
            x = short_transform(x);
            to[q + stride * radix * p] = x[0];
            for (std::size_t k = 1; k < radix; ++k)
                to[q + stride * (radix * p + k)] = turn[k] * x[k];
        }
    }
}

/// What is left of `size` without its factors 2, 3 and 5.
std::size_t rest_of(std::size_t size) {
    for (const std::size_t prime : {2, 3, 5})
        while (size % prime == 0)
            size /= prime;
    return size;
}

} // namespace

Fft::Fft(std::size_t size) : size_(size) {
    if (size == 0 || rest_of(size) != 1)
        throw InputError(fmt::format("a transform of {} points: must be a product of 2, 3 and 5", size));
    for (const std::size_t radix : {4, 2, 3, 5})
        for (; size % radix == 0; size /= radix)
            radices_.push_back(radix);
    turns_.reserve(size_);
    for (std::size_t k = 0; k < size_; ++k) {
        const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(size_);
        turns_.push_back({std::cos(angle), -std::sin(angle)});
    }
}

void Fft::transform(std::vector<Element>& lines, std::vector<Element>& other) const {
    std::size_t length = size_, stride = 1;
    for (const std::size_t radix : radices_) {
        switch (radix) {
        case 2:
            pass<2>(length, stride, turns_, lines, other);
            break;
        case 3:
            pass<3>(length, stride, turns_, lines, other);
            break;
        case 4:
            pass<4>(length, stride, turns_, lines, other);
            break;
        default:
            pass<5>(length, stride, turns_, lines, other);
        }
        std::swap(lines, other);
        length /= radix;
        stride *= radix;
    }
}

std::size_t Fft::suitable(std::size_t least) {
    std::size_t size = least + least % 2;
    while (rest_of(size) != 1)
        size += 2;
    return size;
}

} // namespace rodwake::medium
