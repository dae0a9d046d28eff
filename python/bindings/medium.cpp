#include "medium.hpp"

#include "bind.hpp"
#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"

#include <pybind11/stl.h>

#include <utility>
#include <variant>

namespace rodwake::python {

namespace {

using Number = std::optional<double>;
using Sides = std::optional<std::variant<double, std::pair<double, double>>>;

std::optional<PeriodicBox> box_of(const Sides& sides) {
    if (!sides)
        return std::nullopt;
    const auto* side = std::get_if<double>(&*sides);
    const auto* both = std::get_if<std::pair<double, double>>(&*sides);
    const PeriodicBox box = side ? PeriodicBox(*side) : PeriodicBox(both->first, both->second);
    if (!valid_sides(box))
        throw InputError("periodic = " + to_string(box) + ": the sides of a box are above 0");
    return box;
}

/// A square by its side.
py::object sides_of(const Medium& m) {
    if (!m.box)
        return py::none();
    return m.box->square() ? py::object(py::float_(m.box->x))
                           : py::object(py::make_tuple(m.box->x, m.box->y));
}

double eta_of(const Number& eta, const Number& poisson_ratio) {
    if (eta && poisson_ratio)
        throw InputError("eta and poisson_ratio are two names of one number: give one of them");
    return poisson_ratio ? elastic::eta_from_poisson_ratio(*poisson_ratio) : eta.value_or(1.0);
}

double xi_of(const Number& xi, const Number& alpha) {
    if (xi && alpha)
        throw InputError("xi and alpha = 1/xi are two names of one number: give one of them");
    return alpha ? elastic::xi_from_alpha(*alpha) : xi.value_or(1.0);
}

Medium make_medium(const Number& eta, const Number& xi, const Number& alpha, const Number& poisson_ratio,
                   const Sides& periodic) {
    const Medium medium{{eta_of(eta, poisson_ratio), xi_of(xi, alpha)}, box_of(periodic)};
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

eta       lambda/mu, compression over shear modulus K/mu; above -1
xi        screening length mu/(zeta v0) in f/mu; above 0. Or alpha = 1/xi
periodic  side of a periodic box in f/mu, or both, (Lx, Ly); None: infinite plane

poisson_ratio gives eta = (1 + p)/(1 - p) instead. Without arguments eta = 1, xi = 1. Immutable.)";

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
            return make_medium(values[0].cast<double>(), values[1].cast<double>(), {}, {},
                               values[2].cast<Sides>());
        }));
}

} // namespace rodwake::python
