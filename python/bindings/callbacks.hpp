#pragma once
// Python functions that the library calls back in the middle of a solve, with the interpreter released.

#include "arrays.hpp"
#include "rodwake/core/error.hpp"

#include <exception>

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

/// The numbers that a function returned. Throws InputError if there are not as many as wanted.
inline Array returned(const py::object& values, std::size_t wanted, const char* function) {
    Array array = Array::ensure(values);
    if (!array)
        throw py::error_already_set();
    if (static_cast<std::size_t>(array.size()) != wanted)
        throw InputError(std::string(function) + " returned " + std::to_string(array.size()) +
                         " numbers; expected " + std::to_string(wanted));
    return array;
}

} // namespace rodwake::python
