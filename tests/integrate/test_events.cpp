// Roots: found, in order, in the right direction, where the closed form has them.

#include "problems.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace rodwake::integrate;
using namespace rodwake::integrate::test;

namespace {

constexpr double pi = 3.14159265358979323846;

OdeOptions tight(Method method) { return options_for(method, 1e-11); }

/// One with roots that are known. The problem: y0 = t, y1 = 0, y2 = cos t, y3 = t^3 + 6 t^2 - 4 t - 24 from
/// t0 on.
struct Known {
    const char* name;
    double from, to;
    std::function<double(double t, State y)> value;
    std::vector<double> roots;
};

std::vector<double> multiples(double of, double first, double below) {
    std::vector<double> times;
    for (double t = first; t < below; t += of)
        times.push_back(t);
    return times;
}

std::vector<double> around(std::vector<double> centres, double by) {
    std::vector<double> times;
    for (const double t : centres)
        times.insert(times.end(), {t - by, t + by});
    return times;
}

double product(double t, std::vector<double> roots) {
    double value = 1.0;
    for (const double root : roots)
        value *= t - root;
    return value;
}

const std::vector<double> six = {1, 1.3, 2, 4, 4.2, 6}, tops = {2 * pi, 4 * pi, 6 * pi};

const std::vector<Known> table = {
    {"a cubic state", -8, 5, [](double, State y) { return y[3]; }, {-6, -2, 2}},
    {"a cubic of time",
     -8,
     5,
     [](double t, State) {
         return product(t, {-6, -2, 2});
     },
     {-6, -2, 2}},
    {"a product of six", 0, 9, [](double t, State) { return product(t, six); }, six},
    {"the same of the state, downwards", 0, 9, [](double, State y) { return -product(y[0], six); }, six},
    {"three roots together",
     0,
     9,
     [](double t, State) {
         return product(t, {5, 5.001, 5.002, 8});
     },
     {5, 5.001, 5.002, 8}},
    {"three roots of the state",
     0,
     9,
     [](double, State y) {
         return product(y[0], {2, 2.1, 2.2});
     },
     {2, 2.1, 2.2}},
    {"a sine of time", 0, 20, [](double t, State) { return std::sin(2.5 * t); },
     multiples(pi / 2.5, pi / 2.5, 20)},
    {"for long", 0, 1000, [](double t, State) { return std::sin(2.5 * t); },
     multiples(pi / 2.5, pi / 2.5, 1000)},
    {"tops of a fast cosine", 0, 5, [](double t, State) { return std::cos(40 * (t - 0.05)) - 0.995; },
     around(multiples(pi / 20, 0.05, 5), std::acos(0.995) / 40)},
    {"tops of a state", 1, 20, [](double, State y) { return y[2] - 0.9999; },
     around(tops, std::acos(0.9999))},
    {"a dip", 0, 9, [](double t, State) { return (t - 3) * (t - 3) - 1e-6; }, around({3}, 1e-3)},
    {"a dip of a state, and far below",
     0,
     9,
     [](double, State y) { return (y[0] - 3) * (y[0] - 3) * (8 - y[0]) - 5e-6; },
     {3 - 1e-3, 3 + 1e-3, 8}},
    {"a bump on a slope",
     0,
     5,
     [](double t, State) { return std::exp(-t) - 0.5 + 0.6 * std::exp(-25 * (t - 2) * (t - 2)); },
     {std::log(2.0), 1.850371027242893, 2.1345068528997313}},
    {"a plateau to the end", 0, 9, [](double, State y) { return std::max(0.0, 1 - y[0]); }, {1}},
    {"a plateau from below", 0, 9, [](double t, State) { return std::min(0.0, t - 7.5); }, {7.5}},
    {"a plateau and up again",
     0,
     9,
     [](double t, State) { return std::max(0.0, std::abs(t - 2) - 0.3); },
     {1.7}},
    {"a plateau and down",
     0,
     9,
     [](double t, State) { return t < 4 ? std::max(0.0, 1.5 - t) : 4 - t; },
     {1.5}},
    {"a corner below", 0, 9, [](double t, State) { return std::abs(t - 5) - 0.01; }, around({5}, 0.01)},
    {"a staircase", 0, 9, [](double, State y) { return std::floor(y[0]) - 2.5; }, {3}},
    {"a jump there and back", 0, 9, [](double t, State) { return t > 2 && t < 6 ? -1.0 : 1.0; }, {2, 6}},
    {"at output times",
     0,
     9,
     [](double t, State) {
         return product(t, {1.5, 3, 4.5});
     },
     {1.5, 3, 4.5}},
    {"zero at the start and back there", 0, 9, [](double t, State) { return t * (t - 5); }, {5}},
    {"never", 0, 9, [](double t, State) { return 1.01 + std::sin(9 * t); }, {}},
};

OdeProblem ramps(double from, std::size_t size) {
    OdeProblem problem;
    problem.start_time = from;
    problem.initial_state.assign(size, 1.0);
    std::ranges::copy(std::array{from, 0.0, std::cos(from), product(from, {-6, -2, 2})},
                      problem.initial_state.begin());
    problem.rhs = [](double t, State, std::span<double> ydot) {
        std::ranges::fill(ydot, 0.0);
        std::ranges::copy(std::array{1.0, 0.0, -std::sin(t), 3 * t * t + 12 * t - 4}, ydot.begin());
    };
    return problem;
}

} // namespace

TEST_CASE("a terminal event ends the solve at its root", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    INFO(to_string(method));
    OdeProblem problem = oscillator();
    problem.events = {component_event(0, Crossing::any, true)};
    const std::vector<double> times{0.0, 0.5, 1.0, 1.5, 2.0, 3.0};
    const Solution solution = solve(problem, tight(method), times);
    CHECK(solution.status.termination == Termination::stopped_at_event);
    CHECK(std::abs(solution.final_time - pi / 2) < 1e-9);  // 100 rtol: global over local error
    CHECK(std::abs(solution.final_state[0]) < 1e-14);      // a root to the rounding of its time
    CHECK(std::abs(solution.final_state[1] + 1.0) < 1e-9); // 100 rtol
    CHECK(solution.times == std::vector<double>{0.0, 0.5, 1.0, 1.5});
    REQUIRE(solution.hits.size() == 1);
    CHECK(solution.hits[0].event == 0);
    CHECK(solution.hits[0].time == solution.final_time);
    CHECK(solution.hits[0].state == solution.final_state);
    CHECK(solution.final_state[0] <=
          0.0); // the sign has changed, so a solve from here does not find it again
}

TEST_CASE("every root of the table, by each method", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const std::size_t size = GENERATE(4, 30); // both steppers of erk
    for (const Known& known : table) {
        INFO(known.name << " by " << to_string(method) << ", " << size);
        OdeProblem problem = ramps(known.from, size);
        for (const Crossing crossing : {Crossing::any, Crossing::rising, Crossing::falling})
            problem.events.push_back({"", known.value, crossing, false});
        const std::vector<double> times{1.5, 3.0, 4.5, known.to};
        const std::vector<double> outputs = known.from < 0 ? std::vector{known.to} : times;
        const Solution solution = solve(problem, options_for(method, 1e-9), outputs);
        CAPTURE(solution.status.message(), solution.statistics.event_evaluations);
        REQUIRE(solution.status.termination == Termination::reached_end);
        std::vector<double> found[3];
        for (const EventHit& hit : solution.hits)
            found[hit.event].push_back(hit.time);
        CHECK(found[1].size() + found[2].size() == found[0].size());
        REQUIRE(found[0].size() == known.roots.size());
        for (std::size_t k = 0; k < known.roots.size();
             ++k) // dt = dy/v: 100 rtol over slopes of 1e-3 and more
            CHECK(found[0][k] == Approx(known.roots[k]).margin(1e-4).epsilon(1e-9));
        if (known.roots.empty())
            continue;
        problem.events = {{"", known.value, Crossing::any, true}, {"", known.value, Crossing::any, false}};
        const Solution stopped = solve(problem, options_for(method, 1e-9), outputs);
        CHECK(stopped.final_time == found[0][0]);
        CHECK(stopped.hits.size() == 2);
    }
}

TEST_CASE("noise fails the solve soon, rounding does not", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeProblem problem = ramps(0.0, 4);
    long calls = 0;
    problem.events = {{"noise", [&](double t, State) { return std::sin(1e9 * t + 1e4 * double(++calls)); }}};
    const std::vector<double> times{100.0};
    const Solution solution = solve(problem, options_for(method, 1e-8), times);
    CHECK_THAT(solution.status.message(), Catch::Contains("event 'noise' varies faster"));
    CHECK(calls < 100000); // of 80 parts or so, with some roots in each, and of those above them
    problem.events = {{"rounding", [](double, State y) {
                           return (y[2] * y[2] + 1e3) - (1e3 + y[2] * y[2] * (1 - 1e-15));
                       }}};
    CHECK(solve(problem, options_for(method, 1e-8), times).status.ok());
}

TEST_CASE("an event that is not a number fails the solve wherever in a step it is met", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    OdeProblem problem = ramps(0.0, 4);
    problem.events = {{"root", [](double t, State) { return std::sqrt(std::abs(t - 4.0) - 1.0); }}};
    const std::vector<double> times{9.0};
    CHECK_THAT(solve(problem, options_for(method, 1e-8), times).status.message(),
               Catch::Contains("'root' was"));
}

TEST_CASE("directions", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    INFO(to_string(method));
    OdeProblem problem = oscillator(); // cos t falls at pi/2 and 5pi/2, rises at 3pi/2 and 7pi/2
    problem.events = {component_event(0, Crossing::rising, false),
                      component_event(0, Crossing::falling, false), component_event(0, Crossing::any, false)};
    const std::vector<double> times{12.0};
    const Solution solution = solve(problem, tight(method), times);
    CHECK(solution.status.termination == Termination::reached_end);
    std::vector<double> found[3];
    for (const EventHit& hit : solution.hits)
        found[hit.event].push_back(hit.time / pi);
    const std::vector<double> expected[3] = {{1.5, 3.5}, {0.5, 2.5}, {0.5, 1.5, 2.5, 3.5}};
    for (int i = 0; i < 3; ++i) {
        REQUIRE(found[i].size() == expected[i].size());
        for (std::size_t k = 0; k < found[i].size(); ++k)
            CHECK(std::abs(found[i][k] - expected[i][k]) <
                  3e-9); // 300 rtol: global over local error at t = 12
    }
    CHECK(std::is_sorted(solution.hits.begin(), solution.hits.end(),
                         [](const EventHit& a, const EventHit& b) { return a.time < b.time; }));
}

TEST_CASE("a ball bounced by restarting at its root lands where the closed form says", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    INFO(to_string(method));
    for (const auto& [crossing, kept] : {std::pair{Crossing::falling, 0.8}, {Crossing::any, 0.5}}) {
        double start = 0.0, expected = std::sqrt(2.0), speed = std::sqrt(2.0); // from height 1 at g = 1
        std::vector<double> state{1.0, 0.0};
        for (int bounce = 0; bounce < 5; ++bounce) {
            OdeProblem problem = ballistic(state[0], state[1], -1.0);
            problem.start_time = start;
            problem.events = {component_event(0, crossing, true)};
            const Solution solution = solve(problem, tight(method), std::vector{start + 10.0});
            REQUIRE(solution.status.termination == Termination::stopped_at_event);
            CHECK(std::abs(solution.final_time - expected) < 1e-9); // 100 rtol
            start = solution.final_time;
            speed *= kept;
            expected += 2.0 * speed;
            state = {solution.final_state[0], -kept * solution.final_state[1]};
        }
    }
}

TEST_CASE("a dip in which no samples lie is found through another event's root", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    INFO(to_string(method));
    // y = (t - 1)^2 / 2 - depth: positive but for |t - 1| < sqrt(2 depth), far less than a step
    const double depth = 1e-6;
    OdeProblem problem = ballistic(0.5 - depth, -1.0, 1.0);
    problem.events = {component_event(0, Crossing::falling, true), component_event(1, Crossing::any, false)};
    problem.events[0].sampled = problem.events[1].sampled = false;
    OdeOptions options = options_for(method, 1e-9);
    const std::vector<double> times{4.0};

    double step_over_dip = 0.0; // that the premise holds: without the second event the dip goes unseen
    OdeProblem alone = problem;
    alone.events.pop_back();
    options.on_step = [&](const Step& step) {
        if (step.time_before < 1.0 && step.time > 1.0)
            step_over_dip = step.time - step.time_before;
    };
    CHECK(solve(alone, options, times).status.termination == Termination::reached_end);
    CHECK(step_over_dip > 2.0 * std::sqrt(2.0 * depth));

    const Solution solution = solve(problem, options, times);
    CHECK(solution.status.termination == Termination::stopped_at_event);
    const double root = 1.0 - std::sqrt(2.0 * depth);
    // dt = dy / v with v = sqrt(2 depth) = 1.4e-3 and dy up to 10 rtol
    CHECK(std::abs(solution.final_time - root) < 1e-5);
    REQUIRE(solution.hits.size() == 1); // the lowest point comes after the terminal event
    CHECK(solution.hits[0].event == 0);
}

TEST_CASE("a dip between the ends of one step is found at the candidate time of the event", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    const double depth = 1e-6;
    OdeProblem problem = ballistic(0.5 - depth, -1.0, 1.0);
    problem.events = {component_event(0, Crossing::any, false)};
    problem.events[0].sampled = false;
    problem.events[0].candidate_time = [](const Step& step) {
        const bool turns = step.state_before[1] < 0.0 && step.state[1] > 0.0;
        return turns ? std::optional(1.0) : std::nullopt;
    };
    const std::vector<double> times{4.0};
    const Solution solution = solve(problem, options_for(method, 1e-9), times);
    CHECK(solution.status.termination == Termination::reached_end);
    REQUIRE(solution.hits.size() == 2); // down and up again
    const double half_width = std::sqrt(2.0 * depth);
    CHECK(std::abs(solution.hits[0].time - (1.0 - half_width)) < 1e-5); // dt = dy / v, 10 rtol over 1.4e-3
    CHECK(std::abs(solution.hits[1].time - (1.0 + half_width)) < 1e-5); // the same
}

TEST_CASE("a wrong candidate time does no harm", "[integrate]") {
    const double wrong = GENERATE(-5.0, 0.0, 1e300, std::numeric_limits<double>::quiet_NaN());
    OdeProblem problem = oscillator();
    problem.events = {component_event(0, Crossing::any, true)};
    problem.events[0].candidate_time = [wrong](const Step&) { return std::optional(wrong); };
    const std::vector<double> times{3.0};
    CHECK(std::abs(solve(problem, tight(Method::adams), times).final_time - pi / 2) < 1e-9); // 100 rtol
    problem.events[0].candidate_time = [](const Step&) -> std::optional<double> {
        throw std::runtime_error("no idea");
    };
    CHECK_THAT(solve(problem, tight(Method::adams), times).status.cause, Catch::Contains("no idea"));
}

TEST_CASE("several roots of several events in one step come in order", "[integrate]") {
    OdeProblem problem = ballistic(0.0, 1.0, 0.0); // y = t, in very long steps
    problem.events = {{"at 3", [](double t, State) { return t - 3.0; }, Crossing::any, false},
                      {"at 1", [](double t, State) { return t - 1.0; }, Crossing::any, false},
                      {"at 2", [](double, State y) { return y[0] - 2.0; }, Crossing::any, false},
                      {"stop at 4", [](double t, State) { return t - 4.0; }, Crossing::rising, true},
                      {"at 5", [](double t, State) { return t - 5.0; }, Crossing::any, false}};
    OdeOptions options = options_for(Method::erk, 1e-6);
    options.initial_step = 100.0;
    const std::vector<double> times{0.5, 4.5, 100.0};
    const Solution solution = solve(problem, options, times);
    REQUIRE(solution.hits.size() == 4);
    const std::size_t order[] = {1, 2, 0, 3};
    for (std::size_t k = 0; k < 4; ++k) {
        CHECK(solution.hits[k].event == order[k]);
        CHECK(solution.hits[k].time ==
              Approx(1.0 + static_cast<double>(k)).epsilon(1e-14)); // a rounding of the step
    }
    CHECK(solution.times == std::vector<double>{0.5});
}

TEST_CASE("an event that is zero at the start waits until it has left zero", "[integrate]") {
    const Method method = GENERATE(Method::bdf, Method::adams, Method::erk);
    INFO(to_string(method));
    OdeProblem problem = oscillator();
    problem.events = {component_event(1, Crossing::any, true)}; // v = -sin t: zero at 0, next at pi
    const std::vector<double> times{10.0};
    const Solution solution = solve(problem, tight(method), times);
    CHECK(solution.status.termination == Termination::stopped_at_event);
    CHECK(std::abs(solution.final_time - pi) < 1e-9); // 100 rtol
}

TEST_CASE("an event that is always zero, or never, fires never", "[integrate]") {
    OdeProblem problem = oscillator();
    problem.events = {{"zero", [](double, State) { return 0.0; }, Crossing::any, true},
                      {"one", [](double, State) { return 1.0; }, Crossing::any, true}};
    const std::vector<double> times{3.0};
    const Solution solution = solve(problem, options_for(Method::adams, 1e-8), times);
    CHECK(solution.status.termination == Termination::reached_end);
    CHECK(solution.hits.empty());
}

TEST_CASE("a noisy event fails the solve instead of trapping it", "[integrate]") {
    OdeProblem problem = oscillator();
    long calls = 0;
    problem.events = {
        {"noise", [&](double, State) { return ++calls % 2 ? 1.0 : -1.0; }, Crossing::any, false},
        {"more", [&](double, State) { return calls % 3 ? 1.0 : -1.0; }, Crossing::any, false}};
    const std::vector<double> times{3.0};
    const Solution solution = solve(problem, options_for(Method::adams, 1e-8), times);
    // Either ending is legitimate for nonsense; it must be an ending, after a bounded number of calls.
    CHECK(calls < 10'000'000);
    CHECK((solution.status.termination == Termination::failed ||
           solution.status.termination == Termination::reached_end));
}

TEST_CASE("on_step ends at a terminal root", "[integrate]") {
    OdeProblem problem = oscillator();
    problem.events = {component_event(0, Crossing::any, true)};
    OdeOptions options = options_for(Method::erk, 1e-9);
    double last = 0.0;
    options.on_step = [&](const Step& step) { last = step.time; };
    const std::vector<double> times{3.0};
    CHECK(solve(problem, options, times).final_time == last);
}
