// Several kinds of data as one problem.

#include "rodwake/fitting/trajectory.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace rodwake::fitting {

namespace {

/// One of the problems, and which parameter of the whole each of its parameters is.
struct Part {
    Problem problem;
    std::vector<std::size_t> index;
    std::size_t first_residual = 0;
};

bool agree(const Parameter& a, const Parameter& b) {
    return a.start == b.start && a.lower == b.lower && a.upper == b.upper && a.transform == b.transform &&
           a.scale == b.scale && a.fixed == b.fixed && a.tied_to == b.tied_to && a.tie_factor == b.tie_factor;
}

std::size_t slot_of(const Parameter& parameter, std::vector<Parameter>& all) {
    const auto found = std::ranges::find(all, parameter.name, &Parameter::name);
    if (found == all.end()) {
        all.push_back(parameter);
        return all.size() - 1;
    }
    if (!agree(*found, parameter))
        throw InputError(
            fmt::format("fit: parameter {} has another start, bounds, scale or tie in one kind of "
                        "data than in the other; it must be the same",
                        parameter.name));
    return static_cast<std::size_t>(found - all.begin());
}

void evaluate(const Part& part, std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
              Eigen::MatrixXd* jacobian) {
    const auto rows = static_cast<Eigen::Index>(part.problem.residuals),
               first = static_cast<Eigen::Index>(part.first_residual);
    std::vector<double> own;
    for (const std::size_t j : part.index)
        own.push_back(p[j]);
    Eigen::MatrixXd slopes;
    if (jacobian)
        slopes.setZero(rows, static_cast<Eigen::Index>(own.size()));
    part.problem.evaluate(own, r.segment(first, rows), jacobian ? &slopes : nullptr);
    for (std::size_t j = 0; jacobian && j < own.size(); ++j)
        jacobian->col(static_cast<Eigen::Index>(part.index[j])).segment(first, rows) =
            slopes.col(static_cast<Eigen::Index>(j));
}

std::string name_of(const std::vector<Part>& parts, std::size_t i) {
    const Part* of = &parts.front();
    for (const Part& part : parts)
        if (part.first_residual <= i)
            of = &part;
    const std::size_t own = i - of->first_residual;
    return of->problem.residual_name ? of->problem.residual_name(own) : fmt::format("{}", own);
}

} // namespace

Problem joined(const std::vector<Problem>& problems) {
    if (problems.empty())
        throw InputError("fit: there are no data");
    Problem whole;
    whole.sigma_known = problems.front().sigma_known;
    double values = 0.0;
    const auto parts = std::make_shared<std::vector<Part>>();
    for (const Problem& problem : problems) {
        if (problem.sigma_known != whole.sigma_known)
            throw InputError(
                "fit: standard errors are known for one kind of data and not for the other: their "
                "weights cannot be compared; give all of them, or none");
        Part part{problem, {}, whole.residuals};
        for (const Parameter& parameter : problem.parameters)
            part.index.push_back(slot_of(parameter, whole.parameters));
        whole.residuals += problem.residuals;
        whole.remarks.insert(whole.remarks.end(), problem.remarks.begin(), problem.remarks.end());
        values += problem.independent * static_cast<double>(problem.residuals);
        parts->push_back(std::move(part));
    }
    whole.independent = whole.residuals > 0 ? values / static_cast<double>(whole.residuals) : 1.0;
    whole.evaluate = [parts](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                             Eigen::MatrixXd* jacobian) {
        if (jacobian)
            jacobian->setZero();
        for (const Part& part : *parts)
            evaluate(part, p, r, jacobian);
    };
    whole.residual_name = [parts](std::size_t i) { return name_of(*parts, i); };
    return whole;
}

} // namespace rodwake::fitting
