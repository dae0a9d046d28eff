#include "rodwake/app/fit.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

namespace rodwake::app {

namespace {

using fitting::Problem;

bool is_fitted(const scene::FitProfile& profile) { return profile.role == scene::FitRole::fit; }

/// The parameters that the scene uses, of those that a model has. Defaults are for data of the usual size,
/// and those of parameters with a length are scaled with the data where these are far from it.
std::vector<fitting::Parameter> parameters(const FitPlan& plan, const std::vector<std::string>& of_model) {
    constexpr double usual_place = 40.0, usual_value = 0.2, near = 25.0;
    double position = 0.0, value = 0.0;
    for (std::size_t i = 0; i < plan.profiles.size(); ++i)
        if (const fitting::Profile& data = plan.profiles[i].data; is_fitted(plan.keys.profiles[i]))
            for (std::size_t k = 0; k < std::min(data.place.size(), data.value.size()); ++k) {
                position = std::max(position, std::hypot(data.place[k], data.at));
                value = std::max(value, std::abs(data.value[k]));
            }
    const auto factor = [](double size, double usual) {
        const bool far = std::isfinite(size) && (size > near * usual || size * near < usual);
        return far && size > 0.0 ? size / usual : 1.0;
    };
    const double by_place = factor(position, usual_place), by_value = factor(value, usual_value);
    const std::map<std::string, double> scales = {
        {"f_over_mu", by_value}, {"xi", by_place},       {"x0", by_place},
        {"offset", by_value},    {"offset_y", by_value}, {"f2d_over_mu", by_value * by_place}};

    const scene::Fit& keys = plan.keys;
    std::vector<fitting::Parameter> out;
    for (const std::string& name : scene::fit_used(keys)) {
        if (std::ranges::find(of_model, name) == of_model.end())
            continue;
        fitting::Parameter& p = out.emplace_back();
        p.name = name;
        const auto start = keys.start.find(name);
        p.start = start == keys.start.end() ? scene::fit_default_start(keys, name) : start->second;
        const bool free = scene::fit_is_free(keys, name);
        if (const auto bounds = scene::fit_bounds(keys, name); bounds && free) {
            p.lower = bounds->low;
            p.upper = bounds->high;
        }
        if (free && scene::fit_in_log(keys, name))
            p.transform = fitting::Transform::log;
        if (const auto fixed = keys.fixed.find(name); fixed != keys.fixed.end()) {
            p.fixed = true;
            p.start = fixed->second;
        }
        if (const auto tie = keys.tied.find(name); tie != keys.tied.end()) {
            p.tied_to = tie->second.to;
            p.tie_factor = tie->second.factor;
        }
        if (p.fixed || (by_place == 1.0 && by_value == 1.0))
            continue;
        const double scale = scales.contains(name) ? scales.at(name) : 1.0;
        if (!keys.bounds.contains(name)) {
            p.lower *= scale;
            p.upper *= scale;
        }
        if (!keys.start.contains(name))
            p.start = std::clamp(p.start * scale, p.lower, p.upper);
        if (p.start == 0.0)
            p.scale = scale;
    }
    return out;
}

/// Throws InputError unless the data suffice for the parameters and the residuals at the start are finite: a
/// search from there would fail, later.
void require_solvable(const Problem& problem) {
    const std::vector<std::size_t> free = fitting::free_parameters(problem);
    if (fitting::degrees_of_freedom(problem) < 0) // neighbours that share data may leave too few
        throw InputError(
            fmt::format("fit: {} data points worth {} independent ones cannot fix {} parameters: give more "
                        "data, a smaller independent_spacing (independent_time of tracks) if neighbours "
                        "share less, or fix some of the parameters",
                        problem.residuals, fitting::independent_values(problem), free.size()));
    std::vector<double> start;
    start.reserve(free.size());
    for (const std::size_t i : free)
        start.push_back(problem.parameters[i].start);
    const std::vector<double> values = fitting::all_values(problem, start);
    Eigen::VectorXd r = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.residuals));
    std::string failure;
    try {
        problem.evaluate(values, r, nullptr);
        if (std::isfinite(r.squaredNorm()))
            return;

        // The first residual that is not finite is named, else the largest.
        Eigen::Index at = 0;
        for (Eigen::Index i = 0; i < r.size() && std::isfinite(r[at]); ++i)
            at = !std::isfinite(r[i]) || std::abs(r[i]) > std::abs(r[at]) ? i : at;
        failure = fmt::format("{}: the residual (model - value)/sigma is {:.3g}, which is beyond what can be "
                              "squared and summed",
                              problem.residual_name(static_cast<std::size_t>(at)), r[at]);
    } catch (const InputError& error) {
        failure = fmt::format("the model cannot be computed: {}", error.what());
    } catch (const RunError& error) {
        failure = fmt::format("the model cannot be computed: {}", error.what());
    }
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!problem.parameters[i].fixed)
            text +=
                fmt::format("{}{} = {:g}", text.empty() ? "" : ", ", problem.parameters[i].name, values[i]);
    throw InputError(fmt::format(
        "{} (at the start of the fit: {}); change fit.start, or the data if they are wrong", failure, text));
}

FitPart part(const Problem& problem, const std::vector<std::string>& known, bool starts) {
    FitPart out;
    for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
        const std::string& name = problem.parameters[i].name;
        if (std::ranges::find(known, name) == known.end() && !(starts && fitting::is_start_pose(name)))
            continue;
        out.parameters.push_back(problem.parameters[i]);
        out.index.push_back(i);
    }
    return out;
}

} // namespace

bool FitInputs::complete() const {
    const auto there = [](const auto& data) { return data.has_value(); };
    return std::ranges::all_of(profiles, there) && std::ranges::all_of(tracks, there) &&
           std::ranges::all_of(maps, there);
}

std::vector<std::string> map_names(const scene::Fit& keys) {
    std::vector<std::string> names = fitting::map_parameter_names();
    if (!scene::fit_is_isotropic(keys)) // the others are of profiles and tracks
        std::erase_if(names, [](const std::string& name) {
            return name == "f_over_mu" || name == "eta" || name == "xi" || name == "alpha";
        });
    return names;
}

Problem fit_problem(const FitPlan& plan) {
    std::vector<Problem> kinds;
    if (std::ranges::any_of(plan.keys.profiles, is_fitted)) {
        std::vector<fitting::Profile> fitted;
        for (std::size_t i = 0; i < plan.profiles.size(); ++i)
            if (is_fitted(plan.keys.profiles[i]))
                fitted.push_back(plan.profiles[i].data);
        kinds.push_back(
            fitting::wake_problem(plan.wake, fitted, parameters(plan, fitting::wake_parameter_names())));
    }
    if (!plan.maps.empty()) {
        std::vector<fitting::Map> maps;
        for (const FitMapData& map : plan.maps)
            maps.push_back(map.data);
        kinds.push_back(
            fitting::map_problem(plan.map_model, maps, plan.mask, parameters(plan, map_names(plan.keys))));
    }
    if (!plan.tracks.empty()) {
        std::vector<fitting::Trajectory> tracks;
        for (const FitTrackData& track : plan.tracks)
            tracks.push_back(track.data);
        Problem problem = fitting::trajectory_problem(
            plan.track_model, tracks, parameters(plan, fitting::trajectory_parameter_names()));

        // Global searches need bounds: a start pose is within ten standard errors of its datum.
        double sigma = 0.0;
        for (const FitTrackData& track : plan.tracks)
            sigma = std::max({sigma, track.data.sigma_position, track.data.sigma_heading});
        for (fitting::Parameter& p : problem.parameters)
            if (fitting::is_global(plan.keys.search.algorithm) && fitting::is_start_pose(p.name)) {
                p.lower = p.start - 10.0 * sigma;
                p.upper = p.start + 10.0 * sigma;
            }

        const auto known = std::ranges::count_if(plan.tracks, &FitTrackData::sigma_known);
        if (known != 0 && known != static_cast<long>(plan.tracks.size()))
            throw InputError("some of [[fit.trajectories]] have sigma_position and sigma_heading and some do "
                             "not, so they cannot be weighted together: give them for all, or for none");
        problem.sigma_known = known != 0;
        kinds.push_back(problem);
    }
    if (kinds.size() == 1)
        return kinds.front();
    const auto known = std::ranges::count_if(kinds, &Problem::sigma_known);
    if (known != 0 && known != static_cast<long>(kinds.size()))
        throw InputError(
            "profiles, maps and trajectories need standard errors all, or none of them: sigma in the files, "
            "sigma_position and sigma_heading in [[fit.trajectories]]");
    return fitting::joined(kinds);
}

fitting::MapMask map_mask(const scene::FitMask& keys) {
    fitting::MapMask mask{.strip = keys.strip, .radius = keys.radius};
    if (!keys.sector.empty()) {
        mask.from = keys.sector[0];
        mask.to = keys.sector[1];
    }
    return mask;
}

FitPlan fit_plan(const scene::Fit& keys, FitInputs inputs) {
    FitPlan plan;
    plan.keys = keys;

    // drag_area is held at the value that the run measured.
    if (std::exchange(plan.keys.measured_drag, false)) {
        if (!inputs.drag_area)
            throw InputError(
                "fit.measured_drag: a run of the scene measures it; give drag_area in fit.fixed");
        plan.keys.fixed["drag_area"] = inputs.drag_area->value;
        if (inputs.drag_area->error > 0.0)
            plan.keys.fixed_errors["drag_area"] = inputs.drag_area->error;
    }

    for (auto& profile : inputs.profiles)
        plan.profiles.push_back(std::move(profile.value()));
    for (auto& track : inputs.tracks)
        plan.tracks.push_back(std::move(track.value()));
    for (auto& map : inputs.maps)
        plan.maps.push_back(std::move(map.value()));
    plan.map_model = {keys.rod_length, keys.source_width};

    // Each mask has a fit of its own, so that all must leave some bins.
    for (std::size_t i = 0; i < keys.masks.size(); ++i)
        for (const FitMapData& map : plan.maps)
            if (fitting::used_bins(map.data, map_mask(keys.masks[i])).empty())
                throw InputError(
                    fmt::format("fit.masks.{} leaves no bin of {}: make strip or radius smaller, "
                                "or sector wider",
                                i, map.file.string()));
    if (!keys.masks.empty())
        plan.mask = map_mask(keys.masks.front());
    plan.wake = {keys.box, keys.heading, keys.core};
    if (scene::fit_is_isotropic(keys)) // point forces beside it are in the box of the maps
        plan.wake.box = PeriodicBox(plan.maps.front().data.lx, plan.maps.front().data.ly);
    plan.track_model.ode.rtol = 1e-10;
    plan.track_model.ode.atol = 1e-12;
    plan.problem = fit_problem(plan);
    if (keys.posterior && !plan.problem.sigma_known)
        throw InputError("fit.posterior needs data whose standard errors are known: give sigma in the files, "
                         "sigma_position and sigma_heading of trajectories");
    plan.problem.remarks = data_remarks(plan);
    require_solvable(plan.problem);
    plan.method = {keys.search};
    return plan;
}

std::vector<double> FitPart::values(std::span<const double> all) const {
    std::vector<double> out;
    for (const std::size_t i : index)
        out.push_back(all[i]);
    return out;
}

FitPart wake_part(const Problem& problem) { return part(problem, fitting::wake_parameter_names(), false); }

FitPart map_part(const FitPlan& plan) { return part(plan.problem, map_names(plan.keys), false); }

FitPart track_part(const Problem& problem) {
    return part(problem, fitting::trajectory_parameter_names(), true);
}

std::vector<double> compared_values(const FitPlan& plan, const scene::FitCompare& compare,
                                    std::span<const double> fitted) {
    std::vector<double> out(fitted.begin(), fitted.end());
    const auto& all = plan.problem.parameters;
    const auto slot = [&](const char* name) -> double* {
        const auto at = std::ranges::find(all, name, &fitting::Parameter::name);
        return at == all.end() ? nullptr : &out[static_cast<std::size_t>(at - all.begin())];
    };
    for (const auto& [name, value] : compare.values)
        if (double* at = slot(name.c_str()))
            *at = value;
    if (scene::fit_is_isotropic(plan.keys)) // a point force
        for (std::size_t i = 0; i < all.size(); ++i)
            if (all[i].name.starts_with("p_") || all[i].name.starts_with("q_") ||
                all[i].name.starts_with("t_") || all[i].name.starts_with("h_"))
                out[i] = 0.0;
    const double* strength = slot("f_over_mu");
    const auto given = [&](const char* name) {
        return compare.values.contains(name) ? &compare.values.at(name) : nullptr;
    };
    if (const double* alpha = given("alpha"); alpha && slot("xi") && strength)
        *slot("xi") = *strength / *alpha;
    if (const double* xi = given("xi"); xi && slot("alpha") && strength)
        *slot("alpha") = *strength / *xi;
    if (double* area = slot("drag_area"); area && strength) {
        if (const double* xi = given("xi"))
            *area = std::abs(*strength) * *xi;
        if (const double* alpha = given("alpha"))
            *area = *strength * *strength / *alpha;
    }
    return out;
}

std::string fit_unit(const scene::Fit& keys, const std::string& parameter) {
    // Of maps; F and T are the units of force and time that the scene uses.
    static const std::map<std::string, int> powers = {
        {"drag_area", 2}, {"p_xx", 2},   {"p_yy", 2},   {"q_xxx", 3},   {"q_xyy", 3},
        {"q_yxy", 3},     {"t_xxxx", 4}, {"t_xxyy", 4}, {"h_xxxxx", 5}, {"h_xxxyy", 5}};
    static const std::map<std::string, std::string> units = {
        {"amplitude", "1"},     {"force", "F"},         {"p_xx", "F {0}"},      {"p_yy", "F {0}"},
        {"q_xxx", "F {0}^2"},   {"q_xyy", "F {0}^2"},   {"q_yxy", "F {0}^2"},   {"t_xxxx", "F {0}^3"},
        {"t_xxyy", "F {0}^3"},  {"h_xxxxx", "F {0}^4"}, {"h_xxxyy", "F {0}^4"}, {"zeta", "F T/{0}^3"},
        {"rho", "F T^2/{0}^3"}, {"eta_s", "F T/{0}"}};
    if (scene::is_map_parameter(parameter)) {
        const auto power = powers.find(parameter);
        if (scene::fit_is_isotropic(keys) && power != powers.end())
            return fmt::format("{}^{}", keys.length_unit, power->second);
        const auto at = units.find(parameter);
        return fmt::format(fmt::runtime(at == units.end() ? "F/{0}" : at->second), keys.length_unit);
    }
    // Of profiles and tracks.
    if (fitting::is_start_pose(parameter))
        return parameter.starts_with("heading") ? "rad" : "f/mu";
    if (const rods::Coupling* coupling = rods::find_coupling(parameter))
        return std::string(coupling->unit);
    if (const rods::OtherTurning* turning = rods::find_other_turning(parameter))
        return std::string(turning->unit);
    if (rods::is_noise(parameter))
        return parameter == "D_r" ? "rad^2 mu v0/f" : "f v0/mu";
    if (parameter == "eta" || parameter == "alpha")
        return "1";
    const std::string length = keys.profiles.empty() && keys.maps.empty() ? "f/mu" : keys.length_unit;
    return parameter == "f2d_over_mu" ? length + "^2" : length;
}

std::vector<fitting::Prior> fit_priors(const FitPlan& plan) {
    std::vector<fitting::Prior> priors;
    for (const std::size_t i : fitting::free_parameters(plan.problem)) {
        const fitting::Parameter& p = plan.problem.parameters[i];
        double low = p.lower, high = p.upper;
        if (fitting::is_start_pose(p.name)) { // "x.<track>.<rod>"
            const fitting::Trajectory& track =
                plan.tracks.at(std::stoul(p.name.substr(p.name.find('.') + 1))).data;
            const double sigma = p.name.starts_with("heading") ? track.sigma_heading : track.sigma_position,
                         wide = 10.0 * sigma / std::sqrt(track.independent);
            low = p.start - wide, high = p.start + wide;
        }
        const auto& given = plan.keys.posterior->priors;
        fitting::Prior prior = given.contains(p.name) ? given.at(p.name) : fitting::Prior{};
        prior.low = prior.low.value_or(low), prior.high = prior.high.value_or(high);
        priors.push_back(prior);
    }
    return priors;
}

fitting::PosteriorMethod posterior_method(const FitPlan& plan) {
    const scene::FitPosterior& keys = *plan.keys.posterior;
    fitting::PosteriorMethod method;
    method.chains = keys.chains, method.samples = keys.samples, method.evidence = keys.evidence;
    method.seed = plan.method.seed;
    return method;
}

} // namespace rodwake::app
