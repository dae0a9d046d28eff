// Fixed points of a pair's flow and their branches, as tuples that rodwake/equilibria.py gives names.

#include "arrays.hpp"
#include "bind.hpp"
#include "rod_problem.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/rods/pair_branches.hpp"

#include <pybind11/complex.h>
#include <pybind11/stl.h>

namespace rodwake::python {

namespace {

/// The plane: images of rods have no fixed points in common with it.
const elastic::Medium& plane(const Medium& medium) {
    if (medium.box)
        throw InputError(
            "medium: fixed points of a pair are those on the infinite plane; give no `periodic`");
    return medium.elastic;
}

py::tuple described(const rods::PairEquilibrium& e) {
    return py::make_tuple(to_string(e.kind), std::array{e.pose.x, e.pose.y, e.pose.heading},
                          std::pair(e.separation[0], e.separation[1]), e.omega, e.eigenvalues, e.stable());
}

std::vector<py::tuple> equilibria(const Medium& medium, double kappa, double gamma1, double gamma2) {
    std::vector<rods::PairEquilibrium> found;
    {
        const py::gil_scoped_release release;
        found = rods::pair_equilibria(plane(medium), {kappa, gamma1, gamma2});
    }
    std::vector<py::tuple> list;
    for (const rods::PairEquilibrium& equilibrium : found)
        list.push_back(described(equilibrium));
    return list;
}

std::vector<py::tuple> branches(const Medium& medium, double kappa, double gamma1, double gamma2,
                                const std::string& over, double least, double most) {
    std::vector<rods::PairBranch> found;
    {
        const py::gil_scoped_release release;
        found = rods::pair_branches(plane(medium), {kappa, gamma1, gamma2}, rods::branch_parameter(over),
                                    least, most);
    }
    std::vector<py::tuple> list;
    for (const rods::PairBranch& branch : found) {
        std::vector<double> parameters;
        std::vector<py::tuple> points;
        std::vector<std::size_t> folds;
        for (const rods::BranchPoint& point : branch.points) {
            if (point.fold)
                folds.push_back(points.size());
            parameters.push_back(point.parameter);
            points.push_back(described(point.equilibrium));
        }
        list.push_back(
            py::make_tuple(parameters, points, folds, std::pair(branch.first_end, branch.last_end)));
    }
    return list;
}

py::tuple flow(const std::array<double, 3>& pose, const Medium& medium, double kappa, double gamma1,
               double gamma2) {
    const rods::PairFlow at =
        rods::pair_flow(plane(medium), {kappa, gamma1, gamma2}, {pose[0], pose[1], pose[2]});
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> jacobian = at.by_pose;
    return py::make_tuple(Array(3, at.rates.data()), Array({3, 3}, jacobian.data()));
}

} // namespace

void bind_equilibria(py::module_& module) {
    module.def("pair_equilibria", &equilibria);
    module.def("pair_branches", &branches);
    module.def("pair_flow", &flow);
}

} // namespace rodwake::python
