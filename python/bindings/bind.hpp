#pragma once
// What the module _core is made of: a function for each concept, which adds its classes and functions.

#include <pybind11/pybind11.h>

namespace rodwake::python {

namespace py = pybind11;

/// Exceptions of the library become those of rodwake.errors.
void bind_errors(py::module_& module);
void bind_medium(py::module_& module);
void bind_fields(py::module_& module);
void bind_rods(py::module_& module);
void bind_equilibria(py::module_& module);
void bind_noise(py::module_& module);
void bind_scene(py::module_& module);
void bind_integrate(py::module_& module);
void bind_fit(py::module_& module);
void bind_posterior(py::module_& module);
void bind_granular(py::module_& module);
void bind_run(py::module_& module);
void bind_scan(py::module_& module);
void bind_tradeoff(py::module_& module);

} // namespace rodwake::python
