// What is taken off of a rod's own field, against that field kept by itself.

#include "reference_run.hpp"

#include "medium/mode_step.hpp"
#include "medium/own_response.hpp"
#include "rodwake/medium/turning_wake.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <complex>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

const rods::Couplings couplings{1.0, 0.3, -0.2};

/// Turning rate that a rod's own field gives it after it has turned at `rate` for `time`, by sums, over
/// `rate`.
double response(const elastic::Medium& elastic, const DynamicMedium& medium, double rate, double time) {
    const ModalField modes(elastic, medium);
    std::vector<double> field(modes.numbers());
    modes.add_steady({0.0, 0.0, 0.0}, field);
    const int steps = static_cast<int>(std::ceil(time / 0.05));
    const double h = time / steps;
    const auto pose = [&](double t) {
        return rods::Pose{std::sin(rate * t) / rate, (1.0 - std::cos(rate * t)) / rate, rate * t};
    };
    std::vector<DecayWeights> weights;
    for (std::size_t i = 0; i < 2 * modes.size(); ++i)
        weights.push_back(decay_weights(
            i < modes.size() ? modes.decay_longitudinal[i] : modes.decay_transverse[i - modes.size()], h));
    ThreadPool team(1);
    ModeMesh mesh(modes, medium.box, team);
    std::array<std::vector<double>, 4> forces;
    for (auto& f : forces)
        f.resize(4 * modes.size());
    for (int step = 0; step < steps; ++step) {
        for (std::size_t j = 0; j < 4; ++j) {
            const rods::Pose p = pose((step + (j == 0 ? 0.0 : j == 3 ? 1.0 : 0.5)) * h);
            mesh.forces(std::vector<double>{p.x, p.y, p.heading}, forces[j]);
        }
        for (std::size_t i = 0; i < field.size(); ++i) {
            const DecayWeights& w = weights[i / (2 * modes.size()) * modes.size() + i % modes.size()];
            field[i] = w.full * field[i] +
                       weighted(4, w.force, {forces[0][i], forces[1][i], forces[2][i], forces[3][i]});
        }
    }
    const rods::Pose end = pose(time);
    std::vector<double> turning(1);
    mesh.turning(std::vector<double>{end.x, end.y, end.heading}, field, couplings, turning);
    return turning[0] / rate;
}

/// The same by OwnResponse.
double approximate(const elastic::Medium& elastic, const DynamicMedium& medium, double rate, double time) {
    const OwnResponse own(elastic, medium, couplings, ModalField(elastic, medium));
    std::vector<double> state(OwnResponse::numbers(1)), next(state.size());
    own.start(std::vector<double>{0.0, 0.0, 0.0}, state);
    const int steps = static_cast<int>(std::ceil(time / 0.05));
    const double h = time / steps;
    const auto pose = [&](double t) { return std::vector<double>{0.0, 0.0, rate * t}; };
    for (int step = 0; step < steps; ++step) {
        const auto a = pose(step * h), b = pose((step + 0.5) * h), c = pose((step + 1) * h);
        own.advance(4, h, {a, b, b, c}, state, next);
        std::swap(state, next);
    }
    return own.turning(pose(time), 0, state) / rate;
}

} // namespace

TEST_CASE("a rod that begins to turn slowly is turned by its own field as the response says") {
    const DynamicMedium medium{.box = 48.0, .force_width = 0.8, .modes = 96}; // images are far
    for (const elastic::Medium& elastic : {elastic::Medium{1.0, 1.0}, elastic::Medium{0.3, 3.0}}) {
        double largest = 0.0, off = 0.0;
        for (const double time : {0.3, 1.0}) {
            const double exact = response(elastic, medium, 1e-3, time),
                         found = approximate(elastic, medium, 1e-3, time);
            CAPTURE(elastic.eta, elastic.xi, time, exact, found);
            largest = std::max(largest, std::abs(exact));
            off = std::max(off, std::abs(found - exact));
            CHECK(off < 0.1 * largest); // the exact one has images
        }
        CHECK(largest > 1e-3);
    }
}

TEST_CASE("the fit and what comes of slow turning agree with each other") {
    const DynamicMedium medium{.box = 48.0, .force_width = 0.8, .modes = 96, .start = Start::rest};
    const elastic::Medium elastic{1.0, 1.0};
    const OwnResponse own(elastic, medium, couplings, ModalField(elastic, medium));
    CHECK(own.fit_error() < 1e-3);
    CHECK(approximate(elastic, medium, 1e-3, 100.0) == Approx(own.slow()).epsilon(1e-3));
    CHECK(own.slow() > 0.05);
}

TEST_CASE("the fit holds for weak and strong drag") {
    for (const double alpha : {0.01, 0.1, 10.0}) {
        const DynamicMedium medium{.box = 20.0, .force_width = 0.8, .modes = 30, .start = Start::rest};
        const elastic::Medium elastic{1.0, 1.0 / alpha};
        CHECK(OwnResponse(elastic, medium, couplings, ModalField(elastic, medium)).fit_error() < 0.01);
    }
}

TEST_CASE("from rest only what has happened since turns a rod") {
    const DynamicMedium medium{.box = 20.0, .force_width = 0.8, .modes = 30, .start = Start::rest};
    const elastic::Medium elastic{1.0, 1.0};
    const OwnResponse own(elastic, medium, couplings, ModalField(elastic, medium));
    std::vector<double> state(OwnResponse::numbers(1)), next(state.size());
    const std::vector<double> straight{0.0, 0.0, 0.7};
    own.start(straight, state);
    own.advance(4, 0.5, {straight, straight, straight, straight}, state, next);
    CHECK(std::abs(own.turning(straight, 0, next)) < 1e-12);
    const std::vector<double> turned{0.0, 0.0, 0.8};
    CHECK(std::abs(own.turning(turned, 0, state)) == 0.0); // nothing has happened yet
    CHECK(std::abs(own.turning(turned, 0, next)) > 1e-6);
}

// --- What turning adds to a rod's field, against the field of a rod that has always walked a circle: mode by
// mode the integral over its past, by Simpson's rule.

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
        const double qx = modes.qx[i / modes.columns()], qy = modes.qy[i % modes.columns()];
        const double ux = modes.unit_x[i], uy = modes.unit_y[i];
        const Number force = modes.force[i] * std::exp(Number{0.0, -qx * rod.x - qy * rod.y});
        if (modes.force[i] == 0.0)
            continue;
        const Number l = force * integral({qx, qy, ux, uy, rate}, modes.decay_longitudinal[i]);
        const Number t = force * integral({qx, qy, -uy, ux, rate}, modes.decay_transverse[i]);
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
