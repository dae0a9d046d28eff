// How many independent values there are in data of which neighbours share noise.

#include "rodwake/fitting/wake.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::fitting {

namespace {

using Range = std::pair<std::size_t, std::size_t>;

/// Rows between turns of the direction in which the places go.
std::vector<Range> stretches(std::span<const double> places) {
    std::vector<Range> all;
    std::size_t first = 0;
    int direction = 0;
    for (std::size_t i = 1; i < places.size(); ++i) {
        const int step = (places[i] > places[i - 1]) - (places[i] < places[i - 1]);
        if (step != 0 && step == -direction) {
            all.emplace_back(first, i);
            first = i;
            direction = 0;
        } else if (step != 0) {
            direction = step;
        }
    }
    all.emplace_back(first, places.size());
    return all;
}

/// Runs one after the other; rows in no order, of which stretches are short, are one.
std::vector<Range> runs_in(std::span<const double> places) {
    constexpr std::size_t shortest = 4; // in random order a stretch has 2 to 3 rows
    std::vector<Range> all = stretches(places);
    return shortest * all.size() > places.size() ? std::vector<Range>{{0, places.size()}} : all;
}

/// Of `order`, the rows of one run by place.
void set_worth(std::span<const double> places, std::span<const std::size_t> order, double spacing,
               std::vector<double>& worth) {
    std::size_t low = 0, high = 0; // the rows closer than `spacing` are [low, high)
    for (const std::size_t row : order) {
        while (places[row] - places[order[low]] >= spacing)
            ++low;
        while (high < order.size() && places[order[high]] - places[row] < spacing)
            ++high;
        const auto count = static_cast<double>(high - low);
        const double span = places[order[high - 1]] - places[order[low]];
        worth[row] =
            count < 2.0 ? 1.0 : std::min(1.0, std::max(span / (spacing * (count - 1.0)), 1.0 / count));
    }
}

} // namespace

std::vector<double> independent_worth(std::span<const double> places, double spacing) {
    std::vector<double> worth(places.size(), 1.0);
    if (places.empty())
        return worth;
    for (const auto& [first, last] : runs_in(places)) {
        std::vector<std::size_t> order(last - first);
        std::iota(order.begin(), order.end(), first);
        std::ranges::sort(order, {}, [&](std::size_t row) { return places[row]; });
        set_worth(places, order, spacing, worth);
    }
    return worth;
}

double mean_worth(std::span<const double> worth) {
    return std::accumulate(worth.begin(), worth.end(), 0.0) / static_cast<double>(worth.size());
}

} // namespace rodwake::fitting
