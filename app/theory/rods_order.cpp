#include "rods_order.hpp"

#include "rodwake/core/box_sides.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"
#include "theory_records.hpp"

#include <algorithm>
#include <numeric>

namespace rodwake::app {

namespace {

using measure::RodOrder;
using measure::RodOrderSeries;

OrderRow row_of(double t, const RodOrder& o) {
    return {t,
            o.polar,
            o.nematic,
            static_cast<double>(o.clusters.size()),
            o.mean_size(),
            o.weighted_size(),
            static_cast<double>(o.clusters.front())};
}

/// Means over the runs, as far as all of them go.
std::string series_csv(const std::vector<RodOrderSeries>& runs) {
    const auto shortest = std::ranges::min(runs, {}, [](const auto& run) { return run.times.size(); });
    std::vector<OrderRow> rows(shortest.times.size());
    for (const RodOrderSeries& run : runs)
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const OrderRow row = row_of(shortest.times[i], run.orders[i]);
            for_each_field<OrderRow>([&](const auto& field) {
                rows[i].*field.member += row.*field.member / static_cast<double>(runs.size());
            });
            rows[i].t = row.t; // the same in all
        }
    return csv_of(rows);
}

/// Sizes that occur.
std::string clusters_csv(const measure::MeanRodOrder& mean, std::size_t rods) {
    std::vector<ClusterRow> rows;
    for (std::size_t i = 0; i < mean.clusters.size(); ++i) {
        const auto size = static_cast<double>(i + 1);
        if (mean.clusters[i] != 0.0)
            rows.push_back({size, mean.clusters[i], size * mean.clusters[i] / static_cast<double>(rods)});
    }
    return csv_of(rows);
}

std::string means_json(const measure::MeanRodOrder& mean, const OrderKeys& keys, std::size_t runs) {
    const OrderReport report{
        mean.polar,   mean.nematic,  mean.mean_size, mean.weighted_size,
        mean.largest, keys.link,     keys.from,      keys.block,
        runs,         mean.instants, mean.blocks,    {keys.units.length_name, keys.units.time_name, {}}};
    return record_json(report).dump(2) + "\n";
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
