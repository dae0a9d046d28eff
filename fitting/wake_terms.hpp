#pragma once
// Which terms of the wake take part, and the field they need: the model of wake.hpp at one set of parameter
// values.

#include "rodwake/elastic/wake_field.hpp"
#include "rodwake/fitting/wake.hpp"

#include <memory>

namespace rodwake::fitting {

/// Places of the known names in the list of parameters; -1: absent.
struct WakeTerms {
    long f_over_mu = -1, f2d_over_mu = -1, eta = -1, xi = -1, alpha = -1, x0 = -1, offset = -1, offset_y = -1;

    bool field() const { return f_over_mu >= 0 || f2d_over_mu >= 0; }
};

/// Throws InputError for names that are unknown or missing.
WakeTerms wake_terms(const std::vector<Parameter>& parameters);

/// Screening length of these values: xi itself or f_over_mu/alpha.
double screening_length(const WakeTerms& terms, std::span<const double> values);

/// The model at one set of values.
class WakeValues {
public:
    /// Throws InputError for a medium that cannot be.
    WakeValues(const WakeModel& model, const WakeTerms& terms, std::span<const double> values);

    double at(Component component, double x, double y) const;
    /// The value, and its derivatives by all parameters into `gradient`.
    double at(Component component, double x, double y, Eigen::Ref<Eigen::RowVectorXd> gradient) const;

private:
    double value_of(long term) const { return term < 0 ? 0.0 : values_[static_cast<std::size_t>(term)]; }
    double offset(Component component) const;
    /// Of the terms that take part: the field holds no number for the others.
    double combined(const elastic::FieldValues& of, Component component) const;
    double field_at(Component component, double s, double y) const;
    double slope_along_x(Component component, double s, double y) const;

    WakeTerms terms_;
    std::span<const double> values_;
    double xi_ = 0.0;
    elastic::FieldRequest request_;
    std::shared_ptr<const elastic::Wake> wake_; ///< none: no term needs it
};

} // namespace rodwake::fitting
