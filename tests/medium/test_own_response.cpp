// What is taken off of a rod's own field, against that field kept by itself.

#include "medium/mode_step.hpp"
#include "medium/own_response.hpp"
#include "reference_run.hpp"

#include <catch2/catch.hpp>

#include <cmath>

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
        weights.push_back(decay_weights(i < modes.size() ? modes.decay_longitudinal()[i]
                                                         : modes.decay_transverse()[i - modes.size()],
                                        h));
    Team team(1);
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
