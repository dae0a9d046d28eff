#include "fit_stage.hpp"

#include "fit_records.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/hdf5_writer.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;

std::string name_of(const FitPlan& plan, const fitting::Posterior& posterior, std::size_t k) {
    return plan.problem.parameters[posterior.free[k]].name;
}

std::string posterior_json(const FitPlan& plan, const fitting::Posterior& posterior,
                           const std::string& command) {
    static constexpr const char* kinds[] = {"uniform", "log_uniform", "normal"};
    const std::vector<fitting::Prior> priors = fit_priors(plan);
    ordered_json out;
    out["parameters"] = ordered_json::object();
    for (std::size_t k = 0; k < posterior.free.size(); ++k) {
        const fitting::Prior& prior = priors[k];
        ordered_json prior_json = {{"kind", kinds[static_cast<std::size_t>(prior.kind)]},
                                   {"low", finite_or_null(prior.low)},
                                   {"high", finite_or_null(prior.high)}};
        if (prior.kind == fitting::PriorKind::normal)
            prior_json.update({{"mean", prior.mean}, {"sd", prior.sd}});
        const std::string name = name_of(plan, posterior, k);
        const fitting::Marginal& m = posterior.marginals[k];
        out["parameters"][name] = {{"mean", m.mean},
                                   {"sd", m.sd},
                                   {"median", m.median},
                                   {"q025", m.q025},
                                   {"q975", m.q975},
                                   {"rhat", finite_or_null(m.rhat)},
                                   {"ess", finite_or_null(m.ess)},
                                   {"unit", fit_unit(plan.keys, name)},
                                   {"prior", prior_json}};
    }
    out["log_evidence"] = nullptr;
    if (posterior.log_evidence)
        out["log_evidence"] = {{"value", finite_or_null(posterior.log_evidence->value)},
                               {"stderr", finite_or_null(posterior.log_evidence->error)}};
    out["samples"] = "posterior.csv";
    out["chains"] = posterior.log_likelihood.size();
    out["accepted"] = posterior.accepted;
    out["seed"] = plan.method.seed;
    out["remarks"] = posterior.remarks;
    out["provenance"] = {{"command", command}, {"version", build_info().version}, {"git", build_info().git}};
    return json_text(out, 2) + "\n";
}

// posterior.nc: NetCDF4 in the layout of ArviZ, a group a kind of variable, each with its own coordinates.

struct Shape {
    std::size_t chains, draws;
};

/// Dimensions of a group.
std::vector<std::string> scales_of(store::Hdf5Writer& file, const std::string& group, Shape shape) {
    file.scale(group + "/chain", shape.chains);
    file.scale(group + "/draw", shape.draws);
    file.attribute(group, "inference_library", std::string("rodwake"));
    file.attribute(group, "inference_library_version", build_info().version);
    return {group + "/chain", group + "/draw"};
}

std::vector<double> values_at(const fitting::Posterior& posterior, std::size_t c, std::size_t i) {
    std::vector<double> out;
    for (const auto& of_parameter : posterior.values)
        out.push_back(of_parameter[c][i]);
    return out;
}

void write_netcdf(const std::filesystem::path& path, const FitPlan& plan, const fitting::Posterior& posterior,
                  std::size_t threads) {
    const fitting::Density density(plan.problem, fit_priors(plan));
    const Shape shape{posterior.log_likelihood.size(), posterior.log_likelihood.front().size()};
    const std::size_t count = shape.chains * shape.draws;
    store::Hdf5Writer file(path);

    // Samples of each parameter, and the density at each of them.
    const auto scales = scales_of(file, "/posterior", shape);
    for (std::size_t k = 0; k < posterior.free.size(); ++k) {
        const std::string name = name_of(plan, posterior, k), path_in_file = "/posterior/" + name;
        std::vector<double> values;
        for (const auto& chain : posterior.values[k])
            values.insert(values.end(), chain.begin(), chain.end());
        file.dataset(path_in_file, values, {shape.chains, shape.draws}, fit_unit(plan.keys, name));
        file.dimensions(path_in_file, scales);
    }
    std::vector<double> log_density;
    for (std::size_t c = 0; c < shape.chains; ++c)
        for (std::size_t i = 0; i < shape.draws; ++i)
            log_density.push_back(posterior.log_likelihood[c][i] +
                                  density.log_prior(values_at(posterior, c, i)));
    const auto stats_scales = scales_of(file, "/sample_stats", shape);
    file.dataset("/sample_stats/lp", log_density, {shape.chains, shape.draws}, "1");
    file.dimensions("/sample_stats/lp", stats_scales);

    // Log-likelihood of each residual, for leave-one-out comparisons, unless the table would be too long.
    constexpr std::size_t longest = 4'000'000;
    if (const std::size_t residuals = fitting::data_count(plan.problem); count * residuals <= longest) {
        std::vector<double> all(count * residuals);
        parallel_for(count, threads, [&](std::size_t i) {
            const std::vector<double> terms =
                density.log_likelihoods(values_at(posterior, i / shape.draws, i % shape.draws));
            std::ranges::copy(terms, all.begin() + static_cast<std::ptrdiff_t>(i * residuals));
        });
        std::vector<std::string> axes = scales_of(file, "/log_likelihood", shape);
        axes.emplace_back("/log_likelihood/residual");
        file.scale(axes.back(), residuals);
        file.dataset("/log_likelihood/data", all, {shape.chains, shape.draws, residuals}, "1");
        file.dimensions("/log_likelihood/data", axes);
    }
    file.commit();
}

// Predictions of the samples, with and without the noise of the data.

constexpr std::size_t most_draws = 200, predicted_places = 201;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Quantiles of predictions: median and 95 % interval of the posterior, and that with the noise of a datum.
struct PredictionBand {
    double median, low, high, noise_low, noise_high;
};

double quantile(const std::vector<double>& sorted, double p) {
    const double at = p * static_cast<double>(sorted.size() - 1);
    const auto i = static_cast<std::size_t>(at);
    return std::lerp(sorted[i], sorted[std::min(i + 1, sorted.size() - 1)], at - static_cast<double>(i));
}

/// Quantile of the values with normal noise added, by bisection of the mixture's distribution function.
double noisy_quantile(const std::vector<double>& sorted, double sigma, double p) {
    double low = sorted.front() - 6.0 * sigma, high = sorted.back() + 6.0 * sigma;
    for (int round = 0; round < 50; ++round) {
        const double middle = 0.5 * (low + high);
        double below = 0.0;
        for (const double value : sorted)
            below += 0.5 * std::erfc((value - middle) / (sigma * std::numbers::sqrt2));
        (below < p * static_cast<double>(sorted.size()) ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// Values that are not finite do not count.
PredictionBand band_of(std::vector<double> values, double sigma) {
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty())
        return {unknown, unknown, unknown, unknown, unknown};
    std::ranges::sort(values);
    const bool noisy = sigma > 0.0;
    return {quantile(values, 0.5), quantile(values, 0.025), quantile(values, 0.975),
            noisy ? noisy_quantile(values, sigma, 0.025) : unknown,
            noisy ? noisy_quantile(values, sigma, 0.975) : unknown};
}

/// Standard error of a datum anywhere along the line, between those of the points beside it.
double sigma_at(const fitting::Profile& data, double position) {
    if (data.sigma.empty())
        return 0.0;
    double below = -HUGE_VAL, above = HUGE_VAL, low = 0.0, high = 0.0;
    for (std::size_t i = 0; i < data.place.size(); ++i) {
        if (data.place[i] <= position && data.place[i] > below)
            below = data.place[i], low = data.sigma[i];
        if (data.place[i] >= position && data.place[i] < above)
            above = data.place[i], high = data.sigma[i];
    }
    if (!std::isfinite(below) || !std::isfinite(above) || above == below)
        return std::isfinite(below) ? low : high;
    return std::lerp(low, high, (position - below) / (above - below));
}

void write_curve(const std::filesystem::path& folder, const FitPlan& plan, std::size_t index,
                 const std::vector<std::vector<double>>& draws, std::size_t threads) {
    const fitting::Profile& data = plan.profiles[index].data;
    const auto [from, to] = std::ranges::minmax(data.place);
    std::vector<double> places(predicted_places);
    for (std::size_t i = 0; i < predicted_places; ++i)
        places[i] = std::lerp(from, to, static_cast<double>(i) / static_cast<double>(predicted_places - 1));
    std::vector<std::vector<double>> models(draws.size());
    parallel_for(draws.size(), threads,
                 [&](std::size_t i) { models[i] = predicted_line(plan, data, places, draws[i]).value; });
    std::vector<PredictedRow> rows(predicted_places);
    parallel_for(predicted_places, threads, [&](std::size_t i) {
        std::vector<double> values;
        values.reserve(models.size());
        for (const auto& model : models)
            values.push_back(model[i]);
        const PredictionBand b = band_of(std::move(values), sigma_at(data, places[i]));
        rows[i] = {places[i], b.median, b.low, b.high, b.noise_low, b.noise_high};
    });
    store::write_atomically(folder / fmt::format("posterior_curve_{}.csv", index), csv_of(rows));
}

void write_track(const std::filesystem::path& folder, const FitPlan& plan, std::size_t index,
                 const std::vector<std::vector<double>>& draws, std::size_t threads) {
    const FitTrackData& track = plan.tracks[index];
    const FitPart part = track_part(plan.problem);
    std::vector<std::vector<std::vector<double>>> models(draws.size());
    parallel_for(draws.size(), threads, [&](std::size_t i) {
        models[i] =
            fitting::predict(plan.track_model, track.data, index, part.parameters, part.values(draws[i]));
    });
    // Variance that the diffusion of the rods adds, as a mean over a few draws.
    constexpr std::size_t few = 20;
    std::vector<std::vector<double>> diffusion(track.data.times.size(),
                                               std::vector<double>(track.data.states.front().size()));
    if (std::ranges::any_of(part.parameters, rods::is_noise, &fitting::Parameter::name)) {
        const std::size_t count = std::min(few, draws.size());
        for (std::size_t k = 0; k < count; ++k) {
            const auto variance = fitting::noise_variance(track.data, index, part.parameters,
                                                          part.values(draws[k * draws.size() / count]));
            for (std::size_t row = 0; row < diffusion.size(); ++row)
                for (std::size_t i = 0; i < diffusion[row].size(); ++i)
                    diffusion[row][i] += variance[row][i] / static_cast<double>(count);
        }
    }

    std::vector<PredictedPoseRow> rows;
    for (std::size_t row = 0; row < track.data.times.size(); ++row)
        for (std::size_t i = 0; i < track.data.states[row].size(); ++i) {
            const std::size_t rod = i / 3;
            const bool heading = i % 3 == 2;
            const double unit = heading ? 1.0 : track.length;
            std::vector<double> values;
            values.reserve(models.size());
            for (const auto& model : models)
                values.push_back(unit * model[row][i]);
            const PredictionBand b =
                band_of(std::move(values),
                        unit * std::hypot(heading ? track.data.sigma_heading : track.data.sigma_position,
                                          std::sqrt(diffusion[row][i])));
            rows.push_back({track.time * track.data.times[row], static_cast<double>(rod),
                            static_cast<double>(i % 3), unit * track.data.states[row][i], b.median, b.low,
                            b.high, b.noise_low, b.noise_high});
        }
    store::write_atomically(folder / fmt::format("posterior_trajectory_{}.csv", index), csv_of(rows));
}

} // namespace

void write_posterior(const std::filesystem::path& folder, const FitPlan& plan,
                     const fitting::Posterior& posterior, const RunContext& context) {
    std::vector<std::string> names = {"chain", "draw"};
    std::vector<std::vector<double>> columns(names.size() + posterior.free.size() + 1);
    for (std::size_t k = 0; k < posterior.free.size(); ++k)
        names.push_back(name_of(plan, posterior, k));
    names.emplace_back("log_likelihood");
    for (std::size_t c = 0; c < posterior.log_likelihood.size(); ++c)
        for (std::size_t i = 0; i < posterior.log_likelihood[c].size(); ++i) {
            columns[0].push_back(static_cast<double>(c));
            columns[1].push_back(static_cast<double>(i));
            for (std::size_t k = 0; k < posterior.free.size(); ++k)
                columns[2 + k].push_back(posterior.values[k][c][i]);
            columns.back().push_back(posterior.log_likelihood[c][i]);
        }
    store::write_atomically(folder / "posterior.csv", store::to_csv(names, columns));
    write_netcdf(folder / "posterior.nc", plan, posterior, context.thread_count());
    // The predictions use draws that are spread evenly over the chains.
    const std::size_t length = posterior.log_likelihood.front().size(),
                      all = length * posterior.log_likelihood.size(), count = std::min(most_draws, all);
    std::vector<std::vector<double>> draws;
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t at = k * all / count;
        std::vector<double> free;
        for (const auto& values : posterior.values)
            free.push_back(values[at / length][at % length]);
        draws.push_back(fitting::all_values(plan.problem, free));
    }
    for (std::size_t i = 0; i < plan.profiles.size(); ++i)
        write_curve(folder, plan, i, draws, context.thread_count());
    for (std::size_t i = 0; i < plan.tracks.size(); ++i)
        write_track(folder, plan, i, draws, context.thread_count());
    store::write_atomically(folder / "posterior.json", posterior_json(plan, posterior, context.command));
}

} // namespace rodwake::app
