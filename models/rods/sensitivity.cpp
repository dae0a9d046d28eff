#include "rodwake/rods/sensitivity.hpp"

#include "interaction.hpp"

#include "rodwake/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <vector>

namespace rodwake::rods {

namespace {

using integrate::State;
using Column = Eigen::Index;

bool of_medium(Parameter p) { return p == Parameter::eta || p == Parameter::xi; }
bool of_rows(Parameter p) { return p == Parameter::rows_gamma || p == Parameter::rows_direction; }
bool of_bodies(Parameter p) { return p == Parameter::stall_overlap || p == Parameter::mobility_ratio; }

/// The turning rate is linear in the couplings: its derivative by one is the rate with that one alone.
Couplings unit_coupling(Parameter p) {
    Couplings couplings;
    if (const Coupling* coupling = coupling_of(p))
        couplings.*coupling->number = 1.0;
    return couplings;
}

/// Derivatives of the right-hand side by couplings and medium.
class ParameterDerivatives {
public:
    ParameterDerivatives(const RodProblem& problem, std::span<const Parameter> parameters);
    void operator()(State y, Eigen::Ref<Eigen::MatrixXd> by_parameter) const;

private:
    void add_wakes(State y, Eigen::Ref<Eigen::MatrixXd> by_parameter) const;

    std::shared_ptr<const elastic::WakeField> field_;
    Couplings couplings_;
    Rows rows_;
    RodBodies bodies_;
    BodyForces contacts_, half_across_; ///< the latter with half the mobility across the rods
    std::vector<Parameter> parameters_;
    elastic::FieldRequest request_; ///< by the couplings among the parameters
    bool medium_wanted_ = false;    ///< eta or xi among them
};

ParameterDerivatives::ParameterDerivatives(const RodProblem& problem, std::span<const Parameter> parameters)
    : field_(wakes_of(problem)), couplings_(problem.couplings), rows_(problem.rows), bodies_(problem.bodies),
      contacts_(bodies_, problem.rods.size(), problem.box),
      parameters_(parameters.begin(), parameters.end()) {
    RodBodies half = bodies_;
    half.mobility_ratio /= 2.0;
    half_across_ = BodyForces(half, problem.rods.size(), problem.box);
    for (const Parameter p : parameters_) {
        request_.strain |= unit_coupling(p).apolar();
        request_.polar |= unit_coupling(p).polar();
        medium_wanted_ |= of_medium(p) && couplings_.any();
    }
}

void ParameterDerivatives::operator()(State y, Eigen::Ref<Eigen::MatrixXd> by_parameter) const {
    if (request_.strain || request_.polar || medium_wanted_)
        add_wakes(y, by_parameter);

    // Rates by contacts go as stall_overlap^(-3/2), and are linear in the mobility ratio.
    if (contacts_.any() && std::ranges::any_of(parameters_, of_bodies)) {
        std::vector<double> rates(y.size(), 0.0), half(y.size(), 0.0);
        contacts_.add_rates(y, rates);
        half_across_.add_rates(y, half);
        for (std::size_t j = 0; j < parameters_.size(); ++j)
            for (std::size_t i = 0; of_bodies(parameters_[j]) && i < y.size(); ++i)
                by_parameter(static_cast<Column>(i), static_cast<Column>(j)) +=
                    parameters_[j] == Parameter::stall_overlap
                        ? -1.5 * rates[i] / bodies_.stall_overlap
                        : (rates[i] - half[i]) / (0.5 * bodies_.mobility_ratio);
    }
    for (std::size_t j = 0; j < parameters_.size(); ++j)
        for (std::size_t a = 0; of_rows(parameters_[j]) && a < y.size() / 3; ++a)
            by_parameter(static_cast<Column>(3 * a + 2), static_cast<Column>(j)) =
                parameters_[j] == Parameter::rows_gamma ? Rows{1.0, rows_.direction}.rate(y[3 * a + 2])
                                                        : -rows_.rate_by_heading(y[3 * a + 2]);
}

void ParameterDerivatives::add_wakes(State y, Eigen::Ref<Eigen::MatrixXd> by_parameter) const {
    const std::size_t rods = y.size() / 3;
    const elastic::FieldRequest of_couplings = request_of(couplings_, false);
    std::vector<Direction> n;
    for (std::size_t a = 0; a < rods; ++a)
        n.push_back(direction(y, a));
    for (std::size_t b = 0; b < rods; ++b) {
        const auto wake = field_->wake(y[3 * b + 2]);
        for (std::size_t a = 0; a < rods; ++a) {
            const bool own = a == b; // then the wakes of its images
            if (own && !field_->box())
                continue;
            const View at = own ? View{0.0, 0.0, {1.0, 0.0}} : view(y, a, b, n[a], n[b]);
            elastic::FieldValues field;
            elastic::MediumDerivatives derivatives;
            if (request_.strain || request_.polar)
                field = own ? wake->self_image_field(request_) : wake->at(at.x, at.y, request_);
            if (medium_wanted_)
                derivatives = own ? wake->own_place_by_medium(of_couplings)
                                  : wake->medium_derivatives(at.x, at.y, of_couplings);
            for (std::size_t j = 0; j < parameters_.size(); ++j) {
                const Parameter p = parameters_[j];
                if (of_rows(p) || of_bodies(p))
                    continue;
                by_parameter(static_cast<Column>(3 * a + 2), static_cast<Column>(j)) +=
                    !of_medium(p) ? turning_rate(field, unit_coupling(p), at.heading)
                                  : turning_rate(p == Parameter::eta ? derivatives.by_eta : derivatives.by_xi,
                                                 couplings_, at.heading);
            }
        }
    }
}

void check(const RodProblem& problem, std::span<const Parameter> parameters,
           std::span<const std::size_t> headings, std::span<const std::size_t> indices) {
    if (!parameters.empty() && !problem.medium)
        throw InputError("sensitivities to couplings and medium need a medium; there is none");
    const auto field = wakes_of(problem);
    const elastic::FieldCapabilities can = field ? field->capabilities() : elastic::FieldCapabilities{};
    if (!can.gradients)
        throw InputError("sensitivities need a field with gradients");
    if (!can.medium_derivatives && std::ranges::any_of(parameters, of_medium))
        throw InputError("sensitivities to eta and xi need a field that can be differentiated by them: "
                         "the exact one");
    for (const std::size_t rod : headings)
        if (rod >= problem.rods.size())
            throw InputError(
                fmt::format("the heading of rods[{}] is to be a parameter, but there are {} rods", rod,
                            problem.rods.size()));
    for (const std::size_t index : indices)
        if (index / 2 >= problem.rods.size())
            throw InputError(
                fmt::format("the position of rods[{}] is to be a parameter, but there are {} rods", index / 2,
                            problem.rods.size()));
}

} // namespace

double& value(RodProblem& problem, Parameter parameter) {
    if (of_medium(parameter) && !problem.medium)
        throw InputError("eta and xi belong to a medium; there is none");
    if (const Coupling* coupling = coupling_of(parameter))
        return problem.couplings.*coupling->number;
    if (of_rows(parameter))
        return parameter == Parameter::rows_gamma ? problem.rows.gamma : problem.rows.direction;
    if (of_bodies(parameter))
        return parameter == Parameter::stall_overlap ? problem.bodies.stall_overlap
                                                     : problem.bodies.mobility_ratio;
    return parameter == Parameter::eta ? problem.medium->eta : problem.medium->xi;
}

double value(const RodProblem& problem, Parameter parameter) {
    return value(const_cast<RodProblem&>(problem), parameter); // which changes nothing
}

integrate::SensitivityProblem to_sensitivity_problem(const RodProblem& problem,
                                                     std::span<const Parameter> parameters,
                                                     std::span<const std::size_t> headings,
                                                     std::span<const std::size_t> indices) {
    check(problem, parameters, headings, indices);
    integrate::SensitivityProblem result;
    result.ode = to_ode(problem);
    if (problem.rods.size() > 1 && !problem.bodies.any()) // whose own limit is there
        result.ode.step_limit = step_limit(problem);
    result.parameters = parameters.size() + headings.size() + indices.size();
    // NOLINTBEGIN(performance-unnecessary-value-param): an Eigen::Ref is a view, and the signature is the
    // problem's
    result.by_parameter = [](double, State, Eigen::Ref<Eigen::MatrixXd>) {
    }; // headings and places act at the start alone
    if (!parameters.empty()) {
        const auto derivatives = std::make_shared<const ParameterDerivatives>(problem, parameters);
        result.by_parameter = [derivatives](double, State y, Eigen::Ref<Eigen::MatrixXd> by_parameter) {
            (*derivatives)(y, by_parameter);
        };
    }
    // NOLINTEND(performance-unnecessary-value-param)
    for (const Parameter p : parameters)
        result.parameter_scale.push_back(std::max(1.0, std::abs(value(problem, p))));
    result.parameter_scale.resize(result.parameters, 1.0);

    // Headings and places are the initial state.
    result.initial = Eigen::MatrixXd::Zero(static_cast<Column>(3 * problem.rods.size()),
                                           static_cast<Column>(result.parameters));
    auto column = static_cast<Column>(parameters.size());
    for (const std::size_t rod : headings)
        result.initial(static_cast<Column>(3 * rod + 2), column++) = 1.0;
    for (const std::size_t index : indices)
        result.initial(static_cast<Column>(3 * (index / 2) + index % 2), column++) = 1.0;

    // The derivative of the closest pair's separation by the state.
    const auto contact_gradient = [box = problem.box](double, State y) {
        const Separation pair = closest_pair(y, box);
        const Offset d = offset(y, pair.first, pair.second, box);
        const auto a = static_cast<Column>(3 * pair.first), b = static_cast<Column>(3 * pair.second);
        Eigen::VectorXd gradient = Eigen::VectorXd::Zero(static_cast<Column>(y.size()));
        gradient.segment<2>(a) = Eigen::Vector2d(d.x, d.y) / pair.distance;
        gradient.segment<2>(b) = -gradient.segment<2>(a);
        return gradient;
    };
    result.event_gradient.assign(result.ode.events.size(), contact_gradient);
    return result;
}

} // namespace rodwake::rods
