// Order of the beads: g(r), psi6, g_B(r) and its class.

#include "rodwake/measure/order.hpp"

#include "bed/measure_parts.hpp"
#include "bed/measured_tracks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app::measures {

namespace {

using measure::OrderAccumulator, measure::OrderResult;
using scene::Measure, scene::Scene;

measure::OrderOptions options_of(const Scene& scene, double a) {
    const Measure& m = *scene.measure;
    measure::OrderOptions options;
    options.neighbours = m.order_neighbours;
    options.cutoff = m.order_cutoff;
    options.bin = 0.05 * a;
    options.order_bin = a;
    options.block = m.block;
    if (scene.tracks)
        options.localisation = scene.tracks->localisation.given;
    return options;
}

/// Every so many of the measured frames.
std::size_t stride(const Measure& m, double interval) {
    const double wanted = m.order_interval.value_or(std::max(interval, 0.5));
    return static_cast<std::size_t>(std::max(1.0, std::ceil(wanted / interval * (1.0 - 1e-9))));
}

void include(const Scene& scene, MeasurePlan& plan) {
    include_sums<OrderAccumulator>(plan, "order", options_of(scene, scene::measured_radius(scene)),
                                   stride(*scene.measure, plan.interval * static_cast<double>(plan.stride)));
}

std::string describe(const Scene& scene) {
    const Measure& m = *scene.measure;
    const double interval = measured_interval(scene);
    const std::string rule = m.order_neighbours == measure::Neighbours::delaunay ? "Delaunay neighbours"
                             : m.order_cutoff ? fmt::format("neighbours within {:.3g} a",
                                                            *m.order_cutoff / scene::measured_radius(scene))
                                              : "neighbours within the first minimum of g(r)";
    const double every = interval > 0.0 ? interval * static_cast<double>(stride(m, interval))
                                        : m.order_interval.value_or(0.5); // or the next frame's time
    return fmt::format("g(r), psi6 and g_B(r), {}, every {:g} s", rule, every);
}

struct OrderValues {
    const OrderResult& r;
    double a; ///< m
};
using F = const OrderValues&;

constexpr ResultValue<OrderValues> values[] = {
    {{"psi6", R"($\psi_6$, measured frames)", "",
      R"($|\langle\psi_{6,i}\rangle|$ over the beads; neighbours by the cut-off below, or Delaunay)"},
     [](F f) { return f.r.psi6; }},
    {{"local_psi6", R"($\langle|\psi_{6,i}|\rangle$)", "",
      "mean over beads of the size of the local bond order"},
     [](F f) { return f.r.local_psi6; }},
    {{"neighbours", "Neighbours", "", "of a bead, mean"}, [](F f) { return f.r.neighbours; }},
    {{"cutoff", "Cut-off", "a", "beads nearer than this are neighbours"},
     [](F f) { return f.r.cutoff / f.a; }},
    {{"cutoffs_by_spacing", "", "runs", "whose $g(r)$ had no minimum to take the cut-off from"},
     [](F f) { return f.r.cutoffs_by_spacing; }},
    {{"g_minimum", "First minimum of $g(r)$", "a", "distance at which $g(r)$ of the beads has it"},
     [](F f) { return f.r.g_minimum ? Value(*f.r.g_minimum / f.a) : Value(); }},
    {{.key = "class",
      .meaning = "of the decay of $g_B$: exponential, algebraic, long-range",
      .is_text = true},
     [](F f) { return to_string(f.r.decay.decay); }},
    {{.key = "phase", .title = "Phase", .meaning = "of the beads, by the decay of $g_B$", .is_text = true},
     [](F f) { return phase_of(f.r.decay.decay); }},
    {{"exponent", R"($\eta_6$)", "", R"(of $g_B \propto r^{-\eta_6}$, fitted)"},
     [](F f) { return f.r.decay.exponent; }},
    {{"length", R"($\xi_6$)", "a", R"(of $g_B \propto \mathrm{exp}(-r/\xi_6)$, fitted)"},
     [](F f) { return f.r.decay.length.scaled(1.0 / f.a); }},
    {{"plateau", "", "", "$g_B$ far away: mean over the farther half of the points"},
     [](F f) { return f.r.decay.plateau; }},
    {{"chi2.exponential", "", "", "of the exponential fitted to $g_B$"},
     [](F f) { return f.r.decay.chi2_exponential; }},
    {{"chi2.algebraic", "", "", "of the power law fitted to $g_B$"},
     [](F f) { return f.r.decay.chi2_algebraic; }},
    {{"chi2.constant", "", "", "of the constant fitted to $g_B$"},
     [](F f) { return f.r.decay.chi2_constant; }},
    {{"points", "", "", "of $g_B$ that were fitted"}, [](F f) { return f.r.decay.points; }},
    {{.key = "reason", .meaning = "which numbers decided the class", .is_text = true},
     [](F f) { return f.r.decay.reason; }},
    {{"frames", "", "", "measured"}, [](F f) { return f.r.frames; }},
    {{"blocks", "", "", "of time, for the errors"}, [](F f) { return f.r.blocks; }},
};
constexpr auto value_infos = infos_of(values);

constexpr ResultColumn<OrderValues> gr_columns[] = {
    {{"r", "a", "distance"}, [](F f) { return scaled(f.r.r, 1.0 / f.a); }},
    {{"g", "1", "pair correlation g(r)"}, [](F f) { return f.r.g; }},
    {{"sigma", "1", "standard error (empty: unknown)"}, [](F f) { return f.r.g_error; }}};
constexpr ResultColumn<OrderValues> gB_columns[] = {
    {{"r", "a", "distance"}, [](F f) { return scaled(f.r.order_r, 1.0 / f.a); }},
    {{"gB", "1", "bond-orientational correlation g_B(r)"}, [](F f) { return f.r.g_B; }},
    {{"sigma", "1", "standard error (empty: unknown)"}, [](F f) { return f.r.g_B_error; }},
    {{"pairs", "1", "pairs behind the value"}, [](F f) { return f.r.order_pairs; }}};
/// One pair of kinds after the other.
constexpr auto for_kinds = [](F f, auto of_bin) {
    Column column;
    for (const measure::KindCorrelation& pair : f.r.kinds)
        for (std::size_t k = 0; k < f.r.r.size(); ++k)
            column.push_back(static_cast<double>(of_bin(pair, k)));
    return column;
};
constexpr ResultColumn<OrderValues> kinds_columns[] = {
    {{"kind", "1", "number of a kind in bead_kinds, from 0"},
     [](F f) { return for_kinds(f, [](const auto& pair, std::size_t) { return pair.kind; }); }},
    {{"other", "1", "number of the kind of the beads around it"},
     [](F f) { return for_kinds(f, [](const auto& pair, std::size_t) { return pair.other; }); }},
    {{"r", "a", "distance"},
     [](F f) { return for_kinds(f, [&](const auto&, std::size_t k) { return f.r.r[k] / f.a; }); }},
    {{"g", "1", "pair correlation g(r) of the two kinds"},
     [](F f) { return for_kinds(f, [](const auto& pair, std::size_t k) { return pair.g[k]; }); }},
    {{"sigma", "1", "standard error (empty: unknown)"},
     [](F f) { return for_kinds(f, [](const auto& pair, std::size_t k) { return pair.g_error[k]; }); }}};
constexpr auto gr_infos = infos_of(gr_columns);
constexpr auto gB_infos = infos_of(gB_columns);
constexpr auto kinds_infos = infos_of(kinds_columns);
constexpr FileInfo files[] = {
    {"gr.csv", "pair correlation", gr_infos},
    {"gr_kinds.csv", "pair correlation of beads of several sizes, by their kinds", kinds_infos},
    {"gB.csv", "bond-orientational correlation", gB_infos}};

/// The class as a number; not measured if undetermined.
Estimate class_number(const Value& text) {
    using measure::Decay;
    constexpr Decay numbered[] = {Decay::exponential, Decay::algebraic, Decay::long_range};
    for (double number = 0.0; const Decay decay : numbered) {
        if (std::get<std::string>(text) == to_string(decay))
            return {number, unknown_error, 1};
        number += 1.0;
    }
    return {};
}

constexpr SeriesInfo series[] = {
    {{"psi6", "1", "|mean over the beads of psi6|, neighbours as measure.order has them"}},
    {{"exponent", "1", "of an algebraic decay of g_B"}},
    {{"class", "1", "of the decay of g_B: 0 exponential, 1 algebraic, 2 long-range"},
     false,
     "class",
     class_number}};

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius();
    OrderResult r = measure::reduce(measure::take<OrderAccumulator>(data.sums, "order"));
    const auto still = std::ranges::count_if(data.tables, [&](const RunTables& run) {
        return data.scene.granular && run.summary("absorbing_state", "absorbing_state") != 0.0;
    });
    std::string border;
    if (still > 0) {
        r.decay.decay = measure::Decay::undetermined;
        r.decay.reason =
            fmt::format("{} of {} runs ended in an absorbing state: a bed that does not move has no phase",
                        still, data.tables.size());
        border = "; " + r.decay.reason;
    }
    const OrderValues f = {r, a};
    Values listed = values_of(values, f);
    if (r.at_border) { // only tracks have it; the stage logs it
        listed.push_back({"at_border", *r.at_border});
        border += fmt::format("; {:.2g} % of the beads are too near the border", 100.0 * *r.at_border);
    }
    std::vector<MeasureTable> tables = {
        {"gr.csv", "pair correlation g(r); r in bead radii a", gr_infos, columns_of(gr_columns, f)},
        {"gB.csv", "bond-orientational correlation g_B(r); r in a; pairs behind each value", gB_infos,
         columns_of(gB_columns, f)}};
    if (!r.kinds.empty())
        tables.push_back({"gr_kinds.csv", "pair correlation g(r) by kinds of beads; r in bead radii a",
                          kinds_infos, columns_of(kinds_columns, f)});
    return {.values = std::move(listed),
            .tables = std::move(tables),
            .line = fmt::format("psi6 {}, g_B {} ({}); neighbours within {:.3g} a{}", text(r.psi6),
                                to_string(r.decay.decay), phase_of(r.decay.decay), r.cutoff / a, border)};
}

} // namespace

MeasureKind order() {
    return {.name = "order",
            .order = 10,
            .wanted = [](const Measure& m) { return m.order; },
            .describe = describe,
            .include = include,
            .report = report,
            .values = value_infos,
            .files = files,
            .series = series};
}

} // namespace rodwake::app::measures

namespace rodwake::app {

std::vector<std::complex<double>> local_order(const scene::Scene& scene, measure::Measures& sums,
                                              const Column& x, const Column& y) {
    std::vector<std::complex<double>> psi(x.size(), std::nan(""));
    measure::Accumulator* const order = sums.find("order");
    if (!order)
        return psi;
    const measure::Layout& layout = sums.layout();
    const double cutoff = order->as<measure::OrderAccumulator>().settled_cutoff().value;
    if (scene.measure->order_neighbours == measure::Neighbours::delaunay)
        psi = measure::psi6_by_delaunay(x, y, image_box(layout));
    else if (cutoff > 0.0)
        psi = measure::psi6_by_cutoff(x, y, image_box(layout), cutoff);
    for (std::size_t i = 0; i < x.size(); ++i)
        if (layout.window && !(layout.window->inside_by(x[i], y[i]) > cutoff))
            psi[i] = std::nan("");
    return psi;
}

} // namespace rodwake::app
