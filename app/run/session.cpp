#include "session.hpp"

#include "rodwake/app/run.hpp"
#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/provenance.hpp"
#include "stage_kind.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/sink.h>

#include <algorithm>

namespace rodwake::app {

namespace {

/// Of all stages the one that is least done; a folder without any has only begun.
std::string worst(const StageRecords& records) {
    if (records.empty())
        return "unfinished";
    for (const char* status : {"failed", "unfinished", "interrupted"})
        for (const auto& [stage, of] : records)
            if (of == status)
                return status;
    return std::ranges::any_of(records, [](const auto& item) { return item.second == files_lost; })
               ? "unfinished"
               : "finished";
}

std::string provenance(const RunContext& context, const scene::Scene& scene, const StageRecords& records,
                       double wall_seconds) {
    // The seed is that of everything random, and 0 where nothing is.
    const std::uint64_t of_noise = scene.noise ? static_cast<std::uint64_t>(scene.noise->seed) : 0,
                        of_scan = scene.scan ? static_cast<std::uint64_t>(scene.scan->seed) : of_noise,
                        of_fit = scene.fit ? scene.fit->search.seed : of_scan;
    return store::provenance_json(
        {context.command, scene.path, worst(records),
         context.seed.value_or(scene.granular ? static_cast<std::uint64_t>(scene.granular->seed) : of_fit),
         wall_seconds, records});
}

/// The run folder, marked before the first other file: whatever fails afterwards, it can be taken over.
RunFolder begun(const std::filesystem::path& path, const RunContext& context, const Plan& plan) {
    RunFolder folder(path, plan.scene, plan.stages, context.force,
                     context.scan.rerun_failed || context.scan.merge, context.draws);
    scene::Scene written = plan.scene;
    if (folder.kept_runs()) // an ensemble that is kept has as many runs as it had
        written.granular->runs = *folder.kept_runs();
    // scene.toml states the gap that is used, unless a variant with other beads has another default.
    const bool other_beads = std::ranges::any_of(written.variants, [](const scene::Variant& variant) {
        return std::ranges::any_of(variant.set, [](const std::string& line) {
            return line.find("granular.bead_") != std::string::npos;
        });
    });
    if (written.granular && !other_beads)
        written.granular->gap.emplace(written.granular->plates.gap);
    folder.begin([&](const StageRecords& records) { return provenance(context, plan.scene, records, 0.0); },
                 scene::to_toml(written));
    return folder;
}

void write_medium(store::Hdf5Writer& results, const elastic::Medium& medium, const OutputUnits& units) {
    results.attribute("/medium", "eta", medium.eta);
    results.attribute("/medium", "nu", medium.nu());
    results.attribute("/medium", "alpha", 1.0 / medium.xi);
    results.attribute("/medium", "xi", medium.xi * units.length);
}

} // namespace

void write_couplings(store::Hdf5Writer& results, const std::string& group, const scene::Coupling& coupling,
                     const OutputUnits& units) {
    const rods::Couplings couplings = own_couplings(coupling);
    if (coupling.gamma_flow != 0.0)
        results.attribute(group, "gamma_flow", coupling.gamma_flow / units.length);
    if (coupling.rows.any()) {
        results.attribute(group, "gamma_rows", coupling.rows.gamma / units.time);
        results.attribute(group, "rows_direction", coupling.rows.direction);
    }
    for (const rods::Coupling& item : rods::coupling_list)
        results.attribute(group, std::string(item.name),
                          rods::in_units(item, couplings.*item.number, units.length, units.time));
}

Session::Session(Plan given, const std::filesystem::path& folder, RunContext of)
    : context(std::move(of)), plan(std::move(given)), directory(begun(folder, context, plan)),
      log(make_logger(context, directory.file("log.txt"))), units(output_units(plan.scene)),
      results(directory.file("result.h5")), start_(std::chrono::steady_clock::now()) {
    log->debug("{}", context.command);
    if (!directory.lock().doubt().empty())
        log->warn("{}", directory.lock().doubt());
    if (!directory.lock().taken_over().empty())
        log->warn("{}: {} left its lock behind and is gone; taking over", directory.path().string(),
                  directory.lock().taken_over());
    if (directory.resumed())
        log->info("{}: an earlier run did not finish; resuming it", directory.path().string());
    else if (directory.extended())
        log->info("{}: continuing a finished run", directory.path().string());
    tell_lost();
    const std::size_t wanted = context.thread_count(), started = ThreadPool(wanted).started();
    if (started < wanted) // loops go on with fewer of themselves
        log->warn("only {} of {} threads can be started (a limit of the system's); continuing with these",
                  started, wanted);
    for (const Stage stage : plan.stages)
        if (std::ranges::count(directory.kept(), stage) > 0)
            log->info("{}: done already", to_string(stage));
    results.attribute("/", "schema", std::int64_t{1});
    results.attribute("/", "rodwake_version", build_info().version);
    results.attribute("/", "title", plan.scene.title);
    const bool bed_only =
        (plan.scene.granular || plan.scene.tracks) && !plan.scene.field && !plan.scene.rods_run;
    results.attribute("/", "units", bed_only ? "si" : units.system);
    results.attribute("/", "length_unit", bed_only ? "m" : units.length_name);
    results.attribute("/", "time_unit", bed_only ? "s" : units.time_name);
    if (plan.scene.medium && !plan.scene.medium->fitted)
        write_medium(results, {plan.scene.medium->eta, plan.scene.medium->xi}, units);
    if (plan.scene.medium && plan.scene.medium->box()) {
        const PeriodicBox box = *plan.scene.medium->box() * units.length;
        results.attribute("/medium", "periodic", box.x);
        if (!box.square())
            results.attribute("/medium", "periodic_y", box.y);
    }
    if (plan.scene.coupling)
        write_couplings(results, "/coupling", *plan.scene.coupling, units);
    // Stages that are kept hand over their datasets, and what later stages take from them.
    for (const Stage stage : directory.kept()) {
        if (kind_of(stage).datasets && std::filesystem::exists(directory.file("result.h5")))
            results.copy_group(directory.file("result.h5"), std::string("/") + to_string(stage));
        if (const auto take = kind_of(stage).take_kept)
            take(*this);
    }
}

void Session::tell_lost() const {
    const StageRecords records = directory.records("finished");
    for (const auto& [stage, files] : directory.lost()) {
        if (files.empty()) // the command that found them gone reported it
            continue;
        const auto record = records.find(stage);
        const bool made =
            stage.empty() ? context.draws || files.back().ends_with(".json") || files.back().ends_with(".h5")
                          : record != records.end() && record->second == "finished";
        log->info("{}{}{} {} gone; {}", stage.empty() ? "" : stage + ": ", files.front(),
                  files.size() == 1 ? "" : fmt::format(" and {} more files", files.size() - 1),
                  files.size() == 1 ? "is" : "are", made ? "made again" : "left so by this command");
    }
}

void Session::use_medium(double eta, double xi) {
    fitted_ = plan.scene;
    fitted_->medium->fitted = false;
    fitted_->medium->eta = eta;
    fitted_->medium->xi = xi;
    write_medium(results, {eta, xi}, units);
}

void Session::close(StageEnd end) {
    closing_ = true;
    results.commit();
    write_manifest(directory.path());
    write_provenance(end == StageEnd::finished || end == StageEnd::incomplete
                         ? "finished"
                         : (end == StageEnd::failed ? "failed" : "interrupted"),
                     true);
}

void Session::fail(const std::string& why) noexcept {
    try {
        if (closing_ &&
            !finished_.empty()) // who ends with an error has not finished, whatever is there already
            finished_.pop_back();
        write_provenance("failed", false);
        for (const auto& sink : log->sinks())
            if (sink == log->sinks().front()) // log.txt; the caller hears it from the exception
                sink->log({log->name(), spdlog::level::err, why});
        log->flush();
        write_manifest(directory.path());
    } catch (const std::exception&) { // a full disk takes the record too; `unfinished` still stands there
    }
}

/// `results_kept`: result.h5 is in place, so what field and rods computed is not lost.
void Session::write_provenance(const std::string& status, bool results_kept) const {
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    StageRecords records = directory.records(status);
    for (const Stage stage : finished_)
        if (results_kept || !kind_of(stage).datasets)
            records[to_string(stage)] = "finished";
    directory.write("provenance.json", provenance(context, plan.scene, records, wall));
}

} // namespace rodwake::app
