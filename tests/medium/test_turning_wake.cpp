// What turning adds to a rod's field, against the field of a rod that has always walked a circle: mode by
// mode the integral over its past, by Simpson's rule.

#include "rodwake/medium/turning_wake.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

using Number = std::complex<double>;

const elastic::Medium elastic{0.7, 2.0}; // alpha = 1/2
constexpr DynamicMedium medium{.box = 8.0, .force_width = 1.0, .modes = 8};
constexpr rods::Pose rod{1.0, -2.0, 0.6};

/// Force on one mode, over f_q, of the rod as it was a time s ago.
struct Past {
    double qx, qy, ex, ey, rate;

    Number operator()(double s) const {
        const double then = rod.heading - rate * s;
        const double x = (std::sin(then) - std::sin(rod.heading)) / rate;
        const double y = (std::cos(rod.heading) - std::cos(then)) / rate;
        return (ex * std::cos(then) + ey * std::sin(then)) * std::exp(Number{0.0, -qx * x - qy * y});
    }
};

/// int_0^inf e^(-decay s) past(s) ds; the slowest decay here is 1.2, the fastest phase below 5.
Number integral(const Past& past, double decay) {
    constexpr int intervals = 4000;
    const double step = 30.0 / decay / intervals;
    Number sum;
    for (int i = 0; i <= intervals; ++i) {
        const double s = i * step, weight = i == 0 || i == intervals ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        sum += weight * std::exp(-decay * s) * past(s);
    }
    return sum * step / 3.0;
}

/// The field of a rod on a circle, as amplitudes of the modes.
std::vector<double> circle(const ModalField& modes, double rate) {
    std::vector<double> field(4 * modes.size());
    for (std::size_t i = 0; i < modes.size(); ++i) {
        const double qx = modes.qx()[i / modes.columns()], qy = modes.qy()[i % modes.columns()];
        const double ux = modes.unit_x()[i], uy = modes.unit_y()[i];
        const Number force = modes.force()[i] * std::exp(Number{0.0, -qx * rod.x - qy * rod.y});
        if (modes.force()[i] == 0.0)
            continue;
        const Number l = force * integral({qx, qy, ux, uy, rate}, modes.decay_longitudinal()[i]);
        const Number t = force * integral({qx, qy, -uy, ux, rate}, modes.decay_transverse()[i]);
        const std::array parts{l.real(), l.imag(), t.real(), t.imag()};
        for (std::size_t part = 0; part < 4; ++part)
            field[part * modes.size() + i] = parts[part];
    }
    return field;
}

/// Largest error of an amplitude: of the steady field, and of that with what turning adds.
std::array<double, 2> errors(double rate) {
    const ModalField modes(elastic, medium);
    const std::vector<double> exact = circle(modes, rate);
    std::vector<double> field(exact.size());
    modes.add_steady(rod, field);
    std::array<double, 2> error{};
    for (double& largest : error) {
        for (std::size_t i = 0; i < exact.size(); ++i)
            largest = std::max(largest, std::abs(field[i] - exact[i]));
        add_turning(modes, rod, rate, field);
    }
    return error;
}

} // namespace

TEST_CASE("the field of a rod on a circle is the steady one to order 1 in its turning rate, with the "
          "correction to 2") {
    const auto fast = errors(0.04), slow = errors(0.02), left = errors(-0.02);
    REQUIRE(slow[0] > 1e-5); // far above the quadrature's 1e-11
    CHECK(std::log2(fast[0] / slow[0]) == Approx(1.0).margin(0.1));
    CHECK(std::log2(fast[1] / slow[1]) == Approx(2.0).margin(0.1));
    CHECK(std::abs(left[1] / slow[1] - 1.0) < 0.2); // either way round
    CHECK(slow[1] < 0.1 * slow[0]);
}
