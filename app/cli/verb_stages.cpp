// rodwake field, rods, dem, measure, fit, run: read the scene, plan, execute, and say how it ended.

#include "rodwake/app/describe.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/scan/mpi.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>

namespace rodwake::cli {

namespace {

using app::Stage;

/// The stage a verb stands for, and what its scene must have.
struct StageVerb {
    Verb verb;
    Stage stage;
    const char* lacks;
};

constexpr StageVerb stage_verbs[] = {
    {Verb::dem, Stage::granular, "no [granular] table, so there is no bed to simulate"},
    {Verb::measure, Stage::measure, "no [measure] table and no [rods_order], so there is nothing to measure"},
    {Verb::fit, Stage::fit, "no [fit] table, so there is nothing to fit"},
    {Verb::field, Stage::field,
     "no [field] table, so there is no field to compute; rodwake rods or run may do"},
    {Verb::scan, Stage::scan, "no [scan] table, so there is nothing to scan"},
    {Verb::rods, Stage::rods, "no [rods_run] table, so there are no rods to integrate"},
};

std::vector<Stage> stages_of(Verb verb, const scene::Scene& scene, const std::filesystem::path& folder) {
    const auto of = std::ranges::find(stage_verbs, verb, &StageVerb::verb);
    if (of == std::end(stage_verbs))
        return app::stages_of(scene);
    // Whether the verb looks at the order of rods: of those it integrates, and of those that are to be
    // measured. Beside [measure] rods of the theory may be integrated later, in a field that is measured now.
    const bool later = scene.rods_order && scene.measure && !order_of_bed(scene) &&
                       app::stage_status(folder, Stage::rods) != "finished";
    const bool ordered =
        scene.rods_order && (verb == Verb::rods ? !order_of_bed(scene) : verb == Verb::measure && !later);
    if (!app::has_table(scene, of->stage) && !(verb == Verb::measure && ordered))
        throw InputError(scene.path + ": " + of->lacks);
    if (scene.medium && scene.medium->fitted && (verb == Verb::field || verb == Verb::rods))
        throw InputError(
            scene.path +
            ": medium.fitted = true takes eta and xi from [fit]: rodwake run fits first; or give eta and "
            "xi in [medium]");
    std::vector<Stage> stages;
    if (has_table(scene, of->stage))
        stages.push_back(of->stage);
    if (ordered)
        stages.push_back(Stage::order);
    return stages;
}

/// mpiexec kills its ranks a second after the signal, and planning a large scan takes longer. Its ledger is
/// whole at any time, so it ends then wherever it is.
void end_in_time(const std::stop_token& ended, const Options& options) {
    using namespace std::chrono_literals;
    for (int late = 0; !ended.stop_requested(); late += stop_signal() != 0 ? 1 : 0) {
        std::this_thread::sleep_for(20ms);
        if (late < 30)
            continue;
        const std::filesystem::path folder = output_folder(options);
        print_message(fmt::format("stopped by a signal; results so far are in {}; the same command resumes\n",
                                  folder.string()));
        std::error_code ignored;
        std::filesystem::remove(folder / "rodwake.lock", ignored);
        std::_Exit(signal_exit_code(stop_signal()));
    }
}

/// On a rank that rank 0 hands points to, which speaks for all.
int serve(const Options& options, const scene::Scene& scene, std::span<const Stage> stages,
          const app::RunContext& context, scan::MpiJob& job) {
    try {
        const app::Plan plan = app::plan_run(scene, stages, output_folder(options), context);
        app::serve(plan, output_folder(options), context, job);
    } catch (const std::exception& error) {
        job.fail(describe(error));
        return 0; // rank 0 ends the job: at an error here mpiexec might kill it before it has printed the
                  // reason
    }
    return stop_signal() ? signal_exit_code(stop_signal()) : 0;
}

} // namespace

int verb_stages(const Options& options) {
    const scene::Scene scene = scene_of(options);
    const std::vector<Stage> stages = stages_of(options.verb, scene, output_folder(options));
    if (options.dry_run)
        return verb_check(options);
    // A scan or granular runs may be an MPI job, of which ranks that serve say nothing.
    std::unique_ptr<scan::MpiJob> job;
    if (scan::started_as_rank()) {
        if (options.verb != Verb::scan && options.verb != Verb::dem)
            throw InputError(
                "only rodwake scan and rodwake dem work under mpiexec: other commands would repeat "
                "the same work on every rank");
        job = scan::MpiJob::join();
    }
    app::RunContext context = context_of(options);
    context.draws = options.verb == Verb::run && !options.no_figures;
    if (job)
        context.executor = [&job](scan::Evaluate evaluate, std::function<bool()> stop) {
            return job->executor(std::move(evaluate), std::move(stop));
        };
    if (job && job->rank() > 0) {
        context.log = nullptr;
        context.progress = nullptr;
    }
    if (job && job->rank() > 0)
        return serve(options, scene, stages, context, *job);
    std::jthread watch;
    if (job && options.verb == Verb::scan)
        watch = std::jthread([&](const std::stop_token& ended) { end_in_time(ended, options); });
    const auto plan = // large for a small stack
        std::make_unique<const app::Plan>(app::plan_run(scene, stages, output_folder(options), context));
    for (const std::string& doubt : app::doubts(*plan))
        context.log(app::Severity::warning, doubt);
    const app::StageEnd end = app::run(*plan, output_folder(options), context);
    if (end == app::StageEnd::failed)
        return 1;
    if (end != app::StageEnd::interrupted && context.draws)
        make_figures(output_folder(options), false, options.quiet);
    if (end == app::StageEnd::interrupted || stop_signal())
        return signal_exit_code(stop_signal());
    return end == app::StageEnd::incomplete ? 3 : 0;
}

} // namespace rodwake::cli
