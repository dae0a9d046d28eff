#include "rodwake/elastic/mutual_wakes.hpp"

#include "mutual_pairs.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "wake_cutoff.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <string>

namespace rodwake::elastic {

namespace {

void require(bool legal, const std::string& message) {
    if (!legal)
        throw InputError(message);
}

void require_finite(std::span<const Source> rods) {
    for (std::size_t k = 0; k < rods.size(); ++k)
        require(std::isfinite(rods[k].x) && std::isfinite(rods[k].y) && std::isfinite(rods[k].heading),
                "rod " + std::to_string(k) + " has a place or heading that is not finite");
}

/// What a sum is made for.
struct Task {
    const KernelMedium& medium;
    const Field& field;
    const MutualWakesOptions& options;
    Team& team;
    bool polar;
    std::span<const KernelSource> rods;
    std::array<double*, all_parts> sum; ///< one number a rod, zero to begin with

    int parts() const { return polar ? all_parts : strain_parts; }
    std::size_t blocks() const { return (rods.size() + block_rods - 1) / block_rods; }
    std::span<const KernelSource> block(std::size_t k) const {
        return rods.subspan(k * block_rods, std::min(block_rods, rods.size() - k * block_rods));
    }
};

void add_block(const Task& task, std::size_t block, const BlockSums& sums) {
    for (int k = 0; k < task.parts(); ++k)
        for (std::size_t i = 0; i < task.block(block).size(); ++i)
            task.sum[k][block * block_rods + i] += sums.part[k][i];
}

/// Two blocks and what their rods give each other.
struct BlockWork {
    std::size_t a, b;
    BlockSums sum_a, sum_b;
};

/// All pairs. Blocks two by two on threads, some hundred at a time; their sums are added up in one order. Two
/// blocks take 0.1 ms and more, which repays a thread; fewer than 128 rods are one block and start none.
void add_all_pairs(const Task& task) {
    constexpr std::size_t at_a_time = 256;
    std::vector<BlockWork> work;
    const auto finish = [&] {
        parallel_for(work.size(), task.team, [&](std::size_t k) {
            BlockWork& one = work[k];
            const std::span<const KernelSource> none;
            add_block_pair(
                task.medium, task.field, task.options.accuracy, task.polar,
                {task.block(one.a), one.a == one.b ? none : task.block(one.b), &one.sum_a, &one.sum_b});
        });
        for (const BlockWork& one : work) {
            add_block(task, one.a, one.sum_a);
            add_block(task, one.b, one.sum_b);
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

/// Numbers of the rods whose wakes are felt in a block.
std::vector<std::uint32_t> felt_in(const Task& task, const WakeCutoff& cutoff,
                                   std::span<const KernelSource> targets) {
    const Circle circle = circle_around(targets);
    std::vector<std::uint32_t> felt;
    for (std::size_t k = 0; k < task.rods.size(); ++k)
        if (!cutoff.skips(task.rods[k], circle))
            felt.push_back(static_cast<std::uint32_t>(k));
    return felt;
}

/// A tile of the targets, and those rods beyond it whose wakes are felt in it.
struct FeltTile {
    std::span<const KernelSource> rods;
    std::size_t first;
    std::vector<KernelSource> sources;
};

FeltTile felt_tile(const Task& task, const WakeCutoff& cutoff, std::span<const std::uint32_t> felt,
                   std::size_t first) {
    FeltTile tile{task.rods.subspan(first, std::min(tile_rods, task.rods.size() - first)), first, {}};
    const Circle circle = circle_around(tile.rods);
    for (const std::uint32_t k : felt)
        if ((k < first || k >= first + tile.rods.size()) && !cutoff.skips(task.rods[k], circle))
            tile.sources.push_back(task.rods[k]);
    return tile;
}

/// Sums at a tile: of its own rods, and of the others that are felt.
void add_tile(const Task& task, const FeltTile& tile) {
    BlockSums own, far;
    std::array<double, tile_rods> x{}, y{};
    for (std::size_t i = 0; i < tile.rods.size(); ++i) {
        x[i] = tile.rods[i].x;
        y[i] = tile.rods[i].y;
    }
    KernelTargets targets{x.data(), y.data(), tile.rods.size(), {}};
    for (int k = 0; k < task.parts(); ++k)
        targets.sum[k] = far.part[k].data();
    sum_wakes(task.medium, task.field, task.options.accuracy, tile.sources, targets);
    add_block_pair(task.medium, task.field, task.options.accuracy, task.polar, {tile.rods, {}, &own, &own});
    for (int k = 0; k < task.parts(); ++k)
        for (std::size_t i = 0; i < tile.rods.size(); ++i)
            task.sum[k][tile.first + i] = own.part[k][i] + far.part[k][i];
}

/// Shows each tile to use(), blocks on threads.
template<class Use>
void each_tile(const Task& task, const WakeCutoff& cutoff, const Use& use) {
    parallel_for(task.blocks(), task.team, [&](std::size_t block) {
        const std::vector<std::uint32_t> felt = felt_in(task, cutoff, task.block(block));
        for (std::size_t i = 0; i < task.block(block).size(); i += tile_rods)
            use(felt_tile(task, cutoff, felt, block * block_rods + i));
    });
}

/// The pairs that are felt, rods in compact order. 0: too many, nothing done. Tiles are found twice, first to
/// be counted: that is a twentieth of the work, and keeping them all would take memory as N^2.
std::size_t add_felt_pairs(const Task& task, const WakeCutoff& cutoff) {
    std::atomic<std::size_t> felt{0};
    each_tile(task, cutoff, [&](const FeltTile& tile) {
        felt += tile.rods.size() * (tile.sources.size() + tile.rods.size() - 1);
    });
    if (2 * felt > task.rods.size() * task.rods.size())
        return 0;
    each_tile(task, cutoff, [&](const FeltTile& tile) { add_tile(task, tile); });
    return felt;
}

/// The cutoff of each source, or nothing to be left out.
bool may_skip(const MutualWakesOptions& options, bool polar, std::size_t rods) {
    return options.strain_tolerance > 0.0 && (!polar || options.polar_tolerance > 0.0) && rods > tile_rods;
}

/// Sums of the pairs that are felt, in the given order of rods; 0: too many, nothing done.
std::size_t add_sorted(const Task& task) {
    const std::size_t n = task.rods.size();
    const double share = 1.0 / static_cast<double>(n - 1);
    const WakeCutoff cutoff(task.field.medium(), {task.options.strain_tolerance * share,
                                                  task.options.polar_tolerance * share, task.polar});
    const std::vector<std::uint32_t> order = compact_order(task.rods);
    std::vector<KernelSource> rods;
    rods.reserve(n);
    for (const std::uint32_t k : order)
        rods.push_back(task.rods[k]);
    std::vector<double> part(static_cast<std::size_t>(task.parts()) * n);
    Task sorted{task.medium, task.field, task.options, task.team, task.polar, rods, {}};
    for (int k = 0; k < task.parts(); ++k)
        sorted.sum[k] = part.data() + static_cast<std::size_t>(k) * n;
    const std::size_t done = add_felt_pairs(sorted, cutoff);
    if (done > 0)
        for (int k = 0; k < task.parts(); ++k)
            for (std::size_t i = 0; i < n; ++i)
                task.sum[k][order[i]] = sorted.sum[k][i];
    return done;
}

std::size_t run(const WakeKernel& kernel, const MutualWakesOptions& options, Team& team,
                std::span<const Source> rods, const StrainSums& strain, const PolarSums* polar) {
    require_lengths(rods.size(), strain);
    if (polar != nullptr)
        require_lengths(rods.size(), *polar);
    require_finite(rods);
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
    if (may_skip(options, task.polar, rods.size()))
        if (const std::size_t done = add_sorted(task); done > 0)
            return done;
    add_all_pairs(task);
    return rods.empty() ? 0 : rods.size() * (rods.size() - 1);
}

} // namespace

MutualWakes::MutualWakes(const Medium& medium, const MutualWakesOptions& options)
    : kernel_(medium, options.accuracy), options_(options), team_(std::make_shared<Team>(options.threads)) {
    require(options.threads > 0, "threads = 0: give at least one");
    for (const double tolerance : {options.strain_tolerance, options.polar_tolerance})
        require(tolerance >= 0.0 && std::isfinite(tolerance),
                "a tolerance of " + std::to_string(tolerance) + ": must be >= 0 and finite");
}

std::size_t MutualWakes::strain(std::span<const Source> rods, const StrainSums& sums) const {
    return run(kernel_, options_, *team_, rods, sums, nullptr);
}

std::size_t MutualWakes::strain_and_polar(std::span<const Source> rods, const StrainSums& strain,
                                          const PolarSums& polar) const {
    return run(kernel_, options_, *team_, rods, strain, &polar);
}

namespace {

struct Box {
    double x0, x1, y0, y1;
};

template<class Range, class At>
Box box_around(const Range& range, const At& at) {
    const KernelSource& first = at(*range.begin());
    Box box{first.x, first.x, first.y, first.y};
    for (const auto& one : range) {
        const KernelSource& rod = at(one);
        box = {std::min(box.x0, rod.x), std::max(box.x1, rod.x), std::min(box.y0, rod.y),
               std::max(box.y1, rod.y)};
    }
    return box;
}

/// Half of a number of rods, in whole tiles, or in whole blocks if there are several.
std::size_t half_of(std::size_t count) {
    const std::size_t unit = count > block_rods ? block_rods : tile_rods, units = (count + unit - 1) / unit;
    return units / 2 * unit;
}

void split(std::span<const KernelSource> rods, std::span<std::uint32_t> numbers) {
    if (numbers.size() <= tile_rods) {
        std::sort(numbers.begin(), numbers.end());
        return;
    }
    const Box box = box_around(numbers, [&](std::uint32_t k) -> const KernelSource& { return rods[k]; });
    const bool across = box.x1 - box.x0 >= box.y1 - box.y0;
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        const double at_a = across ? rods[a].x : rods[a].y, at_b = across ? rods[b].x : rods[b].y;
        return at_a != at_b ? at_a < at_b : a < b;
    };
    const std::size_t half = half_of(numbers.size());
    std::nth_element(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(half), numbers.end(),
                     less);
    split(rods, numbers.first(half));
    split(rods, numbers.subspan(half));
}

} // namespace

std::vector<std::uint32_t> compact_order(std::span<const KernelSource> rods) {
    std::vector<std::uint32_t> numbers(rods.size());
    std::iota(numbers.begin(), numbers.end(), 0U);
    split(rods, numbers);
    return numbers;
}

Circle circle_around(std::span<const KernelSource> rods) {
    const Box box = box_around(rods, [](const KernelSource& rod) -> const KernelSource& { return rod; });
    const double x = 0.5 * (box.x0 + box.x1), y = 0.5 * (box.y0 + box.y1);
    double radius = 0.0;
    for (const KernelSource& rod : rods)
        radius = std::max(radius, std::hypot(rod.x - x, rod.y - y));
    return {x, y, radius};
}

} // namespace rodwake::elastic
