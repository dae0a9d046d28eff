#include "rodwake/app/design_models.hpp"

#include "rodwake/app/rods.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/fitting/posterior.hpp"
#include "rodwake/scene/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

bool diffuses(const scene::Fit& fit) { return scene::fit_has(fit, "D_r") || scene::fit_has(fit, "D_t"); }

} // namespace

FitPlan DesignModels::Model::plan_of(const std::vector<States>& data) const {
    FitInputs inputs;
    for (std::size_t k = 0; k < tracks; ++k) {
        inputs.tracks.emplace_back(track);
        inputs.tracks.back()->data.states = data[k % data.size()];
    }
    scene::Fit all = keys;
    all.trajectories.resize(tracks, keys.trajectories.front());
    return fit_plan(all, std::move(inputs));
}

DesignModels::Model DesignModels::model_of(const scene::Scene& scene, long runs) {
    Model model{.keys = *scene.fit, .track = {}};
    model.keys.models.clear();
    const scene::FitTrajectory& keys = scene.fit->trajectories.front();
    const rods::RodProblem rods = rod_problem(scene);
    model.track.name = model.track.file = "design";
    model.track.rods = rods.rods.size();
    model.track.sigma_known = true;

    // The poses are asked for at the output times, the start and the end.
    fitting::Trajectory& data = model.track.data;
    data.name = "design";
    data.times = rods.output_times;
    if (data.times.empty() || data.times.back() < rods.t_end)
        data.times.push_back(rods.t_end);
    if (data.times.front() > 0.0)
        data.times.insert(data.times.begin(), 0.0);
    data.states.assign(data.times.size(), rods::to_state(rods.rods));
    data.free_start = keys.start_poses != scene::StartPoses::exact;
    data.box = rods.box;
    data.bodies = rods.bodies;

    const double smaller = diffuses(model.keys) ? 1.0 : std::sqrt(static_cast<double>(runs));
    data.sigma_position = *keys.sigma_position / smaller;
    data.sigma_heading = *keys.sigma_heading / smaller;
    model.tracks = diffuses(model.keys) ? static_cast<std::size_t>(runs) : 1;
    return model;
}

DesignModels::DesignModels(const scene::Scene& base, const std::vector<std::string>& settings, long runs) {
    const scene::Scene scene = scene::apply_variant(base, {.name = "design", .label = "", .set = settings});
    const auto need = [](bool there, const char* message) {
        if (!there)
            throw InputError(fmt::format("design: {}", message));
    };
    need(!scene.rods.empty() && scene.rods_run, "the scene has no [[rods]] and [rods_run], whose start and "
                                                "output times would be the experiment's");
    need(scene.fit && scene.fit->trajectories.size() == 1 && scene.fit->profiles.empty() &&
             scene.fit->maps.empty(),
         "[fit] must have one of [[fit.trajectories]], whose errors would be the experiment's, and no other "
         "data; its file need not be there");
    const scene::FitTrajectory& track = scene.fit->trajectories.front();
    need(track.sigma_position && track.sigma_heading,
         "give sigma_position and sigma_heading in [[fit.trajectories]]: how well rods would be seen");
    need(!track.contact_time, "a contact_time is no datum before the experiment: leave it out");
    need(!scene.fit->models.empty(), "there are no models to compare: give [[fit.models]]");
    need(scene.fit->posterior.has_value(),
         "[fit.posterior] is missing: its priors give the range of the parameters");
    models_.push_back(model_of(scene, runs));
    for (const scene::FitModel& rival : scene.fit->models)
        models_.push_back(model_of(scene::apply_model(scene, rival), runs));
    const bool diffusive = diffuses(models_.front().keys);
    if (std::ranges::any_of(models_, [&](const Model& m) { return diffuses(m.keys) != diffusive; }))
        throw InputError("design: models with and without D_r or D_t cannot be compared: set it to 0 in "
                         "fit.fixed of the models without");
    models_.front().plan_of({models_.front().track.data.states}); // throws for what no fit can be made of
}

std::vector<std::string> DesignModels::names() const {
    std::vector<std::string> names;
    for (const Model& model : models_)
        names.push_back(model.keys.name);
    return names;
}

std::vector<double> DesignModels::log_evidence(std::size_t by, std::uint64_t seed, std::uint32_t set) const {
    const Model& maker = models_.at(by);
    RandomStream random(seed, set, static_cast<std::uint32_t>(1 + by));

    // Parameters from the priors; start poses are those of the design.
    const FitPlan plan = maker.plan_of({maker.track.data.states});
    const fitting::Density density(plan.problem, fit_priors(plan));
    Eigen::VectorXd z(density.size());
    for (double& normal : z)
        normal = random.normal();
    std::vector<double> free = density.values(z);
    for (std::size_t k = 0; k < free.size(); ++k) {
        const fitting::Parameter& p = plan.problem.parameters[fitting::free_parameters(plan.problem)[k]];
        if (fitting::is_start_pose(p.name))
            free[k] = p.start;
    }

    // Tracks of the rods with these parameters, and errors of their poses; an exact start has none.
    const FitPart part = track_part(plan.problem);
    const std::vector<double> truth = part.values(fitting::all_values(plan.problem, free));
    const fitting::Trajectory& data = maker.track.data;
    std::vector<States> states(maker.tracks);
    for (std::size_t k = 0; k < maker.tracks; ++k) {
        states[k] = fitting::drawn_states(plan.track_model, data, k, part.parameters, truth, seed + 1 + by,
                                          set * 1000 + static_cast<std::uint32_t>(k));
        for (std::size_t row = data.free_start ? 0 : 1; row < states[k].size(); ++row)
            for (std::size_t i = 0; i < states[k][row].size(); ++i)
                states[k][row][i] +=
                    (i % 3 == 2 ? data.sigma_heading : data.sigma_position) * random.normal();
    }

    // Each model from its own start; the one that made the tracks from the true parameters, too.
    std::vector<double> logs;
    for (const Model& model : models_) {
        const FitPlan own = model.plan_of(states);
        std::vector<double> from;
        for (const fitting::Parameter& p : own.problem.parameters)
            from.push_back(p.start);
        double best = fitting::curvature_evidence(own.problem, fit_priors(own), from);
        if (&model == &maker && own.problem.parameters.size() == plan.problem.parameters.size())
            best = std::max(best, fitting::curvature_evidence(own.problem, fit_priors(own),
                                                              fitting::all_values(own.problem, free)));
        logs.push_back(best);
    }
    return logs;
}

} // namespace rodwake::app
