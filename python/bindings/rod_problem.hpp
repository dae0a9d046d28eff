#pragma once
// From arrays and names to problems of the rods part.

#include "arrays.hpp"
#include "medium.hpp"
#include "rodwake/rods/simulate.hpp"

#include <optional>
#include <string>
#include <vector>

namespace rodwake::python {

/// Rods in these poses (N, 3), in this medium; null: rods walk straight. Throws InputError for other shapes.
rods::RodProblem problem_of(const Array& poses, const Medium* medium, const rods::Couplings& couplings);

/// "bdf", "adams" or "erk"; nothing for "auto". Throws InputError for other names.
std::optional<integrate::Method> method_of(const std::string& name);

/// "angle", "director" or "dae". Throws InputError for other names.
rods::Form form_of(const std::string& name);

/// Those of a scene that says nothing of them; none for a t_end that is none, which the solver tells.
std::vector<double> default_times(double t_end);

py::dict statistics_of(const integrate::Statistics& statistics);

} // namespace rodwake::python
