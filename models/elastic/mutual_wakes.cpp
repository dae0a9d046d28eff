#include "rodwake/elastic/mutual_wakes.hpp"

#include "far_wakes.hpp"
#include "mutual_pairs.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

namespace rodwake::elastic {

namespace {

void require(bool legal, const std::string& message) {
    if (!legal)
        throw InputError(message);
}

/// What a sum is made for.
struct Task {
    const KernelMedium& medium;
    const Field& field;
    const MutualWakesOptions& options;
    ThreadPool& team;
    bool polar;
    std::span<const KernelSource> rods;
    std::array<double*, all_parts> sum; ///< one number a rod, zero to begin with

    int parts() const { return polar ? all_parts : strain_parts; }
    std::size_t blocks() const { return (rods.size() + block_rods - 1) / block_rods; }
    std::span<const KernelSource> block(std::size_t k) const {
        return rods.subspan(k * block_rods, std::min(block_rods, rods.size() - k * block_rods));
    }
};

void add_block(const Task& task, std::size_t block, const RodSums& sums) {
    for (int k = 0; k < task.parts(); ++k)
        for (std::size_t i = 0; i < task.block(block).size(); ++i)
            task.sum[k][block * block_rods + i] += sums.part[k][i];
}

/// Two blocks and what their rods give each other.
struct BlockWork {
    std::size_t a, b;
    RodSums sum_a, sum_b;
};

/// All pairs. Blocks two by two on threads, some hundred at a time; their sums are added up in one order. Two
/// blocks take 0.1 ms and more, which repays a thread; fewer than 128 rods are one block and start none.
void add_all_pairs(const Task& task) {
    constexpr std::size_t at_a_time = 256;
    std::vector<BlockWork> work;
    const auto finish = [&] {
        parallel_for(work.size(), task.team, [&](std::size_t k) {
            BlockWork& item = work[k];
            const std::span<const KernelSource> none;
            add_block_pair(
                task.medium, task.field, task.options.accuracy, task.polar,
                {task.block(item.a), item.a == item.b ? none : task.block(item.b), &item.sum_a, &item.sum_b});
        });
        for (const BlockWork& each : work) {
            add_block(task, each.a, each.sum_a);
            add_block(task, each.b, each.sum_b);
        }
        work.clear();
    };
    for (std::size_t a = 0; a < task.blocks(); ++a)
        for (std::size_t b = a; b < task.blocks(); ++b) {
            work.push_back({a, b, {}, {}});
            if (work.size() == at_a_time)
                finish();
        }
    finish();
}

// Near pairs, rods in compact order.

constexpr std::size_t group_rods = 8;

struct Box {
    double x0, x1, y0, y1;
};

template<class Range, class At>
Box box_around(const Range& range, const At& at) {
    const KernelSource& first = at(*range.begin());
    Box box{first.x, first.x, first.y, first.y};
    for (const auto& item : range) {
        const KernelSource& rod = at(item);
        box = {std::min(box.x0, rod.x), std::max(box.x1, rod.x), std::min(box.y0, rod.y),
               std::max(box.y1, rod.y)};
    }
    return box;
}

/// Brings numbers of rods into an order in which each group, and each block, lies together: halves across the
/// longer side, again and again. It depends on the places and, where these are equal, on the numbers.
void split(std::span<const KernelSource> rods, std::span<std::uint32_t> numbers) {
    if (numbers.size() <= group_rods) {
        std::sort(numbers.begin(), numbers.end());
        return;
    }
    const Box box = box_around(numbers, [&](std::uint32_t k) -> const KernelSource& { return rods[k]; });
    const bool across = box.x1 - box.x0 >= box.y1 - box.y0;
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        const double at_a = across ? rods[a].x : rods[a].y, at_b = across ? rods[b].x : rods[b].y;
        return at_a != at_b ? at_a < at_b : a < b;
    };
    // Half of the rods, in whole groups, or in whole blocks if there are several.
    const std::size_t unit = numbers.size() > block_rods ? block_rods : group_rods,
                      half = (numbers.size() + unit - 1) / unit / 2 * unit;
    std::nth_element(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(half), numbers.end(),
                     less);
    split(rods, numbers.first(half));
    split(rods, numbers.subspan(half));
}

/// A circle round places.
struct Circle {
    double x, y, radius;
};

Circle circle_around(std::span<const KernelSource> rods) {
    const Box box = box_around(rods, [](const KernelSource& rod) -> const KernelSource& { return rod; });
    const double x = 0.5 * (box.x0 + box.x1), y = 0.5 * (box.y0 + box.y1);
    double radius = 0.0;
    for (const KernelSource& rod : rods)
        radius = std::max(radius, std::hypot(rod.x - x, rod.y - y));
    return {x, y, radius};
}

struct NearBlocks {
    const NearHeat& heat;
    double reach; ///< in the rods' unit
    std::vector<Circle> blocks;
};

/// Rods near to a block, to a group of it and to a rod.
struct SurroundingSources {
    NearSources block, group, rod;
};

/// Puts the exact field of near rods in at a group, in place of their far wakes.
std::size_t add_group(const Task& task, const NearBlocks& near, SurroundingSources& around,
                      std::size_t first) {
    const auto group = task.rods.subspan(first, std::min(group_rods, task.rods.size() - first));
    const Circle circle = circle_around(group);
    find_near(around.block, circle.x, circle.y, near.reach + circle.radius, -1.0, around.group);
    std::size_t done = 0;
    for (std::size_t rod = first; rod < first + group.size(); ++rod) {
        const KernelSource& at = task.rods[rod];
        find_near(around.group, at.x, at.y, near.reach, static_cast<double>(rod), around.rod);
        done += around.rod.count;
        std::array<double, all_parts> all{};
        const auto sums = std::span(all).first(static_cast<std::size_t>(task.parts()));
        add_near(task.medium, task.field, near.heat, around.rod, at.x, at.y, task.polar, sums);

        // Take off what the rod got of its own heat.
        const double per_xi = 1.0 / task.field.medium().xi, c = at.cosine, s = at.sine;
        const auto& own = near.heat.own;
        const double trace = (own[0][0] + own[2][0]) * per_xi, difference = (own[0][0] - own[2][0]) * per_xi;
        sums[0] += 0.5 * (trace + difference * (c * c - s * s));
        sums[1] += difference * s * c;
        sums[2] += 0.5 * (trace - difference * (c * c - s * s));
        for (std::size_t k = strain_parts; k < sums.size(); k += 2) {
            const double along = own[k][0] * per_xi * per_xi; // nothing points aside
            sums[k] += along * c;
            sums[k + 1] += along * s;
        }
        for (std::size_t k = 0; k < sums.size(); ++k)
            task.sum[k][rod] += sums[k];
    }
    return done;
}

std::size_t add_near_pairs(const Task& task, const NearHeat& heat) {
    NearBlocks near{heat, heat.reach * task.field.medium().xi, {}};
    for (std::size_t k = 0; k < task.blocks(); ++k)
        near.blocks.push_back(circle_around(task.block(k)));
    std::atomic<std::size_t> done{0};
    parallel_for(task.blocks(), task.team, [&](std::size_t block) {
        const std::size_t end = block * block_rods + task.block(block).size();
        thread_local SurroundingSources around;

        // The rods near to the block, from the blocks near to it.
        NearSources& all = around.group; // not yet in use
        const Circle& circle = near.blocks[block];
        all.count = 0;
        for (std::size_t other = 0; other < task.blocks(); ++other) {
            const Circle& there = near.blocks[other];
            const double dx = circle.x - there.x, dy = circle.y - there.y,
                         most = near.reach + circle.radius + there.radius;
            if (!(dx * dx + dy * dy <= most * most))
                continue;
            all.reserve(all.count + block_rods);
            for (std::size_t i = 0; i < task.block(other).size(); ++i)
                all.add(task.block(other)[i], static_cast<double>(other * block_rods + i));
        }
        find_near(all, circle.x, circle.y, near.reach + circle.radius, -1.0, around.block);
        for (std::size_t first = block * block_rods; first < end; first += group_rods)
            done += add_group(task, near, around, first);
    });
    return done;
}

} // namespace

/// Made when they are first asked for.
struct MutualWakes::Far {
    std::mutex mutex;
    std::map<std::pair<bool, double>, const FarWakes> kept; ///< by polar, and the sum of the tolerances
};

namespace {

bool may_be_far(const MutualWakesOptions& options, const Medium& medium, bool polar, std::size_t rods) {
    constexpr double finest = 1e-10; // in xi: transforms are good to 1e-12 of a sum's parts
    return options.strain_tolerance * medium.xi >= finest &&
           (!polar || options.polar_tolerance * medium.xi * medium.xi >= finest) && medium.eta >= 0.0 &&
           medium.eta <= FarWakes::largest_eta && rods >= fewest_far_rods;
}

/// How many near pairs there were; none, if all pairs are cheaper and nothing was done.
std::optional<std::size_t> add_far_and_near(const Task& task, MutualWakes::Far& made) {
    const double per_xi = 1.0 / task.field.medium().xi;
    std::vector<std::uint32_t> order(task.rods.size());
    std::iota(order.begin(), order.end(), 0U);
    split(task.rods, order);
    std::vector<KernelSource> rods, in_xi;
    for (const std::uint32_t k : order) {
        const KernelSource& rod = rods.emplace_back(task.rods[k]);
        in_xi.push_back({rod.x * per_xi, rod.y * per_xi, rod.cosine, rod.sine});
    }
    // crowds whose errors add up get smaller ones, in steps of the square root of two, of which few are made
    MutualWakesOptions options = task.options;
    for (double growth = FarWakes::error_growth(in_xi, task.polar); growth > 1.0;
         growth *= std::numbers::sqrt2 / 2.0) {
        options.strain_tolerance *= std::numbers::sqrt2 / 2.0;
        options.polar_tolerance *= std::numbers::sqrt2 / 2.0;
    }
    if (!may_be_far(options, task.field.medium(), task.polar, rods.size()))
        return std::nullopt;
    std::unique_lock lock(made.mutex);
    const FarWakes& far =
        made.kept
            .try_emplace({task.polar, options.strain_tolerance + options.polar_tolerance},
                         task.field.medium(), options.strain_tolerance, options.polar_tolerance, task.polar)
            .first->second;
    lock.unlock();
    const FarWakes::QuadraturePlan plan = far.plan(in_xi);
    const auto count = static_cast<double>(rods.size());
    const double all_pairs_cost = count * count * (task.polar ? 9.0 : 6.2) * // ns of one core, as measured
                                  (task.options.accuracy == Accuracy::single ? 0.5 : 1.0);
    if (plan.cost > all_pairs_cost)
        return std::nullopt;
    const NearHeat& near = far.near_heat(plan);
    if (near.powers.empty())
        return std::nullopt;
    std::vector<double> part(static_cast<std::size_t>(task.parts()) * rods.size());
    Task sorted{task.medium, task.field, task.options, task.team, task.polar, rods, {}};
    for (int k = 0; k < task.parts(); ++k)
        sorted.sum[k] = part.data() + static_cast<std::size_t>(k) * rods.size();
    far.add(plan, in_xi, task.team, std::span(sorted.sum).first(static_cast<std::size_t>(task.parts())));
    for (int k = 0; k < task.parts(); ++k)
        for (std::size_t i = 0; i < rods.size(); ++i)
            sorted.sum[k][i] *= k < strain_parts ? per_xi : per_xi * per_xi;
    const std::size_t done = add_near_pairs(sorted, near);
    for (int k = 0; k < task.parts(); ++k)
        for (std::size_t i = 0; i < rods.size(); ++i)
            task.sum[k][order[i]] = sorted.sum[k][i];
    return done;
}

std::size_t run(const WakeKernel& kernel, const MutualWakesOptions& options, ThreadPool& team,
                MutualWakes::Far& far, std::span<const Source> rods, const StrainSums& strain,
                const PolarSums* polar) {
    require_lengths(rods.size(), strain);
    if (polar != nullptr)
        require_lengths(rods.size(), *polar);
    for (std::size_t k = 0; k < rods.size(); ++k)
        require(std::isfinite(rods[k].x) && std::isfinite(rods[k].y) && std::isfinite(rods[k].heading),
                "rod " + std::to_string(k) + " has a position or heading that is not finite");
    const std::vector<KernelSource> sources = kernel_sources(rods);
    const Field field(kernel.medium());
    const KernelMedium medium = KernelInternals::constants(field);
    Task task{medium,
              field,
              options,
              team,
              polar != nullptr,
              sources,
              {strain.xx.data(), strain.xy.data(), strain.yy.data()}};
    if (polar != nullptr)
        std::ranges::copy(std::array{polar->laplacian_x.data(), polar->laplacian_y.data(),
                                     polar->gradient_x.data(), polar->gradient_y.data()},
                          task.sum.begin() + strain_parts);
    for (int k = 0; k < task.parts(); ++k)
        std::fill_n(task.sum[k], rods.size(), 0.0);
    if (may_be_far(options, kernel.medium(), task.polar, rods.size()))
        if (const auto done = add_far_and_near(task, far))
            return *done;
    add_all_pairs(task);
    return rods.empty() ? 0 : rods.size() * (rods.size() - 1);
}

} // namespace

MutualWakes::MutualWakes(const Medium& medium, const MutualWakesOptions& options)
    : kernel_(medium, options.accuracy), options_(options),
      team_(std::make_shared<ThreadPool>(options.threads)), far_(std::make_shared<Far>()) {
    require(options.threads > 0, "threads = 0: give at least one");
    for (const double tolerance : {options.strain_tolerance, options.polar_tolerance})
        require(tolerance >= 0.0 && std::isfinite(tolerance),
                "a tolerance of " + std::to_string(tolerance) + ": must be >= 0 and finite");
}

std::size_t MutualWakes::strain(std::span<const Source> rods, const StrainSums& sums) const {
    return run(kernel_, options_, *team_, *far_, rods, sums, nullptr);
}

std::size_t MutualWakes::strain_and_polar(std::span<const Source> rods, const StrainSums& strain,
                                          const PolarSums& polar) const {
    return run(kernel_, options_, *team_, *far_, rods, strain, &polar);
}

} // namespace rodwake::elastic
