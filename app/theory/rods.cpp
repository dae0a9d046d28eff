#include "rodwake/app/rods.hpp"

#include "rodwake/scan/proportion.hpp"

#include <algorithm>
#include <span>

namespace rodwake::app {

rods::Couplings own_couplings(const scene::Coupling& c) {
    return c.polar_basis == scene::PolarBasis::divergence ? rods::from_divergence_basis(c)
                                                          : rods::Couplings(c);
}

rods::Couplings couplings_of(const scene::Scene& scene) {
    if (!scene.coupling)
        return {};
    const rods::Couplings own = own_couplings(*scene.coupling);
    return scene.medium && scene.coupling->gamma_flow != 0.0
               ? rods::with_flow(own, scene.coupling->gamma_flow, scene.medium->eta, scene.medium->xi)
               : own;
}

rods::RodProblem rod_problem(const scene::Scene& scene) {
    rods::RodProblem problem;
    if (scene.medium) {
        problem.medium = elastic::Medium{scene.medium->eta, scene.medium->xi};
        problem.box = scene.medium->box();
    }
    problem.couplings = couplings_of(scene);
    problem.rows = scene.coupling ? scene.coupling->rows : rods::Rows{};
    for (const scene::Rod& rod : scene.rods)
        problem.rods.push_back({rod.position[0], rod.position[1], rod.heading});
    problem.bodies = scene::bodies_of(scene);
    problem.t_end = scene.rods_run->t_end;
    problem.output_times = scene.rods_run->output_times;
    problem.output_times.insert(problem.output_times.begin(), 0.0);
    problem.contact_distance = scene.rods_run->contact_distance;
    problem.sums.accuracy = scene.rods_run->precision;
    problem.sums.turning_tolerance = scene.rods_run->turning_tolerance;
    return problem;
}

rods::RodOptions rod_options(const scene::RodsRun& run, const rods::RodProblem& problem) {
    rods::RodOptions options;
    options.form = run.form;
    options.ode.method = run.method                           ? *run.method
                         : run.form == rods::Formulation::dae ? integrate::Method::bdf
                                                              : rods::suitable_method(problem);
    options.held_wakes =
        !run.method && run.form == rods::Formulation::angle && rods::suits_held_wakes(problem);
    options.ode.rtol = run.rtol;
    options.ode.atol = run.atol;
    options.ode.max_steps = run.max_steps;
    return options;
}

std::optional<NoisePlan> noise_plan(const scene::Scene& scene, const rods::RodProblem& problem) {
    if (!noisy(scene))
        return std::nullopt;
    const scene::Noise& keys = *scene.noise;
    NoisePlan plan;
    plan.noise.rotational = keys.rotational_diffusion;
    plan.noise.translational = keys.translational_diffusion;
    plan.noise.time_step =
        keys.time_step ? *keys.time_step : rods::suitable_time_step(problem, keys.rotational_diffusion);
    plan.noise.seed = static_cast<std::uint64_t>(keys.seed);
    plan.runs = static_cast<std::uint32_t>(keys.runs);
    plan.capture_error = keys.capture_error;
    plan.most_runs = static_cast<std::uint32_t>(keys.most_runs);
    return plan;
}

std::uint32_t wanted_runs(const rods::NoiseSums& sums, std::size_t rods, const NoisePlan& plan) {
    std::uint32_t runs = plan.runs;
    if (!plan.capture_error)
        return runs;
    while (runs < plan.most_runs && runs <= sums.ends.size()) {
        const std::span<const rods::NoisyEnd> ends = std::span(sums.ends).first(runs);
        if (std::ranges::any_of(ends, &rods::NoisyEnd::failed)) // more would say no more
            break;
        const rods::CaptureCount captures = rods::count_captures(ends, rods);
        const auto [low, high] = scan::Proportion{captures.count, captures.of}.wilson(scan::quantile_95);
        if (captures.of == 0 || 0.5 * (high - low) <= *plan.capture_error)
            break;
        runs = std::min(plan.most_runs, runs + (runs + 1) / 2);
    }
    return runs;
}

bool run_wanted(const rods::RodProblem& problem, const rods::RodOptions& options, const NoisePlan& plan,
                std::size_t threads, rods::NoiseSums& sums,
                const std::function<void(const rods::NoiseSums&)>& added) {
    while (true) {
        const std::uint32_t wanted = wanted_runs(sums, problem.rods.size(), plan);
        if (sums.ends.size() >= wanted)
            return true;
        if (!rods::run_ensemble(problem, options, plan.noise, wanted, threads, sums, added))
            return false;
    }
}

OutputUnits output_units(const scene::Scene& scene) {
    if (scene.units == scene::UnitSystem::reduced || !scene.scales)
        return {};
    return {scene.scales->f_over_mu, scene.scales->f_over_mu / scene.scales->v0, "si", "m", "s"};
}

OutputUnits order_units(const scene::Scene& scene) {
    return order_of_bed(scene) ? OutputUnits{1.0, 1.0, "si", "m", "s"} : output_units(scene);
}

} // namespace rodwake::app
