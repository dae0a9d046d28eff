// Compiled once for each instruction set (foreach_target includes this file again).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pair_jets.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "pair_jets.hpp"
#include "pair_jets_inl.hpp"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace rodwake::rods::HWY_NAMESPACE {

template<bool polar>
bool FillAll(PairJets& jets, const PairConstants& c) {
    const Lanes d;
    M good = hn::Eq(hn::Zero(d), hn::Zero(d));
    for (std::size_t at = 0; at < jets.states; at += lane_count) {
        const auto load = [&](std::size_t column)
                              HWY_ATTR { return hn::LoadU(d, jets.at[column].data() + at); };
        const auto store = [&](std::size_t column, V v)
                               HWY_ATTR { hn::StoreU(v, d, jets.at[column].data() + at); };
        const Jets item = JetsAt<polar>(
            {load(PairJets::x), load(PairJets::y), {load(PairJets::heading0), load(PairJets::heading1)}}, c);
        for (std::size_t rod = 0; rod < 2; ++rod) {
            const std::size_t first = rod == 0 ? PairJets::rate0 : PairJets::rate1;
            store(first, item.rate[rod]);
            for (std::size_t k = 0; k < 4; ++k)
                store(first + 1 + k, item.by[rod][k]);
            store(PairJets::cosine0 + 2 * rod, item.n[rod].cosine);
            store(PairJets::sine0 + 2 * rod, item.n[rod].sine);
        }
        good = hn::And(good, item.good);
    }
    return hn::AllTrue(d, good);
}

bool FillJets(const elastic::Medium& medium, const Couplings& couplings, PairJets& jets) {
    const PairConstants c = ConstantsOf(medium, couplings);
    return couplings.polar() ? FillAll<true>(jets, c) : FillAll<false>(jets, c);
}

} // namespace rodwake::rods::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rodwake::rods {

HWY_EXPORT(FillJets);

void PairJets::resize(std::size_t count) {
    states = count;
    for (std::vector<double>& column : at)
        column.resize((count + most_lanes - 1) / most_lanes * most_lanes);
}

bool fill_jets(const elastic::Medium& medium, const Couplings& couplings, PairJets& jets) {
    if (jets.states == 0)
        return true;
    for (std::size_t k = 0; k < PairJets::rate0; ++k) // what fills the last vector must be harmless
        std::fill(jets.at[k].begin() + static_cast<std::ptrdiff_t>(jets.states), jets.at[k].end(),
                  jets.at[k][jets.states - 1]);
    return medium.eta >= 0.0 && HWY_DYNAMIC_DISPATCH(FillJets)(medium, couplings, jets);
}

} // namespace rodwake::rods
#endif
