#include "elastic/nonuniform_fft.hpp"
#include "mode_displacement.hpp"
#include "rodwake/medium/film.hpp"

#include <vector>

namespace rodwake::medium {

namespace {

/// Both transforms of a square of complex numbers with e^(+2 pi i j k/n), line by line and then across.
void transform_square(std::vector<Complex>& square, std::size_t points) {
    fourier::Fft fft(points);
    std::vector<fourier::Fft::Element> data(points), other(points);
    for (const bool across : {false, true}) {
        // Lines `apart` from each other, their elements `step`.
        const std::size_t apart = across ? 1 : points, step = across ? points : 1;
        for (std::size_t first = 0; first < points; first += fourier::Fft::lanes) {
            const std::size_t count = std::min(fourier::Fft::lanes, points - first);
            for (std::size_t j = 0; j < points; ++j)
                for (std::size_t lane = 0; lane < fourier::Fft::lanes; ++lane) {
                    const Complex value =
                        lane < count ? square[(first + lane) * apart + j * step] : Complex{};
                    // parts swapped before and after change the sign of the exponent
                    set_lane(data[j], lane, {value.im, value.re});
                }
            fft.transform(data, other);
            for (std::size_t j = 0; j < points; ++j)
                for (std::size_t lane = 0; lane < count; ++lane) {
                    const Complex value = lane_of(data[j], lane);
                    square[(first + lane) * apart + j * step] = {value.im, value.re};
                }
        }
    }
}

/// Where a wave number -n ... n stands in a transform of `points`.
std::size_t folded(std::ptrdiff_t n, std::size_t points) {
    const auto size = static_cast<std::ptrdiff_t>(points);
    return static_cast<std::size_t>((n % size + size) % size);
}

} // namespace

FieldGrid::FieldGrid(std::size_t points) : points_(fourier::Fft(points).size()) {}

void FieldGrid::evaluate(const ModalField& modes, std::span<const double> field, std::span<double> ux,
                         std::span<double> uy) const {
    std::vector<Complex> square(points_ * points_); // [j][i] of u_x + i u_y
    const auto half = static_cast<std::ptrdiff_t>(modes.rows() - 1);
    const auto columns = static_cast<std::ptrdiff_t>(modes.columns());
    for (std::ptrdiff_t m = 0; m <= half; ++m)
        for (std::ptrdiff_t n = m == 0 ? 1 : -half; n <= half; ++n) {
            const Displacement u =
                displacement(modes, static_cast<std::size_t>(m * columns + n + half), field);
            // the corner of the grid is -(box, box)/2: e^(i q.corner) = (-1)^(m + n)
            const double sign = (m + n) % 2 == 0 ? 1.0 : -1.0;
            Complex& plus = square[folded(n, points_) * points_ + folded(m, points_)];
            plus = plus + sign * (u.x + times_i(u.y));
            Complex& minus = square[folded(-n, points_) * points_ + folded(-m, points_)];
            minus = minus + sign * (conjugate(u.x) + times_i(conjugate(u.y)));
        }
    transform_square(square, points_);
    for (std::size_t k = 0; k < square.size(); ++k) {
        ux[k] = square[k].re;
        uy[k] = square[k].im;
    }
}

} // namespace rodwake::medium
