#pragma once
// NumPy arrays of doubles, C order, seen as spans and made from vectors.

#include <pybind11/numpy.h>

#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace rodwake::python {

namespace py = pybind11;

/// What is not one is converted; copied only then.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline std::span<const double> numbers(const Array& array) {
    return {array.data(), static_cast<std::size_t>(array.size())};
}

inline std::vector<double> copied(const Array& array) {
    const auto values = numbers(array);
    return {values.begin(), values.end()};
}

/// The vector's own memory, which goes with the array.
inline Array array_of(std::vector<double>&& values, std::vector<py::ssize_t> shape) {
    auto owned = std::make_unique<std::vector<double>>(std::move(values));
    const double* data = owned->data();
    const py::capsule owner(owned.release(), [](void* v) { delete static_cast<std::vector<double>*>(v); });
    return Array(std::move(shape), data, owner);
}

/// What a function of rodwake/arguments.py makes of an argument. Throws InputError that names it.
template<class... Limits>
py::object argument(const char* function, const char* name, const py::object& given, Limits&&... limits) {
    return py::module_::import("rodwake.arguments")
        .attr(function)(name, given, std::forward<Limits>(limits)...);
}

} // namespace rodwake::python
