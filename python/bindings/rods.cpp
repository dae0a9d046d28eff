// simulate: rods from an array of poses, the result as arrays.

#include "rodwake/app/rods.hpp"
#include "arrays.hpp"
#include "bind.hpp"
#include "rod_problem.hpp"
#include "rodwake/rods/certificate.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>

#include <cstring>

namespace rodwake::python {

namespace {

using Number = std::optional<double>;

struct Run {
    Array t, poses; ///< (T,), (T, N, 3)
    rods::RodOutcome outcome;
    std::string status, message, method;
    integrate::Statistics statistics;
    bool has_contact_distance = false; ///< a contact distance was given

    std::size_t rods() const { return static_cast<std::size_t>(poses.shape(1)); }
};

Run simulate(const Array& poses, const Medium* medium, double kappa, double gamma1, double gamma2,
             double t_end, const std::optional<Array>& output_times, Number contact_distance,
             const std::optional<py::tuple>& body, const std::string& method, const std::string& form,
             double rtol, Number atol, long max_steps) {
    rods::RodProblem problem = problem_of(poses, medium, {kappa, gamma1, gamma2});
    if (body)
        problem.bodies = {{{(*body)[0].cast<std::size_t>(), (*body)[1].cast<double>(),
                            (*body)[2].cast<double>(), (*body)[3].cast<double>()}},
                          (*body)[4].cast<double>(),
                          (*body)[5].cast<double>()};
    problem.t_end = t_end;
    problem.output_times = output_times ? copied(*output_times) : default_times(t_end);
    problem.contact_distance = contact_distance;
    Interrupt interrupt;
    rods::RodResult result;
    std::string chosen;
    {
        const py::gil_scoped_release release;
        // As in the program: criteria, tolerances and method are those of a scene with these values.
        scene::RodsRun keys;
        keys.method = method_of(method);
        keys.form = form_of(form);
        keys.rtol = rtol;
        keys.atol = atol.value_or(rtol / 100.0);
        keys.max_steps = max_steps;
        rods::RodOptions options = app::rod_options(keys, problem);
        options.ode.stop_requested = [&] { return interrupt(); };
        result = rods::simulate_certified(problem, options);
        chosen = to_string(options.ode.method);
    }
    interrupt.rethrow();
    const integrate::Solution& solution = result.solution;
    // As the results of a run have it: the output times, then the end if it is another time (contact,
    // failure).
    std::vector<double> times = solution.times, path; // [T], [T][N][3]
    for (const std::vector<double>& state : solution.states)
        path.insert(path.end(), state.begin(), state.end());
    if (times.empty() || solution.final_time > times.back()) {
        times.push_back(solution.final_time);
        path.insert(path.end(), solution.final_state.begin(), solution.final_state.end());
    }
    const auto rows = static_cast<py::ssize_t>(times.size());
    Run run;
    run.t = array_of(std::move(times), {rows});
    run.poses = array_of(std::move(path), {rows, static_cast<py::ssize_t>(problem.rods.size()), 3});
    run.outcome = std::move(result.outcome);
    run.has_contact_distance = contact_distance.has_value();
    run.status = to_string(solution.status.termination);
    run.message = solution.status.message();
    run.method = std::move(chosen);
    run.statistics = solution.statistics;
    return run;
}

/// t (T,), poses (T, N, 3), turning (T, N)
Run classify(const Array& t, const Array& poses, const Array& turning, const Medium* medium,
             Number contact_distance) {
    const auto rods = static_cast<std::size_t>(poses.shape(1));
    rods::RodTrack track{copied(t), {}, {}};
    for (py::ssize_t k = 0; k < t.size(); ++k) {
        track.states.emplace_back(poses.data(k), poses.data(k) + 3 * rods);
        track.turning.emplace_back(turning.data(k), turning.data(k) + rods);
    }
    const auto box = medium ? medium->box : std::nullopt;
    rods::RodOutcome outcome = outcome_of(track, contact_distance, box, medium != nullptr);
    const bool contact = outcome.ending == Ending::contact;
    Run run{t,  poses, std::move(outcome),          contact ? "stopped_at_event" : "reached_end", "",
            "", {},    contact_distance.has_value()};
    return run;
}

py::object pair_of(const Run& run) {
    if (run.rods() < 2)
        return py::none();
    return py::make_tuple(run.outcome.pair.first, run.outcome.pair.second);
}

std::string text_of(const Run& run) {
    std::string text = "<RodResult: " + to_string(run.outcome.ending) +
                       " at t = " + std::string(py::str(py::float_(run.outcome.time))) + ", " +
                       std::to_string(run.rods()) + " rods, " + std::to_string(run.t.size()) + " times";
    if (run.status == "failed")
        text += "; failed: " + run.message;
    if (run.rods() > 1 && !run.has_contact_distance)
        text += "; no contact_distance: rods that meet run into the singularity of their fields";
    return text + ">";
}

/// NaN, which equals nothing, as None.
std::optional<double> or_none(double number) {
    return std::isnan(number) ? std::nullopt : std::optional(number);
}

py::tuple saved(const Run& run) {
    const rods::RodOutcome& o = run.outcome;
    const integrate::Statistics& s = run.statistics;
    return py::make_tuple(run.t, run.poses, static_cast<int>(o.ending), o.time, o.pair.first, o.pair.second,
                          o.pair.distance, o.min_separation, o.min_separation_time, o.turn, o.reason,
                          run.status, run.message, run.method, run.has_contact_distance,
                          std::vector{s.steps, s.rhs_evaluations, s.jacobian_evaluations,
                                      s.error_test_failures, s.convergence_failures},
                          static_cast<int>(o.certificate), or_none(o.separation), or_none(o.omega), o.grows,
                          o.stable, or_none(o.min_gap), o.min_gap_time, o.failed);
}

/// Bit for bit, so that a solve that failed on NaN equals its copy too.
bool same_bits(const Array& a, const Array& b) {
    return a.nbytes() == b.nbytes() &&
           std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.nbytes())) == 0;
}

py::object without_arrays(const Run& run) {
    const py::tuple values = saved(run);
    return values[py::slice(2, static_cast<py::ssize_t>(values.size()), 1)];
}

bool equal(const Run& run, const py::object& given) {
    if (!py::isinstance<Run>(given))
        return false;
    const Run& other = given.cast<const Run&>();
    return same_bits(run.t, other.t) && same_bits(run.poses, other.poses) &&
           without_arrays(run).equal(without_arrays(other));
}

Run restored(const py::tuple& v) {
    const auto number = [&](std::size_t k) { return v[k].cast<double>(); };
    const auto text = [&](std::size_t k) { return v[k].cast<std::string>(); };
    const auto counts = v[15].cast<std::vector<long>>();
    return {v[0].cast<Array>(),
            v[1].cast<Array>(),
            {static_cast<Ending>(v[2].cast<int>()),
             number(3),
             {v[4].cast<std::size_t>(), v[5].cast<std::size_t>(), number(6)},
             number(7),
             number(8),
             v[9].cast<std::vector<double>>(),
             v[17].cast<std::optional<double>>().value_or(std::nan("")),
             v[18].cast<std::optional<double>>().value_or(std::nan("")),
             v[19].cast<std::optional<bool>>(),
             v[20].cast<std::optional<bool>>(),
             v[21].cast<std::optional<double>>().value_or(std::nan("")),
             number(22),
             text(23),
             text(10),
             static_cast<Certificate>(v[16].cast<int>())},
            text(11),
            text(12),
            text(13),
            {counts.at(0), counts.at(1), counts.at(2), counts.at(3), counts.at(4)},
            v[14].cast<bool>()};
}

constexpr const char* about_run =
    "Motion of rods and how it ended. Lengths in f/mu, times in f/(mu v0), angles in rad.";

} // namespace

void bind_rods(py::module_& module) {
    const auto outcome = [](const Run& run) { return to_string(run.outcome.ending); };
    const auto counted = [](const Run& run) { return statistics_of(run.statistics); };
    const auto turn = [](const Run& run) {
        return Array(static_cast<py::ssize_t>(run.rods()), run.outcome.turn.data());
    };
    py::class_<Run>(module, "RodResult", about_run)
        .def_readonly("t", &Run::t, "(T,): the output times, then the end if it is another time")
        .def_readonly("poses", &Run::poses, "(T, N, 3): x, y and heading of each rod at each time")
        .def_property_readonly("outcome", outcome,
                               "'contact', 'bound', 'orbit', 'pursuit', 'escape' or 'undecided'")
        .def_property_readonly(
            "certificate", [](const Run& run) { return to_string(run.outcome.certificate); },
            "how well the outcome is known: 'verified', 'checked' or 'open'")
        .def_property_readonly(
            "time", [](const Run& run) { return run.outcome.time; }, "of contact, else the end of the run")
        .def_property_readonly("pair", &pair_of,
                               "numbers of the two rods that the outcome is about; None: a single rod")
        .def_property_readonly(
            "separation", [](const Run& run) { return run.outcome.pair.distance; },
            "of that pair, when the outcome was decided")
        .def_property_readonly(
            "omega", [](const Run& run) { return run.outcome.omega; },
            "turning rate of an orbit, + counterclockwise; NaN: no orbit")
        .def_property_readonly(
            "min_separation", [](const Run& run) { return run.outcome.min_separation; },
            "smallest separation of two rods at any time; infinite for a single rod")
        .def_property_readonly(
            "min_separation_time", [](const Run& run) { return run.outcome.min_separation_time; }, "when")
        .def_property_readonly(
            "min_gap", [](const Run& run) { return run.outcome.min_gap; },
            "smallest gap between two bodies at any time, below 0 where they overlap; NaN: no bodies")
        .def_property_readonly("turn", turn, "(N,): heading at the end less that at the start, turns counted")
        .def_property_readonly(
            "reason", [](const Run& run) { return run.outcome.reason; }, "the outcome in words")
        .def_readonly("status", &Run::status, "'reached_end', 'stopped_at_event' (contact) or 'failed'")
        .def_readonly("message", &Run::message, "how the solve ended, in words; '' from classify")
        .def_readonly("method", &Run::method, "'bdf', 'adams' or 'erk': what 'auto' chose; '' from classify")
        .def_property_readonly("statistics", counted, "what the solver counted: steps, rhs_evaluations, ...")
        .def("__repr__", &text_of)
        .def("__eq__", &equal)
        .def(py::pickle(&saved, &restored));
    module.def("simulate", &simulate);
    module.def("classify", &classify);
}

} // namespace rodwake::python
