// Order of the beads: g(r), psi6, g_B(r) and its class.

#include "rodwake/measure/order.hpp"

#include "bed/measure_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app::measures {

namespace {

using measure::OrderAccumulator, measure::OrderResult;
using scene::Measure, scene::Scene;

constexpr ValueInfo values[] = {
    {.key = "phase", .title = "Phase", .meaning = "of the beads, by the decay of $g_B$", .is_text = true},
    {"psi6", R"($\psi_6$, measured frames)", "",
     R"($|\langle\psi_{6,i}\rangle|$ over the beads; neighbours by the cut-off below, or Delaunay)"},
    {"local_psi6", R"($\langle|\psi_{6,i}|\rangle$)", "",
     "mean over beads of the size of the local bond order"},
    {"neighbours", "Neighbours", "", "of a bead, mean"},
    {"cutoff", "Cut-off", "a", "beads nearer than this are neighbours"},
    {"g_minimum", "First minimum of $g(r)$", "a", "distance at which $g(r)$ of the beads has it"},
    {"exponent", R"($\eta_6$)", "", R"(of $g_B \propto r^{-\eta_6}$, fitted)"},
    {"length", R"($\xi_6$)", "a", R"(of $g_B \propto \mathrm{exp}(-r/\xi_6)$, fitted)"},
    {"plateau", "", "", "$g_B$ far away: mean over the farther half of the points"},
    {"cutoffs_by_spacing", "", "runs", "whose $g(r)$ had no minimum to take the cut-off from"},
    {.key = "class", .meaning = "of the decay of $g_B$: exponential, algebraic, long-range", .is_text = true},
    {.key = "reason", .meaning = "which numbers decided the class", .is_text = true},
    {"chi2.exponential", "", "", "of the exponential fitted to $g_B$"},
    {"chi2.algebraic", "", "", "of the power law fitted to $g_B$"},
    {"chi2.constant", "", "", "of the constant fitted to $g_B$"},
    {"points", "", "", "of $g_B$ that were fitted"},
    {"frames", "", "", "measured"},
    {"blocks", "", "", "of time, for the errors"},
};

constexpr ColumnInfo gr_columns[] = {{"r", "a", "distance"},
                                     {"g", "1", "pair correlation g(r)"},
                                     {"sigma", "1", "standard error; empty: unknown"}};
constexpr ColumnInfo gB_columns[] = {{"r", "a", "distance"},
                                     {"gB", "1", "bond-orientational correlation g_B(r)"},
                                     {"sigma", "1", "standard error; empty: unknown"},
                                     {"pairs", "1", "pairs behind the value"}};
constexpr FileInfo files[] = {{"gr.csv", "pair correlation", gr_columns},
                              {"gB.csv", "bond-orientational correlation", gB_columns}};

constexpr SeriesInfo series[] = {
    {{"psi6", "1", "|mean over the beads of psi6|, neighbours as measure.order has them"}},
    {{"exponent", "1", "of an algebraic decay of g_B"}},
    {{"class", "1", "of the decay of g_B: 0 exponential, 1 algebraic, 2 long-range"}, false}};

measure::OrderOptions options_of(const Measure& m, double a) {
    measure::OrderOptions options;
    options.neighbours = m.order_neighbours;
    options.cutoff = m.order_cutoff;
    options.bin = 0.05 * a;
    options.order_bin = a;
    options.block = m.block;
    return options;
}

/// Every so many of the measured frames.
std::size_t stride(const Measure& m, double interval) {
    const double wanted = m.order_interval.value_or(std::max(interval, 0.5));
    return static_cast<std::size_t>(std::max(1.0, std::ceil(wanted / interval * (1.0 - 1e-9))));
}

void include(const Scene& scene, MeasurePlan& plan) {
    include_sums<OrderAccumulator>(plan, "order", options_of(*scene.measure, scene.granular->bead_radius),
                                   stride(*scene.measure, plan.interval * static_cast<double>(plan.stride)));
}

std::string describe(const Scene& scene) {
    const Measure& m = *scene.measure;
    const double interval =
        static_cast<double>(steps_between_frames(scene)) * scene::time_step(*scene.granular);
    const std::string rule = m.order_neighbours == measure::Neighbours::delaunay ? "Delaunay neighbours"
                             : m.order_cutoff ? fmt::format("neighbours within {:.3g} a",
                                                            *m.order_cutoff / scene.granular->bead_radius)
                                              : "neighbours within the first minimum of g(r)";
    return fmt::format("g(r), psi6 and g_B(r), {}, every {:g} s", rule,
                       interval * static_cast<double>(stride(m, interval)));
}

Values values_of(const OrderResult& r, double a) {
    const measure::DecayClass& d = r.decay;
    return {{"psi6", r.psi6},
            {"local_psi6", r.local_psi6},
            {"neighbours", r.neighbours},
            {"cutoff", r.cutoff / a},
            {"cutoffs_by_spacing", count_value(r.cutoffs_by_spacing)},
            {"g_minimum", r.g_minimum ? Value(*r.g_minimum / a) : Value()},
            {"class", to_string(d.decay)},
            {"phase", phase_of(d.decay)},
            {"exponent", d.exponent},
            {"length", d.length.scaled(1.0 / a)},
            {"plateau", d.plateau},
            {"chi2.exponential", d.chi2_exponential},
            {"chi2.algebraic", d.chi2_algebraic},
            {"chi2.constant", d.chi2_constant},
            {"points", d.points},
            {"reason", d.reason},
            {"frames", count_value(r.frames)},
            {"blocks", count_value(r.blocks)}};
}

/// Not measured if undetermined.
Estimate class_number(measure::Decay decay) {
    if (decay == measure::Decay::undetermined)
        return {};
    const double number = decay == measure::Decay::exponential ? 0.0
                          : decay == measure::Decay::algebraic ? 1.0
                                                               : 2.0;
    return {number, unknown_error, 1};
}

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius();
    const OrderResult r = measure::reduce(measure::take<OrderAccumulator>(data.sums, "order"));
    return {
        .values = values_of(r, a),
        .tables = {{"gr.csv",
                    "pair correlation g(r); r in bead radii a",
                    gr_columns,
                    {scaled(r.r, 1.0 / a), r.g, r.g_error}},
                   {"gB.csv",
                    "bond-orientational correlation g_B(r); r in a; pairs behind each value",
                    gB_columns,
                    {scaled(r.order_r, 1.0 / a), r.g_B, r.g_B_error, r.order_pairs}}},
        .series = {{"psi6", r.psi6}, {"exponent", r.decay.exponent}, {"class", class_number(r.decay.decay)}},
        .line = fmt::format("psi6 {}, g_B {} ({}); neighbours within {:.3g} a", text(r.psi6),
                            to_string(r.decay.decay), phase_of(r.decay.decay), r.cutoff / a)};
}

} // namespace

MeasureKind order() {
    return {.name = "order",
            .order = 10,
            .wanted = [](const Measure& m) { return m.order; },
            .describe = describe,
            .include = include,
            .report = report,
            .values = values,
            .files = files,
            .series = series};
}

} // namespace rodwake::app::measures
