#include "wake_terms.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rodwake::fitting {

namespace {

double part(const elastic::Vector& v, Component component) { return component == Component::Ux ? v.x : v.y; }

long* slot(WakeTerms& terms, const std::string& name) {
    long* slots[] = {&terms.f_over_mu, &terms.f2d_over_mu, &terms.eta,    &terms.xi,
                     &terms.alpha,     &terms.x0,          &terms.offset, &terms.offset_y};
    const auto names = wake_parameter_names();
    const auto found = std::ranges::find(names, name);
    return found == names.end() ? nullptr : slots[found - names.begin()];
}

void require_medium(const WakeTerms& terms) {
    if (!terms.field())
        return;
    if (terms.eta < 0)
        throw InputError(
            "eta is needed by monopole and dipole: make it a parameter, or give it a fixed value");
    if ((terms.xi < 0) == (terms.alpha < 0))
        throw InputError(
            "monopole and dipole need exactly one of xi and alpha, as a parameter or with a fixed value");
    if (terms.alpha >= 0 && terms.f_over_mu < 0)
        throw InputError("alpha = f_over_mu/xi needs f_over_mu; without a monopole use xi");
}

} // namespace

std::vector<std::string> wake_parameter_names() {
    return {"f_over_mu", "f2d_over_mu", "eta", "xi", "alpha", "x0", "offset", "offset_y"};
}

WakeTerms wake_terms(const std::vector<Parameter>& parameters) {
    WakeTerms terms;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        long* place = slot(terms, parameters[i].name);
        if (!place)
            throw InputError(fmt::format("unknown parameter \"{}\" of a wake; known: {}", parameters[i].name,
                                         fmt::join(wake_parameter_names(), ", ")));
        *place = static_cast<long>(i);
    }
    require_medium(terms);
    return terms;
}

double screening_length(const WakeTerms& terms, std::span<const double> values) {
    const auto value = [&](long term) { return values[static_cast<std::size_t>(term)]; };
    return terms.xi >= 0 ? value(terms.xi) : value(terms.f_over_mu) / value(terms.alpha);
}

WakeValues::WakeValues(const WakeModel& model, const WakeTerms& terms, std::span<const double> values)
    : terms_(terms), values_(values) {
    request_ = {.displacement = terms.f_over_mu >= 0, .dipole = terms.f2d_over_mu >= 0};
    if (!terms.field())
        return;
    xi_ = screening_length(terms, values);
    wake_ = elastic::exact_field({value_of(terms.eta), xi_}, model.box)->wake(model.heading);
}

double WakeValues::offset(Component component) const {
    return value_of(component == Component::Ux ? terms_.offset : terms_.offset_y);
}

double WakeValues::combined(const elastic::FieldValues& of, Component component) const {
    return (request_.displacement ? value_of(terms_.f_over_mu) * part(of.displacement, component) : 0.0) +
           (request_.dipole ? value_of(terms_.f2d_over_mu) * part(of.dipole, component) : 0.0);
}

/// Monopole and dipole at s from where the force acts.
double WakeValues::field_at(Component component, double s, double y) const {
    return combined(wake_->at(s, y, request_), component);
}

double WakeValues::at(Component component, double x, double y) const {
    return (wake_ ? field_at(component, x - value_of(terms_.x0), y) : 0.0) + offset(component);
}

/// Fourth-order differences: the strain lacks the rotation that d U_y/dx needs. The field is smooth on the
/// scale of the distance and good to 1e-15, so this is good to about 1e-11.
double WakeValues::slope_along_x(Component component, double s, double y) const {
    const double h = 2e-3 * std::hypot(s, y);
    const auto difference = [&](double d) {
        return field_at(component, s + d, y) - field_at(component, s - d, y);
    };
    return (8.0 * difference(h) - difference(2.0 * h)) / (12.0 * h);
}

double WakeValues::at(Component component, double x, double y,
                      Eigen::Ref<Eigen::RowVectorXd> gradient) const {
    gradient.setZero();
    const auto set = [&](long term, double value) {
        if (term >= 0)
            gradient[term] = value;
    };
    set(component == Component::Ux ? terms_.offset : terms_.offset_y, 1.0);
    if (!wake_)
        return offset(component);
    const double s = x - value_of(terms_.x0), f = value_of(terms_.f_over_mu);
    const elastic::FieldValues field = wake_->at(s, y, request_);
    const elastic::MediumDerivatives medium = wake_->by_medium(s, y, request_);
    const double by_xi = combined(medium.by_xi, component);
    set(terms_.f_over_mu, part(field.displacement, component) + (terms_.alpha >= 0 ? by_xi * xi_ / f : 0.0));
    set(terms_.f2d_over_mu, part(field.dipole, component));
    set(terms_.eta, combined(medium.by_eta, component));
    set(terms_.xi, by_xi);
    if (terms_.alpha >= 0)
        set(terms_.alpha, -by_xi * xi_ / value_of(terms_.alpha));
    if (terms_.x0 >= 0)
        set(terms_.x0, -slope_along_x(component, s, y));
    return combined(field, component) + offset(component);
}

} // namespace rodwake::fitting
