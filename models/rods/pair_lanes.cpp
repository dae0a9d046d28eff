#include "pair_lanes.hpp"

#include "elastic/wake_kernel.hpp"
#include "rodwake/integrate/tsitouras_famelis.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/rods/settled_orbit.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::rods {

namespace {

using State6 = std::array<double, 6>;

constexpr double ulp = std::numeric_limits<double>::epsilon();

State6 numbers(const LaneNumbers (&of)[6], std::size_t lane) {
    State6 all;
    for (std::size_t k = 0; k < 6; ++k)
        all[k] = of[k][lane];
    return all;
}

/// Not std::hypot, which takes several times as long: what overflows a square is beyond the kernels.
double separation(const State6& y) {
    const double x = y[0] - y[3], across = y[1] - y[4];
    return std::sqrt(x * x + across * across);
}

} // namespace

PairQueue::PairQueue(std::span<const PairProblem> pairs, std::span<const std::size_t> order,
                     std::size_t& next, const PairOptions& options, std::span<PairResult> results)
    : pairs_(pairs), order_(order), next_(next), options_(options), results_(results) {}

void PairQueue::fill(std::size_t count) {
    for (std::size_t lane = 0; lane < count; ++lane) {
        load(lane, pairs_[order_[0]]); // lanes without a pair compute something harmless
        next(lane);
    }
}

void PairQueue::next(std::size_t lane) {
    if (lanes.active[lane] != 0.0)
        --working_;
    lanes.active[lane] = 0.0;
    lanes.t_end[lane] = lanes.time[lane]; // an idle lane takes steps of length 0
    if (next_ == order_.size())
        return;
    pair_[lane] = order_[next_++];
    load(lane, pairs_[pair_[lane]]);
    lanes.active[lane] = 1.0;
    ++working_;
    fresh_ = true;
}

void PairQueue::report(std::uint32_t taken) const {
    for (; taken != 0; taken &= taken - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(taken));
        options_.on_step(pair_[lane],
                         {lanes.time[lane], numbers(lanes.state, lane), numbers(lanes.rate, lane)});
    }
}

bool PairQueue::take_fresh() { return std::exchange(fresh_, false); }

void PairQueue::load(std::size_t lane, const PairProblem& pair) {
    PairLanes& l = lanes;
    const auto medium = elastic::KernelInternals::constants(elastic::Field(pair.medium));
    l.c_shear[lane] = medium.c_shear;
    l.nu[lane] = medium.nu;
    l.delta[lane] = medium.delta;
    l.inverse_nu[lane] = medium.inverse_nu;
    const double unit = 0.5 * std::numbers::inv_pi * medium.c_shear;
    const auto& [kappa, gamma1, gamma2] = pair.couplings;
    l.kappa[lane] = 0.5 * unit * kappa; // the kernels give twice the torque's parts
    l.gamma1[lane] = unit * medium.c_shear * gamma1;
    l.gamma2[lane] = unit * medium.c_shear * gamma2;
    l.time[lane] = 0.0;
    l.t_end[lane] = pair.t_end;
    l.forced[lane] = 0.0;
    const double contact = pair.contact_distance;
    l.contact_square[lane] = contact > 0.0 ? contact * contact : -1.0;
    l.tail_start[lane] = (1.0 - options_.criteria.steady_fraction) * pair.t_end;
    for (std::size_t k = 0; k < 6; ++k) {
        const Pose& rod = pair.rods[k / 3];
        l.state[k][lane] = l.start[k][lane] = k % 3 == 0 ? rod.x : k % 3 == 1 ? rod.y : rod.heading;
        l.rate[k][lane] = std::nan(""); // until the lanes evaluate it
    }
    l.smallest[lane] = separation(numbers(l.state, lane));
    l.late_least[lane] = std::numeric_limits<double>::infinity();
    for (LaneNumbers* zero : {&l.smallest_time, &l.late_most, &l.late_turning, &l.most_turned, &l.ahead_x,
                              &l.ahead_y, &l.attempts, &l.steps})
        (*zero)[lane] = 0.0;
    search_[lane] = {};
    contact_[lane] = false;
}

bool PairQueue::inspect(std::size_t lane) {
    PairLanes& l = lanes;
    LaneSearch& search = search_[lane];
    const State6 before = numbers(l.state, lane), after = numbers(l.end_state, lane);
    const integrate::Step step{l.time[lane], l.time[lane] + l.tried[lane], before, after};
    const double contact = pairs_[pair_[lane]].contact_distance, gap = separation(after) - contact;
    if (contact > 0.0 && gap <= 0.0 && search.aim != LaneSearch::Aim::root) {
        search = {LaneSearch::Aim::root, 0.0, l.tried[lane], 0};
        l.forced[lane] = fall_time(step, 0, 1, contact) - l.time[lane];
        return false;
    }
    if (contact > 0.0 && search.aim == LaneSearch::Aim::root) {
        // Contact is met as well as coordinates of this size resolve it, or the step halved to its last bit.
        constexpr int most_tries = 60;
        const double length = l.tried[lane];
        (gap > 0.0 ? search.outside : search.inside) = length;
        double largest = 0.0;
        for (const double number : after)
            largest = std::max(largest, std::abs(number));
        if (std::abs(gap) <= 1e-12 + 8.0 * ulp * largest || ++search.tries > most_tries) {
            contact_[lane] = true;
            l.forced[lane] = 0.0;
            return true;
        }
        // Newton's method, kept between a step that ends outside and one that ends inside.
        const State6 rate = numbers(l.end_rate, lane);
        const double closing =
            ((after[0] - after[3]) * (rate[0] - rate[3]) + (after[1] - after[4]) * (rate[1] - rate[4])) /
            separation(after);
        const double next = length - gap / closing;
        const bool between = next > search.outside && next < search.inside;
        l.forced[lane] = between ? next : 0.5 * (search.outside + search.inside);
        return false;
    }
    const auto approach = closest_approach(step);
    const bool looked = std::exchange(search.aim, LaneSearch::Aim::none) == LaneSearch::Aim::look;
    if (approach && approach->pair.distance < contact && !looked) {
        search.aim = LaneSearch::Aim::look;
        l.forced[lane] = approach->time - l.time[lane];
        return false;
    }
    if (approach && approach->pair.distance < l.smallest[lane]) {
        l.smallest[lane] = approach->pair.distance;
        l.smallest_time[lane] = approach->time;
    }
    l.forced[lane] = 0.0;
    return true;
}

void PairQueue::finish(std::size_t lane, PairEnding end) {
    const PairLanes& l = lanes;
    PairResult& result = results_[pair_[lane]];
    result = {};
    result.end = end;
    result.time = l.time[lane];
    result.state = numbers(l.state, lane);
    result.rate = numbers(l.rate, lane);
    result.separation = separation(result.state);
    result.min_separation = contact_[lane] ? result.separation : l.smallest[lane];
    result.min_separation_time = contact_[lane] ? result.time : l.smallest_time[lane];
    result.turn = {result.state[2] - l.start[2][lane], result.state[5] - l.start[5][lane]};
    result.ahead_x = l.ahead_x[lane];
    result.ahead_y = l.ahead_y[lane];
    result.steps = static_cast<long>(l.steps[lane]);
    result.rhs_evaluations =
        1 + static_cast<long>(integrate::tsitouras_famelis::stages - 1) * static_cast<long>(l.attempts[lane]);

    // Without a contact distance nothing holds behind a passage as close as the tolerance.
    const PairProblem& pair = pairs_[pair_[lane]];
    bool passed_through = false;
    if (pair.contact_distance == 0.0 && pair.couplings.any() && end == PairEnding::finished) {
        const double first = separation(numbers(l.start, lane)),
                     tolerance = options_.rtol + std::min(options_.atol, 0.1 * options_.rtol);
        passed_through = result.min_separation <= passing_resolution(result.state, first, tolerance);
    }
    if (contact_[lane])
        result.ending = Ending::contact;
    else if (passed_through)
        result.end = PairEnding::out_of_range; // rods::simulate says why
    else if (end == PairEnding::finished) {
        result.late = {l.late_least[lane], l.late_most[lane], l.late_turning[lane]};
        const Ending ending = classify_pair(result.state, result.rate, 0, 1, result.late, options_.criteria);
        const bool alone =
            ending == Ending::pursuit && // nobody follows whom he does not feel
            !reaches(pair.medium, pair.couplings, result.separation, pair.t_end, options_.criteria.felt_turn);
        result.ending = alone ? Ending::undecided : ending;
        if (ending == Ending::undecided) {
            const State6& y = result.state;
            const auto contact =
                pair.contact_distance > 0.0 ? std::optional(pair.contact_distance) : std::nullopt;
            if (const auto settled = settled_orbit(pair.medium, pair.couplings, {y[0], y[1], y[2]},
                                                   {y[3], y[4], y[5]}, contact)) {
                result.ending = Ending::orbit;
                result.orbit_separation = settled->orbit.separation[0];
                result.omega = settled->orbit.omega;
            }
        }
    }
    next(lane);
}

} // namespace rodwake::rods
