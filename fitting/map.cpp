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

// The model of a map: its parameters, and its values and derivatives at all bins.

namespace {

using elastic::DisplacementMap, elastic::OrthotropicMedium, elastic::OrthotropicParameter, elastic::RodSource;

/// The parameters of map_parameter_names. From force to eta_s they follow elastic::OrthotropicParameter:
/// first the sources, then the constants of the medium.
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
    drag_area,
    term_count
};
constexpr std::size_t sources = c11 - force;
static_assert(static_cast<std::size_t>(OrthotropicParameter::eta_s) == eta_s - force);

/// Index of each term among the parameters; -1: absent.
struct MapTerms {
    std::array<long, term_count> index;

    bool has(std::size_t term) const { return index[term] >= 0; }
    bool has_any(std::size_t first, std::size_t last) const {
        return std::any_of(index.begin() + first, index.begin() + last, [](long i) { return i >= 0; });
    }
    double value(std::span<const double> p, std::size_t term, double absent = 0.0) const {
        return index[term] < 0 ? absent : p[static_cast<std::size_t>(index[term])];
    }
};

/// Throws InputError for names that are unknown and for missing ones.
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
    if (!terms.has(eta) && (!terms.has(c11) || !terms.has(c22) || !terms.has(c12) || !terms.has(c66)))
        throw InputError(
            "a map needs c11, c22, c12 and c66, or f_over_mu and eta, as parameters or with fixed "
            "values");
    if (terms.has(eta) && (!terms.has(f_over_mu) || terms.has(force) || terms.has_any(c11, offset)))
        throw InputError("an isotropic map has f_over_mu and eta instead of force and constants");
    if (terms.has(xi) + terms.has(alpha) + terms.has(drag_area) > 1)
        throw InputError("give one of xi, alpha and drag_area");
    if (!terms.has(eta) && !terms.has_any(force, c11))
        throw InputError("a map needs force, p_xx, p_yy, q_xxx, q_xyy or q_yxy: without a source there is no "
                         "displacement");
    if (terms.has(amplitude) && !terms.has(force))
        throw InputError("amplitude scales the predicted monopole force: also give force");
    return terms;
}

/// The drag constant zeta = 1/xi of an isotropic medium for a rod at unit speed, in one of its forms; its
/// derivative by the term `by` if that is given.
double screening(const MapTerms& t, std::span<const double> p, std::optional<std::size_t> by = {}) {
    const double strength = t.value(p, f_over_mu), f = std::abs(strength), sign = strength < 0.0 ? -1.0 : 1.0;
    if (t.has(xi)) {
        const double length = t.value(p, xi);
        return !by ? 1.0 / length : *by == xi ? -1.0 / (length * length) : 0.0;
    }
    if (t.has(alpha)) {
        const double a = t.value(p, alpha);
        return !by ? a / f : *by == alpha ? 1.0 / f : *by == f_over_mu ? -sign * a / (f * f) : 0.0;
    }
    if (t.has(drag_area)) {
        const double area = t.value(p, drag_area);
        return !by ? f / area : *by == drag_area ? -f / (area * area) : *by == f_over_mu ? sign / area : 0.0;
    }
    return 0.0;
}

OrthotropicMedium medium(const MapTerms& t, std::span<const double> p) {
    if (t.has(eta)) {
        const double ratio = t.value(p, eta);
        return {1.0 + ratio, 1.0 + ratio, ratio - 1.0, 1.0, screening(t, p)};
    }
    return {t.value(p, c11),  t.value(p, c22), t.value(p, c12),  t.value(p, c66),
            t.value(p, zeta), t.value(p, rho), t.value(p, eta_s)};
}

void add(DisplacementMap& sum, const DisplacementMap& more, double factor) {
    for (std::size_t i = 0; i < sum.Ux.size(); ++i) {
        sum.Ux[i] += factor * more.Ux[i];
        sum.Uy[i] += factor * more.Uy[i];
    }
}

DisplacementMap constants(std::size_t bins, double x, double y) {
    return {std::vector<double>(bins, x), std::vector<double>(bins, y)};
}

class MapField {
public:
    MapField(const MapModel& model, const Map& map, const MapTerms& terms)
        : terms_(terms), field_({map.lx, map.ly, terms.has(eta) ? std::copysign(1.0, map.speed) : map.speed,
                                 model.rod_length, model.source_width},
                                map.x, map.y),
          bins_(map.bins()) {}

    /// From here on the constants of the medium are those of `p`, so that fields of unit sources are computed
    /// once.
    void hold_medium(std::span<const double> p) {
        std::array<DisplacementMap, sources> units;
        for (std::size_t k = 0; k < sources; ++k) // absent sources stay empty
            if (terms_.has(force + k) || (k == 0 && terms_.has(eta)))
                units[k] = unit(p, force + k);
        held_ = std::move(units);
    }

    DisplacementMap at(std::span<const double> p) const {
        DisplacementMap out = constants(bins_, terms_.value(p, offset), terms_.value(p, offset_y));
        const RodSource s = source(p);
        if (!held_) {
            add(out, field_.displacement(medium(terms_, p), s), 1.0);
            return out;
        }
        const double strength[sources] = {s.force, s.p_xx,   s.p_yy,   s.q_xxx,   s.q_xyy,
                                          s.q_yxy, s.t_xxxx, s.t_xxyy, s.h_xxxxx, s.h_xxxyy};
        for (std::size_t k = 0; k < sources; ++k)
            if (!(*held_)[k].Ux.empty())
                add(out, (*held_)[k], strength[k]);
        return out;
    }

    /// Derivative by the parameter that is this term.
    DisplacementMap derivative(std::span<const double> p, std::size_t term) const {
        if (term == offset || term == offset_y)
            return constants(bins_, term == offset ? 1.0 : 0.0, term == offset_y ? 1.0 : 0.0);

        // Constants of the medium; the drag constant goes with the force, too.
        if (term > f_over_mu) {
            OrthotropicMedium change{0.0, 0.0, 0.0, 0.0, screening(terms_, p, term)};
            if (term == eta)
                change.c11 = change.c22 = change.c12 = 1.0;
            return field_.derivative(medium(terms_, p), source(p), change);
        }
        if (term == f_over_mu) {
            DisplacementMap out = unit(p, force);
            if (const double by = screening(terms_, p, term); by != 0.0)
                add(out, field_.derivative(medium(terms_, p), source(p), {0.0, 0.0, 0.0, 0.0, by}), 1.0);
            return out;
        }
        if (term >= c11)
            return field_.derivative(medium(terms_, p), source(p),
                                     static_cast<OrthotropicParameter>(term - force));

        // Sources; the monopole is amplitude times force.
        DisplacementMap out = unit(p, term == amplitude ? std::size_t{force} : term);
        if (term == amplitude || term == force) {
            const double factor =
                term == amplitude ? terms_.value(p, force) : terms_.value(p, amplitude, 1.0);
            for (auto* component : {&out.Ux, &out.Uy})
                for (double& value : *component)
                    value *= factor;
        }
        return out;
    }

private:
    RodSource source(std::span<const double> p) const {
        const double monopole = terms_.value(p, terms_.has(eta) ? f_over_mu : force);
        RodSource s;
        s.force = terms_.value(p, amplitude, 1.0) * monopole;
        double* const moments[] = {&s.p_xx,   &s.p_yy,   &s.q_xxx,   &s.q_xyy,  &s.q_yxy,
                                   &s.t_xxxx, &s.t_xxyy, &s.h_xxxxx, &s.h_xxxyy};
        for (std::size_t k = 0; k < std::size(moments); ++k)
            *moments[k] = terms_.value(p, p_xx + k);
        return s;
    }

    /// Field of a source of strength 1.
    DisplacementMap unit(std::span<const double> p, std::size_t term) const {
        return held_ ? (*held_)[term - force]
                     : field_.derivative(medium(terms_, p), {},
                                         static_cast<OrthotropicParameter>(term - force));
    }

    MapTerms terms_;
    elastic::AnisotropicField field_;
    std::size_t bins_;
    std::optional<std::array<DisplacementMap, sources>> held_; ///< fields of unit sources
};

} // namespace

std::vector<std::string> map_parameter_names() {
    return {"amplitude", "force",    "p_xx",      "p_yy", "q_xxx", "q_xyy", "q_yxy",    "t_xxxx", "t_xxyy",
            "h_xxxxx",   "h_xxxyy",  "c11",       "c22",  "c12",   "c66",   "zeta",     "rho",    "eta_s",
            "offset",    "offset_y", "f_over_mu", "eta",  "xi",    "alpha", "drag_area"};
}

namespace {

/// A map with its fitted bins. Its residuals are first all U_x, then all U_y.
struct FittedMap {
    Map map;
    std::vector<std::size_t> bins;
    MapField field;
    std::vector<double> weight; ///< 1/sigma of each residual
    std::size_t first = 0;
    std::size_t like = 0; ///< the first map that has the same model, this one or one before
};

std::string where(const Map& map, std::size_t bin) {
    return fmt::format("{} at ({:g}, {:g})", map.name, map.place_x(bin), map.place_y(bin));
}

FittedMap fitted(const MapModel& model, const Map& map, const MapMask& mask, const MapTerms& terms) {
    const std::size_t n = map.bins();
    if (map.Ux.size() != n || map.Uy.size() != n || map.known.size() != n ||
        (!map.sigma_x.empty() && map.sigma_x.size() != n) || map.sigma_x.size() != map.sigma_y.size())
        throw InputError(map.name + ": displacements, sigmas and the grid of the map differ in number");
    if (!(map.independent > 0.0 && map.independent <= 1.0))
        throw InputError(fmt::format("{}: independent = {}: a bin is worth more than 0 and at most 1 value",
                                     map.name, map.independent));
    if (!std::isfinite(map.speed))
        throw InputError(map.name + ": the speed of the rod must be a finite number");
    FittedMap out{map, used_bins(map, mask), MapField(model, map, terms), {}};
    if (out.bins.empty())
        throw InputError(map.name + ": the mask leaves no bin with data");
    for (const std::size_t bin : out.bins) {
        if (!std::isfinite(map.Ux[bin]) || !std::isfinite(map.Uy[bin]))
            throw InputError(where(map, bin) + ": the displacement must be a finite number");
        for (const auto* list : {&map.sigma_x, &map.sigma_y})
            if (const double sigma = list->empty() ? 1.0 : (*list)[bin];
                !(sigma > 0.0) || !std::isfinite(sigma))
                throw InputError(fmt::format("{}: sigma = {}: must be above 0", where(map, bin), sigma));
    }
    for (const auto* list : {&map.sigma_x, &map.sigma_y})
        for (const std::size_t bin : out.bins)
            out.weight.push_back(std::sqrt(map.independent) / (list->empty() ? 1.0 : (*list)[bin]));
    return out;
}

/// Residuals and their derivatives. Maps on one grid, in one box and at one speed have one model, which is
/// computed once for all of them.
void evaluate(const std::vector<FittedMap>& all, const MapTerms& terms, const std::vector<bool>& wanted,
              std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r, Eigen::MatrixXd* jacobian) {
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].like != i)
            continue;
        const auto set = [&](const DisplacementMap& u, bool minus_data, Eigen::Ref<Eigen::VectorXd> out) {
            for (const FittedMap& f : all)
                for (std::size_t k = 0; k < f.weight.size() && f.like == i; ++k) {
                    const bool x = k < f.bins.size();
                    const std::size_t bin = f.bins[x ? k : k - f.bins.size()];
                    const double data = !minus_data ? 0.0 : x ? f.map.Ux[bin] : f.map.Uy[bin];
                    out[static_cast<Eigen::Index>(f.first + k)] =
                        f.weight[k] * ((x ? u.Ux[bin] : u.Uy[bin]) - data);
                }
        };
        set(all[i].field.at(p), true, r);
        for (std::size_t term = 0; jacobian && term < terms.index.size(); ++term)
            if (const long column = terms.index[term];
                column >= 0 && wanted[static_cast<std::size_t>(column)])
                set(all[i].field.derivative(p, term), false, jacobian->col(column));
    }
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
    auto all = std::make_shared<std::vector<FittedMap>>();
    Problem problem;
    double values = 0.0;
    std::vector<double> starts;
    std::vector<bool> wanted;
    for (const Parameter& p : parameters) {
        starts.push_back(p.start);
        wanted.push_back(!p.fixed);
    }

    // Fields of unit sources are computed once if every constant of the medium is fixed. With alpha and
    // drag_area the drag goes with the force.
    bool medium_is_fixed = true;
    for (std::size_t term = c11; term < term_count; ++term) {
        const bool constant = term <= eta_s || term > f_over_mu ||
                              (term == f_over_mu && (terms.has(alpha) || terms.has(drag_area)));
        if (constant && terms.has(term) && wanted[static_cast<std::size_t>(terms.index[term])])
            medium_is_fixed = false;
    }
    for (const Map& map : maps) {
        all->push_back(fitted(model, map, mask, terms));
        all->back().first = problem.residuals;
        const auto same_model = [&](const FittedMap& f) { // of an isotropic medium at any speed of one sign
            return f.map.lx == map.lx && f.map.ly == map.ly && f.map.x == map.x && f.map.y == map.y &&
                   (terms.has(eta) ? std::signbit(f.map.speed) == std::signbit(map.speed)
                                   : f.map.speed == map.speed);
        };
        all->back().like = static_cast<std::size_t>(std::ranges::find_if(*all, same_model) - all->begin());
        for (const char* quantity : {"U_x", "U_y"}) {
            Series series{map.name, quantity, std::vector<std::size_t>(all->back().bins.size())};
            std::iota(series.residuals.begin(), series.residuals.end(), problem.residuals);
            problem.residuals += problem.series.emplace_back(std::move(series)).residuals.size();
        }
        for (const double weight : all->back().weight)
            problem.log_sigma.push_back(-std::log(weight));
        values += map.independent * 2.0 * static_cast<double>(all->back().bins.size());
        if (medium_is_fixed && all->back().like + 1 == all->size())
            all->back().field.hold_medium(starts);
    }
    if (all->empty())
        throw InputError("there are no maps to fit");
    problem.parameters = std::move(parameters);
    const auto with = std::ranges::count_if(maps, [](const Map& m) { return !m.sigma_x.empty(); });
    if (with != 0 && with != static_cast<long>(maps.size()))
        throw InputError("some maps have standard errors and some have none: their weights cannot be "
                         "compared; give all of them some, or none");
    problem.sigma_known = with != 0;
    problem.independent = values / static_cast<double>(problem.residuals);
    // NOLINTNEXTLINE(performance-unnecessary-value-param): an Eigen::Ref is a view
    problem.evaluate = [=](std::span<const double> p, Eigen::Ref<Eigen::VectorXd> r,
                           Eigen::MatrixXd* jacobian) { evaluate(*all, terms, wanted, p, r, jacobian); };
    problem.residual_name = [all](std::size_t i) {
        const auto after = std::ranges::upper_bound(*all, i, {}, &FittedMap::first);
        const FittedMap& f = *std::prev(after);
        const std::size_t own = i - f.first, n = f.bins.size();
        return fmt::format("U_{} of {}", own < n ? "x" : "y", where(f.map, f.bins[own % n]));
    };
    validate(problem);
    return problem;
}

elastic::DisplacementMap predict(const MapModel& model, const Map& map,
                                 const std::vector<Parameter>& parameters, std::span<const double> values) {
    return MapField(model, map, map_terms(parameters)).at(values);
}

Prediction predict_line(const MapModel& model, const Map& map, const Profile& line,
                        std::span<const double> positions, const std::vector<Parameter>& parameters,
                        std::span<const double> values) {
    const MapTerms terms = map_terms(parameters);
    const bool along_x = line.along == Axis::x;
    const std::vector<double> along(positions.begin(), positions.end()), across = {line.at};
    const Map grid{.lx = map.lx,
                   .ly = map.ly,
                   .speed = map.speed,
                   .x = along_x ? along : across,
                   .y = along_x ? across : along};
    const MapField field(model, grid, terms);
    const auto part = [&](const elastic::DisplacementMap& u) {
        return line.component == Component::Ux ? u.Ux : u.Uy;
    };
    Prediction out{part(field.at(values)), Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(positions.size()),
                                                                 static_cast<Eigen::Index>(values.size()))};
    for (std::size_t term = 0; term < terms.index.size(); ++term)
        if (terms.has(term)) {
            const std::vector<double> slope = part(field.derivative(values, term));
            out.by_parameter.col(terms.index[term]) =
                Eigen::Map<const Eigen::VectorXd>(slope.data(), static_cast<Eigen::Index>(slope.size()));
        }
    return out;
}

} // namespace rodwake::fitting
