#include "rodwake/app/plan.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/scene/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace rodwake::app {

const char* to_string(scene::FieldBackend backend) {
    using enum scene::FieldBackend;
    return backend == exact      ? "exact"
           : backend == table    ? "table"
           : backend == measured ? "measured"
                                 : "dynamic";
}

bool Plan::has(Stage stage) const { return std::ranges::find(stages, stage) != stages.end(); }

std::vector<RodsPlan> plan_rods(const scene::Scene& scene) {
    std::vector<RodsPlan> plans;
    for (Case& case_ : cases_of(scene)) {
        RodsPlan plan{std::move(case_), {}, {}, {}};
        plan.problem = rod_problem(plan.of.scene);
        plan.options = rod_options(*plan.of.scene.rods_run, plan.problem);
        plan.noise = noise_plan(plan.of.scene, plan.problem);
        if (plan.of.scene.noise) // one without noise among others is judged alike
            plan.options.criteria = rods::noisy_criteria;
        plans.push_back(std::move(plan));
    }
    return plans;
}

Plan make_plan(const scene::Scene& scene, std::span<const Stage> stages, PlanInputs inputs) {
    Plan plan{scene, {stages.begin(), stages.end()}, {}, {}, std::move(inputs.fit), {},
              {},    std::move(inputs.tracks)};
    const bool scans_beds = plan.has(Stage::scan) && scan_subject(scene) == scene::ScanSubject::beds;
    const bool bed_order = plan.has(Stage::order) && order_of_bed(scene);
    if (plan.has(Stage::granular) || (plan.has(Stage::measure) && scene.granular) || bed_order ||
        scans_beds) {
        for (Case& case_ : bed_cases(scene)) {
            BedPlan bed{std::move(case_), {}, {}, {}};
            bed.problem = granular_problem(bed.of.scene);
            bed.schedule = granular_schedule(*bed.of.scene.granular, bed.problem);
            bed.measures = measure_plan(bed.of.scene, bed.problem);
            plan.beds.push_back(std::move(bed));
        }
    }
    if (plan.has(Stage::rods))
        plan.rods = plan_rods(scene);
    if (plan.fit && plan.fit->complete())
        plan.fit_plan = fit_plan(*scene.fit, *plan.fit);
    if (plan.fit_plan)
        for (const scene::FitModel& model : scene.fit->models)
            model_plan(scene, model, *plan.fit_plan, *plan.fit); // refuses what cannot be weighed
    if (plan.has(Stage::scan))
        plan.scan = plan_scan(scene, inputs.list);
    return plan;
}

void apply_seed(scene::Scene& scene, std::uint64_t seed) {
    constexpr auto largest = static_cast<std::uint64_t>(std::numeric_limits<long>::max());
    const bool measured = scene.medium && scene.medium->measured;
    if ((scene.granular || scene.fit || scene.scan || scene.rods_random || scene.noise || measured) &&
        seed > largest)
        throw InputError(fmt::format("--seed {}: must be from 0 to {}", seed, largest));
    if (scene.granular) {
        scene.granular->seed = static_cast<long>(seed);
        if (scene.granular->rods_random) {
            scene.granular->rods_random->seed = static_cast<long>(seed);
            scene.granular->rods = scene::random_bed_rods(*scene.granular);
            if (static_cast<long>(scene.granular->rods.size()) < scene.granular->rods_random->count)
                throw InputError(
                    fmt::format("--seed {}: no room for {} rods of [granular.rods_random]: after {} no "
                                "further one was found; take another seed, a smaller count or "
                                "min_separation, or a larger bed",
                                seed, scene.granular->rods_random->count, scene.granular->rods.size()));
        }
    }
    if (scene.rods_random) {
        scene.rods_random->seed = static_cast<long>(seed);
        scene.rods = random_rods(*scene.rods_random, scene.body);
    }
    if (scene.noise)
        scene.noise->seed = static_cast<long>(seed);
    if (scene.fit)
        scene.fit->search.seed = seed;
    if (scene.scan)
        scene.scan->seed = static_cast<long>(seed);
    if (measured)
        scene.medium->measured->seed = static_cast<long>(seed);
}

std::vector<Case> cases_of(const scene::Scene& scene) {
    std::vector<Case> cases = {{"scene", "", "", scene}};
    for (const scene::Variant& variant : scene.variants)
        cases.push_back({variant.name, variant.label.empty() ? variant.name : variant.label,
                         "variants/" + variant.name + "/", scene::apply_variant(scene, variant)});
    return cases;
}

std::vector<Case> bed_cases(const scene::Scene& scene) {
    std::vector<Case> cases = cases_of(scene);
    std::erase_if(cases, [&](const Case& case_) {
        return !case_.folder.empty() && (!case_.scene.granular || case_.scene.granular == scene.granular);
    });
    return cases;
}

} // namespace rodwake::app
