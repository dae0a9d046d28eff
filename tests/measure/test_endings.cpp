// An encounter of the theory and the track it leaves end alike: one definition for both.

#include "rodwake/measure/pairs.hpp"
#include "rodwake/rods/simulate.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace rodwake;

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

measure::PairTrack track_of(const integrate::Solution& solution) {
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
        CHECK(follow_pair(track_of(result.solution), options).ending == one.ending);
    }
}
