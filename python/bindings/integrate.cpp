// Initial-value problems of the user, and those of rods with the user's events and terms.

#include "bind.hpp"
#include "callbacks.hpp"
#include "rod_problem.hpp"
#include "signals.hpp"

#include <pybind11/stl.h>

#include <algorithm>

namespace rodwake::python {

namespace {

using integrate::State;

integrate::Crossing crossing_of(const std::string& direction) {
    if (direction == "rising")
        return integrate::Crossing::rising;
    if (direction == "falling")
        return integrate::Crossing::falling;
    if (direction != "any")
        throw InputError("direction = '" + direction + "': expected 'any', 'rising' or 'falling'");
    return integrate::Crossing::any;
}

void require_size(const Array& array, std::size_t wanted, const char* what) {
    if (static_cast<std::size_t>(array.size()) != wanted)
        throw InputError(std::string(what) + " " + std::to_string(array.size()) + " numbers; expected " +
                         std::to_string(wanted));
}

/// Functions of Python as those of a problem. `calls` must outlive them.
std::function<void(double, State, std::span<double>)> rate_of(const py::function& f, Callbacks& calls) {
    return [f = f.ptr(), &calls](double t, State y, std::span<double> rate) {
        calls([&] {
            const py::object value = py::reinterpret_borrow<py::function>(f)(t, array_of(y));
            const std::string wanted = std::to_string(y.size()) + " real numbers";
            const Array numbers_of = real_vector(value, "the right-hand side returned", wanted);
            require_size(numbers_of, y.size(), "the right-hand side returned");
            std::ranges::copy(numbers(numbers_of), rate.begin());
        });
    };
}

std::function<void(double, State, Eigen::Ref<Eigen::MatrixXd>)> jacobian_of(const py::function& f,
                                                                            Callbacks& calls) {
    return [f = f.ptr(), &calls](double t, State y, Eigen::Ref<Eigen::MatrixXd> jacobian) {
        calls([&] {
            const py::object value = py::reinterpret_borrow<py::function>(f)(t, array_of(y));
            const std::string n = std::to_string(y.size());
            const Array rows = real_numbers(value, "the Jacobian returned", n + " x " + n + " real numbers");
            require_size(rows, y.size() * y.size(), "the Jacobian returned");
            if (y.size() > 1 && (rows.ndim() != 2 || rows.shape(0) != rows.shape(1)))
                throw InputError("the Jacobian returned an array that is not " + n + " x " + n);
            for (std::size_t i = 0; i < y.size(); ++i)
                for (std::size_t j = 0; j < y.size(); ++j)
                    jacobian(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
                        rows.data()[i * y.size() + j];
        });
    };
}

std::function<double(double, State)> value_of(const py::function& f, const std::string& event,
                                              Callbacks& calls) {
    return [f = f.ptr(), what = event + " returned", &calls](double t, State y) {
        return calls(
            [&] { return real_number(py::reinterpret_borrow<py::function>(f)(t, array_of(y)), what); });
    };
}

std::function<std::optional<double>(const integrate::Step&)>
candidate_time_of(const std::optional<py::function>& f, const std::string& event, Callbacks& calls) {
    if (!f)
        return nullptr;
    return [f = f->ptr(), what = "the candidate_time of " + event + " returned",
            &calls](const integrate::Step& step) {
        return calls([&]() -> std::optional<double> {
            const py::object time = py::reinterpret_borrow<py::function>(f)(
                step.time_before, array_of(step.state_before), step.time, array_of(step.state));
            return time.is_none() ? std::nullopt : std::optional(real_number(time, what));
        });
    };
}

/// Equations of motion of rods as a function that Python can call and `solve` knows without Python.
struct RodEquations {
    integrate::OdeProblem problem;

    Array state_of(const py::object& given) const {
        Array y = real_numbers(given, "y is", "x, y, heading of each rod");
        if (static_cast<std::size_t>(y.size()) != problem.initial_state.size())
            throw InputError("y has " + std::to_string(y.size()) + " numbers; the rods have " +
                             std::to_string(problem.initial_state.size()) + ": x, y, heading of each");
        return y;
    }
    Array rate(double t, const py::object& given) const {
        const Array y = state_of(given);
        Array rate(y.size());
        problem.rhs(t, numbers(y), {rate.mutable_data(), static_cast<std::size_t>(rate.size())});
        return rate;
    }
    Array jacobian(double t, const py::object& given) const {
        const Array y = state_of(given);
        if (!problem.jacobian)
            throw InputError("these equations have no Jacobian: their field has no gradients");
        Eigen::MatrixXd j = Eigen::MatrixXd::Zero(y.size(), y.size());
        problem.jacobian(t, numbers(y), j);
        const Eigen::MatrixXd rows = j.transpose(); // C order
        return array_of({rows.data(), rows.data() + rows.size()}, {y.size(), y.size()});
    }
};

RodEquations equations(const py::object& poses, const py::object& medium, const py::object& kappa,
                       const py::object& gamma1, const py::object& gamma2) {
    const auto number = [](const char* name, const py::object& given) {
        return argument("number", name, given).cast<double>();
    };
    rods::RodProblem problem =
        problem_of(argument("poses", "poses", poses).cast<Array>(),
                   argument("medium", "medium", medium).cast<const Medium*>(),
                   {number("kappa", kappa), number("gamma1", gamma1), number("gamma2", gamma2)});
    problem.t_end = 1.0; // means nothing to the equations
    return {rods::to_ode(problem)};
}

/// name, value(t, y), direction, terminal, candidate_time(t_before, y_before, t, y)
using EventTuple = std::tuple<std::string, py::function, std::string, bool, std::optional<py::function>>;

/// t, y (T, n), final_time, final_state, hits [(event, time, state)], status, message, statistics
py::tuple to_tuple(integrate::Solution&& s) {
    const auto columns = static_cast<py::ssize_t>(s.final_state.size());
    const auto rows = static_cast<py::ssize_t>(s.times.size());
    std::vector<double> states;
    for (const std::vector<double>& state : s.states)
        states.insert(states.end(), state.begin(), state.end());
    py::list hits;
    for (integrate::EventHit& hit : s.hits)
        hits.append(py::make_tuple(hit.event, hit.time, array_of(std::move(hit.state), {columns})));
    return py::make_tuple(array_of(std::move(s.times), {rows}), array_of(std::move(states), {rows, columns}),
                          s.final_time, array_of(std::move(s.final_state), {columns}), hits,
                          to_string(s.status.termination), s.status.message(), statistics_of(s.statistics));
}

py::tuple solve(const py::object& rhs, const Array& y0, const Array& times, double t0,
                const std::optional<py::function>& jacobian, const std::vector<EventTuple>& events,
                const std::string& method, double rtol, std::optional<double> atol, long max_steps,
                double max_step) {
    Callbacks calls;
    Interrupt interrupt;
    integrate::OdeOptions options;
    options.method = method_of(method).value_or(integrate::Method::adams);
    options.rtol = rtol;
    options.atol = atol.value_or(rtol / 100.0);
    options.max_steps = max_steps;
    options.max_step = max_step;
    options.stop_requested = [&] { return interrupt(); };

    // The equations are those of rods, or the user's; both take the user's events.
    integrate::OdeProblem problem;
    if (py::isinstance<RodEquations>(rhs))
        problem = rhs.cast<const RodEquations&>().problem;
    else
        problem.rhs = rate_of(rhs.cast<py::function>(), calls);
    if (jacobian)
        problem.jacobian = jacobian_of(*jacobian, calls);
    if (const std::size_t size = problem.initial_state.size(); size > 0)
        require_size(y0, size, "y0 has");
    problem.initial_state = copied(y0);
    problem.start_time = t0;
    for (const auto& [name, value, direction, terminal, candidate] : events) {
        const std::string event = "events[" + std::to_string(problem.events.size()) + "]";
        problem.events.push_back({name, value_of(value, event, calls), crossing_of(direction), terminal,
                                  candidate_time_of(candidate, event, calls)});
    }
    integrate::Solution solution;
    {
        const py::gil_scoped_release release;
        solution = integrate::solve(problem, options, numbers(times));
    }
    calls.rethrow();
    interrupt.rethrow();
    return to_tuple(std::move(solution));
}

constexpr const char* about_equations =
    R"(Equations of motion of rods as a function of time and state, dy/dt = equations(t, y), to integrate or to add terms to.

The state y (3 N,) is x, y and heading of each rod in turn. `integrate` runs these equations without Python and steps over no
encounter.

Parameters
----------
poses, medium, kappa, gamma1, gamma2
    As for `simulate`.)";

} // namespace

void bind_integrate(py::module_& module) {
    py::class_<RodEquations>(module, "RodEquations", about_equations)
        .def(py::init(&equations), py::arg("poses"), py::arg("medium") = py::none(), py::kw_only(),
             py::arg("kappa") = 0.0, py::arg("gamma1") = 0.0, py::arg("gamma2") = 0.0)
        .def_property_readonly(
            "y0", [](const RodEquations& e) { return array_of(e.problem.initial_state); },
            "(3 N,): the poses as a state")
        .def("__repr__",
             [](const RodEquations& e) {
                 return "<RodEquations: " + std::to_string(e.problem.initial_state.size() / 3) + " rods>";
             })
        .def("__call__", &RodEquations::rate, py::arg("t"), py::arg("y"), "dy/dt, (3 N,)")
        .def("jacobian", &RodEquations::jacobian, py::arg("t"), py::arg("y"), "d rate_i/d y_j, (3 N, 3 N)");
    module.def("solve", &solve);
}

} // namespace rodwake::python
