#include "problems.hpp"

#include "rodwake/rods/method.hpp"

namespace rodwake::cli {

rods::Couplings couplings_of(const scene::Scene& scene) {
    if (!scene.coupling)
        return {};
    const scene::Coupling& c = *scene.coupling;
    return c.polar_basis == scene::PolarBasis::divergence
               ? rods::from_divergence_basis(c.kappa, c.gamma1, c.gamma2)
               : rods::Couplings{c.kappa, c.gamma1, c.gamma2};
}

rods::RodProblem rod_problem(const scene::Scene& scene) {
    rods::RodProblem problem;
    if (scene.medium) {
        problem.medium = elastic::Medium{scene.medium->eta, scene.medium->xi};
        problem.box = scene.medium->periodic;
    }
    problem.couplings = couplings_of(scene);
    for (const scene::Rod& rod : scene.rods)
        problem.rods.push_back({rod.position[0], rod.position[1], rod.heading});
    problem.t_end = scene.rods_run->t_end;
    problem.output_times = scene.rods_run->output_times;
    problem.output_times.insert(problem.output_times.begin(), 0.0);
    problem.contact_distance = scene.rods_run->contact_distance;
    return problem;
}

namespace {

integrate::Method method_of(scene::RodMethod method, const rods::RodProblem& problem) {
    switch (method) {
    case scene::RodMethod::bdf:
        return integrate::Method::bdf;
    case scene::RodMethod::adams:
        return integrate::Method::adams;
    case scene::RodMethod::erk:
        return integrate::Method::erk;
    case scene::RodMethod::automatic:
        break;
    }
    return rods::suitable_method(problem);
}

} // namespace

integrate::OdeOptions ode_options(const scene::RodsRun& run, const rods::RodProblem& problem) {
    integrate::OdeOptions options;
    options.method = method_of(run.method, problem);
    options.rtol = run.rtol;
    options.atol = run.atol;
    options.max_steps = run.max_steps;
    return options;
}

OutputUnits output_units(const scene::Scene& scene) {
    if (scene.units == scene::UnitSystem::reduced || !scene.scales)
        return {};
    return {scene.scales->f_over_mu, scene.scales->f_over_mu / scene.scales->v0, "si", "m", "s"};
}

} // namespace rodwake::cli
