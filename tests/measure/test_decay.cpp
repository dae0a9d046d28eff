// The decay of g_B(r): fits of known curves with noise, their errors, and the class.

#include "measure/decay_fit.hpp"
#include "order_beds.hpp"
#include "rodwake/core/error.hpp"
#include "support/normal.hpp"

#include <catch2/catch.hpp>

#include <functional>
#include <limits>

using namespace rodwake;
using namespace rodwake::measure;
using order_beds::radius;

namespace {

const double box = 78.0 * radius;
using Curve = std::function<double(double)>;

/// Eight points from 8 a to 39 a with independent noise.
DecayPoints noisy(const Curve& curve, double noise, std::uint32_t trial, double box_or_0) {
    RandomStream random(5, trial);
    DecayPoints p;
    p.box = box_or_0;
    for (double r = 10.0; r < 39.0; r += 4.0) {
        p.r.push_back(r * radius);
        p.g_B.push_back(curve(r * radius) + noise * normal(random));
        p.error.push_back(noise);
    }
    return p;
}

Curve power(double eta, double box_or_0) {
    return [=](double r) {
        return 0.5 * algebraic_shape(r, eta, box_or_0) / algebraic_shape(8.0 * radius, eta, box_or_0);
    };
}
Curve exponential(double length, double box_or_0) {
    return [=](double r) { return exponential_shape(r, 1.0 / length, box_or_0); };
}
Curve constant(double value) {
    return [=](double) { return value; };
}

/// Share of the trials that are of this class.
double share(Decay wanted, const Curve& curve, double noise, double box_or_0, std::uint32_t trials) {
    double hits = 0.0;
    for (std::uint32_t trial = 0; trial < trials; ++trial)
        hits += classify(noisy(curve, noise, trial, box_or_0), 0.0).decay == wanted;
    return hits / trials;
}

/// Mean and standard deviation of (eta - truth)/error over trials.
std::pair<double, double> pulls(const std::function<DecayPoints(std::uint32_t)>& make, double truth,
                                int trials) {
    double sum = 0.0, square = 0.0;
    for (int t = 0; t < trials; ++t) {
        const Estimate eta = classify(make(static_cast<std::uint32_t>(t)), 0.0).exponent;
        REQUIRE(eta.known());
        const double pull = (eta.value - truth) / eta.error;
        sum += pull / trials;
        square += pull * pull / trials;
    }
    return {sum, std::sqrt(square - sum * sum)};
}

/// Twenty blocks whose points share most of their fluctuation; with each left out.
DecayPoints common_noise(const Curve& curve, double common, double own, std::uint32_t trial) {
    const std::size_t blocks = 20;
    DecayPoints p = noisy(curve, 1.0, 0, box);
    RandomStream random(6, trial);
    std::vector<std::vector<double>> g(blocks, std::vector<double>(p.r.size()));
    for (auto& block : g) {
        const double together = common * normal(random);
        for (std::size_t i = 0; i < p.r.size(); ++i)
            block[i] = curve(p.r[i]) + together + own * normal(random);
    }
    const double n = static_cast<double>(blocks);
    p.without.assign(blocks, std::vector<double>(p.r.size()));
    for (std::size_t i = 0; i < p.r.size(); ++i) {
        double mean = 0.0;
        for (const auto& block : g)
            mean += block[i] / n;
        for (std::size_t b = 0; b < blocks; ++b)
            p.without[b][i] = (n * mean - g[b][i]) / (n - 1.0);
        p.g_B[i] = mean;
        p.error[i] = std::hypot(common, own) / std::sqrt(n);
    }
    return p;
}

} // namespace

TEST_CASE("s is the mean of the box's Green's function over a circle", "[decay]") {
    // -(2 pi/L^2) sum J0(q r)/q^2, smeared over sigma = L/60, which shifts it by a constant but for
    // exp(-r^2/4 sigma^2)
    const auto green = [](double r) {
        double sum = 0.0;
        for (int m = 0; m <= 60; ++m)
            for (int n = m == 0 ? 1 : 0; n <= 60; ++n) {
                const double q = 2.0 * M_PI * std::hypot(m, n), smear = q / 60.0;
                const double images = (m == 0 || n == 0) ? 2.0 : 4.0;
                sum +=
                    images * 2.0 * M_PI * std::cyl_bessel_j(0.0, q * r) / (q * q) * std::exp(-smear * smear);
            }
        return -sum;
    };
    const double near = 0.12;
    for (const double r : {0.2, 0.35, 0.5}) {
        const double s = -std::log(algebraic_shape(r, 1.0, 1.0)) + std::log(algebraic_shape(near, 1.0, 1.0));
        CHECK(std::abs(s - (green(r) - green(near))) < 1e-5);                  // exp(-0.12^2 60^2/4) = 2e-6
        CHECK(std::abs(std::log(r / near) - (green(r) - green(near))) > 1e-2); // and not the plane's
    }
    CHECK(algebraic_shape(3.0, 0.2, 0.0) == Approx(std::pow(3.0, -0.2)).epsilon(1e-14));
}

TEST_CASE("the exponential of the box is the mean over a circle of all images", "[decay]") {
    for (const double rate : {0.1, 2.0, 10.0})
        for (const double r : {0.1, 0.3, 0.5}) {
            double sum = 0.0;
            for (int k = 0; k < 720; ++k)
                for (int m = -2; m <= 2; ++m)
                    for (int n = -2; n <= 2; ++n) {
                        const double angle = (k + 0.5) * M_PI / 360.0;
                        sum += std::exp(-rate * std::hypot(r * std::cos(angle) + m, r * std::sin(angle) + n));
                    }
            // 32 angles around: beyond that the images' variation has no share worth 1e-4
            CHECK(exponential_shape(r, rate, 1.0) == Approx(sum / 720.0).epsilon(1e-4));
        }
    CHECK(exponential_shape(0.3, 10.0, 0.0) == std::exp(-3.0));
}

TEST_CASE("fits recover what the curve was made of", "[decay]") {
    for (const double in : {0.0, box}) {
        for (const double eta : {0.1, 0.2, 0.6}) {
            const DecayClass c = classify(noisy(power(eta, in), 1e-9, 1, in), 0.0);
            CHECK(std::abs(c.exponent.value - eta) < 1e-7); // noise of 1e-9 over ln 5
        }
        for (const double length : {4.0, 12.0, 30.0}) {
            const DecayClass c = classify(noisy(exponential(length * radius, in), 1e-9, 1, in), 0.0);
            CHECK(std::abs(c.length.value / (length * radius) - 1.0) < 1e-5);
        }
    }
    const DecayClass c = classify(noisy(constant(0.7), 1e-9, 1, box), 0.0);
    CHECK(std::abs(c.plateau.value - 0.7) < 1e-8);
}

namespace {

void check_classes(std::uint32_t trials) {
    const double one = 1.0 / trials; // a single trial may fall out where nearly all are required
    for (const double in : {0.0, box}) {
        const auto is = [&](Decay wanted, const Curve& curve, double least) {
            CHECK(share(wanted, curve, 0.002, in, trials) >= std::min(least, 1.0 - one));
        };
        for (const double length : {3.0, 8.0, 15.0}) // xi well within the range; errors as of real beds
            is(Decay::exponential, exponential(length * radius, in), 0.98);
        for (const double eta : {0.05, 0.1, 0.15, 0.2})
            is(Decay::algebraic, power(eta, in), 0.98);
        // at the bound itself: hexatic unless noise pushes eta beyond its error, one time in six
        is(Decay::algebraic, power(0.25, in), 0.83 - 3.5 * std::sqrt(0.14 / trials));
        is(Decay::exponential, power(0.35, in), 0.98);
        // eta of a constant is above 0 by 2 errors one time in 44; 3 sigma
        is(Decay::long_range, constant(0.6), 0.977 - 3.0 * std::sqrt(0.022 / trials));
        is(Decay::exponential, constant(0.0), 0.99 - 3.0 * std::sqrt(0.01 / trials)); // P > 1 %
        CHECK(share(Decay::long_range, constant(0.6), 1e-6, in, trials) == 1.0);
        // the helper does not count everything
        CHECK(share(Decay::long_range, power(0.2, in), 0.002, in, trials) <= std::max(0.02, one));
    }
    CHECK(share(Decay::undetermined, constant(0.3), 0.1, box, trials) >= 0.5); // nothing can be said
    CHECK(share(Decay::long_range, constant(0.3), 0.1, box, trials) <= 0.1 + one);
}

/// Pulls of points that fluctuate together are of mean 0 and deviation 1, within 3.5 of their errors; 20
/// blocks know an error to 16 %, of which a mean is known better.
void check_jackknife(int trials) {
    const Curve curve = power(0.1, box);
    const auto jackknife = [&](std::uint32_t t) { return common_noise(curve, 0.05, 0.01, t); };
    const auto [mean, spread] = pulls(jackknife, 0.1, trials);
    CHECK(std::abs(mean) < 3.5 / std::sqrt(trials));
    CHECK(std::abs(spread - 1.0) < 3.5 / std::sqrt(2.0 * trials));
    const auto naive = [&](std::uint32_t t) {
        DecayPoints p = jackknife(t);
        p.without.clear();
        return p;
    };
    CHECK(pulls(naive, 0.1, trials / 4).second < 0.6); // without the jackknife
    DecayPoints slow = jackknife(0), fast = slow;
    slow.growth = 2.0;
    CHECK(classify(slow, 0.0).exponent.error ==
          Approx(2.0 * classify(fast, 0.0).exponent.error).epsilon(1e-12));
}

} // namespace

TEST_CASE("classes of known curves with noise", "[decay]") { check_classes(20); }

TEST_CASE("classes of known curves with noise, many trials", "[.long]") { check_classes(100); }

TEST_CASE("errors of the exponent are true for independent points", "[decay]") {
    const auto [mean, spread] =
        pulls([](std::uint32_t t) { return noisy(power(0.2, box), 0.003, t, box); }, 0.2, 150);
    CHECK(std::abs(mean) < 0.28);         // 3.5 sigma of a mean of 150
    CHECK(std::abs(spread - 1.0) < 0.20); // 3.5/sqrt(300)
}

TEST_CASE("errors of the exponent are true for points that fluctuate together", "[decay]") {
    check_jackknife(40);
}

TEST_CASE("errors of the exponent for points that fluctuate together, many trials", "[.long]") {
    check_jackknife(200);
}

TEST_CASE("too little to tell is said, and only unknown errors are NaN", "[decay]") {
    const auto said = [](const DecayPoints& p, double from) {
        const DecayClass c = classify(p, from);
        CHECK(c.decay == Decay::undetermined);
        CHECK_FALSE(c.reason.empty());
        CHECK(std::isfinite(c.exponent.value + c.length.value + c.plateau.value + c.chi2_algebraic +
                            c.chi2_exponential + c.chi2_constant));
        CHECK_FALSE((c.exponent.known() || c.length.known()));
        return c.points;
    };
    CHECK(said({}, 0.0) == 0);
    DecayPoints p = noisy(power(0.1, box), 0.002, 0, box);
    CHECK(said(p, 30.0 * radius) == 3);
    for (std::size_t i = 0; i < 5; ++i)
        p.error[i] = i % 2 == 0 ? -1.0 : 0.0;
    CHECK(said(p, 0.0) == 3);
    p.g_B.pop_back();
    CHECK_THROWS_AS(classify(p, 0.0), InputError);
    CHECK(
        classify(std::vector<double>{1.0}, std::vector<double>{1.0}, std::vector<double>{0.1}, 0.0).points ==
        1);
}

TEST_CASE("names of classes and phases", "[decay]") {
    CHECK(std::string(to_string(Decay::exponential)) + " " + phase_of(Decay::exponential) ==
          "exponential liquid");
    CHECK(std::string(to_string(Decay::algebraic)) + " " + phase_of(Decay::algebraic) == "algebraic hexatic");
    CHECK(std::string(to_string(Decay::long_range)) + " " + phase_of(Decay::long_range) ==
          "long-range crystal");
    CHECK(std::string(to_string(Decay::undetermined)) + " " + phase_of(Decay::undetermined) ==
          "undetermined undetermined");
}
