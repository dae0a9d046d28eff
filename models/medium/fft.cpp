#include "fft.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace rodwake::medium {

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
