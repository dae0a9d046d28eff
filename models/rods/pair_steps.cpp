// The lanes step by step, until the queue is empty. Compiled once for each instruction set (foreach_target
// includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pair_steps.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "pair_lanes.hpp"
#include "pair_trial_inl.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

using elastic::HWY_NAMESPACE::ExpMinus;

std::size_t LaneCount() { return lane_count; }

HWY_INLINE V Load(const LaneNumbers& numbers) { return hn::Load(Lanes(), numbers.at); }
HWY_INLINE void Store(V v, LaneNumbers& numbers) { hn::Store(v, Lanes(), numbers.at); }
HWY_INLINE void StoreIf(M mask, V v, LaneNumbers& numbers) {
    Store(hn::IfThenElse(mask, v, Load(numbers)), numbers);
}

PairConstants LoadConstants(const PairLanes& l) {
    return {elastic::bessel_table().rows(),
            {Load(l.c_shear), Load(l.nu), Load(l.delta), Load(l.inverse_nu)},
            Load(l.kappa),
            Load(l.gamma1),
            Load(l.gamma2)};
}

/// Factor for the next step: 0.8 error^(-1/6), between 1/5 and 5. The logarithm is good to 1e-3.
HWY_INLINE V StepFactor(V error_square) {
    const Lanes d;
    const hn::RebindToUnsigned<Lanes> u;
    const auto bits = hn::BitCast(u, error_square);
    const V power = hn::Set(d, 0x1p52);
    const V exponent = hn::Sub(hn::BitCast(d, hn::Or(hn::ShiftRight<52>(bits), hn::BitCast(u, power))),
                               hn::Set(d, 0x1p52 + 1023.0));
    const V m = hn::BitCast(
        d, hn::Or(hn::And(bits, hn::Set(u, (std::uint64_t{1} << 52) - 1)), hn::BitCast(u, hn::Set(d, 1.0))));
    constexpr double log_of_mantissa[] = {-1.7417939, 2.8212026, -1.4699568, 0.44717955, -0.056570851};
    V log[1];
    elastic::HWY_NAMESPACE::Polynomials(d, {m}, log_of_mantissa, log);
    log[0] = Fma(d, exponent, hn::Set(d, 0.69314718), log[0]);
    // ln(5/0.8) + ln(error)/6
    const V below =
        hn::Max(Fma(d, log[0], hn::Set(d, 1.0 / 12), hn::Set(d, 1.8325814637483101)), hn::Zero(d));
    elastic::HWY_NAMESPACE::Exponential<Lanes> fall[1];
    ExpMinus(d, {below}, fall);
    const V factor = hn::Max(hn::Mul(hn::Set(d, 5.0), fall[0].value), hn::Set(d, 0.2));
    return hn::IfThenElse(hn::Lt(error_square, hn::Set(d, 1e300)), factor,
                          hn::Set(d, 0.2)); // not a number: 1/5
}

/// Longest step in which a meeting cannot be passed unseen: encounter_step of separation.hpp.
HWY_INLINE V EncounterStep(const V (&y)[6], const Rates& rate) {
    const Lanes d;
    const V x = hn::Sub(y[0], y[3]), across = hn::Sub(y[1], y[4]);
    const V vx = hn::Sub(rate.of[0], rate.of[3]), vy = hn::Sub(rate.of[1], rate.of[4]);
    const V r = hn::Sqrt(Fma(d, x, x, hn::Mul(across, across))),
            speed = hn::Sqrt(Fma(d, vx, vx, hn::Mul(vy, vy)));
    return hn::Div(r, hn::Mul(hn::Set(d, 3.0), hn::Max(speed, hn::Set(d, 0.5))));
}

/// Half the rate of change of the squared separation.
HWY_INLINE V SquareRate(const V (&y)[6], const Rates& rate) {
    const Lanes d;
    return Fma(d, hn::Sub(y[0], y[3]), hn::Sub(rate.of[0], rate.of[3]),
               hn::Mul(hn::Sub(y[1], y[4]), hn::Sub(rate.of[1], rate.of[4])));
}

/// SeparationRecord and the rods' order when they had turned most, of the lanes whose step is taken.
HWY_INLINE void Record(PairLanes& l, M taken, V time, const V (&end)[6], const Rates& rate, V square) {
    const V r = hn::Sqrt(square);
    const M smaller = hn::And(taken, hn::Lt(r, Load(l.smallest)));
    StoreIf(smaller, r, l.smallest);
    StoreIf(smaller, time, l.smallest_time);
    const M late = hn::And(taken, hn::Ge(time, Load(l.tail_start)));
    const V turning = hn::Max(hn::Abs(rate.of[2]), hn::Abs(rate.of[5]));
    StoreIf(late, hn::Min(Load(l.late_least), r), l.late_least);
    StoreIf(late, hn::Max(Load(l.late_most), r), l.late_most);
    StoreIf(late, hn::Max(Load(l.late_turning), turning), l.late_turning);
    const V all =
        hn::Add(hn::Abs(hn::Sub(end[2], Load(l.start[2]))), hn::Abs(hn::Sub(end[5], Load(l.start[5]))));
    const M most = hn::And(taken, hn::Gt(all, Load(l.most_turned)));
    StoreIf(most, all, l.most_turned);
    const auto moved = [&](std::size_t k) HWY_ATTR {
        return hn::Add(hn::Sub(hn::Sub(end[k], end[k + 3]), Load(l.start[k])), Load(l.start[k + 3]));
    };
    StoreIf(most, moved(0), l.ahead_x);
    StoreIf(most, moved(1), l.ahead_y);
}

/// By how much the headings may turn in a first step.
double FirstTurn(double rtol) { return 0.3 * std::sqrt(std::sqrt(std::sqrt(rtol))); }

/// Rates and first steps of pairs that have just been taken up.
template<bool polar>
HWY_NOINLINE void StartRates(PairLanes& l, double rtol) {
    const Lanes d;
    V y[6];
    for (std::size_t i = 0; i < 6; ++i)
        y[i] = Load(l.state[i]);
    const Rates rates =
        RatesAt<polar>({hn::Sub(y[0], y[3]), hn::Sub(y[1], y[4]), {y[2], y[5]}}, LoadConstants(l));
    const V known = Load(l.rate[0]);
    const M fresh = hn::Not(hn::Eq(known, known)); // not a number
    const V turn = hn::Set(d, FirstTurn(rtol)), turning = hn::Max(hn::Abs(rates.of[2]), hn::Abs(rates.of[5]));
    StoreIf(fresh, hn::Div(turn, hn::Max(turning, turn)), l.step); // at most 1
    for (std::size_t i = 0; i < 6; ++i)
        StoreIf(fresh, rates.of[i], l.rate[i]);
}

/// A bit a lane.
HWY_INLINE std::uint32_t Bits(M mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Lanes(), mask, bytes);
    return bytes[0] & ((1u << lane_count) - 1u);
}

HWY_INLINE M FromBits(std::uint32_t bits) {
    const Lanes d;
    HWY_ALIGN double ones[lane_count];
    for (std::size_t lane = 0; lane < lane_count; ++lane)
        ones[lane] = (bits >> lane & 1u) != 0 ? 1.0 : 0.0;
    return hn::Ne(hn::Load(d, ones), hn::Zero(d));
}

/// How far the lanes may go: as error control wants, to the late part or the end, or to where a meeting is
/// looked for.
struct LaneSteps {
    V time, wanted, forced, to_late, rest;
};

HWY_INLINE LaneSteps BoundsOf(const PairLanes& l) {
    const V time = Load(l.time), tail_start = Load(l.tail_start), rest = hn::Sub(Load(l.t_end), time);
    const V to_late =
        hn::IfThenElse(hn::Lt(time, tail_start), hn::Sub(tail_start, time), rest); // a step ends there
    return {time, Load(l.step), Load(l.forced), to_late, rest};
}

HWY_INLINE V StepOf(const LaneSteps& bounds, const V (&y)[6], const Rates& rate) {
    const V free = hn::Min(bounds.wanted, EncounterStep(y, rate)), end = hn::Min(bounds.to_late, bounds.rest);
    return hn::IfThenElse(hn::Gt(bounds.forced, hn::Zero(Lanes())), bounds.forced, hn::Min(free, end));
}

/// Lanes whose step is taken, of those that passed: the others go back for a step that lands on a meeting.
HWY_INLINE M InspectLanes(PairQueue& queue, M passed, std::uint32_t look, const Trial& trial) {
    PairLanes& l = queue.lanes;
    if (HWY_LIKELY(look == 0))
        return passed;
    Store(trial.h, l.tried);
    for (std::size_t i = 0; i < 6; ++i) {
        Store(trial.end[i], l.end_state[i]);
        Store(trial.end_rate().of[i], l.end_rate[i]);
    }
    std::uint32_t taken = Bits(passed);
    for (; look != 0; look &= look - 1) {
        const int lane = std::countr_zero(look);
        if (!queue.inspect(static_cast<std::size_t>(lane)))
            taken &= ~(1u << lane);
    }
    return FromBits(taken);
}

/// Lanes that are through, for one reason or another; `looked`: those that may have met.
struct Ended {
    std::uint32_t at_end, lost, tired, looked;
};

HWY_INLINE void FinishLanes(PairQueue& queue, const Ended& ended) {
    std::uint32_t left = ended.at_end | ended.lost | ended.tired | ended.looked;
    for (; left != 0; left &= left - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(left));
        const std::uint32_t bit = 1u << lane;
        if ((ended.at_end & bit) != 0 || queue.in_contact(lane))
            queue.finish(lane, PairEnding::finished);
        else if ((ended.lost & bit) != 0)
            queue.finish(lane, PairEnding::out_of_range);
        else if ((ended.tired & bit) != 0)
            queue.finish(lane, PairEnding::too_many_steps);
    }
}

/// Lanes that may have met or passed each other in the step: in contact, or closer in between than at both
/// ends.
HWY_INLINE M MayMeet(const PairLanes& l, const Trial& trial, V square) {
    const V zero = hn::Zero(Lanes());
    const M turns = hn::And(hn::Lt(SquareRate(trial.y, trial.k[0]), zero),
                            hn::Gt(SquareRate(trial.end, trial.end_rate()), zero));
    return hn::Or(turns, hn::Le(square, Load(l.contact_square)));
}

/// Time, step and counts after an attempt; the time at its end is returned.
HWY_INLINE V Advance(PairLanes& l, M taken, M active, const LaneSteps& bounds, V h, V error_square) {
    const Lanes d;
    const M to_end = hn::Ge(h, bounds.rest), cut = hn::AndNot(to_end, hn::Ge(h, bounds.to_late));
    V time = hn::IfThenElse(to_end, Load(l.t_end), hn::Add(bounds.time, h));
    time = hn::IfThenElse(cut, Load(l.tail_start), time);
    StoreIf(taken, time, l.time);
    // a step that only looks for a meeting tells nothing of the next one's length, one cut short little
    const V next = hn::Mul(h, StepFactor(error_square));
    const V step = hn::IfThenElse(hn::And(cut, taken), hn::Max(next, bounds.wanted), next);
    StoreIf(hn::AndNot(hn::Gt(bounds.forced, hn::Zero(d)), active), step, l.step);
    Store(hn::Add(Load(l.attempts), hn::Set(d, 1.0)), l.attempts);
    StoreIf(taken, hn::Add(Load(l.steps), hn::Set(d, 1.0)), l.steps);
    return time;
}

HWY_INLINE void Begin(const PairLanes& l, const LaneSteps& bounds, Trial& trial) {
    for (std::size_t i = 0; i < 6; ++i) {
        trial.y[i] = Load(l.state[i]);
        trial.k[0].of[i] = Load(l.rate[i]);
    }
    for (std::size_t i = 0; i < 2; ++i)
        trial.k[0].apart[i] = hn::Sub(trial.k[0].of[i], trial.k[0].of[i + 3]);
    trial.h = StepOf(bounds, trial.y, trial.k[0]);
}

/// What follows from a step.
HWY_INLINE void Settle(PairQueue& queue, const LaneSteps& bounds, const Trial& trial) {
    const Lanes d;
    PairLanes& l = queue.lanes;
    const M active = hn::Gt(Load(l.active), hn::Zero(d)), forced = hn::Gt(bounds.forced, hn::Zero(d));
    const M good = hn::Or(forced, hn::Le(trial.error_square, hn::Set(d, 1.0)));
    const M passed = hn::And(active, hn::And(trial.in_range, good));
    const V x = hn::Sub(trial.end[0], trial.end[3]), across = hn::Sub(trial.end[1], trial.end[4]);
    const V square = Fma(d, x, x, hn::Mul(across, across));
    const std::uint32_t look = Bits(hn::And(passed, hn::Or(forced, MayMeet(l, trial, square))));
    const M taken = InspectLanes(queue, passed, look, trial);

    const V time = Advance(l, taken, active, bounds, trial.h, trial.error_square);
    Record(l, taken, time, trial.end, trial.end_rate(), square);
    for (std::size_t i = 0; i < 6; ++i) {
        StoreIf(taken, trial.end[i], l.state[i]);
        StoreIf(taken, trial.end_rate().of[i], l.rate[i]);
    }
    if (HWY_UNLIKELY(static_cast<bool>(queue.options().on_step)))
        queue.report(Bits(taken));
    const V most = hn::Set(d, static_cast<double>(queue.options().max_attempts));
    const M lost = hn::Or(hn::Not(trial.in_range), hn::Le(hn::Add(bounds.time, trial.h), bounds.time));
    FinishLanes(queue, {Bits(hn::And(taken, hn::Ge(time, Load(l.t_end)))), Bits(hn::And(active, lost)),
                        Bits(hn::And(active, hn::Ge(Load(l.attempts), most))), look & Bits(taken)});
}

/// One step of every lane that has a pair.
template<bool polar, std::size_t n>
HWY_INLINE void StepLanes(PairQueue* const (&queues)[n], double rtol, double atol) {
    Trial trial[n];
    LaneSteps bounds[n];
    PairConstants constants[n];
    for (std::size_t v = 0; v < n; ++v) {
        PairLanes& l = queues[v]->lanes;
        if (queues[v]->take_fresh())
            StartRates<polar>(l, rtol);
        bounds[v] = BoundsOf(l);
        constants[v] = LoadConstants(l);
        Begin(l, bounds[v], trial[v]);
    }
    TrySteps<polar>(trial, constants, rtol, atol);
    for (std::size_t v = 0; v < n; ++v)
        Settle(*queues[v], bounds[v], trial[v]);
}

template<bool polar>
HWY_INLINE void Run(PairQueue& first, PairQueue& second) {
    const PairOptions& options = first.options();
    const double lenient = tableau::leniency(options.rtol, 14.0), rtol = lenient * options.rtol,
                 atol = lenient * std::min(options.atol, 0.1 * options.rtol); // as rods::simulate
    while (!first.done() && !second.done())
        StepLanes<polar, 2>({&first, &second}, rtol, atol);
    for (PairQueue* const left : {&first, &second})
        while (!left->done())
            StepLanes<polar, 1>({left}, rtol, atol);
}

void RunApolar(PairQueue& first, PairQueue& second) { Run<false>(first, second); }
void RunPolar(PairQueue& first, PairQueue& second) { Run<true>(first, second); }

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::rods {

HWY_EXPORT(LaneCount);
HWY_EXPORT(RunApolar);
HWY_EXPORT(RunPolar);

std::size_t pair_lane_count() { return HWY_DYNAMIC_DISPATCH(LaneCount)(); }

void run_pairs(PairQueue& first, PairQueue& second, bool polar) {
    if (polar)
        HWY_DYNAMIC_DISPATCH(RunPolar)(first, second);
    else
        HWY_DYNAMIC_DISPATCH(RunApolar)(first, second);
}

} // namespace rodwake::rods
#endif
