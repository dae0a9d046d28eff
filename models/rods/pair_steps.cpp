// One step of all lanes: Dormand-Prince 5(4) (Hairer, Norsett, Wanner I, table II.5.2). Compiled once for
// each instruction set (foreach_target includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pair_steps.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "pair_lanes.hpp"
#include "pair_rates_inl.hpp"

#include <algorithm>
#include <bit>
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

Constants LoadConstants(const PairLanes& l) {
    return {elastic::bessel_table().rows(),
            {Load(l.c_shear), Load(l.nu), Load(l.delta), Load(l.inverse_nu)},
            Load(l.kappa),
            Load(l.gamma1),
            Load(l.gamma2)};
}

constexpr double stage_weights[7][6] = {
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
constexpr double error_weights[7] = {71.0 / 57600,      0.0,        -71.0 / 16695, 71.0 / 1920,
                                     -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

/// Sum over the stages of weight and rate of a coordinate.
template<std::size_t stages>
HWY_INLINE V Weighted(const double* weights, const Rates* k, std::size_t coordinate) {
    const Lanes d;
    V sum = hn::Mul(hn::Set(d, weights[0]), k[0].of[coordinate]);
    for (std::size_t s = 1; s < stages; ++s)
        if (s != 1 || stages < 6) // the second stage counts in neither the solution nor its error
            sum = Fma(d, hn::Set(d, weights[s]), k[s].of[coordinate], sum);
    return sum;
}

/// Headings and separation at an inner stage: all its rates need.
template<std::size_t stage>
HWY_INLINE Relative StageAt(const V (&y)[6], V h, const Rates* k) {
    const Lanes d;
    const auto sum = [&](std::size_t i) HWY_ATTR { return Weighted<stage>(stage_weights[stage], k, i); };
    const V x = hn::Sub(sum(0), sum(3)), across = hn::Sub(sum(1), sum(4));
    return {Fma(d, h, x, hn::Sub(y[0], y[3])),
            Fma(d, h, across, hn::Sub(y[1], y[4])),
            {Fma(d, h, sum(2), y[2]), Fma(d, h, sum(5), y[5])}};
}

struct Attempt {
    V end[6];
    V error_square; ///< of the error over the tolerance
    M in_range;
};

template<bool polar>
HWY_INLINE Attempt TryStep(const V (&y)[6], V h, Rates* k, const Constants& c, double rtol, double atol) {
    const Lanes d;
    k[1] = RatesAt<polar>(StageAt<1>(y, h, k), c);
    k[2] = RatesAt<polar>(StageAt<2>(y, h, k), c);
    k[3] = RatesAt<polar>(StageAt<3>(y, h, k), c);
    k[4] = RatesAt<polar>(StageAt<4>(y, h, k), c);
    k[5] = RatesAt<polar>(StageAt<5>(y, h, k), c);
    Attempt result;
    for (std::size_t i = 0; i < 6; ++i)
        result.end[i] = Fma(d, h, Weighted<6>(stage_weights[6], k, i), y[i]);
    const V(&end)[6] = result.end;
    k[6] = RatesAt<polar>({hn::Sub(end[0], end[3]), hn::Sub(end[1], end[4]), {end[2], end[5]}}, c);
    result.error_square = hn::Zero(d);
    for (std::size_t i = 0; i < 6; ++i) {
        const V error = hn::Mul(h, Weighted<7>(error_weights, k, i));
        const V size =
            hn::Min(hn::Max(hn::Abs(y[i]), hn::Abs(end[i])), hn::Set(d, 1.0)); // OdeProblem::relative_cap
        const V part = hn::Div(error, Fma(d, hn::Set(d, rtol), size, hn::Set(d, atol)));
        result.error_square = Fma(d, part, part, result.error_square);
    }
    result.in_range = k[1].in_range;
    for (std::size_t s = 2; s < 7; ++s)
        result.in_range = hn::And(result.in_range, k[s].in_range);
    return result;
}

/// Factor for the next step: 0.8 error^(-1/5), between 1/5 and 5. The logarithm is good to 1e-3.
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
    // ln(5/0.8) + ln(error)/5
    const V below = hn::Max(Fma(d, log[0], hn::Set(d, 0.1), hn::Set(d, 1.8325814637483101)), hn::Zero(d));
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
    const M late = hn::And(taken, hn::Ge(time, Load(l.late_from)));
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

/// Rates of pairs that have just been taken up.
template<bool polar>
HWY_NOINLINE void StartRates(PairLanes& l) {
    V y[6];
    for (std::size_t i = 0; i < 6; ++i)
        y[i] = Load(l.state[i]);
    const Rates rates =
        RatesAt<polar>({hn::Sub(y[0], y[3]), hn::Sub(y[1], y[4]), {y[2], y[5]}}, LoadConstants(l));
    const V known = Load(l.rate[0]);
    const M fresh = hn::Not(hn::Eq(known, known)); // not a number
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

/// One step of every lane that has a pair, and what follows from it.
template<bool polar>
HWY_INLINE void StepLanes(PairQueue& queue, double rtol, double atol) {
    const Lanes d;
    PairLanes& l = queue.lanes;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0), time = Load(l.time), forced = Load(l.forced);
    const M active = hn::Gt(Load(l.active), zero), is_forced = hn::Gt(forced, zero);
    V y[6];
    Rates k[7];
    for (std::size_t i = 0; i < 6; ++i) {
        y[i] = Load(l.state[i]);
        k[0].of[i] = Load(l.rate[i]);
    }
    const V rest = hn::Sub(Load(l.t_end), time);
    const V late_from = Load(l.late_from), wanted = Load(l.step);
    const V to_late =
        hn::IfThenElse(hn::Lt(time, late_from), hn::Sub(late_from, time), rest); // a step ends there
    V h = hn::Min(hn::Min(wanted, EncounterStep(y, k[0])), hn::Min(to_late, rest));
    h = hn::IfThenElse(is_forced, forced, h);
    const Attempt attempt = TryStep<polar>(y, h, k, LoadConstants(l), rtol, atol);

    const M passed = hn::And(attempt.in_range, hn::Or(is_forced, hn::Le(attempt.error_square, one)));
    const M accepted = hn::And(active, passed);
    const V x = hn::Sub(attempt.end[0], attempt.end[3]), across = hn::Sub(attempt.end[1], attempt.end[4]);
    const V square = Fma(d, x, x, hn::Mul(across, across));
    const M turns = hn::And(hn::Lt(SquareRate(y, k[0]), zero), hn::Gt(SquareRate(attempt.end, k[6]), zero));
    const M close = hn::Le(square, Load(l.contact_square));
    std::uint32_t taken_bits = Bits(accepted);
    const std::uint32_t look = Bits(hn::And(accepted, hn::Or(is_forced, hn::Or(turns, close))));
    if (HWY_UNLIKELY(look != 0)) {
        Store(h, l.tried);
        for (std::size_t i = 0; i < 6; ++i) {
            Store(attempt.end[i], l.end_state[i]);
            Store(k[6].of[i], l.end_rate[i]);
        }
        for (std::uint32_t left = look; left != 0; left &= left - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(left));
            if (!queue.inspect(lane))
                taken_bits &= ~(1u << lane);
        }
    }
    const M taken = FromBits(taken_bits);
    const M to_end = hn::Ge(h, rest), cut = hn::AndNot(to_end, hn::Ge(h, to_late));
    V end_time = hn::IfThenElse(to_end, Load(l.t_end), hn::Add(time, h));
    end_time = hn::IfThenElse(cut, late_from, end_time);
    Record(l, taken, end_time, attempt.end, k[6], square);
    for (std::size_t i = 0; i < 6; ++i) {
        StoreIf(taken, attempt.end[i], l.state[i]);
        StoreIf(taken, k[6].of[i], l.rate[i]);
    }
    StoreIf(taken, end_time, l.time);
    // a step that only looks for a meeting tells nothing of the next one's length, one cut short little
    const V next = hn::Mul(h, StepFactor(attempt.error_square));
    StoreIf(hn::AndNot(is_forced, active), hn::IfThenElse(hn::And(cut, taken), hn::Max(next, wanted), next),
            l.step);
    const V attempts = hn::Add(Load(l.attempts), one);
    Store(attempts, l.attempts);
    StoreIf(taken, hn::Add(Load(l.steps), one), l.steps);

    const M at_end = hn::And(taken, hn::Ge(end_time, Load(l.t_end)));
    const M lost = hn::And(active, hn::Or(hn::Not(attempt.in_range), hn::Le(hn::Add(time, h), time)));
    const M tired =
        hn::And(active, hn::Ge(attempts, hn::Set(d, static_cast<double>(queue.options().max_attempts))));
    std::uint32_t ended = Bits(hn::Or(at_end, hn::Or(lost, tired))) | (look & taken_bits);
    for (; ended != 0; ended &= ended - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(ended));
        const std::uint32_t bit = 1u << lane;
        if ((Bits(at_end) & bit) != 0 || queue.in_contact(lane))
            queue.finish(lane, PairEnding::finished);
        else if ((Bits(lost) & bit) != 0)
            queue.finish(lane, PairEnding::out_of_range);
        else if ((Bits(tired) & bit) != 0)
            queue.finish(lane, PairEnding::too_many_steps);
    }
}

template<bool polar>
HWY_INLINE void Run(PairQueue& queue) {
    const double rtol = queue.options().rtol,
                 atol = std::min(queue.options().atol, 0.1 * rtol); // as rods::simulate
    while (!queue.done()) {
        if (queue.take_fresh())
            StartRates<polar>(queue.lanes);
        StepLanes<polar>(queue, rtol, atol);
    }
}

void RunApolar(PairQueue& queue) { Run<false>(queue); }
void RunPolar(PairQueue& queue) { Run<true>(queue); }

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::rods {

HWY_EXPORT(LaneCount);
HWY_EXPORT(RunApolar);
HWY_EXPORT(RunPolar);

std::size_t pair_lane_count() { return HWY_DYNAMIC_DISPATCH(LaneCount)(); }

void run_pairs(PairQueue& queue, bool polar) {
    if (polar)
        HWY_DYNAMIC_DISPATCH(RunPolar)(queue);
    else
        HWY_DYNAMIC_DISPATCH(RunApolar)(queue);
}

} // namespace rodwake::rods
#endif
