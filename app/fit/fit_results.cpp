#include "fit_stage.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/fitting/refits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

fitting::Prediction predicted_line(const FitPlan& plan, const fitting::Profile& line,
                                   std::span<const double> positions, std::span<const double> values) {
    const bool of_maps = scene::fit_is_isotropic(plan.keys);
    const FitPart part = of_maps ? map_part(plan) : wake_part(plan.problem);
    fitting::Prediction out =
        of_maps ? fitting::predict_line(plan.map_model, plan.maps.front().data, line, positions,
                                        part.parameters, part.values(values))
                : fitting::predict(plan.wake, line, positions, part.parameters, part.values(values));
    Eigen::MatrixXd all =
        Eigen::MatrixXd::Zero(out.by_parameter.rows(), static_cast<Eigen::Index>(values.size()));
    for (std::size_t k = 0; k < part.index.size(); ++k)
        all.col(static_cast<Eigen::Index>(part.index[k])) =
            out.by_parameter.col(static_cast<Eigen::Index>(k));
    out.by_parameter = std::move(all);
    return out;
}

namespace {

constexpr std::size_t curve_points = 401;
const std::vector<fitting::Parameter> point_force = {{.name = "f_over_mu"}, {.name = "eta"}, {.name = "xi"}};

/// The theory of a comparison along a line: where maps are fitted, the wake of a point force.
std::vector<double> compared(const FitPlan& plan, const fitting::Profile& line,
                             std::span<const double> positions, const FitCompareResult& other) {
    if (!scene::fit_is_isotropic(plan.keys))
        return predicted_line(plan, line, positions, other.values).value;
    return fitting::predict(plan.wake, line, positions, point_force, other.point).value;
}

/// Standard error of the prediction; NaN where the model is singular.
std::vector<double> band(const fitting::Report& report, const fitting::Prediction& prediction) {
    const Eigen::VectorXd errors = fitting::propagated(report, prediction.by_parameter);
    std::vector<double> out(errors.begin(), errors.end());
    for (double& error : out)
        if (!std::isfinite(error))
            error = std::nan("");
    return out;
}

/// Absent if the model is 0 on the whole line.
std::optional<fitting::ScaleFactor> scale_factor_of(const fitting::Profile& data,
                                                    const std::vector<double>& prediction,
                                                    const Eigen::MatrixXd* root) {
    try {
        return fitting::scale_factor(data, prediction, root);
    } catch (const InputError&) {
        return std::nullopt;
    }
}

FitProfileResult profile_result(const FitPlan& plan, const FitResults& results, std::size_t index) {
    const fitting::Profile& data = plan.profiles[index].data;
    const fitting::Report& report = results.report;
    FitProfileResult out;

    // Model, band and residual at every point.
    const fitting::Prediction at_points = predicted_line(plan, data, data.place, results.fit.values);
    out.model = at_points.value;
    out.band = band(report, at_points);
    for (std::size_t i = 0; i < data.place.size(); ++i) {
        const double scale = fitting::residual_scale(data, i);
        out.sigma.push_back(data.sigma.empty() ? 0.0 : scale);
        const double error = data.sigma.empty() ? scale * report.error_factor : scale;
        out.residual.push_back((data.value[i] - out.model[i]) / (error > 0.0 ? error : 1.0));
        out.used.push_back(!(std::abs(data.place[i]) < plan.wake.core));
    }

    // Outside the core: chi2, and the factor between data and prediction. Its error needs the derivatives by
    // the free parameters, ties followed, and is unknown or infinite if the prediction itself has no error.
    const fitting::Profile outside = fitting::outside_core(data, plan.wake.core);
    const fitting::Prediction prediction = predicted_line(plan, outside, outside.place, results.fit.values);
    out.chi2 = chi2_of(outside, prediction.value);
    Eigen::MatrixXd by_free(prediction.by_parameter.rows(), static_cast<Eigen::Index>(report.free.size()));
    for (Eigen::Index k = 0; k < by_free.cols(); ++k) {
        const std::size_t free = report.free[static_cast<std::size_t>(k)];
        by_free.col(k) = prediction.by_parameter.col(static_cast<Eigen::Index>(free));
        for (std::size_t i = 0; i < report.estimates.size(); ++i)
            if (report.estimates[i].tied_to == report.estimates[free].name)
                by_free.col(k) += report.estimates[i].tie_factor *
                                  prediction.by_parameter.col(static_cast<Eigen::Index>(i));
    }
    const Eigen::MatrixXd root = by_free * report.root;
    const bool known =
        std::ranges::all_of(band(report, prediction), [](double e) { return std::isfinite(e); });
    out.scale_factor = scale_factor_of(outside, prediction.value, known ? &root : nullptr);
    if (out.scale_factor && !known)
        out.scale_factor->standard_error = std::isfinite(report.error_factor) ? HUGE_VAL : unknown_error;

    // A curve of model and comparisons along the line; points at the singularity are left out.
    const auto [low, high] = std::ranges::minmax(data.place);
    std::vector<double> places(curve_points);
    for (std::size_t i = 0; i < curve_points; ++i)
        places[i] = low + (high - low) * static_cast<double>(i) / static_cast<double>(curve_points - 1);
    const fitting::Prediction along = predicted_line(plan, data, places, results.fit.values);
    std::vector<std::vector<double>> columns = {places, along.value, band(report, along)};
    for (const FitCompareResult& other : results.compare)
        columns.push_back(compared(plan, data, places, other));
    out.curve.resize(columns.size());
    for (std::size_t row = 0; row < places.size(); ++row)
        if (std::isfinite(along.value[row]))
            for (std::size_t k = 0; k < columns.size(); ++k)
                out.curve[k].push_back(columns[k][row]);
    return out;
}

FitMapResult map_result(const FitPlan& plan, std::size_t index, std::span<const double> values) {
    const fitting::Map& map = plan.maps[index].data;
    const FitPart part = map_part(plan);
    FitMapResult out;
    out.model = fitting::predict(plan.map_model, map, part.parameters, part.values(values));
    out.used.assign(map.bins(), false);
    for (const std::size_t bin : fitting::used_bins(map, plan.mask)) {
        out.used[bin] = true;
        ++out.bins;
        const auto r = [&](double value, double model, const std::vector<double>& sigma) {
            return (value - model) / (sigma.empty() ? 1.0 : sigma[bin]);
        };
        const double x = r(map.Ux[bin], out.model.Ux[bin], map.sigma_x),
                     y = r(map.Uy[bin], out.model.Uy[bin], map.sigma_y);
        out.chi2 += map.independent * (x * x + y * y);
    }
    return out;
}

FitCompareResult compare_result(const FitPlan& plan, const scene::FitCompare& keys,
                                std::span<const double> fitted) {
    FitCompareResult out;
    scene::FitCompare named = keys;
    if (keys.line) {
        // A point force fitted to one line alone.
        const auto index = static_cast<std::size_t>(*keys.line);
        scene::Fit alone;
        alone.parameters = {"f_over_mu", "eta", "xi"};
        for (const std::string& name : alone.parameters) {
            if (const auto start = plan.keys.start.find(name); start != plan.keys.start.end())
                alone.start.insert(*start);
            if (const auto bounds = plan.keys.bounds.find(name); bounds != plan.keys.bounds.end())
                alone.bounds.insert(*bounds);
        }
        alone.box = plan.wake.box;
        alone.core = plan.wake.core;
        alone.search = plan.keys.search;
        alone.search.starts = std::max<std::size_t>(alone.search.starts, 10);
        alone.profiles = {plan.keys.profiles[index]};
        alone.profiles.front().role = scene::FitRole::fit;
        FitInputs inputs;
        inputs.profiles.emplace_back(plan.profiles[index]);
        const FitPlan own = fit_plan(alone, std::move(inputs));
        out.line = fitting::report(own.problem, fitting::fit(own.problem, own.method));
        for (const fitting::ParameterEstimate& e : out.line->estimates)
            named.values[e.name] = e.value;
    }
    out.values = compared_values(plan, named, fitted);
    if (scene::fit_is_isotropic(plan.keys)) {
        // f_over_mu, eta and xi of these values of an isotropic medium; without drag a length beyond every
        // box.
        const auto value = [&](const char* name) -> std::optional<double> {
            const auto at = std::ranges::find(plan.problem.parameters, name, &fitting::Parameter::name);
            return at == plan.problem.parameters.end()
                       ? std::nullopt
                       : std::optional(
                             out.values[static_cast<std::size_t>(at - plan.problem.parameters.begin())]);
        };
        const double f = *value("f_over_mu"), area = value("drag_area").value_or(1e6 * std::abs(f)),
                     alpha = value("alpha").value_or(f * std::abs(f) / area);
        out.point = std::vector<double>{f, *value("eta"), value("xi").value_or(f / alpha)};
    }
    for (std::size_t i = 0; i < plan.profiles.size(); ++i) {
        const fitting::Profile data = fitting::outside_core(plan.profiles[i].data, plan.wake.core);
        const std::vector<double> prediction = compared(plan, data, data.place, out);
        out.profile_chi2.push_back(chi2_of(data, prediction));
        out.scale_factor.push_back(scale_factor_of(data, prediction, nullptr));
        if (plan.keys.profiles[i].role == scene::FitRole::fit)
            out.chi2 += out.profile_chi2.back();
    }
    for (std::size_t i = 0; i < plan.maps.size(); ++i)
        out.chi2 += map_result(plan, i, out.values).chi2;
    return out;
}

} // namespace

FitResults fit_results(const FitPlan& plan, fitting::Fit fit) {
    FitResults results;
    results.report = fitting::report(plan.problem, fit);
    results.fit = std::move(fit);
    results.misfit = fitting::misfit(plan.problem, results.fit, plan.method.seed);
    const auto strength = fitted_value(results.report, "f_over_mu"), xi = fitted_value(results.report, "xi"),
               alpha = fitted_value(results.report, "alpha"),
               area = fitted_value(results.report, "drag_area");
    const auto add = [&](const char* name, double value, std::map<std::string, double> gradient) {
        results.derived[name] = derived(results.report, value, gradient);
        results.gradients[name] = std::move(gradient);
    };
    if (strength && xi)
        add("alpha", *strength / *xi, {{"f_over_mu", 1.0 / *xi}, {"xi", -*strength / (*xi * *xi)}});
    if (strength && alpha)
        add("xi", *strength / *alpha,
            {{"f_over_mu", 1.0 / *alpha}, {"alpha", -*strength / (*alpha * *alpha)}});
    if (strength && area) {
        const double f = std::abs(*strength), sign = *strength < 0.0 ? -1.0 : 1.0;
        add("xi", *area / f, {{"f_over_mu", -sign * *area / (f * f)}, {"drag_area", 1.0 / f}});
        add("alpha", f * f / *area,
            {{"f_over_mu", 2.0 * *strength / *area}, {"drag_area", -f * f / (*area * *area)}});
    }
    for (const scene::FitCompare& keys : plan.keys.compare)
        results.compare.push_back(compare_result(plan, keys, results.fit.values));
    for (std::size_t i = 0; i < plan.profiles.size(); ++i)
        results.profiles.push_back(profile_result(plan, results, i));
    for (std::size_t i = 0; i < plan.tracks.size(); ++i) {
        const FitTrackData& track = plan.tracks[i];
        const FitPart part = track_part(plan.problem);
        FitTrackResult out;
        out.model = fitting::predict(plan.track_model, track.data, i, part.parameters,
                                     part.values(results.fit.values));
        double positions = 0.0, headings = 0.0;
        for (std::size_t row = 0; row < out.model.size(); ++row)
            for (std::size_t k = 0; k < out.model[row].size(); ++k) {
                const double difference = out.model[row][k] - track.data.states[row][k];
                (k % 3 == 2 ? headings : positions) += difference * difference;
            }
        const double count = static_cast<double>(out.model.size() * track.rods);
        out.rms_position = std::sqrt(positions / (2.0 * count)) * track.length;
        out.rms_heading = std::sqrt(headings / count);
        results.tracks.push_back(out);
    }
    for (std::size_t i = 0; i < plan.maps.size(); ++i)
        results.maps.push_back(map_result(plan, i, results.fit.values));
    return results;
}

namespace {

/// A list with a value for each parameter, extended by one for each derived quantity, to first order.
std::vector<double> with_derived(const FitResults& results, std::vector<double> values) {
    for (const auto& [name, gradient] : results.gradients) {
        double sum = 0.0;
        for (std::size_t k = 0; k < results.report.estimates.size(); ++k)
            if (const auto by = gradient.find(results.report.estimates[k].name); by != gradient.end())
                sum += by->second * values[k];
        values.push_back(sum);
    }
    return values;
}

fitting::Fit refitted(const fitting::Problem& problem, const fitting::Method& method,
                      std::span<const double> best, const std::string& how) {
    fitting::Fit fit = fitting::refit(problem, method, best);
    if (fit.termination == fitting::Termination::failed || !std::isfinite(fit.chi2))
        throw RunError(fmt::format("no fit {}: {}", how, fit.reason));
    return fit;
}

} // namespace

std::optional<FitSystematics> fit_systematics(const FitPlan& plan, const fitting::Method& method,
                                              const FitResults& results) {
    FitSystematics s;
    const std::vector<double>& best = results.fit.values;
    const auto& parameters = plan.problem.parameters;

    // Each held constant is moved by its error; the changes add as squares.
    for (const auto& [name, error] : plan.keys.fixed_errors) {
        const auto index =
            std::ranges::find(parameters, name, &fitting::Parameter::name) - parameters.begin();
        const auto remake = [&](const std::vector<fitting::Parameter>& moved) {
            FitPlan other = plan;
            for (const fitting::Parameter& p : moved)
                if (p.fixed)
                    other.keys.fixed[p.name] = p.start;
            return fit_problem(other);
        };
        try {
            s.held.push_back(
                {name, error,
                 with_derived(results, fitting::change_with(remake, parameters, method, best,
                                                            {static_cast<std::size_t>(index), error}))});
        } catch (const InputError& wrong) {
            throw RunError(
                fmt::format("fit.fixed_errors.{} = {:g}: the fit fails with the value moved by one "
                            "standard error: {}; give a smaller error",
                            name, error, wrong.what()));
        }
        const std::vector<double>& change = s.held.back().change;
        s.held_error.resize(change.size());
        for (std::size_t k = 0; k < change.size(); ++k)
            s.held_error[k] = std::hypot(s.held_error[k], change[k]);
    }

    // A fit with each mask; their spread is an error.
    if (plan.keys.masks.size() > 1) {
        std::vector<std::vector<double>> values;
        for (const scene::FitMask& keys : plan.keys.masks) {
            FitPlan other = plan;
            other.mask = map_mask(keys);
            const fitting::Problem problem = fit_problem(other);
            const fitting::Fit fit = refitted(
                problem, method, best,
                fmt::format("with the mask |y| >= {:g}, r >= {:g}", other.mask.strip, other.mask.radius));
            s.masks.push_back({other.mask, problem.residuals, fitting::report(problem, fit)});
            std::vector<double> estimates;
            for (const fitting::ParameterEstimate& e : s.masks.back().report.estimates)
                estimates.push_back(e.value);
            values.push_back(with_derived(results, std::move(estimates)));
        }
        s.mask_spread = fitting::spread(values);
    }

    // A jackknife over the runs, if every table has two maps or more.
    std::vector<long> maps_of_table(plan.keys.maps.size(), 0);
    for (const FitMapData& map : plan.maps)
        ++maps_of_table[map.table];
    if (!maps_of_table.empty() && std::ranges::min(maps_of_table) > 1) {
        std::vector<std::vector<std::vector<double>>> groups(plan.keys.maps.size());
        for (std::size_t map = 0; map < plan.maps.size(); ++map) {
            FitPlan other = plan;
            other.maps.erase(other.maps.begin() + static_cast<std::ptrdiff_t>(map));
            fitting::Fit fit =
                refitted(fit_problem(other), method, best, "without " + plan.maps[map].label());
            s.runs.push_back({map, with_derived(results, std::move(fit.values))});
            groups[plan.maps[map].table].push_back(s.runs.back().values);
        }
        s.jackknife = fitting::jackknife_error(groups);
    }
    if (method.stop_requested && method.stop_requested())
        return std::nullopt; // incomplete
    if (s.held.empty() && s.masks.empty() && s.runs.empty())
        return s;

    // The total: the larger of the curvature's error and the jackknife's, which is too small by chance if
    // runs are few, with those of constants and masks.
    const auto part = [&](const std::vector<double>& errors) {
        return errors.empty() ? 0.0 : errors[s.total.size()];
    };
    const auto add = [&](double curvature) {
        s.total.push_back(
            std::hypot(std::max(curvature, part(s.jackknife)), part(s.held_error), part(s.mask_spread)));
    };
    for (const fitting::ParameterEstimate& e : results.report.estimates)
        add(has_error(results.report, e) ? e.standard_error : 0.0);
    for (const auto& [name, derived] : results.derived)
        add(derived.known() ? derived.error : 0.0);
    return s;
}

double whole_error(const FitResults& results, const std::string& name) {
    const auto& all = results.report.estimates;
    const auto at = std::ranges::find(all, name, &fitting::ParameterEstimate::name);
    const auto derived = results.derived.find(name);
    const auto& total = results.systematics.total;
    if (at != all.end())
        return total.empty() ? at->standard_error : total[static_cast<std::size_t>(at - all.begin())];
    const auto index = all.size() + static_cast<std::size_t>(std::distance(results.derived.begin(), derived));
    return total.empty() ? derived->second.error : total[index];
}

} // namespace rodwake::app
