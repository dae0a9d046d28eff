// The order stage: [rods_order] from what an earlier stage left, rods.csv of the theory or the frames of a
// bed; its files.

#include "bed/measure_frames.hpp"
#include "bed/measure_stage.hpp"
#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/measure/rod_order.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/csv.hpp"
#include "run/log.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"
#include "run/session.hpp"
#include "run/stage_kind.hpp"
#include "theory_records.hpp"
#include "wake_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace rodwake::app {

namespace {

/// [rods_order] of a case, in the units of its files.
struct RodOrderSettings {
    std::optional<double> link; ///< absent: bodies that touch
    rods::RodBodies bodies;     ///< in the unit of the files
    double from = 0.0, block = 0.0;
    std::optional<PeriodicBox> box; ///< the periodic one; absent: infinite plane
    OutputUnits units;

    explicit RodOrderSettings(const scene::Scene& scene);
};

using measure::RodOrderSeries;

/// Means over the runs, as far as all of them go.
std::string series_csv(const std::vector<RodOrderSeries>& runs) {
    const auto shortest = std::ranges::min(runs, {}, [](const auto& run) { return run.times.size(); });
    std::vector<OrderRow> rows(shortest.times.size());
    for (const RodOrderSeries& run : runs)
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const measure::RodOrder& o = run.orders[i];
            const OrderRow row = {shortest.times[i],
                                  o.polar,
                                  o.nematic,
                                  static_cast<double>(o.clusters.size()),
                                  o.mean_size(),
                                  o.weighted_size(),
                                  static_cast<double>(o.clusters.front())};
            for_each_field<OrderRow>([&](const auto& field) {
                rows[i].*field.get += row.*field.get / static_cast<double>(runs.size());
            });
            rows[i].t = row.t; // the same in all
        }
    return csv_of(rows);
}

std::string means_json(const measure::MeanRodOrder& mean, const RodOrderSettings& keys,
                       const std::vector<RodOrderSeries>& runs) {
    OrderReport report{mean.polar,
                       mean.nematic,
                       mean.mean_size,
                       mean.weighted_size,
                       mean.largest,
                       keys.link,
                       keys.from,
                       keys.block,
                       {},
                       runs.size(),
                       mean.instants,
                       mean.blocks,
                       {keys.units.length_name, keys.units.time_name, {}}};
    if (!keys.link) // one run, of the theory
        if (const auto lifetime = measure::link_lifetime(runs.front().times, runs.front().orders))
            report.touch_lifetime = *lifetime;
    return json_text(record_json(report), 2) + "\n";
}

RodOrderSettings::RodOrderSettings(const scene::Scene& scene) : units(order_units(scene)) {
    const scene::RodsOrder& order = *scene.rods_order;
    const bool bed = order_of_bed(scene);
    const double end = bed ? scene.granular->duration : scene.rods_run->t_end;
    if (order.link)
        link = *order.link * units.length;
    else
        bodies = bodies_of(scene);
    for (rods::BodyShape& shape : bodies.shapes) {
        shape.length *= units.length;
        shape.thick_diameter *= units.length;
        shape.thin_diameter *= units.length;
    }
    from = order.from * units.time;
    block = order.block.value_or((end - order.from) / 10.0) * units.time;
    if (bed)
        box = bed_size(*scene.granular).box;
    else if (scene.medium && scene.medium->box())
        box = *scene.medium->box() * units.length;
}

/// Of all runs of a case, one for rods of the theory; nothing but a warning if all ended before
/// rods_order.from.
void write_rods_order(const Session& session, const Case& of, const RodOrderSettings& keys,
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
    const auto rods =
        static_cast<double>(std::accumulate(of_some_instant.begin(), of_some_instant.end(), std::size_t{0}));
    std::vector<ClusterRow> clusters; // of the sizes that occur
    for (std::size_t i = 0; i < mean.clusters.size(); ++i) {
        const auto size = static_cast<double>(i + 1);
        if (mean.clusters[i] != 0.0)
            clusters.push_back({size, mean.clusters[i], size * mean.clusters[i] / rods});
    }
    write("clusters.csv", csv_of(clusters));
    std::vector<FluctuationRow> fluctuations;
    for (std::size_t k = 0; k < mean.fluctuations.size(); ++k) {
        const measure::NumberFluctuation& of_cells = mean.fluctuations[k];
        fluctuations.push_back(
            {of_cells.cell, of_cells.rods, of_cells.fluctuation, mean.fluctuation_errors[k]});
    }
    if (!fluctuations.empty()) // of fewer than four rods there are none
        write("fluctuations.csv", csv_of(fluctuations));
    write("rods_order.json", means_json(mean, keys, runs));
    session.log->info("order of the rods{}: polar {:.3g} +- {:.2g}, nematic {:.3g} +- {:.2g}, a rod is in a "
                      "cluster of {:.3g} +- {:.2g}",
                      of.suffix(), mean.polar.value, mean.polar.error, mean.nematic.value, mean.nematic.error,
                      mean.weighted_size.value, mean.weighted_size.error);
}

namespace fs = std::filesystem;

RodOrderSeries theory_series(const fs::path& folder, const scene::Scene& scene,
                             const RodOrderSettings& keys) {
    std::vector<std::string> names{std::string(field_names<TimeRow>().front())};
    for (std::size_t rod = 0; rod < scene.rods.size(); ++rod)
        for (const std::string_view name : field_names<PoseRow>())
            names.push_back(std::string(name) + std::to_string(rod));
    const auto columns = store::read_csv(folder / "rods.csv", names).columns;
    RodOrderSeries series;
    series.times = columns[0];
    // The row of a run that ended between two output times, by contact, does not count.
    const std::size_t last = series.times.size() - 1;
    if (last > 0 && series.times[last] < scene.rods_run->output_times[last - 1] * keys.units.time)
        series.times.pop_back();
    std::vector<measure::RodPosition> places(scene.rods.size());
    const rods::BodyForces bodies(keys.bodies, places.size(), keys.box);
    std::vector<double> state(3 * places.size());
    const auto touch = [&](std::size_t a, std::size_t b) {
        return bodies.contact(state, a, b).overlap > bodies.touching_overlap();
    };
    for (std::size_t i = 0; i < series.times.size(); ++i) {
        for (std::size_t rod = 0; rod < places.size(); ++rod)
            places[rod] = {columns[1 + 3 * rod][i], columns[2 + 3 * rod][i], columns[3 + 3 * rod][i]};
        for (std::size_t rod = 0; rod < places.size(); ++rod) {
            state[3 * rod] = places[rod].x;
            state[3 * rod + 1] = places[rod].y;
            state[3 * rod + 2] = places[rod].heading;
        }
        series.orders.push_back(keys.link
                                    ? measure::rod_order(places, *keys.link, keys.box)
                                    : measure::rod_order(places, bodies.farthest_touch(), keys.box, touch));
    }
    return series;
}

StageEnd run_order(Session& session) {
    if (!order_of_bed(session.plan.scene)) { // rods of the theory
        for (const Case& case_ : cases_of(session.plan.scene)) {
            const RodOrderSettings keys(case_.scene);
            write_rods_order(session, case_, keys,
                             {theory_series(session.directory.file(case_.folder), case_.scene, keys)});
        }
        return StageEnd::finished;
    }
    for (const BedPlan& bed : session.plan.beds) {
        const RodOrderSettings keys(bed.of.scene);
        const std::vector<RunFiles> runs = finished_runs(bed.of, session.directory.path(), session.log);
        SharedProgress progress(session.context, "order", runs.size(), static_cast<double>(runs.size()),
                                "runs");
        std::vector<RodOrderSeries> series(runs.size());
        parallel_for(runs.size(), session.context.thread_count(), [&](std::size_t i) {
            for_each_frame(
                runs[i].trajectory, layout_of(bed.problem), 1, [&](const measure::Frame& frame, double part) {
                    std::vector<measure::RodPosition> motile; // apolar rods have no heading, and are left out
                    for (std::size_t r = 0; r < frame.rods.size(); ++r)
                        if (bed.problem.rods[r].shape.kind == granular::RodKind::motile)
                            motile.push_back(frame.rods[r]);
                    series[i].times.push_back(frame.time);
                    series[i].orders.push_back(measure::rod_order(motile, *keys.link, keys.box));
                    progress.update(i, part);
                    return !session.context.stopped();
                });
        });
        if (session.context.stopped())
            return StageEnd::interrupted;
        write_rods_order(session, bed.of, keys, series);
    }
    return StageEnd::finished;
}

void require_rods(const Plan& plan, const fs::path& folder, const RunContext&) {
    if (!only_measures(plan))
        return;
    if (!plan.scene.measure || plan.scene.measure->trajectory.empty())
        require_run(plan, folder);
    if (order_of_bed(plan.scene))
        return;
    const std::string status = stage_status(folder, Stage::rods);
    if (status != "finished")
        throw InputError(fmt::format(
            "{}: {}; rodwake rods SCENE -o DIR makes one, and its order with it", folder.string(),
            status.empty() ? "holds no run of the rods" : "holds a run of the rods that is " + status));
}

std::string order_key(const scene::Scene& scene) {
    if (!order_of_bed(scene)) {
        scene::Scene key;
        key.rods_order = scene.rods_order;
        return stage_key(scene, Stage::rods) + scene::to_plain_toml(key);
    }
    return key_of_beds(scene, [](scene::Scene& key, const scene::Scene& of) {
        key.rods_order = of.rods_order;
        if (of.measure)
            key.measure.emplace().trajectory = of.measure->trajectory;
    });
}

bool order_outdated(const scene::Scene& scene, const StageChanges& all) {
    return order_of_bed(scene)
               ? all.redone(Stage::granular)
               : all.redone(Stage::rods) || all.dropped(Stage::rods) || has_new_field(scene, all);
}

std::vector<FileKind> order_files() {
    return {{"rods_order.csv", Lifetime::result,
             "order parameters of the rods against time, means over the runs", columns_of<OrderRow>()},
            {"clusters.csv", Lifetime::result, "clusters of the rods by size", columns_of<ClusterRow>()},
            {"fluctuations.csv", Lifetime::result, "number fluctuations of the rods by the size of cells",
             columns_of<FluctuationRow>()},
            {"rods_order.json", Lifetime::result,
             "means of rods_order.csv from rods_order.from on, with standard errors",
             values_of<OrderReport>()}};
}

} // namespace

StageKind order_stage() {
    return {.stage = Stage::order,
            .has_table = [](const scene::Scene& s) { return s.rods_order.has_value(); },
            .wanted =
                [](const scene::Scene& s) {
                    return s.rods_order && !(order_of_bed(s) && scan_subject(s) == scene::ScanSubject::beds);
                },
            .key = order_key,
            .files = order_files,
            .run = run_order,
            .require = require_rods,
            .outdated = order_outdated,
            .light = true};
}

} // namespace rodwake::app
