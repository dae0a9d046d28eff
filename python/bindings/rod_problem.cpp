#include "rod_problem.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/scene/scene.hpp"

#include <cmath>

namespace rodwake::python {

rods::RodProblem problem_of(const Array& poses, const Medium* medium, const rods::Couplings& couplings) {
    if (poses.ndim() != 2 || poses.shape(1) != 3)
        throw InputError("poses: expected an array of shape (N, 3): x, y and heading of each rod");
    rods::RodProblem problem;
    if (medium) {
        problem.medium = medium->elastic;
        problem.box = medium->box;
    }
    problem.couplings = couplings;
    for (py::ssize_t i = 0; i < poses.shape(0); ++i)
        problem.rods.push_back({poses.at(i, 0), poses.at(i, 1), poses.at(i, 2)});
    return problem;
}

std::optional<integrate::Method> method_of(const std::string& name) {
    for (const auto method : {integrate::Method::bdf, integrate::Method::adams, integrate::Method::erk})
        if (name == integrate::to_string(method))
            return method;
    if (name != "auto")
        throw InputError("method = '" + name + "': expected 'auto', 'bdf', 'adams' or 'erk'");
    return std::nullopt;
}

rods::Formulation form_of(const std::string& name) {
    for (const auto form : {rods::Formulation::angle, rods::Formulation::director, rods::Formulation::dae})
        if (name == rods::to_string(form))
            return form;
    throw InputError("form = '" + name + "': expected 'angle', 'director' or 'dae'");
}

std::vector<double> default_times(double t_end) {
    if (!(t_end > 0.0 && std::isfinite(t_end)))
        return {};
    std::vector<double> times = scene::output_grid(t_end / scene::default_outputs, t_end);
    times.insert(times.begin(), 0.0);
    return times;
}

py::dict statistics_of(const integrate::Statistics& s) {
    py::dict counts;
    counts["steps"] = s.steps;
    counts["rhs_evaluations"] = s.rhs_evaluations;
    counts["jacobian_evaluations"] = s.jacobian_evaluations;
    counts["error_test_failures"] = s.error_test_failures;
    counts["convergence_failures"] = s.convergence_failures;
    return counts;
}

} // namespace rodwake::python
