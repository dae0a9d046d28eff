#include "rodwake/measure/rod_order.hpp"

#include "rodwake/core/cell_list.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/measure/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numeric>

namespace rodwake::measure {

namespace {

/// Sets that merge (union-find with path halving): each is known by its root, the smallest member.
class Sets {
public:
    explicit Sets(std::size_t members) : parent_(members) {
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    }

    std::size_t root(std::size_t a) {
        while (parent_[a] != a)
            a = parent_[a] = parent_[parent_[a]];
        return a;
    }
    void merge(std::size_t a, std::size_t b) {
        const std::size_t p = root(a), q = root(b);
        parent_[std::max(p, q)] = std::min(p, q);
    }
    std::vector<std::size_t> sizes() {
        std::vector<std::size_t> count(parent_.size(), 0);
        for (std::size_t a = 0; a < parent_.size(); ++a)
            ++count[root(a)];
        std::erase(count, 0U);
        std::ranges::sort(count, std::greater());
        return count;
    }

private:
    std::vector<std::size_t> parent_;
};

/// Calls see(a, b), a < b, for each pair nearer than `reach`.
template<class See>
void each_near_pair(std::span<const RodPosition> rods, double reach, std::optional<PeriodicBox> box,
                    See&& see) {
    std::vector<double> x, y;
    for (const RodPosition& rod : rods) {
        x.push_back(rod.x);
        y.push_back(rod.y);
    }
    PeriodicBox side = box.value_or(PeriodicBox{});
    if (!box) {
        // On the plane, a square that holds all rods and in which no two are near each other round its edge.
        const auto [left, right] = std::ranges::minmax(x);
        const auto [low, high] = std::ranges::minmax(y);
        side = PeriodicBox(std::max(right - left, high - low) + 2.0 * reach);
    }
    const CellList cells(x, y, side, reach);
    cells.pairs([&](std::size_t p, std::size_t q) {
        const double dx = cells.x()[p] - cells.x()[q], dy = cells.y()[p] - cells.y()[q];
        const std::size_t a = cells.member()[p], b = cells.member()[q];
        if ((box ? nearest_distance(dx, dy, *box) : std::hypot(dx, dy)) < reach)
            see(std::min(a, b), std::max(a, b));
    });
}

/// |mean of exp(i k theta)|
double alignment(std::span<const RodPosition> rods, double k) {
    std::complex<double> sum = 0.0;
    for (const RodPosition& rod : rods)
        sum += std::polar(1.0, k * rod.heading);
    return std::abs(sum) / static_cast<double>(rods.size());
}

std::vector<double> numbers_by_size(const std::vector<const RodOrder*>& orders) {
    std::vector<double> number;
    for (const RodOrder* order : orders)
        for (const std::size_t size : order->clusters) {
            number.resize(std::max(number.size(), size), 0.0);
            number[size - 1] += 1.0;
        }
    for (double& count : number)
        count /= static_cast<double>(orders.size());
    return number;
}

} // namespace

double RodOrder::mean_size() const {
    return static_cast<double>(std::accumulate(clusters.begin(), clusters.end(), std::size_t{0})) /
           static_cast<double>(clusters.size());
}

double RodOrder::weighted_size() const {
    double squares = 0.0, rods = 0.0;
    for (const std::size_t size : clusters) {
        squares += static_cast<double>(size) * static_cast<double>(size);
        rods += static_cast<double>(size);
    }
    return squares / rods;
}

std::vector<NumberFluctuation> number_fluctuations(std::span<const RodPosition> rods,
                                                   std::optional<PeriodicBox> box) {
    const auto count = static_cast<double>(rods.size());

    // Where the cells are: the box, or a square in the middle of the crowd.
    double left = 0.0, low = 0.0;
    PeriodicBox sides = box.value_or(PeriodicBox{});
    if (!box) {
        double x = 0.0, y = 0.0, square = 0.0;
        for (const RodPosition& rod : rods) {
            x += rod.x / count;
            y += rod.y / count;
        }
        for (const RodPosition& rod : rods)
            square += ((rod.x - x) * (rod.x - x) + (rod.y - y) * (rod.y - y)) / count;
        const double half = square > 0.0 ? std::sqrt(square) : 0.5; // 0: all in one place
        left = x - half;
        low = y - half;
        sides = PeriodicBox(2.0 * half);
    }

    // Rods by cells, of which there are four times as many each time.
    std::vector<NumberFluctuation> found;
    for (std::size_t m = 2; m * m <= rods.size(); m *= 2) {
        std::vector<double> number(m * m, 0.0);
        double inside = 0.0, squares = 0.0;
        for (const RodPosition& rod : rods) {
            double u = (rod.x - left) / sides.x, v = (rod.y - low) / sides.y;
            if (box) {
                u -= std::floor(u);
                v -= std::floor(v);
            } else if (std::min(u, v) < 0.0 || std::max(u, v) > 1.0)
                continue;
            const auto at = [m](double part) {
                return std::min(static_cast<std::size_t>(part * static_cast<double>(m)), m - 1);
            };
            number[at(u) * m + at(v)] += 1.0;
            inside += 1.0;
        }
        const auto cells = static_cast<double>(m * m);
        const double mean = inside / cells;
        for (const double n : number)
            squares += (n - mean) * (n - mean);
        found.push_back({std::sqrt(sides.x * sides.y / cells), mean, squares / ((cells - 1.0) * mean)});
    }
    return found;
}

RodOrder rod_order(std::span<const RodPosition> rods, double link, std::optional<PeriodicBox> box) {
    Sets sets(rods.size());
    each_near_pair(rods, link, box, [&](std::size_t a, std::size_t b) { sets.merge(a, b); });
    return {alignment(rods, 1.0), alignment(rods, 2.0), sets.sizes(), {}, number_fluctuations(rods, box)};
}

RodOrder rod_order(std::span<const RodPosition> rods, double reach, std::optional<PeriodicBox> box,
                   const std::function<bool(std::size_t a, std::size_t b)>& linked) {
    RodOrder order{alignment(rods, 1.0), alignment(rods, 2.0), {}, {}, number_fluctuations(rods, box)};
    Sets sets(rods.size());
    each_near_pair(rods, reach, box, [&](std::size_t a, std::size_t b) {
        if (!linked(a, b))
            return;
        sets.merge(a, b);
        order.links.emplace_back(a, b);
    });
    order.clusters = sets.sizes();
    std::ranges::sort(order.links);
    return order;
}

std::optional<double> link_lifetime(std::span<const double> times, std::span<const RodOrder> orders) {
    double linked = 0.0, ended = 0.0;
    for (std::size_t i = 1; i < orders.size(); ++i)
        for (const auto& link : orders[i - 1].links) {
            linked += times[i] - times[i - 1];
            ended += std::ranges::binary_search(orders[i].links, link) ? 0.0 : 1.0;
        }
    return ended > 0.0 ? std::optional(linked / ended) : std::nullopt;
}

MeanRodOrder mean_rod_order(std::span<const RodOrderSeries> runs, double from, double block) {
    // The instants that count, of all runs, and their blocks, numbered from 0 without gaps.
    std::vector<const RodOrder*> orders;
    std::vector<std::size_t> block_of;
    for (const RodOrderSeries& run : runs) {
        std::optional<double> last; // block of this run
        const auto first =
            static_cast<std::size_t>(std::ranges::lower_bound(run.times, from) - run.times.begin());
        for (std::size_t i = first; i < run.times.size(); ++i) {
            const double at = std::floor((run.times[i] - from) / block);
            const std::size_t next = block_of.empty() ? 0 : block_of.back() + 1;
            block_of.push_back(last == at ? block_of.back() : next);
            orders.push_back(&run.orders[i]);
            last = at;
        }
    }
    if (orders.empty())
        throw InputError(fmt::format("order of the rods: no time from {:g} on", from));
    const std::size_t blocks = block_of.back() + 1;
    const auto mean = [&](const auto& number) {
        std::vector<double> sum(blocks, 0.0), weight(blocks, 0.0);
        for (std::size_t i = 0; i < orders.size(); ++i) {
            sum[block_of[i]] += number(*orders[i]);
            weight[block_of[i]] += 1.0;
        }
        for (std::size_t b = 0; b < blocks; ++b)
            sum[b] /= weight[b];
        Estimate estimate = mean_of_blocks(sum, weight);
        estimate.error *= correlation_factor(successive_correlation(sum));
        return estimate;
    };
    MeanRodOrder result;
    result.polar = mean([](const RodOrder& o) { return o.polar; });
    result.nematic = mean([](const RodOrder& o) { return o.nematic; });
    result.mean_size = mean([](const RodOrder& o) { return o.mean_size(); });
    result.weighted_size = mean([](const RodOrder& o) { return o.weighted_size(); });
    result.largest = mean([](const RodOrder& o) { return static_cast<double>(o.clusters.front()); });
    result.clusters = numbers_by_size(orders);
    for (std::size_t k = 0; k < orders.front()->fluctuations.size(); ++k) {
        const auto level = [&](double NumberFluctuation::*number) {
            return mean([&](const RodOrder& o) { return o.fluctuations[k].*number; });
        };
        const Estimate found = level(&NumberFluctuation::fluctuation);
        result.fluctuations.push_back(
            {level(&NumberFluctuation::cell).value, level(&NumberFluctuation::rods).value, found.value});
        result.fluctuation_errors.push_back(found.error);
    }
    result.instants = orders.size();
    result.blocks = blocks;
    return result;
}

} // namespace rodwake::measure
