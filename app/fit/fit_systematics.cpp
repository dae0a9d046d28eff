#include "fit_files.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/fitting/refits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::app {

namespace {

/// The plan with the fixed parameters of this list, as a problem.
fitting::Problem with_fixed(const FitPlan& plan, const std::vector<fitting::Parameter>& parameters) {
    FitPlan other = plan;
    for (const fitting::Parameter& p : parameters)
        if (p.fixed)
            other.keys.fixed[p.name] = p.start;
    return fit_problem(other);
}

FitSystematics::Held held_constant(const FitPlan& plan, const fitting::Method& method,
                                   std::span<const double> best, const std::string& name, double error) {
    const auto& all = plan.problem.parameters;
    const auto index =
        static_cast<std::size_t>(std::ranges::find(all, name, &fitting::Parameter::name) - all.begin());
    const auto remake = [&](const std::vector<fitting::Parameter>& p) { return with_fixed(plan, p); };
    try {
        return {name, error, fitting::change_with(remake, all, method, best, {index, error})};
    } catch (const InputError& wrong) {
        throw RunError(fmt::format("fit.fixed_errors.{} = {:g}: the fit fails with the value moved by one "
                                   "standard error: {}; give a smaller error",
                                   name, error, wrong.what()));
    }
}

void require_fit(const fitting::Fit& fit, const std::string& how) {
    if (fit.termination == fitting::Termination::failed || !std::isfinite(fit.chi2))
        throw RunError(fmt::format("no fit {}: {}", how, fit.reason));
}

FitSystematics::Choice choice(const FitPlan& plan, const fitting::Method& method,
                              std::span<const double> best, const fitting::MapMask& mask) {
    FitPlan other = plan;
    other.mask = mask;
    const fitting::Problem problem = fit_problem(other);
    const fitting::Fit fit = fitting::refit(problem, method, best);
    require_fit(fit, fmt::format("with the mask |y| >= {:g}, r >= {:g}", mask.strip, mask.radius));
    return {mask, problem.residuals, fitting::report(problem, fit)};
}

FitSystematics::LeftOut without(const FitPlan& plan, const fitting::Method& method,
                                std::span<const double> best, std::size_t map) {
    FitPlan other = plan;
    other.maps.erase(other.maps.begin() + static_cast<std::ptrdiff_t>(map));
    fitting::Fit fit = fitting::refit(fit_problem(other), method, best);
    require_fit(fit, "without " + plan.maps[map].label());
    return {map, std::move(fit.values)};
}

/// Two maps or more in every table.
bool has_runs(const FitPlan& plan) {
    std::vector<long> counts(plan.keys.maps.size(), 0);
    for (const FitMapData& map : plan.maps)
        ++counts[map.table];
    return !counts.empty() && std::ranges::all_of(counts, [](long count) { return count > 1; });
}

std::vector<double> values_of(const fitting::Report& report) {
    std::vector<double> values;
    for (const fitting::Estimate& e : report.estimates)
        values.push_back(e.value);
    return values;
}

std::vector<double> quadratic_sum(const std::vector<FitSystematics::Held>& held) {
    std::vector<double> sum(held.front().change.size(), 0.0);
    for (const auto& one : held)
        for (std::size_t k = 0; k < sum.size(); ++k)
            sum[k] = std::hypot(sum[k], one.change[k]);
    return sum;
}

std::vector<double> jackknife(const FitPlan& plan, const std::vector<FitSystematics::LeftOut>& runs) {
    std::vector<std::vector<std::vector<double>>> groups(plan.keys.maps.size());
    for (const auto& run : runs)
        groups[plan.maps[run.map].table].push_back(run.values);
    return fitting::jackknife_error(groups);
}

/// The list with a number of each derived quantity behind those of the parameters: its gradient times them.
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

void set_totals(const FitResults& results, FitSystematics& s) {
    if (s.held.empty() && s.masks.empty() && s.runs.empty())
        return;
    const auto part = [](const std::vector<double>& errors, std::size_t k) {
        return errors.empty() ? 0.0 : errors[k];
    };
    const auto add = [&](double curvature) {
        const std::size_t k = s.total.size();
        const double random = std::max(curvature, part(s.jackknife, k)); // few runs: by chance too small
        s.total.push_back(std::hypot(random, part(s.held_error, k), part(s.mask_spread, k)));
    };
    for (const fitting::Estimate& e : results.report.estimates)
        add(has_error(results.report, e) ? e.standard_error : 0.0);
    for (const auto& [name, one] : results.derived)
        add(one.known() ? one.error : 0.0);
}

} // namespace

std::optional<FitSystematics> fit_systematics(const FitPlan& plan, const fitting::Method& method,
                                              const FitResults& results) {
    FitSystematics s;
    const std::vector<double>& best = results.fit.values;
    for (const auto& [name, error] : plan.keys.fixed_errors) {
        s.held.push_back(held_constant(plan, method, best, name, error));
        s.held.back().change = with_derived(results, std::move(s.held.back().change));
    }
    if (!s.held.empty())
        s.held_error = quadratic_sum(s.held);
    if (plan.keys.masks.size() > 1) {
        std::vector<std::vector<double>> values;
        for (const scene::FitMask& keys : plan.keys.masks) {
            s.masks.push_back(choice(plan, method, best, map_mask(keys)));
            values.push_back(with_derived(results, values_of(s.masks.back().report)));
        }
        s.mask_spread = fitting::spread(values);
    }
    if (has_runs(plan)) {
        for (std::size_t map = 0; map < plan.maps.size(); ++map) {
            s.runs.push_back(without(plan, method, best, map));
            s.runs.back().values = with_derived(results, std::move(s.runs.back().values));
        }
        s.jackknife = jackknife(plan, s.runs);
    }
    set_totals(results, s);
    if (method.stop_requested && method.stop_requested())
        return std::nullopt; // part of it
    return s;
}

double whole_error(const FitResults& results, const std::string& name) {
    const auto& all = results.report.estimates;
    const auto at = std::ranges::find(all, name, &fitting::Estimate::name);
    const auto derived = results.derived.find(name);
    const auto& total = results.systematics.total;
    if (at != all.end())
        return total.empty() ? at->standard_error : total[static_cast<std::size_t>(at - all.begin())];
    const auto place = all.size() + static_cast<std::size_t>(std::distance(results.derived.begin(), derived));
    return total.empty() ? derived->second.error : total[place];
}

} // namespace rodwake::app
