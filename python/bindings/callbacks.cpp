#include "callbacks.hpp"

namespace rodwake::python {

namespace {

constexpr std::size_t most_shown = 60;

/// What came, short: "a list, [1.0, None]".
std::string shown(py::handle value) {
    std::string text = py::repr(value);
    if (text.size() > most_shown)
        text = text.substr(0, most_shown) + "...";
    std::ranges::replace(text, '\n', ' ');
    return text + " (" + std::string(py::str(py::type::handle_of(value).attr("__name__"))) + ")";
}

/// An array whose elements are real numbers as Python has them, objects that know themselves as a float (not
/// None, text or complex numbers), or nothing. `kinds`: those of NumPy that are.
std::optional<Array> converted(py::handle value, std::string_view kinds) {
    const py::array plain(py::reinterpret_borrow<py::object>(value));
    const char kind = plain.dtype().kind();
    if (kind == 'O')
        for (const py::handle element : plain.attr("flat"))
            if (PyComplex_Check(element.ptr()) != 0 || !py::hasattr(element, "__float__"))
                return std::nullopt;
    if (kinds.find(kind) == std::string_view::npos)
        return std::nullopt;

    // Masks are dropped by the conversion to an array.
    const PyTypeObject* type = Py_TYPE(value.ptr());
    const bool masked = type != &PyList_Type && type != &PyFloat_Type &&
                        type != reinterpret_cast<PyTypeObject*>(py::detail::npy_api::get().PyArray_Type_) &&
                        py::hasattr(value, "_mask") &&
                        py::module_::import("numpy").attr("ma").attr("is_masked")(value).cast<bool>();
    return masked ? std::nullopt : std::optional(Array(plain));
}

} // namespace

Array real_numbers(py::handle value, const std::string& what, const std::string& wanted, const char* kinds) {
    std::string why;
    try {
        if (const auto array = converted(value, kinds))
            return *array;
    } catch (const py::error_already_set& error) { // ragged lists and the like
        if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError))
            throw;
        why = std::string(": ") + py::str(error.value()).cast<std::string>();
    }
    throw InputError(what + " " + shown(value) + "; expected " + wanted + why);
}

Array real_vector(py::handle value, const std::string& what, const std::string& wanted) {
    Array array = real_numbers(value, what, wanted);
    py::ssize_t longest = 1;
    for (py::ssize_t axis = 0; axis < array.ndim(); ++axis)
        longest = std::max(longest, array.shape(axis));
    if (array.size() != 0 && longest != array.size())
        throw InputError(what + " an array of shape " +
                         py::str(py::object(array.attr("shape"))).cast<std::string>() + "; expected " +
                         wanted);
    return array;
}

double real_number(py::handle value, const std::string& what) {
    const Array array = real_numbers(value, what, "a real number", "iufO");
    if (array.size() != 1)
        throw InputError(what + " " + shown(value) + "; expected a real number");
    return array.data()[0];
}

} // namespace rodwake::python
