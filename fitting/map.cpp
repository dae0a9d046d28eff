// Residuals of maps against the field of a rod in an orthotropic medium.

#include "rodwake/fitting/map.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

namespace rodwake::fitting {

// The model of a map: which parameters it has, and its values and derivatives at all bins.

/// Index of each among the parameters; -1: absent. In the order of map_parameter_names.
struct MapTerms {
    std::array<long, 25> index;

    bool has(std::size_t term) const { return index[term] >= 0; }
    double value(std::span<const double> p, std::size_t term, double absent) const {
        return index[term] < 0 ? absent : p[static_cast<std::size_t>(index[term])];
    }
};

/// Throws InputError for names that are unknown and for missing ones.
MapTerms map_terms(const std::vector<Parameter>& parameters);

class MapField {
public:
    MapField(const MapModel& model, const Map& map, const MapTerms& terms);

    /// From here on the constants of the medium are those of `p`, worked out once.
    void hold_medium(std::span<const double> p);

    elastic::DisplacementMap at(std::span<const double> p) const;
    /// By the parameter that is this term.
    elastic::DisplacementMap derivative(std::span<const double> p, std::size_t term) const;

private:
    using Basis = std::array<elastic::DisplacementMap, 10>;
    Basis basis(std::span<const double> p) const;
    elastic::RodSource source(std::span<const double> p) const;
    elastic::DisplacementMap unit(std::span<const double> p, std::size_t k) const;

    MapTerms terms_;
    elastic::AnisotropicField field_;
    std::size_t bins_;
    std::optional<Basis> held_; ///< of unit sources, from force to h_xxxyy
};

namespace {

bool isotropic(const MapTerms& terms);

/// A map, what of it is fitted, and where its residuals begin: first all U_x, then all U_y.
struct Fitted {
    Map map;
    std::vector<std::size_t> bins;
    MapField field;
    std::size_t first = 0;
    std::size_t like = 0; ///< the first map that has the same model, this one or one before
};

/// With `alike` the speed counts for its sign alone.
bool same_model(const Map& a, const Map& b, bool alike) {
    const auto speed = [&](const Map& map) { return alike ? std::copysign(1.0, map.speed) : map.speed; };
    return a.lx == b.lx && a.ly == b.ly && speed(a) == speed(b) && a.x == b.x && a.y == b.y;
}

void check_lists(const Map& map) {
    const auto wrong = [&](const auto& list) { return list.size() != map.bins(); };
    const auto wrong_sigma = [&](const auto& list) { return !list.empty() && wrong(list); };
    if (wrong(map.Ux) || wrong(map.Uy) || wrong(map.known) || wrong_sigma(map.sigma_x) ||
        map.sigma_x.size() != map.sigma_y.size())
        throw InputError(map.name + ": displacements, sigmas and the grid of the map differ in number");
    if (!(map.independent > 0.0 && map.independent <= 1.0))
        throw InputError(fmt::format("{}: independent = {}: a bin is worth more than 0 and at most 1 value",
                                     map.name, map.independent));
    if (!std::isfinite(map.speed))
        throw InputError(map.name + ": the speed of the rod must be a finite number");
}

std::string where(const Map& map, std::size_t bin) {
    return fmt::format("{} at ({:g}, {:g})", map.name, map.place_x(bin), map.place_y(bin));
}

void check_bin(const Map& map, std::size_t bin) {
    if (!std::isfinite(map.Ux[bin]) || !std::isfinite(map.Uy[bin]))
        throw InputError(where(map, bin) + ": the displacement must be a finite number");
    if (map.sigma_x.empty())
        return;
    for (const double sigma : {map.sigma_x[bin], map.sigma_y[bin]})
        if (!(sigma > 0.0) || !std::isfinite(sigma))
            throw InputError(fmt::format("{}: sigma = {}: must be above 0", where(map, bin), sigma));
}

Fitted fitted(const MapModel& model, const Map& map, const MapMask& mask, const MapTerms& terms) {
    check_lists(map);
    Fitted out{map, used_bins(map, mask), MapField(model, map, terms)};
    if (out.bins.empty())
        throw InputError(map.name + ": the mask leaves no bin with data");
    for (const std::size_t bin : out.bins)
        check_bin(map, bin);
    return out;
}

bool sigmas_known(const std::vector<Map>& maps) {
    const auto with = std::ranges::count_if(maps, [](const Map& m) { return !m.sigma_x.empty(); });
    if (with != 0 && with != static_cast<long>(maps.size()))
        throw InputError("some maps have standard errors and some have none: their weights cannot be "
                         "compared; give all of them some, or none");
    return with != 0;
}

/// Calls with (row of the residuals, bin, component 0 or 1, 1/sigma).
template<class Visit>
void for_each_residual(const Fitted& f, Visit visit) {
    const double enlarged = std::sqrt(f.map.independent);
    for (std::size_t component = 0; component < 2; ++component)
        for (std::size_t i = 0; i < f.bins.size(); ++i) {
            const auto& sigma = component == 0 ? f.map.sigma_x : f.map.sigma_y;
            visit(static_cast<Eigen::Index>(f.first + component * f.bins.size() + i), f.bins[i], component,
                  enlarged / (sigma.empty() ? 1.0 : sigma[f.bins[i]]));
        }
}

/// Maps on one grid, in one box and at one speed have one model, which is worked out once for all of them.
void evaluate(const std::vector<Fitted>& all, const MapTerms& terms, const std::vector<bool>& wanted,
              std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, Eigen::MatrixXd* jacobian) {
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].like != i)
            continue;
        const auto for_each = [&](const elastic::DisplacementMap& u, auto visit) {
            for (const Fitted& f : all)
                if (f.like == i)
                    for_each_residual(
                        f, [&](Eigen::Index row, std::size_t bin, std::size_t component, double weight) {
                            visit(row, weight, component == 0 ? u.Ux[bin] : u.Uy[bin],
                                  component == 0 ? f.map.Ux[bin] : f.map.Uy[bin]);
                        });
        };
        for_each(all[i].field.at(p), [&](Eigen::Index row, double weight, double model, double data) {
            r[row] = weight * (model - data);
        });
        for (std::size_t term = 0; jacobian && term < terms.index.size(); ++term)
            if (const long column = terms.index[term];
                column >= 0 && wanted[static_cast<std::size_t>(column)])
                for_each(all[i].field.derivative(p, term),
                         [&](Eigen::Index row, double weight, double slope, double) {
                             (*jacobian)(row, column) = weight * slope;
                         });
    }
}

std::string residual_name(const std::vector<Fitted>& all, std::size_t i) {
    const Fitted* of = &all.front();
    for (const Fitted& f : all)
        if (f.first <= i)
            of = &f;
    const std::size_t own = i - of->first, n = of->bins.size();
    return fmt::format("U_{} of {}", own < n ? "x" : "y", where(of->map, of->bins[own % n]));
}

/// Whether every constant of the medium is fixed. With alpha and drag_area the drag goes with the force.
bool medium_is_fixed(const std::vector<Parameter>& parameters) {
    static const std::vector<std::string> constants = {"c11",   "c22", "c12", "c66",   "zeta",     "rho",
                                                       "eta_s", "eta", "xi",  "alpha", "drag_area"};
    const bool by_force = std::ranges::any_of(
        parameters, [](const Parameter& p) { return p.name == "alpha" || p.name == "drag_area"; });
    return std::ranges::all_of(parameters, [&](const Parameter& p) {
        const bool constant = std::ranges::find(constants, p.name) != constants.end();
        return p.fixed || !(constant || (by_force && p.name == "f_over_mu"));
    });
}

std::vector<double> starts_of(const std::vector<Parameter>& parameters) {
    std::vector<double> out;
    out.reserve(parameters.size());
    for (const Parameter& p : parameters)
        out.push_back(p.start);
    return out;
}

} // namespace

bool MapMask::keeps(double x, double y) const {
    constexpr double rounding = 1e-9; // bins in the middle of which an edge lies belong to both sides
    if (std::abs(y) < strip - rounding || std::hypot(x, y) < radius - rounding)
        return false;
    const double angle = std::atan2(std::abs(y), x);
    return from - rounding <= angle && angle <= to + rounding;
}

std::vector<std::size_t> used_bins(const Map& map, const MapMask& mask) {
    std::vector<std::size_t> bins;
    for (std::size_t bin = 0; bin < map.bins(); ++bin)
        if (map.known[bin] && mask.keeps(map.place_x(bin), map.place_y(bin)))
            bins.push_back(bin);
    return bins;
}

Problem map_problem(const MapModel& model, const std::vector<Map>& maps, const MapMask& mask,
                    std::vector<Parameter> parameters) {
    const MapTerms terms = map_terms(parameters);
    auto all = std::make_shared<std::vector<Fitted>>();
    Problem problem;
    double values = 0.0;
    for (const Map& map : maps) {
        all->push_back(fitted(model, map, mask, terms));
        all->back().first = problem.residuals;
        all->back().like = static_cast<std::size_t>(
            std::ranges::find_if(*all,
                                 [&](const Fitted& f) { return same_model(f.map, map, isotropic(terms)); }) -
            all->begin());
        for (const char* quantity : {"U_x", "U_y"}) {
            Series one{map.name, quantity, std::vector<std::size_t>(all->back().bins.size())};
            std::iota(one.residuals.begin(), one.residuals.end(), problem.residuals);
            problem.residuals += problem.series.emplace_back(std::move(one)).residuals.size();
        }
        for_each_residual(all->back(), [&](Eigen::Index, std::size_t, std::size_t, double weight) {
            problem.log_sigma.push_back(-std::log(weight));
        });
        values += map.independent * 2.0 * static_cast<double>(all->back().bins.size());
        if (all->back().like + 1 == all->size() && medium_is_fixed(parameters))
            all->back().field.hold_medium(starts_of(parameters));
    }
    if (all->empty())
        throw InputError("there are no maps to fit");
    std::vector<bool> wanted;
    wanted.reserve(parameters.size());
    for (const Parameter& p : parameters)
        wanted.push_back(!p.fixed);
    problem.parameters = std::move(parameters);
    problem.sigma_known = sigmas_known(maps);
    problem.independent = values / static_cast<double>(problem.residuals);
    // NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
    problem.evaluate = [=](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                           Eigen::MatrixXd* jacobian) { evaluate(*all, terms, wanted, p, r, jacobian); };
    problem.residual_name = [all](std::size_t i) { return residual_name(*all, i); };
    validate(problem);
    return problem;
}

elastic::DisplacementMap predict(const MapModel& model, const Map& map,
                                 const std::vector<Parameter>& parameters, std::span<const double> values) {
    return MapField(model, map, map_terms(parameters)).at(values);
}

Prediction predict_line(const MapModel& model, const Map& map, const Profile& line,
                        std::span<const double> places, const std::vector<Parameter>& parameters,
                        std::span<const double> values) {
    const MapTerms terms = map_terms(parameters);
    const bool along_x = line.along == Axis::x;
    const std::vector<double> along(places.begin(), places.end()), across = {line.at};
    const Map grid{.lx = map.lx,
                   .ly = map.ly,
                   .speed = map.speed,
                   .x = along_x ? along : across,
                   .y = along_x ? across : along};
    const MapField field(model, grid, terms);
    const auto part = [&](const elastic::DisplacementMap& u) {
        return line.component == Component::Ux ? u.Ux : u.Uy;
    };
    Prediction out{part(field.at(values)), Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(places.size()),
                                                                 static_cast<Eigen::Index>(values.size()))};
    for (std::size_t term = 0; term < terms.index.size(); ++term)
        if (terms.has(term)) {
            const std::vector<double> slope = part(field.derivative(values, term));
            out.by_parameter.col(terms.index[term]) =
                Eigen::Map<const Eigen::VectorXd>(slope.data(), static_cast<Eigen::Index>(slope.size()));
        }
    return out;
}

namespace {

using elastic::DisplacementMap, elastic::OrthotropicMedium, elastic::OrthotropicParameter, elastic::RodSource;

enum MomentTerm : std::size_t {
    amplitude,
    force,
    p_xx,
    p_yy,
    q_xxx,
    q_xyy,
    q_yxy,
    t_xxxx,
    t_xxyy,
    h_xxxxx,
    h_xxxyy,
    c11,
    c22,
    c12,
    c66,
    zeta,
    rho,
    eta_s,
    offset,
    offset_y,
    f_over_mu, // of an isotropic medium, in units of its shear modulus, from here on
    eta,
    xi,
    alpha,
    drag_area
};

/// In the order of the terms from force on.
constexpr std::array unit_sources = {OrthotropicParameter::force,   OrthotropicParameter::p_xx,
                                     OrthotropicParameter::p_yy,    OrthotropicParameter::q_xxx,
                                     OrthotropicParameter::q_xyy,   OrthotropicParameter::q_yxy,
                                     OrthotropicParameter::t_xxxx,  OrthotropicParameter::t_xxyy,
                                     OrthotropicParameter::h_xxxxx, OrthotropicParameter::h_xxxyy};

/// Of the terms from c11 to eta_s.
OrthotropicParameter constant(std::size_t term) {
    using enum OrthotropicParameter;
    static constexpr std::array all = {OrthotropicParameter::c11,  OrthotropicParameter::c22,
                                       OrthotropicParameter::c12,  OrthotropicParameter::c66,
                                       OrthotropicParameter::zeta, OrthotropicParameter::rho,
                                       OrthotropicParameter::eta_s};
    return all[term - MomentTerm::c11];
}

/// Of a rod at unit speed, d zeta/d(term) with `by`, else zeta itself: 1/xi, in one of its forms.
double screening(const MapTerms& t, std::span<const double> p, std::optional<std::size_t> by = {}) {
    const double f = std::abs(t.value(p, f_over_mu, 0.0)),
                 sign = t.value(p, f_over_mu, 0.0) < 0.0 ? -1.0 : 1.0;
    if (t.has(xi)) {
        const double length = t.value(p, xi, 0.0);
        return !by ? 1.0 / length : *by == xi ? -1.0 / (length * length) : 0.0;
    }
    if (t.has(alpha)) {
        const double a = t.value(p, alpha, 0.0);
        return !by ? a / f : *by == alpha ? 1.0 / f : *by == f_over_mu ? -sign * a / (f * f) : 0.0;
    }
    if (t.has(drag_area)) {
        const double area = t.value(p, drag_area, 0.0);
        return !by ? f / area : *by == drag_area ? -f / (area * area) : *by == f_over_mu ? sign / area : 0.0;
    }
    return 0.0;
}

bool isotropic(const MapTerms& terms) { return terms.has(eta); }

OrthotropicMedium medium(const MapTerms& t, std::span<const double> p) {
    if (t.has(eta)) {
        const double ratio = t.value(p, eta, 0.0);
        return {1.0 + ratio, 1.0 + ratio, ratio - 1.0, 1.0, screening(t, p)};
    }
    return {t.value(p, c11, 0.0),  t.value(p, c22, 0.0), t.value(p, c12, 0.0),  t.value(p, c66, 0.0),
            t.value(p, zeta, 0.0), t.value(p, rho, 0.0), t.value(p, eta_s, 0.0)};
}

void add(std::vector<double>& sum, const std::vector<double>& more, double factor) {
    for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] += factor * more[i];
}

DisplacementMap constants(std::size_t bins, double x, double y) {
    return {std::vector<double>(bins, x), std::vector<double>(bins, y)};
}

void scale(DisplacementMap& map, double factor) {
    for (auto* component : {&map.Ux, &map.Uy})
        for (double& value : *component)
            value *= factor;
}

void require(const MapTerms& t) {
    const auto has = [&](std::size_t term) { return t.index[term] >= 0; };
    if (!has(eta) && (!has(c11) || !has(c22) || !has(c12) || !has(c66)))
        throw InputError(
            "a map needs c11, c22, c12 and c66, or f_over_mu and eta, as parameters or with fixed "
            "values");
    const auto asked = [](auto parameter) { return parameter >= 0; };
    if (has(eta) && (!has(f_over_mu) || has(force) ||
                     std::any_of(t.index.begin() + c11, t.index.begin() + offset, asked)))
        throw InputError("an isotropic map has f_over_mu and eta in place of force and constants");
    if (has(xi) + has(alpha) + has(drag_area) > 1)
        throw InputError("give one of xi, alpha and drag_area");
    if (!has(eta) && std::none_of(t.index.begin() + force, t.index.begin() + c11, asked)) // the sources
        throw InputError("a map needs force, p_xx, p_yy, q_xxx, q_xyy or q_yxy: without a source there is no "
                         "displacement");
    if (has(amplitude) && !has(force))
        throw InputError("amplitude scales the predicted monopole force: also give force");
}

} // namespace

std::vector<std::string> map_parameter_names() {
    return {"amplitude", "force",    "p_xx",      "p_yy", "q_xxx", "q_xyy", "q_yxy",    "t_xxxx", "t_xxyy",
            "h_xxxxx",   "h_xxxyy",  "c11",       "c22",  "c12",   "c66",   "zeta",     "rho",    "eta_s",
            "offset",    "offset_y", "f_over_mu", "eta",  "xi",    "alpha", "drag_area"};
}

MapTerms map_terms(const std::vector<Parameter>& parameters) {
    MapTerms terms{};
    terms.index.fill(-1);
    const auto names = map_parameter_names();
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const auto at = std::ranges::find(names, parameters[i].name);
        if (at == names.end())
            throw InputError(fmt::format("unknown parameter \"{}\" of a map; known: {}", parameters[i].name,
                                         fmt::join(names, ", ")));
        terms.index[static_cast<std::size_t>(at - names.begin())] = static_cast<long>(i);
    }
    require(terms);
    return terms;
}

MapField::MapField(const MapModel& model, const Map& map, const MapTerms& terms)
    : terms_(terms), field_({map.lx, map.ly, terms.has(eta) ? std::copysign(1.0, map.speed) : map.speed,
                             model.rod_length, model.source_width},
                            map.x, map.y),
      bins_(map.bins()) {}

void MapField::hold_medium(std::span<const double> p) { held_ = basis(p); }

/// Absent sources stay empty.
MapField::Basis MapField::basis(std::span<const double> p) const {
    Basis out;
    for (std::size_t k = 0; k < out.size(); ++k)
        if (terms_.has(force + k) || (k == 0 && terms_.has(eta)))
            out[k] = field_.derivative(medium(terms_, p), {}, unit_sources[k]);
    return out;
}

RodSource MapField::source(std::span<const double> p) const {
    const auto value = [&](std::size_t term) { return terms_.value(p, term, 0.0); };
    const double monopole = value(terms_.has(eta) ? f_over_mu : force);
    return {terms_.value(p, amplitude, 1.0) * monopole,
            value(p_xx),
            value(p_yy),
            value(q_xxx),
            value(q_xyy),
            value(q_yxy),
            value(t_xxxx),
            value(t_xxyy),
            value(h_xxxxx),
            value(h_xxxyy)};
}

DisplacementMap MapField::unit(std::span<const double> p, std::size_t k) const {
    return held_ ? (*held_)[k] : field_.derivative(medium(terms_, p), {}, unit_sources[k]);
}

DisplacementMap MapField::at(std::span<const double> p) const {
    DisplacementMap out = constants(bins_, terms_.value(p, offset, 0.0), terms_.value(p, offset_y, 0.0));
    const RodSource s = source(p);
    const double strength[] = {s.force, s.p_xx,   s.p_yy,   s.q_xxx,   s.q_xyy,
                               s.q_yxy, s.t_xxxx, s.t_xxyy, s.h_xxxxx, s.h_xxxyy};
    Basis whole;
    if (!held_)
        whole[0] = field_.displacement(medium(terms_, p), s);
    for (std::size_t k = 0; k < unit_sources.size(); ++k) {
        const DisplacementMap& part = held_ ? (*held_)[k] : whole[k];
        if (part.Ux.empty())
            continue;
        add(out.Ux, part.Ux, held_ ? strength[k] : 1.0);
        add(out.Uy, part.Uy, held_ ? strength[k] : 1.0);
    }
    return out;
}

DisplacementMap MapField::derivative(std::span<const double> p, std::size_t term) const {
    if (term == offset || term == offset_y)
        return constants(bins_, term == offset ? 1.0 : 0.0, term == offset_y ? 1.0 : 0.0);
    if (term > f_over_mu) {
        OrthotropicMedium change{0.0, 0.0, 0.0, 0.0, screening(terms_, p, term)};
        if (term == eta)
            change.c11 = change.c22 = change.c12 = 1.0;
        return field_.derivative(medium(terms_, p), source(p), change);
    }
    if (term == f_over_mu) {
        DisplacementMap out = unit(p, 0);
        if (const double by = screening(terms_, p, term); by != 0.0) {
            const OrthotropicMedium change{0.0, 0.0, 0.0, 0.0, by};
            const DisplacementMap less = field_.derivative(medium(terms_, p), source(p), change);
            add(out.Ux, less.Ux, 1.0);
            add(out.Uy, less.Uy, 1.0);
        }
        return out;
    }
    if (term >= c11)
        return field_.derivative(medium(terms_, p), source(p), constant(term));
    DisplacementMap out = unit(p, term == amplitude ? 0 : term - force);
    if (term == amplitude)
        scale(out, terms_.value(p, force, 0.0));
    if (term == force)
        scale(out, terms_.value(p, amplitude, 1.0));
    return out;
}

} // namespace rodwake::fitting
