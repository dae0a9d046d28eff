// rodwake field, rods, dem, measure, fit, run: read the scene, do the stages, keep what was computed however
// it ended.

#include "fit_plan.hpp"
#include "measure_stage.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/scene/write.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "signals.hpp"
#include "stages.hpp"
#include "take_seed.hpp"
#include "verbs.hpp"
#include "words_of.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::cli {

namespace {

using Stage = StageEnd (*)(Session&);

std::vector<Stage> stages_of(const Options& options, const scene::Scene& scene) {
    if (options.verb == Verb::field && !scene.field)
        throw InputError(scene.path +
                         ": no [field] table, so there is no field to compute; rodwake rods or run may do");
    if (options.verb == Verb::rods && !scene.rods_run)
        throw InputError(scene.path + ": no [rods_run] table, so there are no rods to integrate");
    if (options.verb == Verb::dem && !scene.granular)
        throw InputError(scene.path + ": no [granular] table, so there is no bed to simulate");
    if (scene.medium && scene.medium->fitted && (options.verb == Verb::field || options.verb == Verb::rods))
        throw InputError(
            scene.path +
            ": medium.fitted = true takes eta and xi from [fit]: rodwake run fits first; or give eta and "
            "xi in [medium]");
    const auto wanted = [&](Verb verb) { return options.verb == verb || options.verb == Verb::run; };
    std::vector<Stage> stages;
    const bool foreign = options.verb == Verb::run && scene.measure && !scene.measure->trajectory.empty();
    if (scene.granular && wanted(Verb::dem) && !foreign)
        stages.push_back(run_dem_stage);
    if (scene.measure && wanted(Verb::measure))
        stages.push_back(run_measure_stage);
    if (scene.fit && wanted(Verb::fit))
        stages.push_back(run_fit_stage);
    if (scene.field && wanted(Verb::field))
        stages.push_back(run_field_stage);
    if (scene.rods_run && wanted(Verb::rods))
        stages.push_back(run_rods_stage);
    return stages;
}

StageEnd run_all(Session& session, const std::vector<Stage>& stages) {
    StageEnd end = StageEnd::finished;
    for (auto stage = stages.begin(); stage != stages.end() && end == StageEnd::finished; ++stage)
        end = (*stage)(session);
    session.close(end);
    return end;
}

/// The same, with an exception on record in the run directory.
StageEnd run_recorded(Session& session, const std::vector<Stage>& stages) {
    try {
        return run_all(session, stages);
    } catch (const std::exception& error) {
        session.fail(words_of(error));
        throw;
    }
}

int finish(const Session& session, StageEnd end) {
    const std::string folder = session.directory.path().string();
    if (end == StageEnd::interrupted) {
        session.log->warn(
            "stopped by a signal; what was computed is in {}; the same command goes on from the last "
            "checkpoint, or starts again where there is none yet",
            folder);
        return signal_exit_code(stop_signal());
    }
    if (end == StageEnd::failed)
        return 1;
    if (session.options.verb == Verb::run) {
        make_figures(session.directory.path(), false, session.options.quiet);
        if (stop_signal())
            return signal_exit_code(stop_signal());
    }
    if (session.options.verb == Verb::fit)
        session.log->info("results in {0}; rodwake plot {0} draws them", folder);
    else
        session.log->info("results in {}", folder);
    return 0;
}

/// What [measure] adds to a folder that holds the run already.
int measure_finished_run(const Options& options, const scene::Scene& scene) {
    const std::filesystem::path folder = output_folder(options);
    if (store::run_status(folder).empty())
        throw InputError(folder.string() +
                         ": holds no rodwake run; rodwake dem SCENE makes one, rodwake run SCENE makes "
                         "and measures it; -o names its folder");
    require_same_beds(scene, folder);
    if (std::filesystem::exists(folder / "measure.json") && !options.force)
        throw InputError(folder.string() + ": is measured already (measure.json); --force measures again");
    const Logger log = make_logger(options, folder / "log.txt");
    const StageEnd end = measure_folder(scene, options, folder, log);
    if (end == StageEnd::interrupted) {
        log->warn("measure: stopped by a signal; nothing was changed");
        return signal_exit_code(stop_signal());
    }
    store::write_atomically(folder / "scene.toml", scene::to_toml(scene));
    log->info("results in {}; rodwake plot {} draws them", folder.string(), folder.string());
    return end == StageEnd::failed ? 1 : 0;
}

} // namespace

int verb_measure(const Options& options) {
    scene::Scene scene = scene::read_scene(options.target, options.overrides);
    take_seed(scene, options);
    if (!scene.measure)
        throw InputError(scene.path + ": no [measure] table, so there is nothing to measure");
    if (options.dry_run)
        return verb_check(options);
    return scene.measure->trajectory.empty() ? measure_finished_run(options, scene) : verb_stages(options);
}

int verb_stages(const Options& options) {
    scene::Scene scene = scene::read_scene(options.target, options.overrides);
    take_seed(scene, options);
    const std::vector<Stage> stages = stages_of(options, scene);
    if (options.dry_run)
        return verb_check(options);
    if (std::ranges::count(stages, &run_dem_stage) > 0)
        require_dem(scene, options);
    if (std::ranges::count(stages, &run_measure_stage) > 0 && !scene.measure->trajectory.empty())
        require_trajectory(scene, options);
    if (options.verb == Verb::fit)
        fit_plan(scene, options, {}); // nothing is written if a file is missing or wrong
    else if (std::ranges::count(stages, &run_fit_stage) > 0)
        require_fit_files(scene, options);
    Session session(options, std::move(scene));
    return finish(session, run_recorded(session, stages));
}

int verb_plot(const Options& options) {
    std::filesystem::path folder = options.target;
    if (folder.filename() == "result.h5")
        folder = folder.has_parent_path() ? folder.parent_path() : ".";
    if (!std::filesystem::is_directory(folder))
        throw InputError(options.target + ": not a run directory; rodwake run SCENE makes one");
    if (store::run_status(folder).empty())
        throw InputError(folder.string() + ": holds no rodwake run (no provenance.json)");
    if (options.dry_run)
        return 0; // there is something to draw; that is all there is to say
    make_figures(folder, options.pdf, options.quiet);
    return stop_signal() ? signal_exit_code(stop_signal()) : 0;
}

} // namespace rodwake::cli
