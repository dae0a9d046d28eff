#pragma once
// Python functions that the library calls back in the middle of a solve, with the interpreter released.

#include "arrays.hpp"
#include "rodwake/core/error.hpp"

#include <algorithm>
#include <exception>
#include <optional>
#include <string>
#include <string_view>

namespace rodwake::python {

/// What a function of Python raised goes through the library as a plain error, and is raised again behind it.
class Callbacks {
public:
    /// Calls with the interpreter held.
    template<class Call>
    auto operator()(const Call& call) {
        const py::gil_scoped_acquire acquire;
        try {
            return call();
        } catch (...) {
            raised_ = std::current_exception();
        }
        throw RunError("a function of Python raised an exception");
    }
    void rethrow() const {
        if (raised_)
            std::rethrow_exception(raised_);
    }

private:
    std::exception_ptr raised_;
};

/// A copy: Python may keep it.
inline Array array_of(std::span<const double> values) {
    return Array(static_cast<py::ssize_t>(values.size()), values.data());
}

// Real numbers from Python. `what` begins the message, "rtol is" or "the Jacobian returned"; what came and
// what was `wanted` follow. Throw InputError for complex numbers, None, text, ragged lists and masked values.

/// Of any shape. `kinds`: the kinds of NumPy's types that are taken.
Array real_numbers(py::handle value, const std::string& what, const std::string& wanted,
                   const char* kinds = "biufO");
/// With at most one axis longer than 1.
Array real_vector(py::handle value, const std::string& what, const std::string& wanted);
/// No bool either.
double real_number(py::handle value, const std::string& what);

} // namespace rodwake::python
