// simulate: rods from an array of poses, the result as arrays.

#include "rodwake/assembly/rods.hpp"
#include "arrays.hpp"
#include "bind.hpp"
#include "medium.hpp"
#include "rod_problem.hpp"
#include "rodwake/core/error.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>

namespace rodwake::python {

namespace {

using Number = std::optional<double>;

/// As the results of a run have it: the output times, then the end if it is another time (contact, failure).
struct Path {
    std::vector<double> times, poses; ///< [T], [T][N][3]
};

Path path_of(const integrate::Solution& solution) {
    Path path{solution.times, {}};
    for (const std::vector<double>& state : solution.states)
        path.poses.insert(path.poses.end(), state.begin(), state.end());
    if (path.times.empty() || solution.final_time > path.times.back()) {
        path.times.push_back(solution.final_time);
        path.poses.insert(path.poses.end(), solution.final_state.begin(), solution.final_state.end());
    }
    return path;
}

/// As in the program: criteria, tolerances and method are those of a scene with these values.
rods::RodOptions options_of(const rods::RodProblem& problem, const std::string& method,
                            const std::string& form, double rtol, Number atol, long max_steps) {
    scene::RodsRun run;
    run.method = method_of(method);
    run.form = form_of(form);
    run.rtol = rtol;
    run.atol = atol.value_or(rtol / 100.0);
    run.max_steps = max_steps;
    return assembly::rod_options(run, problem);
}

struct Run {
    rods::RodResult result;
    std::size_t rods = 0;
    std::string method;
    mutable std::optional<std::pair<Array, Array>> path = {}; ///< t and poses, made when they are asked for
};

const std::pair<Array, Array>& arrays_of(const Run& run) {
    if (!run.path) {
        Path path = path_of(run.result.solution);
        const auto rows = static_cast<py::ssize_t>(path.times.size());
        run.path.emplace(array_of(std::move(path.times), {rows}),
                         array_of(std::move(path.poses), {rows, static_cast<py::ssize_t>(run.rods), 3}));
    }
    return *run.path;
}

Run simulate(const Array& poses, const Medium* medium, double kappa, double gamma1, double gamma2,
             double t_end, const std::optional<Array>& output_times, Number contact_distance,
             const std::string& method, const std::string& form, double rtol, Number atol, long max_steps) {
    rods::RodProblem problem = problem_of(poses, medium, {kappa, gamma1, gamma2});
    problem.t_end = t_end;
    if (output_times)
        problem.output_times = copied(*output_times);
    problem.contact_distance = contact_distance;
    Interrupt interrupt;
    Run run;
    {
        const py::gil_scoped_release release;
        rods::RodOptions options = options_of(problem, method, form, rtol, atol, max_steps);
        options.ode.stop_requested = [&] { return interrupt(); };
        run.result = rods::simulate(problem, options);
        run.method = to_string(options.ode.method);
    }
    interrupt.rethrow();
    run.rods = problem.rods.size();
    return run;
}

py::object pair_of(const Run& run) {
    if (run.rods < 2)
        return py::none();
    return py::make_tuple(run.result.outcome.pair.first, run.result.outcome.pair.second);
}

std::string text_of(const Run& run) {
    const rods::RodOutcome& outcome = run.result.outcome;
    return "<RodResult: " + to_string(outcome.ending) +
           " at t = " + std::string(py::str(py::float_(outcome.time))) + ", " + std::to_string(run.rods) +
           " rods, " + std::to_string(arrays_of(run).first.size()) + " times>";
}

constexpr const char* about_run =
    "Motion of rods and how it ended. Lengths in f/mu, times in f/(mu v0), angles in rad.";

} // namespace

void bind_rods(py::module_& module) {
    const auto outcome = [](const Run& run) { return to_string(run.result.outcome.ending); };
    const auto message = [](const Run& run) { return run.result.solution.status.message(); };
    py::class_<Run>(module, "RodResult", about_run)
        .def_property_readonly(
            "t", [](const Run& run) { return arrays_of(run).first; },
            "(T,): the output times, then the end if it is another time")
        .def_property_readonly(
            "poses", [](const Run& run) { return arrays_of(run).second; },
            "(T, N, 3): x, y and heading of each rod at each time")
        .def_property_readonly("outcome", outcome, "'contact', 'pursuit', 'escape' or 'undecided'")
        .def_property_readonly(
            "time", [](const Run& run) { return run.result.outcome.time; },
            "of contact, else the time reached")
        .def_property_readonly("pair", &pair_of,
                               "numbers of the two rods that the outcome is about; None: a single rod")
        .def_property_readonly(
            "separation", [](const Run& run) { return run.result.outcome.pair.distance; },
            "of that pair, when the outcome was told")
        .def_property_readonly(
            "min_separation", [](const Run& run) { return run.result.outcome.min_separation; },
            "smallest separation of two rods at any time; infinite for a single rod")
        .def_property_readonly(
            "min_separation_time", [](const Run& run) { return run.result.outcome.min_separation_time; },
            "when")
        .def_property_readonly(
            "turn",
            [](const Run& run) {
                auto turn = run.result.outcome.turn;
                const auto rods = static_cast<py::ssize_t>(turn.size());
                return array_of(std::move(turn), {rods});
            },
            "(N,): heading at the end less that at the start, turns counted")
        .def_property_readonly(
            "reason", [](const Run& run) { return run.result.outcome.reason; }, "the outcome in words")
        .def_property_readonly(
            "status", [](const Run& run) { return to_string(run.result.solution.status.termination); },
            "'reached_end', 'stopped_at_event' (contact) or 'failed'")
        .def_property_readonly("message", message, "how the solve ended, in words")
        .def_readonly("method", &Run::method, "'bdf', 'adams' or 'erk': what 'auto' chose")
        .def_property_readonly(
            "statistics", [](const Run& run) { return statistics_of(run.result.solution.statistics); },
            "what the solver counted: steps, rhs_evaluations, ...")
        .def("__repr__", &text_of);
    module.def("simulate", &simulate);
}

} // namespace rodwake::python
