// [rods_order]: order parameters and clusters of a run of the rods.

#include "rodwake/measure/rod_order.hpp"
#include "rodwake/store/csv.hpp"
#include "stage_list.hpp"
#include "values_json.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::stages {

namespace {

using measure::RodOrder;

/// At each stored time, in reduced units.
std::vector<RodOrder> orders_of(const integrate::Solution& solution, double link, rods::Box box) {
    std::vector<RodOrder> orders;
    for (const std::vector<double>& state : solution.states) {
        std::vector<measure::RodPlace> places;
        for (std::size_t rod = 0; rod < state.size() / 3; ++rod) {
            const rods::Pose pose = rods::pose(state, rod);
            places.push_back({pose.x, pose.y, pose.heading});
        }
        orders.push_back(measure::rod_order(places, link, box));
    }
    return orders;
}

std::string series_csv(std::span<const double> times, std::span<const RodOrder> orders, double unit) {
    const std::string names[] = {"t",         "polar",         "nematic", "clusters",
                                 "mean_size", "weighted_size", "largest"};
    std::vector<std::vector<double>> columns(std::size(names));
    for (std::size_t i = 0; i < orders.size(); ++i) {
        const RodOrder& o = orders[i];
        const double row[] = {times[i] * unit,
                              o.polar,
                              o.nematic,
                              static_cast<double>(o.clusters.size()),
                              o.mean_size(),
                              o.weighted_size(),
                              static_cast<double>(o.clusters.front())};
        for (std::size_t k = 0; k < columns.size(); ++k)
            columns[k].push_back(row[k]);
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

std::string means_json(const measure::MeanRodOrder& mean, const scene::RodsOrder& order, double block,
                       const assembly::OutputUnits& units) {
    const assembly::Values values{{"polar", mean.polar},
                                  {"nematic", mean.nematic},
                                  {"mean_size", mean.mean_size},
                                  {"weighted_size", mean.weighted_size},
                                  {"largest", mean.largest},
                                  {"link", order.link * units.length},
                                  {"from", order.from * units.time},
                                  {"block", block * units.time},
                                  {"instants", static_cast<std::int64_t>(mean.instants)},
                                  {"blocks", static_cast<std::int64_t>(mean.blocks)},
                                  {"units.length", units.length_name},
                                  {"units.time", units.time_name}};
    return values_json(values).dump(2) + "\n";
}

} // namespace

void write_rods_order(const Session& session, const assembly::Case& of, const rods::RodResult& result) {
    const integrate::Solution& solution = result.solution;
    const scene::RodsOrder& order = *of.scene.rods_order;
    const auto finished = solution.status.termination;
    if (finished == integrate::Termination::failed || finished == integrate::Termination::interrupted)
        return;
    if (solution.times.empty() || solution.times.back() < order.from)
        return session.log->warn("order of the rods: the run ended before rods_order.from = {:g}",
                                 order.from);
    const rods::Box box = of.scene.medium ? of.scene.medium->periodic : std::nullopt;
    const auto orders = orders_of(solution, order.link, box);
    const double block = order.block.value_or((of.scene.rods_run->t_end - order.from) / 10.0);
    const auto mean = measure::mean_rod_order(solution.times, orders, order.from, block);
    const auto write = [&](const char* name, const std::string& text) {
        session.directory.write(of.folder + name, text);
    };
    write("rods_order.csv", series_csv(solution.times, orders, session.units.time));
    write("clusters.csv", clusters_csv(mean, of.scene.rods.size()));
    write("rods_order.json", means_json(mean, order, block, session.units));
    session.log->info("order of the rods{}: polar {:.3g} +- {:.2g}, nematic {:.3g} +- {:.2g}, a rod is in a "
                      "cluster of {:.3g} +- {:.2g}",
                      of.suffix(), mean.polar.value, mean.polar.error, mean.nematic.value, mean.nematic.error,
                      mean.weighted_size.value, mean.weighted_size.error);
}

} // namespace rodwake::stages
