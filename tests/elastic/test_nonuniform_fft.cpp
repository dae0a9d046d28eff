// Transforms against sums written out.

#include "elastic/nonuniform_fft.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

using namespace rodwake;
using namespace rodwake::fourier;

namespace {

using Number = std::complex<double>;

std::vector<double> random(std::size_t count, double from, double to) {
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> number(from, to);
    std::vector<double> values(count);
    for (double& value : values)
        value = number(generator);
    return values;
}

/// Places in all boxes around, some on grid points and on the box's sides.
std::vector<double> places(double box, std::size_t count) {
    std::vector<double> p = random(3 * count, -2.0 * box, 3.0 * box);
    p[0] = 0.0, p[1] = box, p[3] = -1e-17, p[4] = 0.5 * box;
    return p;
}

std::vector<Complex> weights(std::size_t count) {
    const std::vector<double> numbers = random(2 * count, -1.0, 1.0);
    std::vector<Complex> w;
    for (std::size_t a = 0; a < count; ++a)
        w.push_back({numbers[2 * a], numbers[2 * a + 1]});
    return w;
}

/// e^(-i q.R) of mode (m, n).
Number wave(double box, long m, long n, const std::vector<double>& at, std::size_t a) {
    const double unit = 2.0 * std::numbers::pi / box;
    return std::polar(1.0,
                      -unit * (static_cast<double>(m) * at[3 * a] + static_cast<double>(n) * at[3 * a + 1]));
}

Number number(Complex z) { return {z.re, z.im}; }

} // namespace

TEST_CASE("eight lines at once are transformed as their sums say") {
    for (const std::size_t n : {1, 2, 3, 4, 5, 6, 8, 10, 36, 54, 120, 128, 225}) {
        const Fft fft(n);
        const std::vector<double> values = random(16 * n, -1.0, 1.0);
        std::vector<Fft::Element> lines(n), other(n);
        for (std::size_t j = 0; j < n; ++j)
            for (std::size_t lane = 0; lane < 8; ++lane) {
                lines[j].re[lane] = values[16 * j + 2 * lane];
                lines[j].im[lane] = values[16 * j + 2 * lane + 1];
            }
        fft.transform(lines, other);
        double worst = 0.0;
        for (std::size_t k = 0; k < n; ++k)
            for (std::size_t lane = 0; lane < 8; ++lane) {
                Number sum;
                for (std::size_t j = 0; j < n; ++j)
                    sum += Number(values[16 * j + 2 * lane], values[16 * j + 2 * lane + 1]) *
                           std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(j * k % n) /
                                               static_cast<double>(n));
                worst = std::max(worst, std::abs(sum - Number(lines[k].re[lane], lines[k].im[lane])));
            }
        CAPTURE(n);
        CHECK(worst < 1e-14 * static_cast<double>(n)); // of sums of n numbers of order 1
    }
    CHECK_THROWS_AS(Fft(14), InputError);
    CHECK(Fft::suitable(13) == 16);
    CHECK(Fft::suitable(1535) == 1536);
}

TEST_CASE("sums over points and over modes are exact to 1e-12") {
    constexpr double box = 7.0;
    for (const std::size_t half : {1, 5, 24}) {
        ThreadPool team(1);
        NonuniformFft transform(box, half, team);
        const std::vector<double> at = places(box, 40);
        const std::vector<Complex> w = weights(40);
        transform.place(at);
        transform.to_modes(w);
        const auto side = static_cast<long>(transform.side()), h = static_cast<long>(half);
        const std::vector<Complex> found(transform.modes().begin(), transform.modes().end());
        double worst = 0.0;
        for (long m = -h; m <= h; ++m)
            for (long n = -h; n <= h; ++n) {
                Number sum;
                for (std::size_t a = 0; a < w.size(); ++a)
                    sum += number(w[a]) * wave(box, m, n, at, a);
                worst = std::max(
                    worst, std::abs(sum - number(found[static_cast<std::size_t>((m + h) * side + n + h)])));
            }
        CAPTURE(half, worst);
        CHECK(worst < 1e-12 * 40.0);

        const std::vector<Complex> modes = weights(transform.side() * transform.side());
        std::ranges::copy(modes, transform.modes().begin());
        std::vector<Complex> values(w.size());
        transform.to_points(values);
        worst = 0.0;
        for (std::size_t a = 0; a < w.size(); ++a) {
            Number sum;
            for (long m = -h; m <= h; ++m)
                for (long n = -h; n <= h; ++n)
                    sum += number(modes[static_cast<std::size_t>((m + h) * side + n + h)]) *
                           std::conj(wave(box, m, n, at, a));
            worst = std::max(worst, std::abs(sum - number(values[a])));
        }
        CAPTURE(worst);
        CHECK(worst < 1e-12 * static_cast<double>(modes.size()));
    }
}

TEST_CASE("threads change no bit of a transform", "[threads]") {
    std::vector<std::vector<double>> ends;
    for (const std::size_t threads : {1, 2, 3}) {
        ThreadPool team(threads);
        NonuniformFft transform(7.0, 20, team);
        transform.place(places(7.0, 300));
        transform.to_modes(weights(300));
        std::vector<double>& end = ends.emplace_back();
        for (const Complex mode : transform.modes())
            end.insert(end.end(), {mode.re, mode.im});
        std::vector<Complex> values(300);
        transform.to_points(values);
        for (const Complex value : values)
            end.insert(end.end(), {value.re, value.im});
    }
    CHECK(ends[1] == ends[0]);
    CHECK(ends[2] == ends[0]);
}
