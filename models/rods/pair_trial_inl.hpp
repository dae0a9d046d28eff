// A trial step of many pairs, a pair a lane: Dormand-Prince 5(4), the end and its error (include after
// foreach_target.h).

#if defined(RODWAKE_RODS_PAIR_TRIAL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_RODS_PAIR_TRIAL_INL
#undef RODWAKE_RODS_PAIR_TRIAL_INL
#else
#define RODWAKE_RODS_PAIR_TRIAL_INL
#endif

#include "pair_rates_inl.hpp"
#include "rodwake/integrate/dormand_prince.hpp"

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

using integrate::error_weights, integrate::stage_weights;

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

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
