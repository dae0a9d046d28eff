// Residuals of profiles against the field of a moving rod.

#include "rodwake/fitting/wake.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/elastic/wake_field.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

namespace rodwake::fitting {

std::vector<std::string> wake_parameter_names() {
    return {"f_over_mu", "f2d_over_mu", "eta", "xi", "alpha", "x0", "offset", "offset_y"};
}

namespace {

/// Index of each known name among the parameters; -1: absent.
struct WakeTerms {
    long f_over_mu = -1, f2d_over_mu = -1, eta = -1, xi = -1, alpha = -1, x0 = -1, offset = -1, offset_y = -1;

    bool field() const { return f_over_mu >= 0 || f2d_over_mu >= 0; }
};

/// Throws InputError for names that are unknown or missing.
WakeTerms wake_terms(const std::vector<Parameter>& parameters) {
    WakeTerms terms;
    long* const indices[] = {&terms.f_over_mu, &terms.f2d_over_mu, &terms.eta,    &terms.xi,
                             &terms.alpha,     &terms.x0,          &terms.offset, &terms.offset_y};
    const auto names = wake_parameter_names();
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const auto at = std::ranges::find(names, parameters[i].name);
        if (at == names.end())
            throw InputError(fmt::format("unknown parameter \"{}\" of a wake; known: {}", parameters[i].name,
                                         fmt::join(names, ", ")));
        *indices[at - names.begin()] = static_cast<long>(i);
    }
    if (!terms.field())
        return terms;
    if (terms.eta < 0)
        throw InputError(
            "eta is needed by monopole and dipole: make it a parameter, or give it a fixed value");
    if ((terms.xi < 0) == (terms.alpha < 0))
        throw InputError(
            "monopole and dipole need exactly one of xi and alpha, as a parameter or with a fixed value");
    if (terms.alpha >= 0 && terms.f_over_mu < 0)
        throw InputError("alpha = f_over_mu/xi needs f_over_mu; without a monopole use xi");
    return terms;
}

double part(const elastic::Vector& v, Component component) { return component == Component::Ux ? v.x : v.y; }

/// The model of wake.hpp at one set of values.
class WakeValues {
public:
    /// Throws InputError for an illegal medium.
    WakeValues(const WakeModel& model, const WakeTerms& terms, std::span<const double> values)
        : terms_(terms), values_(values) {
        request_ = {.displacement = terms.f_over_mu >= 0, .dipole = terms.f2d_over_mu >= 0};
        if (!terms.field())
            return;
        xi_ = terms.xi >= 0 ? value_of(terms.xi) : value_of(terms.f_over_mu) / value_of(terms.alpha);
        wake_ = elastic::exact_field({value_of(terms.eta), xi_}, model.box)->wake(model.heading);
    }

    /// The value and, if `gradient` is given, its derivatives by all parameters.
    double at(Component component, double x, double y, Eigen::RowVectorXd* gradient) const {
        const long offset = component == Component::Ux ? terms_.offset : terms_.offset_y;
        const auto set = [&](long term, double value) {
            if (term >= 0)
                (*gradient)[term] = value;
        };
        if (gradient) {
            gradient->setZero();
            set(offset, 1.0);
        }
        if (!wake_)
            return value_of(offset);
        const double s = x - value_of(terms_.x0), f = value_of(terms_.f_over_mu);
        const elastic::FieldValues field = wake_->at(s, y, request_);
        const double value = combined(field, component) + value_of(offset);
        if (!gradient)
            return value;
        const elastic::MediumDerivatives medium = wake_->medium_derivatives(s, y, request_);
        const double by_xi = combined(medium.by_xi, component);
        set(terms_.f_over_mu,
            part(field.displacement, component) + (terms_.alpha >= 0 ? by_xi * xi_ / f : 0.0));
        set(terms_.f2d_over_mu, part(field.dipole, component));
        set(terms_.eta, combined(medium.by_eta, component));
        set(terms_.xi, by_xi);
        if (terms_.alpha >= 0)
            set(terms_.alpha, -by_xi * xi_ / value_of(terms_.alpha));

        // The derivative by x0 from differences of fourth order, since the strain lacks the rotation that
        // dU_y/dx needs. The field is smooth on the scale of the distance and good to 1e-15, the derivative
        // to 1e-11.
        if (terms_.x0 >= 0) {
            const double h = 2e-3 * std::hypot(s, y);
            const auto difference = [&](double d) {
                return combined(wake_->at(s + d, y, request_), component) -
                       combined(wake_->at(s - d, y, request_), component);
            };
            set(terms_.x0, -((8.0 * difference(h) - difference(2.0 * h)) / (12.0 * h)));
        }
        return value;
    }

private:
    double value_of(long term) const { return term < 0 ? 0.0 : values_[static_cast<std::size_t>(term)]; }
    /// Sum of the requested terms: the field holds no number for the others.
    double combined(const elastic::FieldValues& field, Component component) const {
        return (request_.displacement ? value_of(terms_.f_over_mu) * part(field.displacement, component)
                                      : 0.0) +
               (request_.dipole ? value_of(terms_.f2d_over_mu) * part(field.dipole, component) : 0.0);
    }
    WakeTerms terms_;
    std::span<const double> values_;
    double xi_ = 0.0;
    elastic::FieldRequest request_;
    std::shared_ptr<const elastic::Wake> wake_; ///< null: no term needs it
};

struct ProfilePoint {
    Component component;
    double x, y, value, sigma;
    std::string where;
};

std::pair<double, double> coordinates(const Profile& line, double position) {
    return line.along == Axis::x ? std::pair(position, line.at) : std::pair(line.at, position);
}

std::string where(const Profile& profile, std::size_t i) {
    return i < profile.where.size() ? profile.where[i] : fmt::format("{}[{}]", profile.name, i);
}

/// The points that are fitted. Throws InputError for illegal data.
std::vector<ProfilePoint> gather(const WakeModel& model, const WakeTerms& terms,
                                 const std::vector<Profile>& profiles) {
    std::vector<ProfilePoint> points;
    for (const Profile& profile : profiles) {
        if (profile.place.size() != profile.value.size() ||
            (!profile.sigma.empty() && profile.sigma.size() != profile.place.size()))
            throw InputError(profile.name + ": positions, values and sigmas differ in number");
        if (!std::isfinite(profile.at))
            throw InputError(profile.name + ": the line's other coordinate must be a finite number");
        if (!(profile.independent > 0.0 && profile.independent <= 1.0))
            throw InputError(
                fmt::format("{}: independent = {}: a point is worth more than 0 and at most 1 value",
                            profile.name, profile.independent));
        for (std::size_t i = 0; i < profile.place.size(); ++i) {
            if (!std::isfinite(profile.place[i]) || !std::isfinite(profile.value[i]))
                throw InputError(where(profile, i) + ": position and value must be finite numbers");
            const double sigma = profile.sigma.empty() ? 1.0 : profile.sigma[i];
            if (!(sigma > 0.0) || !std::isfinite(sigma))
                throw InputError(fmt::format(
                    "{}: sigma = {}: must be above 0; leave the column out if the errors are unknown",
                    where(profile, i), sigma));
        }
        const Profile kept = outside_core(profile, model.core);
        if (kept.place.empty())
            throw InputError(
                fmt::format("{}: no points are left outside the core of {}", profile.name, model.core));
        for (std::size_t i = 0; i < kept.place.size(); ++i) {
            const auto [x, y] = coordinates(kept, kept.place[i]);
            points.push_back({kept.component, x, y, kept.value[i], residual_scale(kept, i), where(kept, i)});
        }
    }
    if (points.empty())
        throw InputError("there are no data to fit");
    if (points.size() > 1 && std::ranges::all_of(points, [&](const ProfilePoint& point) {
            return point.value == points.front().value;
        }))
        throw InputError(fmt::format("all {} values are equal ({}): there is nothing to fit", points.size(),
                                     points.front().value));

    // At these points the model is infinite for any parameters. With a free x0 they are not known beforehand.
    for (const ProfilePoint& point : points) {
        if (!terms.field() || terms.x0 >= 0 ||
            !elastic::is_singular(point.x, point.y, model.box, model.heading))
            continue;
        if (!model.box || std::hypot(point.x, point.y) < 0.5 * model.box->shorter())
            throw InputError(
                point.where +
                ": the model is infinite at the rod's centre; a core above 0 leaves this point out");
        throw InputError(
            fmt::format("{}: ({:g}, {:g}) is the position of an image of the rod in the box of {}, where "
                        "the model is infinite; leave this point out, by the profile's range for one",
                        point.where, point.x, point.y, to_string(*model.box)));
    }
    return points;
}

} // namespace

double residual_scale(const Profile& profile, std::size_t i) {
    const double worth = profile.worth.empty() ? profile.independent : profile.worth[i];
    return 1.0 / std::sqrt(worth) * (profile.sigma.empty() ? 1.0 : profile.sigma[i]);
}

double chi2_of(const Profile& profile, std::span<const double> model) {
    if (model.size() != profile.value.size())
        throw InputError(profile.name + ": data and prediction differ in number");
    double sum = 0.0;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const double r = (profile.value[i] - model[i]) / residual_scale(profile, i);
        sum += std::isfinite(r) ? r * r : 0.0;
    }
    return sum;
}

void share_data(Profile& profile, double spacing) {
    const auto finite = [](double position) { return std::isfinite(position); };
    if (profile.place.empty() || !std::ranges::all_of(profile.place, finite))
        return; // refused with the rest of the data
    profile.worth = independent_worth(profile.place, spacing);
    profile.independent = mean_worth(profile.worth);
}

Profile outside_core(const Profile& profile, double core) {
    Profile kept = profile;
    kept.place.clear(), kept.value.clear(), kept.sigma.clear(), kept.where.clear(), kept.worth.clear();
    for (std::size_t i = 0; i < profile.place.size(); ++i) {
        if (std::abs(profile.place[i]) < core)
            continue;
        kept.place.push_back(profile.place[i]);
        kept.value.push_back(profile.value[i]);
        if (!profile.sigma.empty())
            kept.sigma.push_back(profile.sigma[i]);
        kept.where.push_back(where(profile, i));
        if (!profile.worth.empty())
            kept.worth.push_back(profile.worth[i]);
    }
    if (!kept.worth.empty())
        kept.independent = mean_worth(kept.worth);
    return kept;
}

Problem wake_problem(const WakeModel& model, const std::vector<Profile>& profiles,
                     std::vector<Parameter> parameters) {
    if (model.box && !valid_sides(*model.box))
        throw InputError(
            fmt::format("box = {}: the sides of the periodic box must be above 0", to_string(*model.box)));
    if (!(model.core >= 0.0) || !std::isfinite(model.heading))
        throw InputError("core must be 0 or more, and the heading a finite number");
    const WakeTerms terms = wake_terms(parameters);
    auto points = std::make_shared<const std::vector<ProfilePoint>>(gather(model, terms, profiles));
    Problem problem;
    problem.parameters = std::move(parameters);
    problem.residuals = points->size();
    const auto with = std::ranges::count_if(profiles, [](const Profile& p) { return !p.sigma.empty(); });
    if (with != 0 && with != static_cast<long>(profiles.size()))
        throw InputError(
            "some profiles have a column sigma and some have none: their weights cannot be compared; "
            "give all of them one, or none");
    problem.sigma_known = with != 0;
    for (const ProfilePoint& point : *points)
        problem.log_sigma.push_back(std::log(point.sigma));
    std::size_t first = 0;
    double values = 0.0; // independent ones
    for (const Profile& profile : profiles) {
        const Profile kept = outside_core(profile, model.core);
        values += kept.independent * static_cast<double>(kept.place.size());
        Series series{profile.name, "values", std::vector<std::size_t>(kept.place.size())};
        std::iota(series.residuals.begin(), series.residuals.end(), first);
        first += series.residuals.size();
        problem.series.push_back(std::move(series));
    }
    problem.independent = values / static_cast<double>(first);
    // NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
    problem.evaluate = [=](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                           Eigen::MatrixXd* jacobian) {
        const WakeValues wake(model, terms, p);
        Eigen::RowVectorXd gradient(static_cast<Eigen::Index>(p.size()));
        for (std::size_t i = 0; i < points->size(); ++i) {
            const ProfilePoint& point = (*points)[i];
            const auto row = static_cast<Eigen::Index>(i);
            const double value = wake.at(point.component, point.x, point.y, jacobian ? &gradient : nullptr);
            r[row] = (value - point.value) / point.sigma;
            if (jacobian)
                jacobian->row(row) = gradient / point.sigma;
        }
    };
    problem.residual_name = [points](std::size_t i) { return (*points)[i].where; };
    validate(problem);
    return problem;
}

Prediction predict(const WakeModel& model, const Profile& line, std::span<const double> positions,
                   const std::vector<Parameter>& parameters, std::span<const double> values) {
    const WakeTerms terms = wake_terms(parameters);
    const WakeValues wake(model, terms, values);
    const auto rows = static_cast<Eigen::Index>(positions.size()),
               columns = static_cast<Eigen::Index>(values.size());
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    Prediction out{{}, Eigen::MatrixXd::Constant(rows, columns, nan)};
    Eigen::RowVectorXd gradient(columns);
    for (Eigen::Index i = 0; i < rows; ++i) {
        const auto [x, y] = coordinates(line, positions[static_cast<std::size_t>(i)]);
        const double x0 = terms.x0 < 0 ? 0.0 : values[static_cast<std::size_t>(terms.x0)];
        if (terms.field() && elastic::is_singular(x - x0, y, model.box, model.heading)) {
            out.value.push_back(nan);
            continue;
        }
        out.value.push_back(wake.at(line.component, x, y, &gradient));
        out.by_parameter.row(i) = gradient;
    }
    return out;
}

ScaleFactor scale_factor(const Profile& data, std::span<const double> model,
                         const Eigen::MatrixXd* model_root) {
    const auto n = static_cast<Eigen::Index>(data.value.size());
    if (static_cast<Eigen::Index>(model.size()) != n)
        throw InputError(data.name + ": data and prediction differ in number");
    const Eigen::Map<const Eigen::VectorXd> d(data.value.data(), n), m(model.data(), n);
    Eigen::VectorXd weight(n);
    const double values = data.independent * static_cast<double>(n);
    for (Eigen::Index i = 0; i < n; ++i)
        weight[i] = std::pow(residual_scale(data, static_cast<std::size_t>(i)), -2.0);
    const double norm = weight.dot(m.cwiseAbs2());
    ScaleFactor out;
    out.points = data.value.size();
    out.chi2 = weight.dot((d - m).cwiseAbs2());
    if (!(norm > 0.0))
        throw InputError(data.name + ": the prediction is zero everywhere, so no factor can be computed");
    out.scale = weight.dot(m.cwiseProduct(d)) / norm;
    const double scatter = weight.dot((d - out.scale * m).cwiseAbs2()) / std::max(values - 1.0, 1.0);
    // If the shape differs, or sigma is unknown, the scatter about the scaled model replaces sigma.
    double variance = (data.sigma.empty() ? scatter : std::max(scatter, 1.0)) / norm;
    if (model_root) {
        const Eigen::VectorXd by_model = weight.cwiseProduct(d - 2.0 * out.scale * m) / norm;
        variance += (model_root->transpose() * by_model).squaredNorm();
    }
    out.standard_error = std::sqrt(variance);
    return out;
}

} // namespace rodwake::fitting
