#include "rod_problem.hpp"

#include "arrays.hpp"
#include "bind.hpp"
#include "rodwake/core/error.hpp"

#include <pybind11/stl.h>

#include <optional>

namespace rodwake::python {

namespace {

using Number = std::optional<double>;

std::optional<PeriodicBox> box_of(const py::object& given) {
    const auto sides = argument("sides", "periodic", given).cast<std::optional<std::pair<double, double>>>();
    return sides ? std::optional(PeriodicBox(sides->first, sides->second)) : std::nullopt;
}

/// A square by its side.
py::object sides_of(const Medium& m) {
    if (!m.box)
        return py::none();
    return m.box->square() ? py::object(py::float_(m.box->x))
                           : py::object(py::make_tuple(m.box->x, m.box->y));
}

Medium make_medium(const py::object& eta, const py::object& xi, const py::object& alpha,
                   const py::object& poisson_ratio, const py::object& periodic) {
    const auto number = [](const char* name, const py::object& given, double above) {
        return argument("maybe", name, given, py::arg("above") = above).cast<Number>();
    };
    const Number own_eta = number("eta", eta, -1.0), ratio = number("poisson_ratio", poisson_ratio, -1.0);
    if (own_eta && ratio)
        throw InputError("eta and poisson_ratio are two names of one number: give one of them");
    const Number own_xi = number("xi", xi, 0.0), inverse = number("alpha", alpha, 0.0);
    if (own_xi && inverse)
        throw InputError("xi and alpha = 1/xi are two names of one number: give one of them");
    const Medium medium{{ratio ? elastic::eta_from_poisson_ratio(*ratio) : own_eta.value_or(1.0),
                         inverse ? elastic::xi_from_alpha(*inverse) : own_xi.value_or(1.0)},
                        box_of(periodic)};
    validate(medium.elastic);
    return medium;
}

/// The call that makes it again.
std::string text_of(const Medium& m) {
    const auto number = [](double value) { return std::string(py::repr(py::float_(value))); };
    return "Medium(eta=" + number(m.elastic.eta) + ", xi=" + number(m.elastic.xi) +
           (m.box ? ", periodic=" + std::string(py::repr(sides_of(m))) : "") + ")";
}

py::tuple values_of(const Medium& m) { return py::make_tuple(m.elastic.eta, m.elastic.xi, sides_of(m)); }

constexpr const char* about_medium = R"(The elastic medium that rods move in.

Immutable.

Parameters
----------
eta : float
    lambda/mu, compression over shear modulus K/mu, above -1. Stable free-standing materials have eta > 0; -1 < eta < 0 is
    admissible only mathematically. Default 1.
xi : float
    Screening length mu/(zeta v0) in f/mu. Default 1.
alpha : float
    1/xi, instead of xi.
poisson_ratio : float
    Two-dimensional Poisson ratio p, -1 < p < 1, instead of eta = (1 + p)/(1 - p).
periodic : float or tuple of float
    Side of a periodic box in f/mu, or both, (Lx, Ly). Default: infinite plane.)";

} // namespace

void bind_medium(py::module_& module) {
    const py::none none;
    py::class_<Medium>(module, "Medium", about_medium)
        .def(py::init(&make_medium), py::kw_only(), py::arg("eta") = none, py::arg("xi") = none,
             py::arg("alpha") = none, py::arg("poisson_ratio") = none, py::arg("periodic") = none)
        .def_property_readonly(
            "eta", [](const Medium& m) { return m.elastic.eta; }, "lambda/mu = K/mu")
        .def_property_readonly(
            "xi", [](const Medium& m) { return m.elastic.xi; }, "screening length, f/mu")
        .def_property_readonly(
            "alpha", [](const Medium& m) { return 1.0 / m.elastic.xi; }, "1/xi, mu/f")
        .def_property_readonly(
            "poisson_ratio", [](const Medium& m) { return elastic::poisson_ratio(m.elastic.eta); },
            "(eta - 1)/(eta + 1), in two dimensions")
        .def_property_readonly("periodic", &sides_of,
                               "side of the periodic box, f/mu, or both; None: infinite plane")
        .def("__repr__", &text_of)
        .def("__eq__",
             [](const Medium& m, const py::object& other) {
                 return py::isinstance<Medium>(other) &&
                        values_of(m).equal(values_of(other.cast<const Medium&>()));
             })
        .def("__hash__", [](const Medium& m) { return py::hash(values_of(m)); })
        .def(py::pickle(&values_of, [](const py::tuple& values) {
            return make_medium(values[0], values[1], py::none(), py::none(), values[2]);
        }));
}

} // namespace rodwake::python
