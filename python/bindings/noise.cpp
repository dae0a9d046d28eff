// simulate_noise: an ensemble of rods that diffuse, its runs and means as arrays.

#include "arrays.hpp"
#include "bind.hpp"
#include "rod_problem.hpp"
#include "rodwake/app/rods.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/rods/noise_ensemble.hpp"
#include "rodwake/scan/proportion.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>

#include <atomic>
#include <cmath>

namespace rodwake::python {

namespace {

struct Ensemble {
    rods::RodProblem problem;
    app::NoisePlan plan;
    rods::NoiseSums sums;

    py::ssize_t rods() const { return static_cast<py::ssize_t>(problem.rods.size()); }
};

Ensemble simulate_noise(const Array& poses, const Medium* medium, double kappa, double gamma1, double gamma2,
                        double t_end, const std::optional<Array>& output_times,
                        std::optional<double> contact_distance, double rotational, double translational,
                        std::uint32_t runs, std::optional<double> capture_error, std::uint32_t most_runs,
                        std::optional<double> time_step, std::uint64_t seed, std::size_t threads,
                        long max_steps) {
    Ensemble out{problem_of(poses, medium, {kappa, gamma1, gamma2}), {}, {}};
    out.problem.t_end = t_end;
    out.problem.output_times = output_times ? copied(*output_times) : default_times(t_end);
    out.problem.contact_distance = contact_distance;
    std::atomic<bool> stopped = false;
    attended(
        [&] {
            const double step = time_step ? *time_step : rods::suitable_time_step(out.problem, rotational);
            out.plan.noise = {rotational, translational, step, seed};
            out.plan.runs = runs;
            out.plan.capture_error = capture_error;
            out.plan.most_runs = most_runs;
            out.sums = rods::no_runs(out.problem);
            // As in the program: criteria and number of steps are those of a scene with [noise].
            scene::RodsRun run;
            run.max_steps = max_steps;
            rods::RodOptions options = app::rod_options(run, out.problem);
            options.criteria = rods::noisy_criteria;
            options.ode.stop_requested = [&] { return stopped.load(); };
            app::run_wanted(out.problem, options, out.plan, std::max<std::size_t>(threads, 1), out.sums);
        },
        [] {}, [&] { stopped = true; });
    return out;
}

/// Of each run, as text.
py::list outcomes_of(const Ensemble& e) {
    py::list all;
    for (const rods::NoisyEnd& end : e.sums.ends)
        all.append(end.failed ? std::string("failed") : to_string(end.ending));
    return all;
}

/// A number of each run.
template<class Of>
Array of_runs(const Ensemble& e, const Of& of) {
    std::vector<double> values;
    values.reserve(e.sums.ends.size());
    for (const rods::NoisyEnd& end : e.sums.ends)
        values.push_back(of(end));
    const auto runs = static_cast<py::ssize_t>(values.size());
    return array_of(std::move(values), {runs});
}

/// (runs, 2); -1 for a single rod
py::array_t<std::int64_t> pairs_of(const Ensemble& e) {
    py::array_t<std::int64_t> pairs({static_cast<py::ssize_t>(e.sums.ends.size()), py::ssize_t{2}});
    std::int64_t* out = pairs.mutable_data();
    for (const rods::NoisyEnd& end : e.sums.ends) {
        *out++ = e.rods() > 1 ? static_cast<std::int64_t>(end.first) : -1;
        *out++ = e.rods() > 1 ? static_cast<std::int64_t>(end.second) : -1;
    }
    return pairs;
}

/// Share of captures and the ends of its interval; None where there is nothing to capture.
py::object capture_of(const Ensemble& e) {
    const rods::CaptureCount counted = rods::count_captures(e.sums.ends, e.problem.rods.size());
    if (counted.of == 0)
        return py::none();
    const scan::Proportion share{counted.count, counted.of};
    const auto [low, high] = share.wilson(scan::quantile_95);
    return py::make_tuple(share.value(), low, high);
}

/// Means and errors, each (T, N).
py::tuple table_of(const Ensemble& e, rods::NoiseMeans means) {
    const auto times = static_cast<py::ssize_t>(e.sums.reached.size());
    return py::make_tuple(array_of(std::move(means.values), {times, e.rods()}),
                          array_of(std::move(means.errors), {times, e.rods()}));
}

Array copy_of(std::vector<double> values) {
    const auto size = static_cast<py::ssize_t>(values.size());
    return array_of(std::move(values), {size});
}

} // namespace

void bind_noise(py::module_& module) {
    py::class_<Ensemble>(module, "Ensemble")
        .def("outcomes", &outcomes_of)
        .def("times",
             [](const Ensemble& e) { return of_runs(e, [](const rods::NoisyEnd& end) { return end.time; }); })
        .def("min_separations",
             [](const Ensemble& e) {
                 return of_runs(e, [](const rods::NoisyEnd& end) { return end.min_separation; });
             })
        .def("pairs", &pairs_of)
        .def("capture", &capture_of)
        .def("t", [](const Ensemble& e) { return copy_of(rods::output_times(e.problem)); })
        .def("runs_at_time", [](const Ensemble& e) { return copy_of(e.sums.reached); })
        .def("mean_square_displacement",
             [](const Ensemble& e) { return table_of(e, rods::mean_square_displacement(e.sums)); })
        .def("heading_correlation",
             [](const Ensemble& e) { return table_of(e, rods::heading_correlation(e.sums)); })
        .def_property_readonly("failure", [](const Ensemble& e) { return e.sums.failure; })
        .def_property_readonly("time_step", [](const Ensemble& e) { return e.plan.noise.time_step; });
    module.def("simulate_noise", &simulate_noise);
}

} // namespace rodwake::python
