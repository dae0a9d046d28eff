#pragma once
// From arrays and names to problems of the rods part.

#include "arrays.hpp"
#include "rodwake/app/run_context.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/elastic/medium.hpp"
#include "rodwake/rods/simulate.hpp"

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

namespace rodwake::python {

// The medium as Python has it: eta, xi and the domain.

struct Medium {
    elastic::Medium elastic;
    std::optional<PeriodicBox> box; ///< f/mu; absent: infinite plane
};

/// Rods in these poses (N, 3), in this medium; null: rods walk straight. Throws InputError for other shapes.
rods::RodProblem problem_of(const Array& poses, const Medium* medium, const rods::Couplings& couplings);

/// "bdf", "adams" or "erk"; nothing for "auto". Throws InputError for other names.
std::optional<integrate::Method> method_of(const std::string& name);

/// "angle", "director" or "dae". Throws InputError for other names.
rods::Formulation form_of(const std::string& name);

/// Those of a scene that says nothing of them; none for a t_end that is none, which the solver tells.
std::vector<double> default_times(double t_end);

py::dict statistics_of(const integrate::Statistics& statistics);

// Points of a scan handed out by Python, to whatever executes functions there.

/// RunContext::executor that calls execute(points, take, stopped), points and results as bytes (a record
/// each): take(results) for every chunk of results, stopped() between them. It gets the interpreter for that.
/// Borrowed: it must outlive the run.
std::function<scan::Execute(scan::Evaluate, std::function<bool()> stop)>
executor_in_python(pybind11::handle execute);

} // namespace rodwake::python
