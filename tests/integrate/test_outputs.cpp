// Output times: exactly those asked for, wherever they fall.

#include "problems.hpp"

#include <catch2/catch.hpp>

#include <cstring>
#include <numbers>
#include <thread>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;

TEST_CASE("outputs are at the requested times, however dense", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const int intervals = GENERATE(1, 7, 3000); // 3000: many within one step
    const std::vector<double> times = evenly(0.0, 3.0, intervals);
    const Solution solution = solve(oscillator(), options_for(method, 1e-9), times);
    INFO(to_string(method));
    REQUIRE(solution.times == times);
    REQUIRE(solution.states.size() == times.size());
    CHECK(solution.final_time == 3.0);
    CHECK(solution.final_state == solution.states.back());
    CHECK(solution.states[0] == std::vector<double>{1.0, 0.0});
    double worst = 0.0;
    for (std::size_t k = 0; k < times.size(); ++k)
        worst = std::max(worst, std::abs(solution.states[k][0] - std::cos(times[k])));
    CHECK(worst < 3e-7); // 300 rtol: global over local error of some 150 steps
    if (intervals == 3000)
        CHECK(solution.statistics.steps < 1000); // outputs do not force steps
}

TEST_CASE("the steps do not depend on the outputs asked for", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const std::vector<double> sparse{3.0}, dense = evenly(0.0, 3.0, 500);
    const Solution a = solve(oscillator(), options_for(method, 1e-9), sparse);
    const Solution b = solve(oscillator(), options_for(method, 1e-9), dense);
    CHECK(a.final_state == b.final_state);
    CHECK(a.statistics.steps == b.statistics.steps);
}

TEST_CASE("inside explicit steps the solution is as good as at their ends, and costs as much for any number "
          "of times",
          "[integrate]") {
    // one dimension more than the small stepper takes goes through ARKODE
    const std::size_t copies = GENERATE(1U, 20U);
    OdeProblem problem = oscillator();
    for (std::size_t k = 1; k < copies; ++k)
        problem.initial_state.insert(problem.initial_state.end(), {1.0, 0.0});
    problem.rhs = [copies](double, State y, std::span<double> ydot) {
        for (std::size_t k = 0; k < copies; ++k) {
            ydot[2 * k] = y[2 * k + 1];
            ydot[2 * k + 1] = -y[2 * k];
        }
    };
    for (const double rtol : {1e-4, 1e-6, 1e-9, 1e-12}) {
        OdeOptions options = options_for(Method::erk, rtol);
        double at_ends = 0.0, inside = 0.0;
        const auto error = [](double t, State y) {
            return std::hypot(y[0] - std::cos(t), y[1] + std::sin(t));
        };
        options.on_step = [&](const Step& step) {
            at_ends = std::max(at_ends, error(step.time, step.state));
        };
        const std::vector<double> some = evenly(0.0, 3.0, 300), many = evenly(0.0, 3.0, 3000);
        const Solution solution = solve(problem, options, many);
        for (std::size_t k = 0; k < many.size(); ++k)
            inside = std::max(inside, error(many[k], solution.states[k]));
        CAPTURE(copies, rtol, at_ends, inside, solution.statistics.steps);
        // at 1e-4 a step of order 6 is a radian long, over which the stages vary as much as the solution
        CHECK(inside < (rtol > 1e-5 ? 3.0 : 2.0) * at_ends + 1e-15);
        const long plain = solve(problem, options, std::vector{3.0}).statistics.rhs_evaluations;
        CHECK(solution.statistics.rhs_evaluations <= plain + 8 * solution.statistics.steps);
        if (solution.statistics.steps < 300)
            CHECK(solve(problem, options, some).statistics.rhs_evaluations <=
                  plain + 8 * solution.statistics.steps);
    }
}

TEST_CASE("the right-hand side is not called beyond the last output time", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    double latest = 0.0;
    OdeProblem problem = oscillator();
    problem.rhs = [&, inner = problem.rhs](double t, State y, std::span<double> ydot) {
        latest = std::max(latest, t);
        inner(t, y, ydot);
    };
    const std::vector<double> times{0.5, 1.0};
    CHECK(solve(problem, options_for(method, 1e-6), times).status.ok());
    CHECK(latest <= 1.0 + 1e-15); // four roundings of the end time
}

TEST_CASE("start time only, and an end one rounding away", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeProblem problem = oscillator();
    problem.start_time = 1.0;
    const std::vector<double> start{1.0}, next{std::nextafter(1.0, 2.0)};
    const Solution at_start = solve(problem, options_for(method, 1e-6), start);
    CHECK(at_start.status.termination == Termination::reached_end);
    CHECK(at_start.final_state == problem.initial_state);
    const Solution near = solve(problem, options_for(method, 1e-6), next);
    CHECK(near.status.termination == Termination::reached_end);
    CHECK(near.times == next);
    CHECK(std::abs(near.final_state[0] - 1.0) < 1e-15); // moves by epsilon^2
}

TEST_CASE("on_step sees the steps join up", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeOptions options = options_for(method, 1e-6);
    double last_time = 0.0;
    std::vector<double> last_state{1.0, 0.0};
    long steps = 0, breaks = 0;
    options.segment_steps = 7;
    options.on_step = [&](const Step& step) {
        ++steps;
        const bool joins = step.time_before == last_time && step.time > step.time_before &&
                           std::equal(last_state.begin(), last_state.end(), step.state_before.begin());
        if (!joins)
            ++breaks;
        last_time = step.time;
        last_state.assign(step.state.begin(), step.state.end());
    };
    const std::vector<double> times{5.0};
    const Solution solution = solve(oscillator(), options, times);
    CHECK(breaks == 0);
    CHECK(steps == solution.statistics.steps);
    CHECK(last_time == 5.0);
    CHECK(last_state == solution.final_state);
}

TEST_CASE("a step limit keeps a quiet right-hand side from stepping over a bump", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    constexpr double at = 100.3, width = 0.05; // y' = normalised bump: y rises from 0 to 1 at t = 100.3
    OdeProblem problem;
    problem.initial_state = {0.0};
    problem.rhs = [](double t, State, std::span<double> ydot) {
        const double u = (t - at) / width;
        ydot[0] = std::exp(-u * u) / (width * std::sqrt(std::numbers::pi));
    };
    const std::vector<double> end{200.0};
    const OdeOptions options = options_for(method, 1e-8);
    CHECK(solve(problem, options, end).final_state[0] < 0.5); // stepped over: why the limit is there
    problem.step_limit = [](double t, State) { return std::max(0.01, 0.2 * std::abs(t - at)); };
    CHECK(std::abs(solve(problem, options, end).final_state[0] - 1.0) < 1e-6); // 100 times rtol
}

// --- A solve resumed at a segment repeats the uninterrupted one bit for bit

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
