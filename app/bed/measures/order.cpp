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
using nlohmann::ordered_json;
using scene::Measure, scene::Scene;

/// Every so many of the measured frames.
std::size_t stride(const Measure& m, double interval) {
    const double wanted = m.order_interval.value_or(std::max(interval, 0.5));
    return static_cast<std::size_t>(std::max(1.0, std::ceil(wanted / interval * (1.0 - 1e-9))));
}

void include(const Scene& scene, MeasurePlan& plan) {
    const Measure& m = *scene.measure;
    const double a = scene::measured_radius(scene);
    measure::OrderOptions options;
    options.neighbours = m.order_neighbours;
    options.cutoff = m.order_cutoff;
    options.bin = 0.05 * a;
    options.order_bin = a;
    options.block = m.block;
    if (scene.tracks)
        options.localisation = scene.tracks->localisation.given;
    include_sums<OrderAccumulator>(plan, "order", options,
                                   stride(m, plan.interval * static_cast<double>(plan.stride)));
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

struct DecayFits : measure::DecayClass {
    static constexpr auto fields() {
        using R = DecayFits;
        return std::tuple{
            field("exponential", &R::chi2_exponential, {"1", "of the exponential fitted to $g_B$"}),
            field("algebraic", &R::chi2_algebraic, {"1", "of the power law fitted to $g_B$"}),
            field("constant", &R::chi2_constant, {"1", "of the constant fitted to $g_B$"})};
    }
};

struct ScaledOrder : OrderResult {
    double a; ///< m
};

struct OrderValues : ScaledOrder {
    static constexpr auto fields() {
        using R = OrderValues;
        return std::tuple{
            field(
                "psi6", {R"($\psi_6$, measured frames)"},
                {"1",
                 R"($|\langle\psi_{6,i}\rangle|$ over the beads; neighbours by the cut-off below, or Delaunay)"},
                &R::psi6),
            field("local_psi6", {R"($\langle|\psi_{6,i}|\rangle$)"},
                  {"1", "mean over beads of the size of the local bond order"}, &R::local_psi6),
            field("neighbours", {"Neighbours"}, {"1", "of a bead, mean"}, &R::neighbours),
            field("cutoff", {"Cut-off"}, {"a", "beads nearer than this are neighbours"},
                  [](const R& r) { return r.cutoff / r.a; }),
            field("cutoffs_by_spacing", &R::cutoffs_by_spacing,
                  {"runs", "whose $g(r)$ had no minimum to take the cut-off from"}),
            field("g_minimum", {"First minimum of $g(r)$"},
                  {"a", "distance at which $g(r)$ of the beads has it"},
                  [](const R& r) { return r.g_minimum ? *r.g_minimum / r.a : std::nan(""); }),
            field("class", {"", "of the decay of $g_B$: exponential, algebraic, long-range"},
                  [](const R& r) { return to_string(r.decay.decay); }),
            field("phase", {"Phase"}, {"", "of the beads, by the decay of $g_B$"},
                  [](const R& r) { return phase_of(r.decay.decay); }),
            field("exponent", {R"($\eta_6$)"}, {"1", R"(of $g_B \propto r^{-\eta_6}$, fitted)"},
                  [](const R& r) { return r.decay.exponent; }),
            field("length", {R"($\xi_6$)"}, {"a", R"(of $g_B \propto \mathrm{exp}(-r/\xi_6)$, fitted)"},
                  [](const R& r) { return r.decay.length.scaled(1.0 / r.a); }),
            field("plateau", {"1", "$g_B$ far away: mean over the farther half of the points"},
                  [](const R& r) { return r.decay.plateau; }),
            field("chi2", {"1", "of what was fitted to $g_B$"},
                  [](const R& r) { return DecayFits{r.decay}; }),
            field("points", {"1", "of $g_B$ that were fitted"}, [](const R& r) { return r.decay.points; }),
            field("reason", {"", "which numbers decided the class"},
                  [](const R& r) { return r.decay.reason; }),
            field("frames", &R::frames, {"1", "measured"}),
            field("blocks", &R::blocks, {"1", "of time, for the errors"})};
    }
};

/// Of tracks in an open window, or a bed with a wall.
struct BorderShare {
    double at_border;

    static constexpr auto fields() {
        return std::tuple{field("at_border", &BorderShare::at_border,
                                {"1", "of tracks in an open window, or a bed with a wall: share of the beads "
                                      "so near its border that psi6 leaves them out"})};
    }
};

struct PairCorrelation : ScaledOrder {
    static constexpr auto fields() {
        using R = PairCorrelation;
        return std::tuple{field("r", {"a", "distance"}, [](const R& r) { return scaled(r.r, 1.0 / r.a); }),
                          field("g", &R::g, {"1", "pair correlation g(r)"}),
                          field("sigma", &R::g_error, {"1", "standard error (empty: unknown)"})};
    }
};

struct BondCorrelation : ScaledOrder {
    static constexpr auto fields() {
        using R = BondCorrelation;
        return std::tuple{
            field("r", {"a", "distance"}, [](const R& r) { return scaled(r.order_r, 1.0 / r.a); }),
            field("gB", &R::g_B, {"1", "bond-orientational correlation g_B(r)"}),
            field("sigma", &R::g_B_error, {"1", "standard error (empty: unknown)"}),
            field("pairs", &R::order_pairs, {"1", "pairs behind the value"})};
    }
};

/// One pair of kinds after the other.
struct KindRow {
    const measure::KindCorrelation& pair;
    std::size_t bin;
    double r; ///< a

    static constexpr auto fields() {
        using R = const KindRow&;
        return std::tuple{field("kind", {"1", "number of a kind in bead_kinds, from 0"},
                                [](R row) { return row.pair.kind; }),
                          field("other", {"1", "number of the kind of the beads around it"},
                                [](R row) { return row.pair.other; }),
                          field("r", &KindRow::r, {"a", "distance"}),
                          field("g", {"1", "pair correlation g(r) of the two kinds"},
                                [](R row) { return row.pair.g[row.bin]; }),
                          field("sigma", {"1", "standard error (empty: unknown)"},
                                [](R row) { return row.pair.g_error[row.bin]; })};
    }
};

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
    const ScaledOrder f = {r, a};
    ordered_json values = record_json(OrderValues{f});
    if (r.at_border) { // only tracks have it; the stage logs it
        values.update(record_json(BorderShare{*r.at_border}));
        border += fmt::format("; {:.2g} % of the beads are too near the border", 100.0 * *r.at_border);
    }
    std::vector<CsvFile> tables = {
        {"gr.csv", "pair correlation g(r); r in bead radii a", csv_of(PairCorrelation{f})},
        {"gB.csv", "bond-orientational correlation g_B(r); r in a; pairs behind each value",
         csv_of(BondCorrelation{f})}};
    if (!r.kinds.empty()) {
        std::vector<KindRow> rows;
        for (const measure::KindCorrelation& pair : r.kinds)
            for (std::size_t k = 0; k < r.r.size(); ++k)
                rows.push_back({pair, k, r.r[k] / a});
        tables.push_back(
            {"gr_kinds.csv", "pair correlation g(r) by kinds of beads; r in bead radii a", csv_of(rows)});
    }
    data.row.psi6 = r.psi6;
    data.row.exponent = r.decay.exponent;
    if (r.decay.decay != measure::Decay::undetermined)
        data.row.decay_class = static_cast<double>(r.decay.decay) - 1.0;
    return {.values = std::move(values),
            .tables = std::move(tables),
            .line = fmt::format("psi6 {}, g_B {} ({}); neighbours within {:.3g} a{}", text(r.psi6),
                                to_string(r.decay.decay), phase_of(r.decay.decay), r.cutoff / a, border)};
}

std::vector<FileKind> files() {
    return {{"gr.csv", Lifetime::result, "pair correlation", columns_of<PairCorrelation>()},
            {"gr_kinds.csv", Lifetime::result, "pair correlation of beads of several sizes, by their kinds",
             columns_of<KindRow>()},
            {"gB.csv", Lifetime::result, "bond-orientational correlation", columns_of<BondCorrelation>()}};
}

} // namespace

MeasureKind order() {
    return {.name = "order",
            .order = 10,
            .wanted = [](const Measure& m) { return m.order; },
            .describe = describe,
            .include = include,
            .report = report,
            .values = values_of<OrderValues, true>,
            .film_numbers = values_of<BorderShare>,
            .files = files};
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
