#pragma once
// Complex numbers of transforms and exponential integrators.

namespace rodwake::fourier {

/// A complex number; of std::complex a product also looks for infinities, at several times the cost.
struct Complex {
    double re = 0.0, im = 0.0;

    friend Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
    friend Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
    friend Complex operator*(Complex a, Complex b) {
        return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
    }
    friend Complex operator*(double a, Complex b) { return {a * b.re, a * b.im}; }
};

} // namespace rodwake::fourier
