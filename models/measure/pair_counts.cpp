#include "pair_counts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace rodwake::measure {

namespace {

struct Slot {
    double pairs = 0.0, order = 0.0; // side by side: one cache line, one vector of two
};

/// For distances up to `farthest` bins, of which the first `bins` are wanted.
std::size_t most_slots(double farthest, std::size_t bins) {
    return std::max(bins, static_cast<std::size_t>(std::min(farthest, 4.0 * static_cast<double>(bins))) + 2);
}

/// One pair after the other: a sum's order never changes.
void add_row(const std::int32_t* at, const double* order, std::size_t count, Slot* slots) {
    for (std::size_t k = 0; k < count; ++k) {
        slots[at[k]].pairs += 1.0;
        slots[at[k]].order += order[k];
    }
}

} // namespace

PairSums count_pairs(const std::vector<double>& x, const std::vector<double>& y,
                     const std::vector<std::complex<double>>& psi, const PeriodicBox& box, double bin,
                     std::size_t bins) {
    std::vector<double> all_x(x.size() + padding, 0.0), all_y = all_x, re = all_x, im = all_x;
    std::ranges::copy(x, all_x.begin());
    std::ranges::copy(y, all_y.begin());
    for (std::size_t i = 0; i < psi.size(); ++i) {
        re[i] = psi[i].real();
        im[i] = psi[i].imag();
    }
    const PairColumns columns{all_x.data(), all_y.data(), re.data(), im.data()};
    const double per_bin = 1.0 / bin;
    // Slots as far as the corners of the box, half its diagonal, so that the loop need not ask; the last one
    // has all that is farther in a box that is mostly empty.
    const double farthest = 0.5001 * std::hypot(box.x, box.y) * per_bin;
    std::vector<Slot> slots(most_slots(farthest, bins));
    const bool has_rest = static_cast<double>(slots.size()) < farthest + 1.0;
    std::vector<std::int32_t> at(x.size() + padding);
    std::vector<double> order(x.size() + padding);
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
        const std::size_t count = x.size() - i - 1;
        fill_pair_row(columns, i, count, box, per_bin, at.data(), order.data());
        for (std::size_t k = 0; k < count && has_rest; ++k)
            at[k] = std::min(at[k], static_cast<std::int32_t>(slots.size() - 1));
        add_row(at.data(), order.data(), count, slots.data());
    }
    PairSums sums{std::vector<double>(bins), std::vector<double>(bins)};
    for (std::size_t k = 0; k < bins; ++k) {
        sums.pairs[k] = slots[k].pairs;
        sums.order[k] = slots[k].order;
    }
    return sums;
}

std::vector<double> count_pairs_in(const Window& window, const std::vector<double>& x,
                                   const std::vector<double>& y, const PeriodicBox& box, double bin,
                                   std::size_t bins) {
    constexpr double least_share = 1e-3; // less is a corner's tip, and rounding at the end of the range
    const std::size_t n = x.size();
    // The first place is that of the bead which looks at all the others: itself, at distance 0, is taken off.
    std::vector<double> all_x(n + 1 + padding, 0.0), all_y = all_x, none = all_x;
    std::ranges::copy(x, all_x.begin() + 1);
    std::ranges::copy(y, all_y.begin() + 1);
    const PairColumns columns{all_x.data(), all_y.data(), none.data(), none.data()};
    const PeriodicBox without_images{2.0 * box.x, 2.0 * box.y};
    std::vector<std::int32_t> at(n + padding);
    std::vector<double> order(n + padding), share(bins), sums(bins, 0.0);
    std::vector<std::int32_t> seen(most_slots(1.0001 * std::hypot(box.x, box.y) / bin, bins));
    const auto last = static_cast<std::int32_t>(seen.size() - 1);
    CircleShares shares(window);
    for (std::size_t i = 0; i < n; ++i) {
        all_x[0] = x[i];
        all_y[0] = y[i];
        fill_pair_row(columns, 0, n, without_images, 1.0 / bin, at.data(), order.data());
        std::ranges::fill(seen, 0);
        for (std::size_t k = 0; k < n; ++k)
            ++seen[static_cast<std::size_t>(std::min(at[k], last))];
        --seen[0];
        shares.about(x[i], y[i], bin, share);
        for (std::size_t k = 0; k < bins; ++k)
            if (share[k] > least_share)
                sums[k] += 0.5 * seen[k] / share[k];
    }
    return sums;
}

std::size_t whole_bins(double side, double bin) {
    return static_cast<std::size_t>(side / (2.0 * bin) * (1.0 + 1e-12));
}

std::vector<double> pair_correlation(const std::vector<double>& pairs, double frames, std::size_t beads,
                                     double area, double bin) {
    const double n = static_cast<double>(beads), all = frames * n * (n - 1.0) / 2.0;
    std::vector<double> g(pairs.size(), 0.0);
    for (std::size_t k = 0; k < g.size() && all > 0.0; ++k) {
        const double ring = M_PI * bin * bin * (2.0 * static_cast<double>(k) + 1.0);
        g[k] = pairs[k] / (all * ring / area);
    }
    return g;
}

std::vector<double> middles(std::size_t bins, double bin) {
    std::vector<double> r(bins);
    for (std::size_t k = 0; k < bins; ++k)
        r[k] = (static_cast<double>(k) + 0.5) * bin;
    return r;
}

} // namespace rodwake::measure
