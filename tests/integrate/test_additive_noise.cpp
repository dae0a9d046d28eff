// Steps with additive noise against their orders, on paths of which all step lengths see the same.

#include "rodwake/core/rng.hpp"
#include "rodwake/integrate/additive_noise.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake::integrate;

namespace {

using Increments = std::array<PathIncrement, 2>;

struct Paths {
    double strength;
    std::uint32_t path;

    Normals normals(std::uint32_t node, std::uint32_t component) const {
        return normals_of(rodwake::philox_block({node, component + 1, path, 0}, {7, 0}));
    }
    Increments whole(double length) const {
        return {draw_increment(length, strength, normals(0, 0)),
                draw_increment(length, strength, normals(0, 1))};
    }
};

void rates(State y, std::span<double> ydot) {
    ydot[0] = 1.3 * std::sin(y[1]) - y[0];
    ydot[1] = std::cos(2.0 * y[0]);
}

/// y(2) of a path by 2^level steps.
class Descent {
public:
    Descent(Paths paths, int level) : paths_(paths), level_(level) { go(1, 0, 2.0, paths.whole(2.0)); }
    std::vector<double> y{0.3, 0.2};

private:
    void go(std::uint32_t node, int depth, double length, const Increments& whole) {
        if (depth == level_) {
            std::vector<double> k1(2);
            rates(y, k1);
            return step_.take(y, k1, length, whole);
        }
        Increments first, second;
        for (std::uint32_t i = 0; i < 2; ++i)
            std::tie(first[i], second[i]) =
                halves(whole[i], length, paths_.strength, paths_.normals(node, i));
        go(2 * node, depth + 1, 0.5 * length, first);
        go(2 * node + 1, depth + 1, 0.5 * length, second);
    }
    Paths paths_;
    int level_;
    AdditiveNoiseStep step_{rates, 2};
};

/// Slope of log error against log step by least squares, each step half of the one before.
double order(const std::vector<double>& errors) {
    const double n = static_cast<double>(errors.size()), middle = 0.5 * (n - 1.0);
    double up = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const double x = static_cast<double>(i) - middle;
        up -= x * std::log2(errors[i]);
        squares += x * x;
    }
    return up / squares;
}

struct Errors {
    std::vector<double> strong, weak; ///< rms of y0; mean of y0 + y1^2, for 2^3 .. 2^7 steps
};

Errors errors(double strength, std::uint32_t paths) {
    Errors found{std::vector<double>(5), std::vector<double>(5)};
    for (std::uint32_t path = 0; path < paths; ++path) {
        const auto fine = Descent({strength, path}, 10).y;
        for (int level = 3; level <= 7; ++level) {
            const auto y = Descent({strength, path}, level).y;
            const auto k = static_cast<std::size_t>(level - 3);
            found.strong[k] += (y[0] - fine[0]) * (y[0] - fine[0]) / paths;
            found.weak[k] += (y[0] + y[1] * y[1] - fine[0] - fine[1] * fine[1]) / paths;
        }
    }
    for (double& mean : found.strong)
        mean = std::sqrt(mean);
    for (double& mean : found.weak)
        mean = std::abs(mean);
    return found;
}

} // namespace

TEST_CASE("an increment and its halves have the law of a Brownian path, and the halves add up") {
    constexpr int draws = 20000;
    const double h = 0.7, s = 1.5, q = 0.5 * h;
    double ww = 0.0, wz = 0.0, zz = 0.0, first = 0.0, second = 0.0, across = 0.0, carried = 0.0;
    for (std::uint32_t path = 0; path < draws; ++path) {
        const Paths paths{s, path};
        const PathIncrement whole = draw_increment(h, s, paths.normals(0, 0));
        const auto [a, b] = halves(whole, h, s, paths.normals(1, 0));
        CHECK(std::abs(a.w + b.w - whole.w) < 1e-14 * (1.0 + std::abs(a.w)));
        CHECK(std::abs(a.z + b.z + q * a.w - whole.z) < 1e-14 * (1.0 + std::abs(a.w)));
        ww += whole.w * whole.w;
        wz += whole.w * whole.z;
        zz += whole.z * whole.z;
        first += a.z * a.z;
        second += b.w * b.z;
        across += a.w * b.w;
        carried += a.z * b.z;
    }
    // Products of Gaussians scatter by at most sqrt(2) of the product of their sizes: 4 standard errors.
    const double error = 4.0 * std::sqrt(2.0 / draws);
    CHECK(ww / draws == Approx(s * s * h).epsilon(error));
    CHECK(wz / draws == Approx(s * s * h * h / 2.0).epsilon(error * 2.0 / std::sqrt(3.0)));
    CHECK(zz / draws == Approx(s * s * h * h * h / 3.0).epsilon(error));
    CHECK(first / draws == Approx(s * s * q * q * q / 3.0).epsilon(error));
    CHECK(second / draws == Approx(s * s * q * q / 2.0).epsilon(error * 2.0 / std::sqrt(3.0)));
    CHECK(std::abs(across / draws) < error * s * s * q);
    CHECK(std::abs(carried / draws) < error * s * s * q * q * q / 3.0);
}

TEST_CASE("strong order 1.5 and weak order 2 with noise of order 1; order 4 without") {
    const Errors strong = errors(1.0, 400);
    CHECK(order(strong.strong) == Approx(1.5).margin(0.15)); // 1.55 over 2000 paths
    // The error of the mean over paths is its strong error over sqrt(400): seen at the long steps only.
    CHECK(order({strong.weak.begin(), strong.weak.begin() + 3}) > 1.5);
    CHECK(order(errors(0.0, 1).strong) == Approx(4.0).margin(0.3));
}

TEST_CASE("weak noise leaves an error of its strength times order 2") {
    const Errors weak = errors(0.02, 100);
    CHECK(order(weak.strong) == Approx(2.0).margin(0.25));
}
