// rodwake fit: measured profiles and tracks, of a finished run of the scene or of files elsewhere.

#include "fit_stage.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/scene/write.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "signals.hpp"
#include "stages.hpp"
#include "take_seed.hpp"
#include "verbs.hpp"

#include <string>

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;

/// What an earlier fit left, so that no file tells of another one.
void remove_old_fit(const fs::path& folder) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        const bool table =
            name.ends_with(".csv") && (name.starts_with("fit_profile_") || name.starts_with("fit_curve_") ||
                                       name.starts_with("fit_trajectory_"));
        if (table || name == "fit.json" || name == "fit.txt" || name == "fit_starts.log")
            fs::remove(entry.path());
    }
}

/// What [fit] adds to a folder that holds the run already.
int fit_finished_run(const Options& options, const scene::Scene& scene) {
    const fs::path folder = output_folder(options);
    if (scene.granular)
        require_same_beds(scene, folder);
    const bool stopped = fit_was_stopped(folder);
    if (fs::exists(folder / "fit.json") && !stopped && !options.force)
        throw InputError(folder.string() + ": is fitted already (fit.json); --force fits again");
    const FitPlan plan = fit_plan(scene, options, folder);
    if (options.force)
        remove_old_fit(folder);
    const Logger log = make_logger(options, folder / "log.txt");
    const FitEnd done = fit_in_folder(scene, plan, options, folder, log);
    if (done.end == StageEnd::interrupted) {
        log->warn("fit: stopped by a signal; the best so far is in {}; the same command goes on with the "
                  "other starts",
                  folder.string());
        return signal_exit_code(stop_signal());
    }
    if (done.end == StageEnd::failed)
        return 1;
    store::write_atomically(folder / "scene.toml", scene::to_toml(scene));
    log->info("results in {0}; rodwake plot {0} draws them", folder.string());
    return 0;
}

} // namespace

int verb_fit(const Options& options) {
    scene::Scene scene = scene::read_scene(options.target, options.overrides);
    take_seed(scene, options);
    if (!scene.fit)
        throw InputError(scene.path + ": no [fit] table, so there is nothing to fit");
    const bool of_a_run = scene.granular && !store::run_status(output_folder(options)).empty();
    return of_a_run && !options.dry_run ? fit_finished_run(options, scene) : verb_stages(options);
}

} // namespace rodwake::cli
