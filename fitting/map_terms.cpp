#include "map_terms.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace rodwake::fitting {

namespace {

using elastic::DisplacementMap, elastic::OrthotropicMedium, elastic::OrthotropicParameter, elastic::RodSource;

enum Term : std::size_t {
    amplitude,
    force,
    p_xx,
    p_yy,
    q_xxx,
    q_xyy,
    q_yxy,
    c11,
    c22,
    c12,
    c66,
    zeta,
    rho,
    eta_s,
    offset,
    offset_y
};

/// In the order of the terms from force on.
constexpr std::array unit_sources = {OrthotropicParameter::force, OrthotropicParameter::p_xx,
                                     OrthotropicParameter::p_yy,  OrthotropicParameter::q_xxx,
                                     OrthotropicParameter::q_xyy, OrthotropicParameter::q_yxy};

/// Of the terms from c11 to eta_s.
OrthotropicParameter constant(std::size_t term) {
    using enum OrthotropicParameter;
    static constexpr std::array all = {OrthotropicParameter::c11,  OrthotropicParameter::c22,
                                       OrthotropicParameter::c12,  OrthotropicParameter::c66,
                                       OrthotropicParameter::zeta, OrthotropicParameter::rho,
                                       OrthotropicParameter::eta_s};
    return all[term - Term::c11];
}

OrthotropicMedium medium(const MapTerms& t, std::span<const double> p) {
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
    if (!has(c11) || !has(c22) || !has(c12) || !has(c66))
        throw InputError("a map needs c11, c22, c12 and c66, as parameters or with fixed values");
    const auto asked = [](auto parameter) { return parameter >= 0; };
    if (std::none_of(t.index.begin() + force, t.index.begin() + c11, asked)) // the sources
        throw InputError("a map needs force, p_xx, p_yy, q_xxx, q_xyy or q_yxy: without a source there is no "
                         "displacement");
    if (has(amplitude) && !has(force))
        throw InputError("amplitude is the monopole over its prediction: give force, which it multiplies");
}

} // namespace

std::vector<std::string> map_parameter_names() {
    return {"amplitude", "force", "p_xx", "p_yy", "q_xxx", "q_xyy", "q_yxy",  "c11",
            "c22",       "c12",   "c66",  "zeta", "rho",   "eta_s", "offset", "offset_y"};
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
    : terms_(terms), field_({map.lx, map.ly, map.speed, model.rod_length, model.source_width}, map.x, map.y),
      bins_(map.bins()) {}

void MapField::hold_medium(std::span<const double> p) { held_ = basis(p); }

/// Absent sources stay empty.
MapField::Basis MapField::basis(std::span<const double> p) const {
    Basis out;
    for (std::size_t k = 0; k < out.size(); ++k)
        if (terms_.index[force + k] >= 0)
            out[k] = field_.derivative(medium(terms_, p), {}, unit_sources[k]);
    return out;
}

RodSource MapField::source(std::span<const double> p) const {
    const auto value = [&](std::size_t term) { return terms_.value(p, term, 0.0); };
    return {terms_.value(p, amplitude, 1.0) * value(force),
            value(p_xx),
            value(p_yy),
            value(q_xxx),
            value(q_xyy),
            value(q_yxy)};
}

DisplacementMap MapField::unit(std::span<const double> p, std::size_t k) const {
    return held_ ? (*held_)[k] : field_.derivative(medium(terms_, p), {}, unit_sources[k]);
}

DisplacementMap MapField::at(std::span<const double> p) const {
    DisplacementMap out = constants(bins_, terms_.value(p, offset, 0.0), terms_.value(p, offset_y, 0.0));
    const RodSource s = source(p);
    const double strength[] = {s.force, s.p_xx, s.p_yy, s.q_xxx, s.q_xyy, s.q_yxy};
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
