// rodwake field, rods, run: read the scene, do the stages, keep what was computed however it ended.

#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "signals.hpp"
#include "stages.hpp"
#include "verbs.hpp"

namespace rodwake::cli {

namespace {

using Stage = StageEnd (*)(Session&);

std::vector<Stage> stages_of(const Options& options, const scene::Scene& scene) {
    if (options.verb == Verb::field && !scene.field)
        throw InputError(scene.path +
                         ": no [field] table, so there is no field to compute; rodwake rods or run may do");
    if (options.verb == Verb::rods && !scene.rods_run)
        throw InputError(scene.path + ": no [rods_run] table, so there are no rods to integrate");
    std::vector<Stage> stages;
    if (scene.field && options.verb != Verb::rods)
        stages.push_back(run_field_stage);
    if (scene.rods_run && options.verb != Verb::field)
        stages.push_back(run_rods_stage);
    return stages;
}

StageEnd run_all(Session& session, const std::vector<Stage>& stages) {
    for (const Stage stage : stages)
        if (const StageEnd end = stage(session); end != StageEnd::finished)
            return end;
    return StageEnd::finished;
}

int finish(Session& session, StageEnd end) {
    session.close(end);
    const std::string folder = session.directory.path().string();
    if (end == StageEnd::interrupted) {
        session.log->warn("stopped by a signal; what was computed is in {}; the same command starts again",
                          folder);
        return signal_exit_code(stop_signal());
    }
    if (end == StageEnd::failed)
        return 1;
    if (session.options.verb == Verb::run)
        make_figures(session.directory.path(), false, session.options.quiet);
    session.log->info("results in {}", folder);
    return 0;
}

} // namespace

int verb_stages(const Options& options) {
    if (options.dry_run)
        return verb_check(options);
    scene::Scene scene = scene::read_scene(options.target, options.overrides);
    const std::vector<Stage> stages = stages_of(options, scene);
    Session session(options, std::move(scene));
    return finish(session, run_all(session, stages));
}

int verb_plot(const Options& options) {
    std::filesystem::path folder = options.target;
    if (folder.filename() == "result.h5")
        folder = folder.has_parent_path() ? folder.parent_path() : ".";
    if (!std::filesystem::is_directory(folder))
        throw InputError(options.target + ": not a run directory; rodwake run SCENE makes one");
    if (store::run_status(folder).empty())
        throw InputError(folder.string() + ": holds no rodwake run (no provenance.json)");
    make_figures(folder, options.pdf, options.quiet);
    return 0;
}

} // namespace rodwake::cli
