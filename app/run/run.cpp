#include "rodwake/app/run.hpp"
#include "rodwake/store/hdf5_writer.hpp"

#include "rodwake/app/run_context.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "stage_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <thread>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

bool only(const Plan& plan, Stage stage) { return plan.stages.size() == 1 && plan.stages.front() == stage; }

} // namespace

Plan plan_run(scene::Scene scene, std::span<const Stage> stages, const fs::path& folder,
              const RunContext& context) {
    if (context.seed)
        apply_seed(scene, *context.seed);
    const auto made = [&](Stage stage) { return std::ranges::find(stages, stage) != stages.end(); };
    const InputRequest request{folder, context, made(Stage::granular) || made(Stage::measure), false};
    PlanInputs inputs;
    for (const Stage stage : stages)
        if (const auto read = kind_of(stage).read)
            read(inputs, scene, request);
    return make_plan(scene, stages, std::move(inputs));
}

Plan plan_check(scene::Scene scene, const fs::path& folder, const RunContext& context) {
    if (context.seed)
        apply_seed(scene, *context.seed);
    PlanInputs inputs;
    for (const Stage stage : all_stages())
        if (const auto read = kind_of(stage).read; read && has_table(scene, stage))
            read(inputs, scene, {folder, context, true, true});
    return make_plan(scene, stages_of(scene), std::move(inputs));
}

void serve(const Plan& plan, const fs::path& folder, const RunContext& context, scan::MpiJob& job) {
    for (const Stage stage : plan.stages)
        if (const auto work = kind_of(stage).serve)
            return work(plan, folder, context, job);
}

StageEnd run(const Plan& plan, const fs::path& folder, const RunContext& context) {
    store::prepare_hdf5();
    // Stages refuse what they cannot do before anything of the folder is touched.
    for (const Stage stage : plan.stages)
        if (const auto require = kind_of(stage).require)
            require(plan, folder, context);
    const auto held = std::make_unique<Session>(plan, folder, context); // large for a small stack
    Session& session = *held;
    StageEnd end = StageEnd::finished;
    try {
        const std::vector<Stage>& stages = session.directory.stages(); // those that are not done already
        for (auto stage = stages.begin(); stage != stages.end() && end == StageEnd::finished; ++stage) {
            end = kind_of(*stage).run(session);
            if (end == StageEnd::finished || end == StageEnd::incomplete)
                session.finished(*stage);
        }
        session.close(end);
    } catch (const std::exception& error) { // it is on record in the folder, too
        session.fail(rodwake::describe(error));
        throw;
    }
    if (end == StageEnd::interrupted)
        session.log->warn("stopped by a signal; results so far are in {}; the same command resumes from the "
                          "last checkpoint, or starts again if there is none yet",
                          folder.string());
    const bool drawn_later = (only_measures(plan) && !(plan.scene.tracks && context.draws)) ||
                             only(plan, Stage::fit) || only(plan, Stage::scan);
    if (end == StageEnd::finished || end == StageEnd::incomplete)
        session.log->info("results in {}{}", folder.string(),
                          drawn_later ? "; rodwake plot " + folder.string() + " draws them" : "");
    return end;
}

std::size_t RunContext::thread_count() const {
    return threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
}

} // namespace rodwake::app
