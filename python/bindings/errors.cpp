#include "bind.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scene/read.hpp"

#include <pybind11/stl.h>

#include <filesystem>

namespace rodwake::python {

namespace {

py::object error_class(const char* name) { return py::module_::import("rodwake.errors").attr(name); }

void raise(const char* name, const py::object& error) {
    PyErr_SetObject(error_class(name).ptr(), error.ptr());
}

/// Messages quote names of files, of any bytes; Python's strings take none that are not UTF-8.
void raise(const char* name, const std::exception& error) {
    raise(name, error_class(name)(printable(error.what())));
}

void translate(std::exception_ptr thrown) {
    try {
        std::rethrow_exception(std::move(thrown));
    } catch (const scene::SceneError& error) {
        const py::object problem = error_class("Problem");
        py::list problems;
        for (const scene::Diagnostic& p : error.diagnostics())
            problems.append(problem(printable(p.file), p.line, p.column, p.key, printable(p.message)));
        raise("SceneError", error_class("SceneError")(printable(error.what()), problems));
    } catch (const InputError& error) {
        raise("InputError", error);
    } catch (const RunError& error) {
        raise("RunError", error);
    } catch (const std::filesystem::filesystem_error& error) {
        raise("RunError", error);
    }
}

} // namespace

void bind_errors(py::module_&) { py::register_local_exception_translator(translate); }

} // namespace rodwake::python
