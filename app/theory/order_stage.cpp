// The order stage: [rods_order] from what an earlier stage left, rods.csv of the theory or the frames of a
// bed.

#include "bed/measure_frames.hpp"
#include "bed/measure_stage.hpp"
#include "rods_order.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/store/csv.hpp"
#include "run/progress.hpp"
#include "run/stage_list.hpp"
#include "theory_records.hpp"

#include <fmt/format.h>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using measure::RodOrderSeries;

/// The row of a run that ended between two output times, by contact, does not count.
std::size_t rows_that_count(const std::vector<double>& t, const scene::RodsRun& run, double unit) {
    const std::size_t last = t.size() - 1;
    return last > 0 && t[last] < run.output_times[last - 1] * unit ? last : t.size();
}

RodOrderSeries theory_series(const fs::path& folder, const scene::Scene& scene, const OrderKeys& keys) {
    std::vector<std::string> names{std::string(field_names<TimeRow>().front())};
    for (std::size_t rod = 0; rod < scene.rods.size(); ++rod)
        for (const std::string_view name : field_names<PoseRow>())
            names.push_back(std::string(name) + std::to_string(rod));
    const auto columns = store::read_csv(folder / "rods.csv", names).columns;
    RodOrderSeries series;
    series.times = columns[0];
    series.times.resize(rows_that_count(series.times, *scene.rods_run, keys.units.time));
    std::vector<measure::RodPlace> places(scene.rods.size());
    for (std::size_t i = 0; i < series.times.size(); ++i) {
        for (std::size_t rod = 0; rod < places.size(); ++rod)
            places[rod] = {columns[1 + 3 * rod][i], columns[2 + 3 * rod][i], columns[3 + 3 * rod][i]};
        series.orders.push_back(measure::rod_order(places, keys.link, keys.box));
    }
    return series;
}

StageEnd order_of_theory(const Session& session) {
    for (const Case& one : cases_of(session.plan.scene)) {
        const OrderKeys keys(one.scene);
        write_rods_order(session, one, keys,
                         {theory_series(session.directory.file(one.folder), one.scene, keys)});
    }
    return StageEnd::finished;
}

/// Apolar rods have no heading, and are left out.
std::vector<measure::RodPlace> motile(const measure::Frame& frame, const granular::GranularProblem& problem) {
    std::vector<measure::RodPlace> places;
    for (std::size_t r = 0; r < frame.rods.size(); ++r)
        if (problem.rods[r].shape.kind == granular::RodKind::motile)
            places.push_back(frame.rods[r]);
    return places;
}

RodOrderSeries bed_series(const RunFiles& run, const granular::GranularProblem& problem,
                          const OrderKeys& keys, const std::function<bool(double)>& on_progress) {
    RodOrderSeries series;
    for_each_frame(run.trajectory, layout_of(problem), 1, [&](const measure::Frame& frame, double part) {
        series.times.push_back(frame.time);
        series.orders.push_back(measure::rod_order(motile(frame, problem), keys.link, keys.box));
        return on_progress(part);
    });
    return series;
}

StageEnd order_of_beds(const Session& session) {
    for (const BedPlan& bed : session.plan.beds) {
        const OrderKeys keys(bed.of.scene);
        const std::vector<RunFiles> runs = finished_runs(bed.of, session.directory.path(), session.log);
        SharedProgress progress(session.context, "order", runs.size(), static_cast<double>(runs.size()),
                                "runs");
        std::vector<RodOrderSeries> series(runs.size());
        parallel_for(runs.size(), session.context.thread_count(), [&](std::size_t i) {
            series[i] = bed_series(runs[i], bed.problem, keys, [&](double part) {
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

} // namespace

void require_rods(const Plan& plan, const fs::path& folder) {
    if (order_of_bed(plan.scene))
        return;
    const std::string status = stage_status(folder, Stage::rods);
    if (status != "finished")
        throw InputError(fmt::format(
            "{}: {}; rodwake rods SCENE -o DIR makes one, and its order with it", folder.string(),
            status.empty() ? "holds no run of the rods" : "holds a run of the rods that is " + status));
}

StageEnd run_order_stage(Session& session) {
    return order_of_bed(session.plan.scene) ? order_of_beds(session) : order_of_theory(session);
}

} // namespace rodwake::app
