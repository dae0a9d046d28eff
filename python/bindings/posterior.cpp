// Densities and samples of the parameters of [fit] with [fit.posterior], on arrays.

#include "rodwake/fitting/posterior.hpp"

#include "bind.hpp"
#include "fit.hpp"
#include "rodwake/app/design_models.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/fitting/fit.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>

#include <atomic>
#include <cmath>

namespace rodwake::python {

namespace {

struct FitProblem {
    app::FitPlan plan;
    fitting::Density density;

    explicit FitProblem(app::FitPlan made) : plan(std::move(made)), density(plan.problem, fit_priors(plan)) {}
};

std::vector<std::string> names_of(const FitProblem& problem) {
    std::vector<std::string> names;
    for (const std::size_t i : fitting::free_parameters(problem.plan.problem))
        names.push_back(problem.plan.problem.parameters[i].name);
    return names;
}

/// Of each row: log prior and log likelihood, which is not worked out where the prior is 0.
std::pair<Array, Array> log_densities(const FitProblem& problem, const Array& rows, std::size_t threads) {
    const auto count = static_cast<std::size_t>(rows.shape(0)),
               size = static_cast<std::size_t>(problem.density.size());
    std::vector<double> prior(count), likelihood(count);
    {
        const double* first = rows.data();
        const py::gil_scoped_release others;
        parallel_for(count, std::max<std::size_t>(threads, 1), [&](std::size_t i) {
            const std::span<const double> row(first + i * size, size);
            prior[i] = problem.density.log_prior(row);
            likelihood[i] = std::isfinite(prior[i]) ? problem.density.log_likelihood(row) : -HUGE_VAL;
        });
    }
    const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(count)};
    return {array_of(std::move(prior), shape), array_of(std::move(likelihood), shape)};
}

Array chains_of(const std::vector<std::vector<double>>& chains) {
    std::vector<double> flat;
    for (const auto& chain : chains)
        flat.insert(flat.end(), chain.begin(), chain.end());
    return array_of(std::move(flat), {static_cast<py::ssize_t>(chains.size()),
                                      static_cast<py::ssize_t>(chains.front().size())});
}

/// Marginals by `make`, samples of each parameter, log likelihoods, log evidence with its error or None,
/// share of the steps taken by each chain, remarks.
py::tuple posterior(const FitProblem& problem, std::size_t threads, const py::object& make) {
    const scene::FitPosterior& keys = problem.plan.keys.posterior.value();
    std::atomic<bool> stopped = false;
    fitting::Method search = problem.plan.method;
    fitting::PosteriorMethod method{
        .chains = keys.chains, .samples = keys.samples, .evidence = keys.evidence};
    method.seed = search.seed;
    method.threads = search.threads = std::max<std::size_t>(threads, 1);
    method.stop_requested = search.stop_requested = [&] { return stopped.load(); };
    std::optional<fitting::Posterior> sampled;
    attended(
        [&] {
            const fitting::Fit fit = fitting::fit(problem.plan.problem, search);
            if (fit.termination == fitting::Termination::failed || !std::isfinite(fit.chi2))
                throw RunError("posterior: the fit that the samples begin from failed: " + fit.reason);
            sampled = fitting::sample(problem.plan.problem, fit_priors(problem.plan), fit.values, method);
        },
        [] {}, [&] { stopped = true; });
    const fitting::Posterior& found = sampled.value();
    const std::vector<std::string> names = names_of(problem);
    py::list marginals, samples;
    for (std::size_t k = 0; k < names.size(); ++k) {
        const fitting::Marginal& m = found.marginals[k];
        marginals.append(make(names[k], m.mean, m.sd, m.median, m.q025, m.q975, m.rhat, m.ess));
        samples.append(chains_of(found.values[k]));
    }
    const py::object evidence =
        found.log_evidence ? py::object(py::make_tuple(found.log_evidence->value, found.log_evidence->error))
                           : py::none();
    return py::make_tuple(marginals, samples, chains_of(found.log_likelihood), evidence, found.accepted,
                          found.remarks);
}

} // namespace

void bind_posterior(py::module_& module) {
    py::class_<FitProblem>(module, "FitProblem")
        .def(py::init([](const scene::Scene& scene, const std::vector<ProfileTuple>& profiles,
                         const std::vector<TrackTuple>& tracks, const std::vector<MapTuple>& maps) {
            return std::make_unique<FitProblem>(fit_plan(scene, profiles, tracks, maps));
        }))
        .def("names", &names_of)
        .def("log_densities", &log_densities)
        .def("posterior", &posterior);

    using app::DesignModels; // of rodwake design
    py::class_<DesignModels>(module, "DesignModels")
        .def(py::init<const scene::Scene&, const std::vector<std::string>&, long>())
        .def("names", &DesignModels::names)
        .def("seed_of_scene", &DesignModels::seed_of_scene)
        .def("log_evidence", &DesignModels::log_evidence, py::call_guard<py::gil_scoped_release>());
}

} // namespace rodwake::python
