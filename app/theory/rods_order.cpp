#include "rods_order.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/store/csv.hpp"
#include "run/values_json.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace rodwake::app {

namespace {

using measure::RodOrder;
using measure::RodOrderSeries;

constexpr std::size_t order_numbers = 6;

/// In the order of the columns after t.
std::array<double, order_numbers> numbers_of(const RodOrder& o) {
    return {o.polar,       o.nematic,         static_cast<double>(o.clusters.size()),
            o.mean_size(), o.weighted_size(), static_cast<double>(o.clusters.front())};
}

/// Means over the runs, as far as all of them go.
std::string series_csv(const std::vector<RodOrderSeries>& runs) {
    const std::string names[] = {"t",         "polar",         "nematic", "clusters",
                                 "mean_size", "weighted_size", "largest"};
    const auto shortest = std::ranges::min(runs, {}, [](const auto& run) { return run.times.size(); });
    std::vector<std::vector<double>> columns(1 + order_numbers,
                                             std::vector<double>(shortest.times.size(), 0.0));
    columns[0] = shortest.times;
    for (const RodOrderSeries& run : runs)
        for (std::size_t i = 0; i < shortest.times.size(); ++i) {
            const auto row = numbers_of(run.orders[i]);
            for (std::size_t k = 0; k < order_numbers; ++k)
                columns[1 + k][i] += row[k] / static_cast<double>(runs.size());
        }
    return store::to_csv(names, columns);
}

/// Sizes that occur.
std::string clusters_csv(const measure::MeanRodOrder& mean, std::size_t rods) {
    const std::string names[] = {"size", "clusters", "share"};
    std::vector<std::vector<double>> columns(std::size(names));
    for (std::size_t i = 0; i < mean.clusters.size(); ++i) {
        const auto size = static_cast<double>(i + 1);
        if (mean.clusters[i] == 0.0)
            continue;
        columns[0].push_back(size);
        columns[1].push_back(mean.clusters[i]);
        columns[2].push_back(size * mean.clusters[i] / static_cast<double>(rods));
    }
    return store::to_csv(names, columns);
}

std::string means_json(const measure::MeanRodOrder& mean, const OrderKeys& keys, std::size_t runs) {
    const Values values{{"polar", mean.polar},
                        {"nematic", mean.nematic},
                        {"mean_size", mean.mean_size},
                        {"weighted_size", mean.weighted_size},
                        {"largest", mean.largest},
                        {"link", keys.link},
                        {"from", keys.from},
                        {"block", keys.block},
                        {"runs", static_cast<std::int64_t>(runs)},
                        {"instants", static_cast<std::int64_t>(mean.instants)},
                        {"blocks", static_cast<std::int64_t>(mean.blocks)},
                        {"units.length", keys.units.length_name},
                        {"units.time", keys.units.time_name}};
    return values_json(values).dump(2) + "\n";
}

} // namespace

OrderKeys::OrderKeys(const scene::Scene& scene) : units(order_units(scene)) {
    const scene::RodsOrder& order = *scene.rods_order;
    const bool bed = order_of_bed(scene);
    const double end = bed ? scene.granular->duration : scene.rods_run->t_end;
    link = order.link * units.length;
    from = order.from * units.time;
    block = order.block.value_or((end - order.from) / 10.0) * units.time;
    if (bed)
        box = bed_size(*scene.granular).box;
    else if (scene.medium && scene.medium->box())
        box = *scene.medium->box() * units.length;
}

void write_rods_order(const Session& session, const Case& of, const OrderKeys& keys,
                      const std::vector<RodOrderSeries>& runs) {
    if (std::ranges::none_of(
            runs, [&](const auto& run) { return !run.times.empty() && run.times.back() >= keys.from; }))
        return session.log->warn("order of the rods{}: the run ended before rods_order.from = {:g} {}",
                                 of.suffix(), keys.from, keys.units.time_name);
    const auto mean = measure::mean_rod_order(runs, keys.from, keys.block);
    const auto write = [&](const char* name, const std::string& text) {
        session.directory.write(of.folder + name, text);
    };
    write("rods_order.csv", series_csv(runs));
    const auto longest =
        std::ranges::max_element(runs, {}, [](const auto& run) { return run.orders.size(); });
    const auto& of_some_instant = longest->orders.front().clusters;
    write("clusters.csv", clusters_csv(mean, std::accumulate(of_some_instant.begin(), of_some_instant.end(),
                                                             std::size_t{0})));
    write("rods_order.json", means_json(mean, keys, runs.size()));
    session.log->info("order of the rods{}: polar {:.3g} +- {:.2g}, nematic {:.3g} +- {:.2g}, a rod is in a "
                      "cluster of {:.3g} +- {:.2g}",
                      of.suffix(), mean.polar.value, mean.polar.error, mean.nematic.value, mean.nematic.error,
                      mean.weighted_size.value, mean.weighted_size.error);
}

} // namespace rodwake::app
