#include "fit_files.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/hdf5_writer.hpp"
#include "run/record_json.hpp"

#include <cmath>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;

std::string name_of(const FitPlan& plan, const fitting::Posterior& found, std::size_t k) {
    return plan.problem.parameters[found.free[k]].name;
}

std::string posterior_csv(const FitPlan& plan, const fitting::Posterior& found) {
    std::vector<std::string> names = {"chain", "draw"};
    std::vector<std::vector<double>> columns(names.size() + found.free.size() + 1);
    for (std::size_t k = 0; k < found.free.size(); ++k)
        names.push_back(name_of(plan, found, k));
    names.emplace_back("log_likelihood");
    for (std::size_t c = 0; c < found.log_likelihood.size(); ++c)
        for (std::size_t i = 0; i < found.log_likelihood[c].size(); ++i) {
            columns[0].push_back(static_cast<double>(c));
            columns[1].push_back(static_cast<double>(i));
            for (std::size_t k = 0; k < found.free.size(); ++k)
                columns[2 + k].push_back(found.values[k][c][i]);
            columns.back().push_back(found.log_likelihood[c][i]);
        }
    return store::to_csv(names, columns);
}

ordered_json prior_json(const fitting::Prior& prior) {
    static constexpr const char* kinds[] = {"uniform", "log_uniform", "normal"};
    ordered_json out = {{"kind", kinds[static_cast<std::size_t>(prior.kind)]},
                        {"low", finite_or_null(prior.low)},
                        {"high", finite_or_null(prior.high)}};
    if (prior.kind == fitting::PriorKind::normal)
        out.update({{"mean", prior.mean}, {"sd", prior.sd}});
    return out;
}

ordered_json marginal_json(const fitting::Marginal& m, const std::string& unit, const fitting::Prior& prior) {
    return {{"mean", m.mean},
            {"sd", m.sd},
            {"median", m.median},
            {"q025", m.q025},
            {"q975", m.q975},
            {"rhat", finite_or_null(m.rhat)},
            {"ess", finite_or_null(m.ess)},
            {"unit", unit},
            {"prior", prior_json(prior)}};
}

std::string posterior_json(const FitPlan& plan, const fitting::Posterior& found, const std::string& command) {
    const std::vector<fitting::Prior> priors = fit_priors(plan);
    ordered_json out;
    out["parameters"] = ordered_json::object();
    for (std::size_t k = 0; k < found.free.size(); ++k) {
        const std::string name = name_of(plan, found, k);
        out["parameters"][name] = marginal_json(found.marginals[k], fit_unit(plan.keys, name), priors[k]);
    }
    out["log_evidence"] = nullptr;
    if (found.log_evidence)
        out["log_evidence"] = {{"value", finite_or_null(found.log_evidence->value)},
                               {"stderr", finite_or_null(found.log_evidence->error)}};
    out["samples"] = "posterior.csv";
    out["chains"] = found.log_likelihood.size();
    out["accepted"] = found.accepted;
    out["seed"] = plan.method.seed;
    out["remarks"] = found.remarks;
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

std::vector<double> flat(const std::vector<std::vector<double>>& chains) {
    std::vector<double> out;
    for (const auto& chain : chains)
        out.insert(out.end(), chain.begin(), chain.end());
    return out;
}

std::vector<double> values_at(const fitting::Posterior& found, std::size_t c, std::size_t i) {
    std::vector<double> out;
    for (const auto& of_parameter : found.values)
        out.push_back(of_parameter[c][i]);
    return out;
}

/// Of each residual, which comparisons by leave-one-out need; left out where it would be too long.
void add_log_likelihoods(store::Hdf5Writer& file, const fitting::Density& density, std::size_t residuals,
                         const fitting::Posterior& found, std::size_t threads, Shape shape) {
    constexpr std::size_t most = 4'000'000;
    const std::size_t count = shape.chains * shape.draws;
    if (count * residuals > most)
        return;
    std::vector<double> all(count * residuals);
    parallel_for(count, threads, [&](std::size_t i) {
        const std::vector<double> one =
            density.log_likelihoods(values_at(found, i / shape.draws, i % shape.draws));
        std::ranges::copy(one, all.begin() + static_cast<std::ptrdiff_t>(i * residuals));
    });
    std::vector<std::string> scales = scales_of(file, "/log_likelihood", shape);
    scales.emplace_back("/log_likelihood/residual");
    file.scale(scales.back(), residuals);
    file.dataset("/log_likelihood/data", all, {shape.chains, shape.draws, residuals}, "1");
    file.dimensions("/log_likelihood/data", scales);
}

void write_netcdf(const std::filesystem::path& path, const FitPlan& plan, const fitting::Posterior& found,
                  std::size_t threads) {
    const fitting::Density density(plan.problem, fit_priors(plan));
    const Shape shape{found.log_likelihood.size(), found.log_likelihood.front().size()};
    store::Hdf5Writer file(path);
    const auto put = [&](const std::string& name, const std::vector<double>& values, const std::string& unit,
                         const std::vector<std::string>& scales) {
        file.dataset(name, values, {shape.chains, shape.draws}, unit);
        file.dimensions(name, scales);
    };
    const auto scales = scales_of(file, "/posterior", shape);
    for (std::size_t k = 0; k < found.free.size(); ++k) {
        const std::string name = name_of(plan, found, k);
        put("/posterior/" + name, flat(found.values[k]), fit_unit(plan.keys, name), scales);
    }
    std::vector<double> density_of_all;
    for (std::size_t c = 0; c < shape.chains; ++c)
        for (std::size_t i = 0; i < shape.draws; ++i)
            density_of_all.push_back(found.log_likelihood[c][i] + density.log_prior(values_at(found, c, i)));
    put("/sample_stats/lp", density_of_all, "1", scales_of(file, "/sample_stats", shape));
    add_log_likelihoods(file, density, fitting::data_count(plan.problem), found, threads, shape);
    file.commit();
}

} // namespace

void write_posterior(const std::filesystem::path& folder, const FitPlan& plan,
                     const fitting::Posterior& found, const RunContext& context) {
    store::write_atomically(folder / "posterior.csv", posterior_csv(plan, found));
    write_netcdf(folder / "posterior.nc", plan, found, context.thread_count());
    write_predictions(folder, plan, found, context.thread_count());
    store::write_atomically(folder / "posterior.json", posterior_json(plan, found, context.command));
}

} // namespace rodwake::app
