#pragma once
// Discrete Fourier transforms of short lines, four side by side:
//
//   X_k = sum_j x_j e^(-2 pi i j k/n),   n = 2^a 3^b 5^c
//
// Stockham's self-sorting algorithm with radices 4, 2, 3 and 5 (Swarztrauber, Parallel Comput. 1, 45, 1984;
// Van Loan, Computational Frameworks for the FFT, SIAM 1992, 1.7). Error: some 1e-16 sqrt(log n) of the root
// mean square of the x_j. Thread-safe.

#include "phi.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace rodwake::medium {

class Fft {
public:
    static constexpr std::size_t lanes = 4;
    /// The same element of each line.
    struct Element {
        Eigen::Array<double, lanes, 1> re, im;
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
    const auto i = static_cast<Eigen::Index>(lane);
    element.re[i] = value.re;
    element.im[i] = value.im;
}
inline Complex lane_of(const Fft::Element& element, std::size_t lane) {
    const auto i = static_cast<Eigen::Index>(lane);
    return {element.re[i], element.im[i]};
}

} // namespace rodwake::medium
