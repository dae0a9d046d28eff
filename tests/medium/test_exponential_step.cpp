// The method by itself: what it does exactly, and its order.

#include "medium/exponential_step.hpp"
#include "reference_run.hpp"

#include <catch2/catch.hpp>

#include <cmath>

using namespace rodwake;
using namespace rodwake::medium;

namespace {

const elastic::Medium solid{0.7, 2.0}; // alpha = 1/2
constexpr double rounding = 1e-13;     // of amplitudes of order 0.1 after a few steps

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    return tests::distance(a, b);
}

Coupled run(ExponentialStep& method, Coupled state, double time, int steps) {
    std::vector<double> rates(state.poses.size());
    for (int i = 0; i < steps; ++i) {
        Coupled next;
        method.rates(state.poses, state.fields, rates);
        method.take(state, rates, time / steps, next);
        state = next;
    }
    return state;
}

} // namespace

TEST_CASE("the field of a rod that walks straight is exact in steps of any length") {
    const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 48};
    ExponentialStep method(solid, medium, {}, 1, 1);
    const double heading = 0.4, time = 7.3;
    const Coupled end = run(method, method.start({1.0, 2.0, heading}), time, 2);
    const Coupled exact =
        method.start({1.0 + time * std::cos(heading), 2.0 + time * std::sin(heading), heading});
    CHECK(largest_difference(end.poses, exact.poses) < rounding);
    CHECK(largest_difference(end.fields, exact.fields) < rounding);
}

TEST_CASE("from rest each mode is its steady state less that of the start, decayed") {
    DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 48, .start = Start::rest};
    const ModalField modes(solid, medium);
    ExponentialStep from_rest(solid, medium, {}, 1, 1);
    medium.start = Start::steady;
    ExponentialStep steady(solid, medium, {}, 1, 1);
    const double time = 0.3;
    const Coupled end = run(from_rest, from_rest.start({0.0, 0.0, 0.0}), time, 3);
    const Coupled first = steady.start({0.0, 0.0, 0.0}), last = steady.start({time, 0.0, 0.0});
    std::vector<double> exact = last.fields;
    for (std::size_t i = 0; i < 4 * modes.size(); ++i) {
        const auto decay = i / modes.size() < 2 ? modes.decay_longitudinal() : modes.decay_transverse();
        exact[i] -= std::exp(-decay[i % modes.size()] * time) * first.fields[i];
    }
    CHECK(largest_difference(end.fields, exact) < rounding);
}

TEST_CASE("what is left of another rod's field decays mode by mode, and loses energy") {
    const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 48, .start = Start::rest};
    const ModalField modes(solid, medium);
    ExponentialStep method(solid, medium, {}, 1, 1);
    const Coupled rest = method.start({0.0, 0.0, 0.0});
    Coupled disturbed = rest;
    modes.add_steady({3.0, 4.0, 1.0}, disturbed.fields);
    const double time = 2.0;
    const Coupled with = run(method, disturbed, time, 4), without = run(method, rest, time, 4);
    double before = 0.0, after = 0.0, error = 0.0; // solid energy: alpha decay |u_q|^2/2 a mode
    for (std::size_t i = 0; i < 4 * modes.size(); ++i) {
        const auto decay = i / modes.size() < 2 ? modes.decay_longitudinal() : modes.decay_transverse();
        const double rate = decay[i % modes.size()], free = with.fields[i] - without.fields[i];
        before += rate * disturbed.fields[i] * disturbed.fields[i];
        after += rate * free * free;
        error = std::max(error, std::abs(free - std::exp(-rate * time) * disturbed.fields[i]));
    }
    CHECK(error < rounding);
    CHECK(after < before * std::exp(-2.0 * modes.decay_transverse()[modes.size() / modes.rows() / 2 + 1] *
                                    time)); // the slowest
}

TEST_CASE("the method is of order 4") {
    for (const bool self_field : {false, true}) {
        const DynamicMedium medium{.box = 8.0, .force_width = 0.6, .modes = 16, .self_field = self_field};
        ExponentialStep method(solid, medium, {4.0, 1.0, -0.5}, 2, 1);
        const Coupled start = method.start({0.0, 1.5, -0.1, 0.3, -1.5, 0.2});
        const Coupled exact = run(method, start, 2.0, 1280);
        const auto error = [&](int steps) {
            const Coupled end = run(method, start, 2.0, steps);
            return std::array{largest_difference(end.poses, exact.poses),
                              largest_difference(end.fields, exact.fields)};
        };
        // coarser steps, of 1 over the fastest decay and more, are of order 3 to 4
        const auto coarse = error(80), middle = error(160), fine = error(320);
        for (std::size_t i = 0; i < 2; ++i) {
            CAPTURE(self_field, i, coarse[i], middle[i], fine[i]);
            CHECK(std::log2(coarse[i] / middle[i]) == Approx(4.0).margin(0.4));
            CHECK(std::log2(middle[i] / fine[i]) == Approx(4.0).margin(0.4));
        }
    }
}

TEST_CASE("threads change no bit of a step", "[threads]") {
    for (const bool self_field : {false, true}) {
        const DynamicMedium medium{.box = 12.0, .force_width = 0.5, .modes = 48, .self_field = self_field};
        std::vector<Coupled> ends;
        for (const std::size_t threads : {1, 2, 3}) {
            ExponentialStep method(solid, medium, {4.0, 1.0, -0.5}, 3, threads);
            ends.push_back(
                run(method, method.start({0.0, 1.5, -0.1, 0.3, -1.5, 0.2, 4.0, 0.0, 3.0}), 1.0, 4));
        }
        for (const Coupled& end : ends) {
            CHECK(end.poses == ends.front().poses);
            CHECK(end.fields == ends.front().fields);
        }
    }
}
