// A solve resumed at a segment repeats the uninterrupted one bit for bit.

#include "problems.hpp"

#include <catch2/catch.hpp>
#include <cstring>
#include <thread>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;

namespace {

struct Saved {
    double time;
    std::vector<double> state;
    std::size_t outputs_done;
};

/// Van der Pol, mu = 5, with an event: varied steps, orders and rejections.
OdeProblem van_der_pol() {
    OdeProblem problem;
    problem.initial_state = {2.0, 0.0};
    problem.rhs = [](double, State y, std::span<double> ydot) {
        ydot[0] = y[1];
        ydot[1] = 5.0 * (1.0 - y[0] * y[0]) * y[1] - y[0];
    };
    problem.events = {component_event(0, Crossing::any, false)};
    return problem;
}

bool same_bits(std::span<const double> a, std::span<const double> b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

/// The whole solution from output `first` and hit `first_hit` on.
bool same_tail(const Solution& whole, const Solution& tail, std::size_t first) {
    const std::size_t first_hit = whole.hits.size() - tail.hits.size();
    bool same = whole.times.size() == first + tail.times.size() && tail.hits.size() <= whole.hits.size();
    for (std::size_t k = 0; same && k < tail.times.size(); ++k)
        same = whole.times[first + k] == tail.times[k] && same_bits(whole.states[first + k], tail.states[k]);
    for (std::size_t k = 0; same && k < tail.hits.size(); ++k)
        same = whole.hits[first_hit + k].time == tail.hits[k].time &&
               same_bits(whole.hits[first_hit + k].state, tail.hits[k].state);
    return same && same_bits(whole.final_state, tail.final_state);
}

std::vector<Saved> segments_of(OdeOptions options, const std::vector<double>& times, Solution& solution) {
    std::vector<Saved> saved;
    options.on_segment = [&](const Segment& segment) {
        saved.push_back({segment.time, {segment.state.begin(), segment.state.end()}, segment.outputs.size()});
    };
    solution = solve(van_der_pol(), options, times);
    return saved;
}

Solution resume(const Saved& from, const OdeOptions& options, const std::vector<double>& times) {
    OdeProblem problem = van_der_pol();
    problem.start_time = from.time;
    problem.initial_state = from.state;
    return solve(problem, options, std::span(times).subspan(from.outputs_done));
}

} // namespace

TEST_CASE("resuming from any segment gives the same bits", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const double rtol = GENERATE(1e-5, 1e-9);
    const double initial_step = GENERATE(0.0, 1e-5);
    INFO(to_string(method) << " rtol " << rtol);
    OdeOptions options = options_for(method, rtol);
    // BDF starts each segment at order 1, whose steps are tiny at tight tolerances.
    options.segment_steps = method == Method::bdf && rtol < 1e-6 ? 401 : 23;
    options.initial_step = initial_step;
    const std::vector<double> times = evenly(0.0, 20.0, 113);
    Solution whole;
    const std::vector<Saved> saved = segments_of(options, times, whole);
    REQUIRE(whole.status.termination == Termination::reached_end);
    REQUIRE(saved.size() > 3);
    for (std::size_t k = 0; k < saved.size(); k += 1 + saved.size() / 8) {
        const Saved& segment = saved[k];
        CHECK(times[segment.outputs_done] > segment.time);
        CHECK((segment.outputs_done == 0 || times[segment.outputs_done - 1] <= segment.time));
        CHECK(same_tail(whole, resume(segment, options, times), segment.outputs_done));
    }
}

TEST_CASE("the comparison sees one bit", "[integrate]") {
    OdeOptions options = options_for(Method::adams, 1e-7);
    options.segment_steps = 37;
    const std::vector<double> times = evenly(0.0, 20.0, 113);
    Solution whole;
    std::vector<Saved> saved = segments_of(options, times, whole);
    saved[1].state[0] = std::nextafter(saved[1].state[0], 10.0);
    CHECK_FALSE(same_tail(whole, resume(saved[1], options, times), saved[1].outputs_done));
}

TEST_CASE("a restart costs less than a twentieth of a default segment", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeOptions options = options_for(method, 1e-8);
    const std::vector<double> times{500.0};
    options.segment_steps = 1'000'000;
    const long without = solve(oscillator(), options, times).statistics.steps;
    options.segment_steps = without / 3;
    const long with = solve(oscillator(), options, times).statistics.steps;
    const long restarts = (with - 1) / options.segment_steps;
    INFO(to_string(method) << " " << without << " " << with);
    REQUIRE(restarts >= 2);
    CHECK(with - without < restarts * OdeOptions().segment_steps / 20);
}

TEST_CASE("two solves at once give what each gives alone", "[integrate]") {
    const std::vector<double> times = evenly(0.0, 50.0, 50);
    const Solution bdf = solve(van_der_pol(), options_for(Method::bdf, 1e-8), times);
    const Solution erk = solve(van_der_pol(), options_for(Method::erk, 1e-8), times);
    Solution bdf_again, erk_again;
    std::thread one([&] { bdf_again = solve(van_der_pol(), options_for(Method::bdf, 1e-8), times); });
    std::thread two([&] { erk_again = solve(van_der_pol(), options_for(Method::erk, 1e-8), times); });
    one.join();
    two.join();
    CHECK(same_tail(bdf, bdf_again, 0));
    CHECK(same_tail(erk, erk_again, 0));
}
