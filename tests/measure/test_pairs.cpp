// Pairs of rods on tracks made by hand.

#include "rodwake/core/error.hpp"
#include "rodwake/measure/pairs.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

using namespace rodwake;
using namespace rodwake::measure;

namespace {

const double a = 4e-4, box = 78.0 * a, length = 4.5e-3, speed = 2.5 * a, step = 0.05;
const double quarter_turn = std::numbers::pi / 2.0;
const PairOptions options = {box, length};

struct Start {
    double x, y, heading;
};

/// Rods of constant speed whose headings turn as given from the time on.
PairTrack track_of(Start first, Start second, const std::function<double(int, double)>& turn_rate,
                   double duration) {
    PairTrack track;
    std::array<Start, 2> rods = {first, second};
    for (int k = 0; k * step <= duration; ++k) {
        const double t = k * step;
        track.t.push_back(t);
        for (int i = 0; i < 2; ++i) {
            Start& rod = rods[i];
            track.x[i].push_back(rod.x);
            track.y[i].push_back(rod.y);
            track.heading[i].push_back(rod.heading);
            rod.x += speed * step * std::cos(rod.heading);
            rod.y += speed * step * std::sin(rod.heading);
            rod.heading += turn_rate(i, t) * step;
        }
    }
    return track;
}

double straight(int, double) { return 0.0; }

PairTrack turned(PairTrack track, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    for (int i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < track.t.size(); ++k) {
            const double x = track.x[i][k], y = track.y[i][k];
            track.x[i][k] = c * x - s * y;
            track.y[i][k] = s * x + c * y;
            track.heading[i][k] += angle;
        }
    return track;
}

/// The formula of the granular record (outward positive, first places as they are): change at half a box.
double granular_change(const PairTrack& t, std::size_t row, double& advanced) {
    double cx = std::cos(t.heading[0][0]) + std::cos(t.heading[1][0]);
    double cy = std::sin(t.heading[0][0]) + std::sin(t.heading[1][0]);
    const double norm = std::hypot(cx, cy);
    cx /= norm, cy /= norm;
    const double before = -cy * (t.x[0][0] - t.x[1][0]) + cx * (t.y[0][0] - t.y[1][0]);
    const double now = -cy * (t.x[0][row] - t.x[1][row]) + cx * (t.y[0][row] - t.y[1][row]);
    advanced = (cx * (t.x[0][row] + t.x[1][row] - t.x[0][0] - t.x[1][0]) +
                cy * (t.y[0][row] + t.y[1][row] - t.y[0][0] - t.y[1][0])) /
               2.0;
    return std::copysign(1.0, before) * (now - before);
}

} // namespace

TEST_CASE("parallel rods that turn in come nearer, and turns towards each other count as such", "[pairs]") {
    const auto inwards = [](int i, double t) { return t < 1.0 ? (i == 0 ? 0.1 : -0.1) : 0.0; };
    const PairTrack track = track_of({0, -9 * a, 0}, {0, 9 * a, 0}, inwards, 20.0);
    for (const double angle : {0.0, 0.7, 3.0}) { // a turned box of the same side: tracks stay in it
        const PairRun run = follow_pair(turned(track, angle), {1e3 * box, length});
        CHECK(run.separation == Approx(18 * a).epsilon(1e-12));
        CHECK(run.turn[0] == Approx(0.1).epsilon(1e-12));
        CHECK(run.turn[1] == Approx(0.1).epsilon(1e-12));
        CHECK(run.non_reciprocity == Approx(0.0).margin(1e-12));
        CHECK(run.last_change < 0.0);
        CHECK_FALSE(run.perpendicular);
    }
    const PairRun run = follow_pair(track, options);
    CHECK(run.last_change == Approx(track.y[1].back() - track.y[0].back() - 18 * a).epsilon(1e-9));
    REQUIRE(run.half_box_change);
    // Both advance alike: half a box where x is; y straight between rows.
    std::size_t row = 0;
    while (track.x[0][row] < box / 2.0)
        ++row;
    CHECK(*run.half_box_change > track.y[1][row] - track.y[0][row] - 18 * a - 1e-12);
    CHECK(*run.half_box_change < track.y[1][row - 1] - track.y[0][row - 1] - 18 * a + 1e-12);
    CHECK(run.min_separation == Approx(track.y[1].back() - track.y[0].back()).epsilon(1e-9));
}

TEST_CASE("parallel rods that turn out part: turns away, change positive, escape", "[pairs]") {
    const auto outwards = [](int i, double t) { return t < 1.0 ? (i == 0 ? -0.1 : 0.1) : 0.0; };
    const PairRun run = follow_pair(track_of({0, -9 * a, 0}, {0, 9 * a, 0}, outwards, 20.0), options);
    CHECK(run.turn[0] == Approx(-0.1).epsilon(1e-12));
    CHECK(run.turn[1] == Approx(-0.1).epsilon(1e-12));
    CHECK(*run.half_box_change > 0.0);
    CHECK(run.ending == Ending::escape);
    CHECK(run.ending_time == Approx(20.0));
    CHECK(run.min_separation == Approx(18 * a).epsilon(1e-12));
}

TEST_CASE("the change at half a box is that of the granular record", "[pairs]") {
    const auto wander = [](int i, double t) { return 0.05 * std::sin(0.9 * t + i); };
    for (const double heading : {0.0, 0.3, -2.0}) {
        const PairTrack track =
            track_of({30 * a, 45 * a, heading}, {34 * a, 30 * a, heading + 0.4}, wander, 30.0);
        const PairRun run = follow_pair(track, options);
        REQUIRE(run.half_box_change);
        std::size_t row = 0;
        double advanced = 0.0, after = 0.0, before = 0.0;
        for (; advanced < box / 2.0; ++row) {
            before = after;
            after = granular_change(track, row, advanced);
        }
        CHECK(*run.half_box_change >= std::min(before, after) - 1e-15);
        CHECK(*run.half_box_change <= std::max(before, after) + 1e-15);
        double ignored;
        CHECK(run.last_change == Approx(granular_change(track, track.t.size() - 1, ignored)).epsilon(1e-12));
        CHECK(before != after); // or the comparison could not fail
    }
}

TEST_CASE("half a box is absent where rods did not come that far", "[pairs]") {
    const PairTrack track = track_of({0, 0, 0}, {0, 18 * a, 0}, straight, 15.0); // 37.5 a of 39 a
    CHECK_FALSE(follow_pair(track, options).half_box_change);
    CHECK(follow_pair(track_of({0, 0, 0}, {0, 18 * a, 0}, straight, 15.7), options).half_box_change);
}

TEST_CASE("a rear rod that turns while the front one does not: not reciprocal", "[pairs]") {
    for (const int rear : {0, 1}) { // the front rod ahead by 5 a
        const auto turn = [&](int i, double t) { return t < 1.0 ? (i == rear ? 0.4 : 0.001) : 0.0; };
        Start back = {0, 0, 0}, front = {5 * a, 18 * a, 0};
        const PairRun run = follow_pair(
            rear == 0 ? track_of(back, front, turn, 4.0) : track_of(front, back, turn, 4.0), options);
        CHECK(run.leader == 1 - rear);
        CHECK(run.non_reciprocity == Approx(0.399 / 0.401).epsilon(1e-9));
        CHECK(run.turn[rear] == Approx(0.4).epsilon(1e-9));        // to its left, where the front one is
        CHECK(run.turn[1 - rear] == Approx(-0.001).epsilon(1e-9)); // away
        // The other way round it is the front one that turns.
        const PairRun swapped = follow_pair(
            rear == 0 ? track_of(front, back, turn, 4.0) : track_of(back, front, turn, 4.0), options);
        CHECK(swapped.non_reciprocity == Approx(-0.399 / 0.401).epsilon(1e-9));
    }
    CHECK(follow_pair(track_of({0, 0, 0}, {0, 18 * a, 0}, straight, 4.0), options).non_reciprocity == 0.0);
}

TEST_CASE("whole turns count, however headings are written", "[pairs]") {
    const auto circling = [](int i, double) { return i == 0 ? 1.0 : 0.0; };
    PairTrack track = track_of({0, 0, 3.0}, {0, -18 * a, 3.0}, circling, 10.0); // the other is to the left
    const PairRun run = follow_pair(track, {1e3 * box, length});
    CHECK(run.turn[0] == Approx(10.0).epsilon(1e-9));
    for (double& heading : track.heading[0])
        heading = std::remainder(heading, 2.0 * std::numbers::pi);
    CHECK(follow_pair(track, {1e3 * box, length}).turn[0] == Approx(10.0).epsilon(1e-9));
}

TEST_CASE("contact is seen across the periodic boundary, at its time", "[pairs]") {
    // 10 a apart across the boundary, closing at 5 a/s: 11.25 a is the contact distance, so begin at 20 a
    const PairTrack track = track_of({70 * a, 0, 0}, {12 * a, 0, std::numbers::pi}, straight, 5.0);
    const PairRun run = follow_pair(track, options);
    CHECK(run.ending == Ending::contact);
    CHECK(run.ending_time == Approx((20.0 - 11.25) / 5.0).margin(step)); // a row
    CHECK(run.separation == Approx(20 * a).epsilon(1e-12));              // no mean heading: distance
    CHECK_FALSE(run.half_box_change);
    CHECK(run.min_separation < 0.3 * a);
    CHECK(run.last_change == 0.0);
    CHECK(run.non_reciprocity == 0.0);
    // In a box large enough they would be 58 a apart and part.
    CHECK(follow_pair(track, {1e3 * box, length}).ending == Ending::escape);
}

TEST_CASE("first places across the boundary are taken to the nearest image", "[pairs]") {
    const auto inwards = [](int i, double t) { return t < 1.0 ? (i == 0 ? 0.1 : -0.1) : 0.0; };
    const PairRun middle = follow_pair(track_of({0, 30 * a, 0}, {0, 48 * a, 0}, inwards, 20.0), options);
    const PairRun across = follow_pair(track_of({0, 70 * a, 0}, {0, 10 * a, 0}, inwards, 20.0), options);
    CHECK(across.separation == Approx(18 * a).epsilon(1e-12));
    CHECK(*across.half_box_change == Approx(*middle.half_box_change).epsilon(1e-9));
    CHECK(across.turn[0] == Approx(middle.turn[0]).epsilon(1e-12));
    CHECK(across.min_separation == Approx(middle.min_separation).epsilon(1e-9));
}

TEST_CASE("perpendicular starts: pursuit when the rear one falls in behind, escape when they part",
          "[pairs]") {
    // Rod 1 comes up from below and turns right into rod 0's direction within 3 s.
    const Start first = {15 * a, 0, 0}, second = {0, -10 * a, quarter_turn};
    const auto falls_in = [](int i, double t) { return i == 1 && t < 3.0 ? -quarter_turn / 3.0 : 0.0; };
    const PairRun run = follow_pair(track_of(first, second, falls_in, 12.0), options);
    CHECK(run.perpendicular);
    CHECK(run.separation == Approx(std::hypot(15, 10) * a).epsilon(1e-12));
    CHECK(run.ending == Ending::pursuit);
    CHECK(run.ending_time == Approx(3.0 - 3.0 * 0.5 / quarter_turn).margin(2 * step)); // 0.5 rad left to turn
    CHECK(run.leader == 0);
    CHECK(run.non_reciprocity == Approx(1.0).epsilon(1e-12));
    CHECK(run.turn[1] == Approx(quarter_turn).epsilon(1e-9)); // rod 0 was to its right
    // Side by side with the same headings is no pursuit, nor do they part; one behind the other is.
    CHECK(follow_pair(track_of({0, 0, 0}, {0, 18 * a, 0}, straight, 4.0), options).ending ==
          Ending::undecided);
    CHECK(follow_pair(track_of({0, 0, 0}, {18 * a, 0, 0}, straight, 4.0), options).ending == Ending::pursuit);
    // locked only after three quarters of the track, and still turning
    CHECK(follow_pair(track_of(first, second, falls_in, 2.5), options).ending == Ending::undecided);
    const PairRun crossing = follow_pair(track_of(first, second, straight, 8.0), options);
    CHECK(crossing.ending == Ending::escape);
    // 4 s later they are more than half a box apart and near each other's images
    CHECK(follow_pair(track_of(first, second, straight, 12.0), options).ending == Ending::undecided);
    CHECK(crossing.perpendicular);
    CHECK_FALSE(follow_pair(track_of(first, {0, -10 * a, 0.9}, straight, 1.0), options).perpendicular);
}

TEST_CASE("noise of a bed's size changes no ending", "[pairs]") {
    // Rattling of 0.03 rad and 0.05 a from row to row: over 0.1 s the headings turn at 0.4 rad/s.
    const auto noisy = [](PairTrack track, double times = 1.0) {
        unsigned state = 1;
        const auto noise = [&state, times] { // minimal standard generator, uniform in [-1, 1)
            state = static_cast<unsigned>(state * 48271ull % 2147483647ull);
            return times * (2.0 * state / 2147483647.0 - 1.0);
        };
        for (int i = 0; i < 2; ++i)
            for (std::size_t k = 0; k < track.t.size(); ++k) {
                track.heading[i][k] += 0.03 * noise();
                track.x[i][k] += 0.05 * a * noise();
                track.y[i][k] += 0.05 * a * noise();
            }
        return track;
    };
    const auto inwards = [](int i, double) { return i == 0 ? 0.1 : -0.1; };
    const PairTrack crossing = track_of({15 * a, 0, 0}, {0, -10 * a, quarter_turn}, straight, 8.0),
                    behind = track_of({0, 0, 0}, {18 * a, 0, 0}, straight, 8.0),
                    turning = track_of({0, -9 * a, -0.8}, {0, 9 * a, 0.8}, inwards, 4.0);
    for (const PairTrack& track : {crossing, behind, turning})
        CHECK(follow_pair(noisy(track), options).ending == follow_pair(track, options).ending);
    CHECK(follow_pair(crossing, options).ending == Ending::escape);
    CHECK(follow_pair(behind, options).ending == Ending::pursuit);
    CHECK(follow_pair(turning, options).ending == Ending::undecided); // they part, but turn back
    PairOptions exact = options;
    exact.ending = EndingCriteria{};
    CHECK(follow_pair(crossing, exact).ending == Ending::escape);
    CHECK(follow_pair(noisy(crossing, 2.0), options).ending == Ending::escape);
    CHECK(follow_pair(noisy(crossing, 2.0), exact).ending ==
          Ending::undecided); // what the wider limits are for
}

TEST_CASE("an ensemble's means count the runs that came there", "[pairs]") {
    std::vector<PairRun> runs(4);
    for (int i = 0; i < 3; ++i)
        runs[i].half_box_change = 1.0 + i;
    runs[0].ending = runs[1].ending = Ending::contact;
    runs[2].ending = Ending::pursuit;
    runs[1].leader = 1;
    runs[1].turn[0] = 0.4; // the rear rod of this run
    runs[1].turn[1] = -0.2;
    runs[1].non_reciprocity = 1.0 / 3.0;
    const PairResult result = reduce(runs);
    CHECK(result.half_box_change.value == Approx(2.0));
    CHECK(result.half_box_change.error == Approx(1.0 / std::sqrt(3.0)));
    CHECK(result.half_box_change.count == 3);
    CHECK(result.not_there == 1);
    CHECK(result.turn_rear.value == Approx(0.1));
    CHECK(result.turn_front.value == Approx(-0.05));
    CHECK(result.non_reciprocity.value == Approx(1.0 / 12.0));
    CHECK(result.contact == 2);
    CHECK(result.pursuit == 1);
    CHECK(result.escape == 0);
    CHECK(result.undecided == 1);
    CHECK(result.runs.size() == 4);
    const PairResult none = reduce(std::span(runs).subspan(3));
    CHECK(none.half_box_change.count == 0);
    CHECK_FALSE(none.half_box_change.known());
    CHECK_THROWS_AS(reduce(std::span<const PairRun>()), InputError);
}

TEST_CASE("tracks that are none are refused", "[pairs]") {
    const PairTrack good = track_of({0, 0, 0}, {0, 18 * a, 0}, straight, 1.0);
    CHECK_NOTHROW(follow_pair(good, options));
    PairTrack bad = good;
    bad.t[3] = bad.t[2];
    CHECK_THROWS_AS(follow_pair(bad, options), InputError);
    bad = good;
    bad.y[1].pop_back();
    CHECK_THROWS_AS(follow_pair(bad, options), InputError);
    bad = good;
    bad.heading[0][5] = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(follow_pair(bad, options), InputError);
    CHECK_THROWS_AS(follow_pair(PairTrack{}, options), InputError);
    CHECK_THROWS_AS(follow_pair(track_of({0, 0, 0}, {0, 18 * a, 0}, straight, 0.0), options), InputError);
    CHECK_THROWS_AS(follow_pair(good, {0.0, length}), InputError);
    CHECK_THROWS_AS(follow_pair(good, {box, -1.0}), InputError);
    PairOptions endless = options;
    endless.ending.residual_turn = std::numeric_limits<double>::infinity();
    CHECK_THROWS_AS(follow_pair(good, endless), InputError);
}

// --- An encounter of the theory and the track it leaves end alike: one definition for both

namespace {

rods::RodProblem perpendicular(double kappa, double dx, double t_end) {
    rods::RodProblem problem{elastic::Medium{1.0, 0.1},
                             {.kappa = kappa},
                             {{0, 0, 0}, {dx, -5, std::numbers::pi / 2}},
                             t_end,
                             {},
                             {}};
    problem.contact_distance = 0.02;
    for (double t = 0.0; t <= t_end; t += 0.02)
        problem.output_times.push_back(t);
    return problem;
}

measure::PairTrack track_of_run(const integrate::Solution& solution) {
    measure::PairTrack track;
    track.t = solution.times;
    auto states = solution.states;
    if (solution.final_time > track.t.back()) { // stopped by contact
        track.t.push_back(solution.final_time);
        states.push_back(solution.final_state);
    }
    for (const auto& state : states)
        for (const std::size_t i : {0, 1}) {
            track.x[i].push_back(state[3 * i]);
            track.y[i].push_back(state[3 * i + 1]);
            track.heading[i].push_back(state[3 * i + 2]);
        }
    return track;
}

} // namespace

TEST_CASE("a run of the theory and its track have one ending", "[endings]") {
    struct Case {
        double kappa, dx, t_end;
        Ending ending;
    };
    const auto one = GENERATE(Case{100.0, 1.0, 16.0, Ending::pursuit},
                              Case{-100.0, 1.0, 60.0, Ending::escape}, Case{0.0, 6.0, 1.0, Ending::undecided},
                              Case{0.0, 1.0, 30.0, Ending::escape}, Case{0.0, 5.0, 30.0, Ending::contact});
    const auto result = rods::simulate(perpendicular(one.kappa, one.dx, one.t_end), {});
    INFO("kappa " << one.kappa << ": " << result.outcome.reason);
    CHECK(result.outcome.ending == one.ending);
    for (const EndingCriteria& criteria : {EndingCriteria{}, noisy_track}) {
        const measure::PairOptions options{1e6, 0.02 * (1.0 + 1e-6),
                                           criteria}; // a plane; the last row is at contact
        CHECK(follow_pair(track_of_run(result.solution), options).ending == one.ending);
    }
}
