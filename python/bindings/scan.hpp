#pragma once
// Points of a scan handed out by Python, to whatever executes functions there.

#include "rodwake/app/run_context.hpp"

#include <pybind11/pybind11.h>

namespace rodwake::python {

/// RunContext::executor that calls execute(points, take, stopped), points and results as bytes (a record
/// each): take(results) for every chunk of results, stopped() between them. It gets the interpreter for that.
/// Borrowed: it must outlive the run.
std::function<scan::Execute(scan::Evaluate, std::function<bool()> stop)>
executor_in_python(pybind11::handle execute);

} // namespace rodwake::python
