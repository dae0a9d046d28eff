// A trial step of many pairs, a pair a lane: the end and its error (include after
// foreach_target.h).

#if defined(RODWAKE_RODS_PAIR_TRIAL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef RODWAKE_RODS_PAIR_TRIAL_INL
#undef RODWAKE_RODS_PAIR_TRIAL_INL
#else
#define RODWAKE_RODS_PAIR_TRIAL_INL
#endif

#include "pair_rates_inl.hpp"
#include "rodwake/integrate/tsitouras_famelis.hpp"

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

namespace tableau = integrate::tsitouras_famelis;

/// Sum over the stages of weight and of a part of their rates.
template<std::size_t count, std::size_t all, class Part>
HWY_INLINE V Weighted(const double (&weights)[all], const Part& part) {
    const Lanes d;
    V sum = hn::Mul(hn::Set(d, weights[0]), part(0));
    RODWAKE_UNROLL
    for (std::size_t s = 1; s < count; ++s)
        if (weights[s] != 0.0)
            sum = Fma(d, hn::Set(d, weights[s]), part(s), sum);
    return sum;
}

template<std::size_t count, std::size_t all>
HWY_INLINE V Weighted(const double (&weights)[all], const Rates* k, std::size_t coordinate) {
    return Weighted<count>(weights, [&](std::size_t s) HWY_ATTR { return k[s].of[coordinate]; });
}

/// Headings and separation at an inner stage: all its rates need.
template<std::size_t stage>
HWY_INLINE Relative StageAt(const V (&y)[6], V h, const Rates* k) {
    const Lanes d;
    const auto& weights = tableau::stage_weights[stage];
    const auto apart = [&](std::size_t i) HWY_ATTR {
        return Weighted<stage>(weights, [&](std::size_t s) HWY_ATTR { return k[s].apart[i]; });
    };
    return {
        Fma(d, h, apart(0), hn::Sub(y[0], y[3])),
        Fma(d, h, apart(1), hn::Sub(y[1], y[4])),
        {Fma(d, h, Weighted<stage>(weights, k, 2), y[2]), Fma(d, h, Weighted<stage>(weights, k, 5), y[5])}};
}

/// A step of a vector of pairs: what it starts from, and how it ends.
struct Trial {
    V y[6], h;
    Rates k[tableau::stages]; ///< the first known before, the last that of the end
    V end[6];
    V error_square; ///< of the error over the tolerance
    M in_range;

    const Rates& end_rate() const { return k[tableau::stages - 1]; }
};

/// Rates of the inner stages. Two vectors in turns: one works while the other waits for its own results.
template<bool polar, std::size_t stage, std::size_t n>
HWY_INLINE void InnerStages(Trial (&trial)[n], const PairConstants (&c)[n]) {
    if constexpr (stage < tableau::stages - 1) {
        RODWAKE_UNROLL
        for (std::size_t v = 0; v < n; ++v) {
            Trial& t = trial[v];
            t.k[stage] = RatesAt<polar>(StageAt<stage>(t.y, t.h, t.k), c[v]);
        }
        InnerStages<polar, stage + 1>(trial, c);
    }
}

HWY_INLINE void Assess(Trial& t, double rtol, double atol) {
    const Lanes d;
    t.error_square = hn::Zero(d);
    for (std::size_t i = 0; i < 6; ++i) {
        const V error = hn::Mul(t.h, Weighted<tableau::stages>(tableau::error_weights, t.k, i));
        const V size =
            hn::Min(hn::Max(hn::Abs(t.y[i]), hn::Abs(t.end[i])), hn::Set(d, 1.0)); // OdeProblem::relative_cap
        const V part = hn::Div(error, Fma(d, hn::Set(d, rtol), size, hn::Set(d, atol)));
        t.error_square = Fma(d, part, part, t.error_square);
    }
    t.in_range = t.k[1].in_range;
    for (std::size_t s = 2; s < tableau::stages; ++s)
        t.in_range = hn::And(t.in_range, t.k[s].in_range);
}

template<bool polar, std::size_t n>
HWY_INLINE void TrySteps(Trial (&trial)[n], const PairConstants (&c)[n], double rtol, double atol) {
    const Lanes d;
    constexpr std::size_t last = tableau::stages - 1;
    InnerStages<polar, 1>(trial, c);
    RODWAKE_UNROLL
    for (std::size_t v = 0; v < n; ++v) {
        Trial& t = trial[v];
        V(&end)[6] = t.end;
        for (std::size_t i = 0; i < 6; ++i)
            end[i] = Fma(d, t.h, Weighted<last>(tableau::stage_weights[last], t.k, i), t.y[i]);
        t.k[last] =
            RatesAt<polar>({hn::Sub(end[0], end[3]), hn::Sub(end[1], end[4]), {end[2], end[5]}}, c[v]);
    }
    for (Trial& t : trial)
        Assess(t, rtol, atol);
}

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
