#include "measure_json.hpp"

#include "rodwake/core/build_info.hpp"

#include <nlohmann/json.hpp>

namespace rodwake::cli {

namespace {

using measure::Estimate;
using nlohmann::ordered_json;

ordered_json number(const Estimate& e, double scale = 1.0) {
    return {{"value", e.samples > 0 ? ordered_json(e.value * scale) : ordered_json(nullptr)},
            {"error", e.known() ? ordered_json(e.error * scale) : ordered_json(nullptr)},
            {"samples", e.samples}};
}

ordered_json order_json(const measure::StructureResult& r, double a) {
    const measure::DecayClass& d = r.decay;
    return {{"psi6", number(r.psi6)},
            {"local_psi6", number(r.local_psi6)},
            {"neighbours", number(r.neighbours)},
            {"cutoff", r.cutoff / a},
            {"cutoffs_by_spacing", r.cutoffs_by_spacing},
            {"g_minimum", r.g_minimum ? ordered_json(*r.g_minimum / a) : ordered_json(nullptr)},
            {"class", to_string(d.decay)},
            {"phase", phase_of(d.decay)},
            {"exponent", number(d.exponent)},
            {"length", number(d.length, 1.0 / a)},
            {"plateau", number(d.plateau)},
            {"chi2",
             {{"exponential", d.chi2_exponential},
              {"algebraic", d.chi2_algebraic},
              {"constant", d.chi2_constant}}},
            {"points", d.points},
            {"reason", d.reason},
            {"frames", r.frames},
            {"blocks", r.blocks}};
}

ordered_json microrheology_json(const measure::MicrorheologyResult& r, double a) {
    return {{"stiffness", number(r.stiffness_zero, a * a)},
            {"scatter", r.scatter * a * a}, // the two parts of its error
            {"bend", r.bend * a * a},
            {"spring", number(r.spring)},
            {"s_low", r.s_low},
            {"s_high", r.s_high},
            {"window_narrowed", r.window_narrowed},
            {"temperature", r.temperature},
            {"frames", r.frames}};
}

ordered_json flow_json(const measure::FlowField& f, double a) {
    return {{"drag", number(f.drag, 1.0 / a)},
            {"drag_share", number(f.drag_share)},
            {"near_speed", f.near_speed / a},
            {"spacing", f.grid.spacing / a},
            {"blocks", f.blocks},
            {"frames", f.frames}};
}

ordered_json displacement_json(const measure::DisplacementField& u, double a) {
    return {{"method", to_string(u.method)},
            {"reference", u.reference == measure::Reference::box ? "box" : "far"},
            {"spacing", u.grid.spacing / a},
            {"blocks", u.blocks},
            {"frames", u.frames},
            {"block_correlation", u.block_correlation},
            {"mean_speed", u.mean_speed / a},
            {"offset", {u.offset.x / a, u.offset.y / a}},
            {"row_angle", u.peaks.row_angle()},
            {"contrast", u.peaks.contrast()}};
}

ordered_json pairs_json(const measure::PairResult& p, double a) {
    return {{"half_box_change", number(p.half_box_change, 1.0 / a)},
            {"not_there", p.not_there},
            {"non_reciprocity", number(p.non_reciprocity)},
            {"turn_rear", number(p.turn_rear)},
            {"turn_front", number(p.turn_front)},
            {"contact", p.contact},
            {"pursuit", p.pursuit},
            {"escape", p.escape}};
}

} // namespace

std::string measure_json(const CaseResults& r, const MeasureOrigin& origin) {
    const double a = r.bead_radius;
    ordered_json out = {
        {"units", {{"length", "a"}, {"time", "s"}, {"a", a}, {"force", "N"}, {"spring", "N/m"}}},
        {"phi_b", r.phi_b},
        {"runs", r.runs}};
    if (r.structure)
        out["order"] = order_json(*r.structure, a);
    if (r.microrheology)
        out["microrheology"] = microrheology_json(*r.microrheology, a);
    if (r.flow)
        out["flow"] = flow_json(*r.flow, a);
    if (r.displacement)
        out["displacement"] = displacement_json(*r.displacement, a);
    if (r.pairs)
        out["pairs"] = pairs_json(*r.pairs, a);
    if (r.force)
        out["force"] = {{"force", number(r.force->force)}, {"speed", number(r.force->speed)}};
    for (const auto& [name, reason] : r.not_measured)
        out["not_measured"][name] = reason;
    out["provenance"] = {{"command", origin.command},
                         {"seed", origin.seed},
                         {"version", build_info().version},
                         {"git", build_info().git}};
    return out.dump(2) + "\n";
}

} // namespace rodwake::cli
