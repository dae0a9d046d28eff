#include "rodwake/app/fit_results.hpp"

#include "fit_files.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

fitting::Prediction predicted_line(const FitPlan& plan, const fitting::Profile& line,
                                   std::span<const double> places, std::span<const double> values) {
    const bool of_maps = scene::fit_is_isotropic(plan.keys);
    const FitPart part = of_maps ? map_part(plan) : wake_part(plan.problem);
    fitting::Prediction out =
        of_maps ? fitting::predict_line(plan.map_model, plan.maps.front().data, line, places, part.parameters,
                                        part.values(values))
                : fitting::predict(plan.wake, line, places, part.parameters, part.values(values));
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
                             std::span<const double> places, const FitCompareResult& other) {
    if (!scene::fit_is_isotropic(plan.keys))
        return predicted_line(plan, line, places, other.values).value;
    return fitting::predict(plan.wake, line, places, point_force, other.point).value;
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

/// Derivatives by the free parameters, ties followed.
Eigen::MatrixXd by_free(const fitting::Report& report, const Eigen::MatrixXd& by_all) {
    Eigen::MatrixXd out(by_all.rows(), static_cast<Eigen::Index>(report.free.size()));
    for (Eigen::Index k = 0; k < out.cols(); ++k) {
        const std::size_t free = report.free[static_cast<std::size_t>(k)];
        out.col(k) = by_all.col(static_cast<Eigen::Index>(free));
        for (std::size_t i = 0; i < report.estimates.size(); ++i)
            if (report.estimates[i].tied_to == report.estimates[free].name)
                out.col(k) += report.estimates[i].tie_factor * by_all.col(static_cast<Eigen::Index>(i));
    }
    return out;
}

/// A profile and what is predicted for it, outside the core.
struct Scored {
    fitting::Profile data;
    fitting::Prediction prediction;
};

Scored outside_core(const FitPlan& plan, std::size_t index, std::span<const double> values) {
    Scored out{fitting::outside_core(plan.profiles[index].data, plan.wake.core), {}};
    out.prediction = predicted_line(plan, out.data, out.data.place, values);
    return out;
}

std::optional<fitting::ScaleFactor> scale_factor_of(const Scored& scored, const Eigen::MatrixXd* root) {
    try {
        return fitting::scale_factor(scored.data, scored.prediction.value, root);
    } catch (const InputError&) { // the model is 0 on the whole line
        return std::nullopt;
    }
}

void set_points(const FitPlan& plan, const FitResults& results, std::size_t index, FitProfileResult& out) {
    const fitting::Profile& data = plan.profiles[index].data;
    const fitting::Prediction prediction = predicted_line(plan, data, data.place, results.fit.values);
    out.model = prediction.value;
    out.band = band(results.report, prediction);
    for (std::size_t i = 0; i < data.place.size(); ++i) {
        const double scale = fitting::residual_scale(data, i);
        const double known = data.sigma.empty() ? 0.0 : scale;
        out.sigma.push_back(known);
        const double error = data.sigma.empty() ? scale * results.report.error_factor : scale;
        out.residual.push_back((data.value[i] - out.model[i]) / (error > 0.0 ? error : 1.0));
        out.used.push_back(!(std::abs(data.place[i]) < plan.wake.core));
    }
}

std::vector<double> curve_places(const fitting::Profile& data) {
    const auto [low, high] = std::ranges::minmax(data.place);
    std::vector<double> places(curve_points);
    for (std::size_t i = 0; i < curve_points; ++i)
        places[i] = low + (high - low) * static_cast<double>(i) / static_cast<double>(curve_points - 1);
    return places;
}

void set_curve(const FitPlan& plan, const FitResults& results, std::size_t index, FitProfileResult& out) {
    const fitting::Profile& data = plan.profiles[index].data;
    const std::vector<double> places = curve_places(data);
    const fitting::Prediction prediction = predicted_line(plan, data, places, results.fit.values);
    std::vector<std::vector<double>> columns = {places, prediction.value, band(results.report, prediction)};
    for (const FitCompareResult& other : results.compare)
        columns.push_back(compared(plan, data, places, other));
    out.curve.resize(columns.size());
    for (std::size_t row = 0; row < places.size(); ++row)
        if (std::isfinite(prediction.value[row]))
            for (std::size_t k = 0; k < columns.size(); ++k)
                out.curve[k].push_back(columns[k][row]);
}

FitProfileResult profile_result(const FitPlan& plan, const FitResults& results, std::size_t index) {
    FitProfileResult out;
    set_points(plan, results, index, out);
    const Scored scored = outside_core(plan, index, results.fit.values);
    out.chi2 = chi2_of(scored.data, scored.prediction.value);
    const Eigen::MatrixXd root =
        by_free(results.report, scored.prediction.by_parameter) * results.report.root;
    const auto errors = band(results.report, scored.prediction);
    const bool known = std::ranges::all_of(errors, [](double e) { return std::isfinite(e); });
    out.scale_factor = scale_factor_of(scored, known ? &root : nullptr);
    if (out.scale_factor && !known) // the prediction itself is not fixed, or nobody knows how well
        out.scale_factor->standard_error =
            std::isfinite(results.report.error_factor) ? HUGE_VAL : unknown_error;
    set_curve(plan, results, index, out);
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

/// f_over_mu, eta and xi of these values of an isotropic medium; without drag a length beyond every box.
std::vector<double> point_values(const FitPlan& plan, std::span<const double> values) {
    const auto value = [&](const char* name) -> std::optional<double> {
        const auto at = std::ranges::find(plan.problem.parameters, name, &fitting::Parameter::name);
        return at == plan.problem.parameters.end()
                   ? std::nullopt
                   : std::optional(values[static_cast<std::size_t>(at - plan.problem.parameters.begin())]);
    };
    const double f = *value("f_over_mu"), area = value("drag_area").value_or(1e6 * std::abs(f)),
                 alpha = value("alpha").value_or(f * std::abs(f) / area);
    return {f, *value("eta"), value("xi").value_or(f / alpha)};
}

/// A point force fitted to one line alone.
std::optional<fitting::Report> line_fit(const FitPlan& plan, const scene::FitCompare& compare) {
    if (!compare.line)
        return std::nullopt;
    const auto index = static_cast<std::size_t>(*compare.line);
    scene::Fit keys;
    keys.parameters = {"f_over_mu", "eta", "xi"};
    for (const std::string& name : keys.parameters) {
        if (const auto start = plan.keys.start.find(name); start != plan.keys.start.end())
            keys.start.insert(*start);
        if (const auto bounds = plan.keys.bounds.find(name); bounds != plan.keys.bounds.end())
            keys.bounds.insert(*bounds);
    }
    keys.box = plan.wake.box;
    keys.core = plan.wake.core;
    keys.search = plan.keys.search;
    keys.search.starts = std::max<std::size_t>(keys.search.starts, 10);
    keys.profiles = {plan.keys.profiles[index]};
    keys.profiles.front().role = scene::FitRole::fit;
    FitInputs inputs;
    inputs.profiles.emplace_back(plan.profiles[index]);
    const FitPlan own = fit_plan(keys, std::move(inputs));
    const fitting::Fit fit = fitting::fit(own.problem, own.method);
    return fitting::report(own.problem, fit);
}

FitCompareResult compare_result(const FitPlan& plan, const scene::FitCompare& keys,
                                std::span<const double> fitted) {
    FitCompareResult out{.line = line_fit(plan, keys)};
    scene::FitCompare named = keys;
    if (out.line)
        for (const fitting::Estimate& e : out.line->estimates)
            named.values[e.name] = e.value;
    out.values = compared_values(plan, named, fitted);
    if (scene::fit_is_isotropic(plan.keys))
        out.point = point_values(plan, out.values);
    for (std::size_t i = 0; i < plan.profiles.size(); ++i) {
        Scored scored{fitting::outside_core(plan.profiles[i].data, plan.wake.core), {}};
        scored.prediction.value = compared(plan, scored.data, scored.data.place, out);
        out.profile_chi2.push_back(chi2_of(scored.data, scored.prediction.value));
        out.scale_factor.push_back(scale_factor_of(scored, nullptr));
        if (plan.keys.profiles[i].role == scene::FitRole::fit)
            out.chi2 += out.profile_chi2.back();
    }
    for (std::size_t i = 0; i < plan.maps.size(); ++i)
        out.chi2 += map_result(plan, i, out.values).chi2;
    return out;
}

FitTrackResult track_result(const FitPlan& plan, std::size_t index, std::span<const double> values) {
    const FitTrackData& track = plan.tracks[index];
    const FitPart part = track_part(plan.problem);
    FitTrackResult out;
    out.model = fitting::predict(plan.track_model, track.data, index, part.parameters, part.values(values));
    double positions = 0.0, headings = 0.0;
    for (std::size_t row = 0; row < out.model.size(); ++row)
        for (std::size_t k = 0; k < out.model[row].size(); ++k) {
            const double difference = out.model[row][k] - track.data.states[row][k];
            (k % 3 == 2 ? headings : positions) += difference * difference;
        }
    const double count = static_cast<double>(out.model.size() * track.rods);
    out.rms_position = std::sqrt(positions / (2.0 * count)) * track.length;
    out.rms_heading = std::sqrt(headings / count);
    return out;
}

void set_derived(FitResults& results) {
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
}

std::string interval_text(const fitting::ProfileLikelihood& one) {
    if (one.low && one.high)
        return fmt::format("{:.5g} to {:.5g}", *one.low, *one.high);
    return one.high  ? fmt::format("up to {:.5g}, without a lower end within the bounds", *one.high)
           : one.low ? fmt::format("{:.5g} and above, without an upper end within the bounds", *one.low)
                     : "none: the data do not constrain it within the bounds";
}

void add_likelihood(const FitResults& results, const std::string& name, std::vector<std::string>& lines) {
    const fitting::ProfileLikelihood& one = results.likelihood.at(name);
    lines.push_back(fmt::format("{}: 95 % interval by the profile likelihood {}", name, interval_text(one)));
    const double lowest = std::ranges::min(one.chi2), best = results.fit.objective;
    if (lowest < best - 1e-3 * (1.0 + 1e-3 * best))
        lines.push_back(fmt::format(
            "the profile likelihood of {} found an objective {:.3g} lower than the fit, at {} = {:.5g}: "
            "start there (fit.start), or increase fit.starts",
            name, best - lowest, name,
            one.value[static_cast<std::size_t>(std::ranges::min_element(one.chi2) - one.chi2.begin())]));
}

} // namespace

namespace {

/// Where a heading wanders so far between rows that what it takes from the path ahead, of standard deviation
/// D_r t^2/sqrt(3), is no longer small beside sigma_position: the filter is linear there.
void add_wandering(const FitPlan& plan, const FitResults& results, std::vector<std::string>& lines) {
    constexpr double small = 0.2; // up to there ranks are uniform: studies/reports/fitting.md
    const auto e = std::ranges::find(results.report.estimates, "D_r", &fitting::Estimate::name);
    if (e == results.report.estimates.end())
        return;
    for (const FitTrackData& track : plan.tracks) {
        double longest = 0.0;
        for (std::size_t i = 1; i < track.data.times.size(); ++i)
            longest = std::max(longest, track.data.times[i] - track.data.times[i - 1]);
        const double curved = e->value * longest * longest / std::sqrt(3.0) / track.data.sigma_position;
        if (curved > small)
            lines.push_back(
                fmt::format("{}: the rods turn too much between rows for the Kalman filter at D_r = {:.3g} "
                            "(path error {:.2g} sigma_position; limit {}). Errors, above all of D_r, are "
                            "underestimated: use more closely spaced rows or a larger sigma_position",
                            track.name, e->value, curved, small));
    }
}

} // namespace

std::string misfit_text(const FitResults& results) {
    if (results.misfit.describes())
        return "";
    return fmt::format("; the model does not describe the data: {} (p {})", results.misfit.worst,
                       *results.misfit.probability < 0.001
                           ? std::string("< 0.001")
                           : fmt::format("= {:.2g}", *results.misfit.probability));
}

std::vector<std::string> findings(const FitPlan& plan, const FitResults& results) {
    std::vector<std::string> lines;
    add_wandering(plan, results, lines);
    for (const auto& [name, one] : results.likelihood)
        add_likelihood(results, name, lines);
    std::vector<std::string> predicted;
    for (std::size_t i = 0; i < results.profiles.size(); ++i)
        if (const auto& excess = results.profiles[i].scale_factor;
            excess && plan.keys.profiles[i].role == scene::FitRole::predict)
            predicted.push_back(fmt::format(
                "{}: predicted; data over prediction {:.4g}{}, chi2 = {:.4g} for {} points",
                plan.profiles[i].name, excess->scale,
                std::isfinite(excess->standard_error) ? fmt::format(" +- {:.2g}", excess->standard_error)
                                                      : ", error unknown",
                excess->chi2, excess->points));
    if (!predicted.empty())
        lines.push_back(fmt::format("{}", fmt::join(predicted, "; ")));
    return lines;
}

std::vector<std::string> comparisons(const FitPlan& plan, const FitResults& results) {
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < results.compare.size(); ++k)
        if (const auto& line = results.compare[k].line) {
            std::string told;
            for (const fitting::Estimate& e : line->estimates)
                told += fmt::format("{}{} = {:.4g}{}", told.empty() ? "" : ", ", e.name, e.value,
                                    e.at_lower || e.at_upper ? " (at its bound)"
                                                             : fmt::format(" +- {:.2g}", e.standard_error));
            lines.push_back(fmt::format(
                "{}: a point force fitted to {} alone gives {}, chi2 = {:.4g} for {} degrees of freedom",
                plan.keys.compare[k].name,
                plan.profiles[static_cast<std::size_t>(*plan.keys.compare[k].line)].name, told, line->chi2,
                line->dof));
        }
    return lines;
}

FitResults fit_results(const FitPlan& plan, fitting::Fit fit) {
    FitResults results;
    results.report = fitting::report(plan.problem, fit);
    results.fit = std::move(fit);
    results.misfit = fitting::misfit(plan.problem, results.fit, plan.method.seed);
    set_derived(results);
    for (const scene::FitCompare& keys : plan.keys.compare)
        results.compare.push_back(compare_result(plan, keys, results.fit.values));
    for (std::size_t i = 0; i < plan.profiles.size(); ++i)
        results.profiles.push_back(profile_result(plan, results, i));
    for (std::size_t i = 0; i < plan.tracks.size(); ++i)
        results.tracks.push_back(track_result(plan, i, results.fit.values));
    for (std::size_t i = 0; i < plan.maps.size(); ++i)
        results.maps.push_back(map_result(plan, i, results.fit.values));
    return results;
}

} // namespace rodwake::app
