#include "rodwake/granular/bead_kinds.hpp"

#include "packing.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/granular/problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::granular {

namespace {

constexpr double cut = 2.0; // deviations from the mean radius of a kind
} // namespace

bool BeadMix::one_size() const {
    return std::ranges::all_of(kinds,
                               [&](const BeadKind& kind) { return kind.radius == kinds.front().radius; });
}

double BeadMix::smallest() const {
    const double least = kinds.empty() ? radius : std::ranges::min(kinds, {}, &BeadKind::radius).radius;
    return least * (1.0 - cut * spread);
}

double BeadMix::largest() const {
    const double most = kinds.empty() ? radius : std::ranges::max(kinds, {}, &BeadKind::radius).radius;
    return most * (1.0 + cut * spread);
}

double BeadMix::root_mean_square() const {
    if (kinds.empty())
        return radius;
    double squares = 0.0, shares = 0.0;
    for (const BeadKind& kind : kinds) {
        squares += kind.share * kind.radius * kind.radius;
        shares += kind.share;
    }
    return one_size() ? kinds.front().radius
                      : std::sqrt(squares / shares); // without rounding if there is no mean
}

std::size_t BeadMix::nearest(double to_radius) const {
    const auto found = std::ranges::min_element(
        kinds, {}, [&](const BeadKind& kind) { return std::abs(kind.radius - to_radius); });
    return found == kinds.end() ? 0 : static_cast<std::size_t>(found - kinds.begin());
}

std::vector<std::size_t> BeadMix::counts(std::size_t beads) const {
    if (kinds.empty())
        return {beads};
    double shares = 0.0;
    for (const BeadKind& kind : kinds)
        shares += kind.share;
    std::vector<std::size_t> count, by_remainder(kinds.size());
    std::vector<double> remainder;
    for (const BeadKind& kind : kinds) {
        const double quota = static_cast<double>(beads) * (kind.share / shares);
        count.push_back(static_cast<std::size_t>(quota));
        remainder.push_back(quota - std::floor(quota));
    }
    std::iota(by_remainder.begin(), by_remainder.end(), std::size_t{0});
    std::ranges::stable_sort(by_remainder, std::ranges::greater(),
                             [&](std::size_t k) { return remainder[k]; });
    const std::size_t given = std::accumulate(count.begin(), count.end(), std::size_t{0});
    for (std::size_t k = 0; k < count.size() && given + k < beads; ++k)
        ++count[by_remainder[k]];
    return count;
}

void require_sizes(const BeadMix& mix, const BeadSizes& sizes, const char* what) {
    const double factor = mix.spread > 0.0 ? 1.1 : 1.0 + 1e-9, most = factor * (1.0 + cut * mix.spread),
                 least = (1.0 - cut * mix.spread) / factor;
    const std::size_t kinds = std::max<std::size_t>(mix.kinds.size(), 1);
    for (std::size_t i = 0; i < sizes.radius.size(); ++i) {
        const std::size_t kind = sizes.kind[i];
        if (kind >= kinds)
            throw InputError(
                fmt::format("{} bead {} is of kind {}, and kinds are numbered from 0 to {}: give the "
                            "[[granular.bead_kinds]] of these beads",
                            what, i, kind, kinds - 1));
        const double mean = mix.kinds.empty() ? mix.radius : mix.kinds[kind].radius;
        if (!(sizes.radius[i] >= least * mean && sizes.radius[i] <= most * mean))
            throw InputError(fmt::format(
                "{} bead {} of kind {} has a radius of {:.10g} m, and its kind {:.10g} m "
                "with bead_spread = {:g}: must be {:.6g} to {:.6g} m; give the sizes of these beads",
                what, i, kind, sizes.radius[i], mean, mix.spread, least * mean, most * mean));
    }
}

std::vector<std::size_t> kind_counts(const GranularProblem& problem) {
    if (!problem.given || problem.given->kind.empty())
        return bead_mix(problem).counts(problem.beads);
    std::vector<std::size_t> counts(std::max<std::size_t>(problem.bead_kinds.size(), 1), 0);
    for (const std::uint8_t kind : problem.given->kind)
        if (kind < counts.size()) // others are refused by require_sizes
            ++counts[kind];
    return counts;
}

namespace {

/// Kinds in the numbers of their shares, dealt to the beads in an order drawn at random.
std::vector<std::uint8_t> dealt_kinds(const GranularProblem& problem, const BeadMix& mix, std::uint32_t run) {
    std::vector<std::uint8_t> kinds(problem.beads, 0);
    if (mix.kinds.size() < 2)
        return kinds;
    std::vector<double> rank(problem.beads);
    for (std::size_t i = 0; i < problem.beads; ++i)
        rank[i] = stream_for(Purpose::kind, problem.seed, run, i).uniform();
    std::vector<std::size_t> order(problem.beads);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return rank[i]; });
    auto next = order.begin();
    const std::vector<std::size_t> counts = mix.counts(problem.beads);
    for (std::size_t k = 0; k < counts.size(); ++k)
        for (std::size_t n = 0; n < counts[k]; ++n)
            kinds[*next++] = static_cast<std::uint8_t>(k);
    return kinds;
}

} // namespace

BeadSizes bead_sizes(const GranularProblem& problem, std::uint32_t run) {
    const BeadMix mix = bead_mix(problem);
    const GivenBeads* given = problem.given ? &*problem.given : nullptr;
    BeadSizes sizes;
    sizes.kind = given && !given->kind.empty() ? given->kind : dealt_kinds(problem, mix, run);
    if (given && !given->radius.empty()) {
        sizes.radius = given->radius;
        require_sizes(mix, sizes, "start_file:");
        if (const double most = std::ranges::max(sizes.radius); 2.0 * most >= problem.plates.gap)
            throw InputError(
                fmt::format("start_file: a bead of radius {:g} m does not fit between the plates, "
                            "which are {:g} m apart",
                            most, problem.plates.gap));
        return sizes;
    }
    for (const std::uint8_t kind : sizes.kind)
        sizes.radius.push_back(kind < mix.kinds.size() ? mix.kinds[kind].radius : mix.radius);
    require_sizes(mix, sizes, "start_file:");
    if (mix.spread == 0.0)
        return sizes;
    // Radii of a spread, scaled so that they cover what they are to cover.
    const auto squares = [&] {
        double sum = 0.0;
        for (const double radius : sizes.radius)
            sum += radius * radius;
        return sum;
    };
    const double wanted = problem.bead_area > 0.0 ? problem.bead_area / M_PI : squares();
    for (std::size_t i = 0; i < problem.beads; ++i) {
        RandomStream random = stream_for(Purpose::radius, problem.seed, run, i);
        double deviation = random.normal();
        while (!(std::abs(deviation) <= cut))
            deviation = random.normal();
        sizes.radius[i] *= 1.0 + mix.spread * deviation;
    }
    const double factor = std::sqrt(wanted / squares());
    for (double& radius : sizes.radius)
        radius *= factor;
    if (const double diameter = 2.0 * std::ranges::max(sizes.radius); diameter >= problem.plates.gap)
        throw InputError(fmt::format(
            "gap = {} m between the plates: must be larger than the largest bead diameter of run {}, {} m; "
            "lower bead_spread = {} or widen the gap",
            problem.plates.gap, run + 1, diameter, mix.spread));
    return sizes;
}

} // namespace rodwake::granular
