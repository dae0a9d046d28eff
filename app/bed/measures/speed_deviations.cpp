// Large deviations of a rod's speed, from the runs' tracks.

#include "rodwake/measure/speed_deviations.hpp"

#include "bed/measure_parts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace rodwake::app::measures {

namespace {

using measure::DeviationBin, measure::DeviationLag, measure::SpeedDeviations;
using scene::Measure, scene::Scene;

constexpr SeriesInfo series[] = {
    {{"deviation_slope", "1/s", "of F(W) - F(-W), large deviations of the rod's speed"}},
    {{"deviation_kink", "1/s", "what the slope of F gains at W = 0"}}};

void reset_late_keys(Measure& m) {
    m.speed_deviations = false;
    m.deviation_lag = std::nullopt;
}

measure::DeviationOptions options_of(const Scene& scene, std::optional<double> film = {}) {
    return {scene.measure->block, scene::deviation_lag(*scene.measure, measured_duration(scene, film))};
}

struct Found {
    const SpeedDeviations& r;
    double a; ///< m
    bool told = r.told < r.lags.size();
    DeviationLag lag = told ? r.lags[r.told] : DeviationLag{};

    std::optional<double> known(double number) const { return told ? std::optional(number) : std::nullopt; }
};
using F = const Found&;

std::string words_of(F f) {
    if (!f.told)
        return "at no lag are there enough displacements backwards, 20 in each of 4 bins";
    const auto within = [](const Estimate& e) { return std::abs(e.value) <= 2.0 * e.error; };
    return fmt::format("at {:.3g} s F(W) - F(-W) {} linear in W, F has {}", f.lag.lag,
                       within(f.lag.cubic) ? "is" : "is not",
                       within(f.lag.kink) ? "no kink at 0 that is seen" : "a kink at 0");
}

constexpr ToldValue<Found> values[] = {
    {{"speed", "Speed of the rod", "a/s", "v, along its heading"},
     [](F f) { return f.r.speed.scaled(1.0 / f.a); }},
    {{"lag", "Lag $\\tau$ of the numbers below", "s", "the longest with enough displacements backwards"},
     [](F f) { return f.known(f.lag.lag); }},
    {{"backwards", "Share of displacements backwards", "", "along the heading, at this lag"},
     [](F f) { return f.known(f.lag.backwards); }},
    {{"deviation_slope", "Slope of $F(W)-F(-W)$", "1/s",
      "of a line through 0; F = -ln P/lag, W = displacement/(v lag)"},
     [](F f) { return f.lag.slope; }},
    {{"gaussian_slope", "Slope of a Gaussian", "1/s", "of the same variance, -2/(lag var W)"},
     [](F f) { return f.known(f.lag.gaussian_slope); }},
    {{"deviation_linear", "", "1/s", "of F(W) - F(-W) = linear W + cubic W^3"},
     [](F f) { return f.lag.linear; }},
    {{"deviation_cubic", "Its term in $W^3$", "1/s", "of the same; 0: F(W) - F(-W) is linear"},
     [](F f) { return f.lag.cubic; }},
    {{"deviation_kink", "Kink of $F$ at 0", "1/s", "what its slope gains there; 0: F is smooth"},
     [](F f) { return f.lag.kink; }},
    {{"pairs", "", "", "of bins at +-W in which both are known"}, [](F f) { return f.lag.pairs; }},
    {{.key = "reason", .meaning = "what these numbers say, at two errors", .is_text = true},
     [](F f) { return words_of(f); }},
    {{"blocks", "", "", "of time, within which displacements are taken"}, [](F f) { return f.r.blocks; }},
    {{"parts", "", "", "runs or blocks whose scatter gives the errors"}, [](F f) { return f.r.parts; }},
};
constexpr auto value_infos = infos_of(values);

double error_of(const Estimate& e) { return e.count > 0 ? e.error : unknown_error; }
double value_of(const Estimate& e) { return e.count > 0 ? e.value : unknown_error; }

constexpr RowColumn<DeviationLag> lag_columns[] = {
    {{"lag", "s", "tau"}, [](const DeviationLag& l) { return l.lag; }},
    {{"mean_W", "1", "of W"}, [](const DeviationLag& l) { return l.mean; }},
    {{"variance_W", "1", "of W"}, [](const DeviationLag& l) { return l.variance; }},
    {{"backwards", "1", "share of displacements backwards"},
     [](const DeviationLag& l) { return l.backwards; }},
    {{"pairs", "1", "of bins at +-W in which both are known"}, [](const DeviationLag& l) { return l.pairs; }},
    {{"slope", "1/s", "of F(W) - F(-W), through 0; empty: unknown"},
     [](const DeviationLag& l) { return value_of(l.slope); }},
    {{"slope_error", "1/s", "standard error; empty: unknown"},
     [](const DeviationLag& l) { return error_of(l.slope); }},
    {{"gaussian_slope", "1/s", "of a Gaussian of the same variance"},
     [](const DeviationLag& l) { return l.gaussian_slope; }},
    {{"cubic", "1/s", "term in W^3 of F(W) - F(-W); empty: unknown"},
     [](const DeviationLag& l) { return value_of(l.cubic); }},
    {{"cubic_error", "1/s", "standard error; empty: unknown"},
     [](const DeviationLag& l) { return error_of(l.cubic); }},
    {{"kink", "1/s", "what the slope of F gains at 0; empty: unknown"},
     [](const DeviationLag& l) { return value_of(l.kink); }},
    {{"kink_error", "1/s", "standard error; empty: unknown"},
     [](const DeviationLag& l) { return error_of(l.kink); }}};
constexpr auto lag_infos = infos_of(lag_columns);

struct Row {
    double lag;
    DeviationBin bin;
};
constexpr RowColumn<Row> bin_columns[] = {
    {{"lag", "s", "tau"}, [](const Row& r) { return r.lag; }},
    {{"W", "1", "displacement along the heading over that at the mean speed"},
     [](const Row& r) { return r.bin.W; }},
    {{"plus", "1", "displacements in the bin at W"}, [](const Row& r) { return r.bin.plus; }},
    {{"minus", "1", "displacements in the bin at -W"}, [](const Row& r) { return r.bin.minus; }},
    {{"F_plus", "1/s", "F(W) = -ln P(W)/lag; empty: too few"},
     [](const Row& r) { return value_of(r.bin.plus_rate); }},
    {{"F_plus_error", "1/s", "standard error; empty: unknown"},
     [](const Row& r) { return error_of(r.bin.plus_rate); }},
    {{"F_minus", "1/s", "F(-W); empty: too few"}, [](const Row& r) { return value_of(r.bin.minus_rate); }},
    {{"F_minus_error", "1/s", "standard error; empty: unknown"},
     [](const Row& r) { return error_of(r.bin.minus_rate); }},
    {{"A", "1/s", "F(W) - F(-W); empty: too few"},
     [](const Row& r) { return value_of(r.bin.antisymmetric); }},
    {{"A_error", "1/s", "standard error; empty: unknown"},
     [](const Row& r) { return error_of(r.bin.antisymmetric); }}};
constexpr auto bin_infos = infos_of(bin_columns);

constexpr FileInfo files[] = {
    {"deviations.csv", "large-deviation function of the rod's speed, by lag", bin_infos},
    {"deviation_lags.csv", "its antisymmetric part and its kink, by lag", lag_infos}};

MeasureReport report(const MeasuredCase& data) {
    std::vector<measure::HeadingTrack> tracks;
    for (const RunTables& run : data.tables)
        tracks.push_back(track_of(*data.scene.measure, run));
    const SpeedDeviations r = measure::speed_deviations(tracks, options_of(data.scene, data.film));
    const Found f = {r, data.bead_radius()};
    std::vector<Row> rows;
    for (const DeviationLag& lag : r.lags)
        for (const DeviationBin& bin : lag.bins)
            rows.push_back({lag.lag, bin});
    return {.values = values_of(values, f),
            .tables = {{"deviations.csv", "large-deviation function F in 1/s of W = displacement/(speed lag)",
                        bin_infos, columns_of(bin_columns, rows)},
                       {"deviation_lags.csv", "its antisymmetric part and its kink at W = 0 by lag in s",
                        lag_infos, columns_of(lag_columns, r.lags)}},
            .line = fmt::format("speed deviations: {}{}", words_of(f),
                                f.told ? fmt::format("; slope {} 1/s, a Gaussian's {:.3g}", text(f.lag.slope),
                                                     f.lag.gaussian_slope)
                                       : "")};
}

std::string describe(const Scene& scene) {
    return fmt::format("large deviations of the speed of rod {} over lags up to {:.3g} s", scene.measure->rod,
                       options_of(scene).lag);
}

} // namespace

MeasureKind speed_deviations() {
    return {.name = "speed_deviations",
            .order = 100,
            .wanted = [](const Measure& m) { return m.speed_deviations; },
            .describe = describe,
            .reset_late_keys = reset_late_keys,
            .report = report,
            .values = value_infos,
            .files = files,
            .series = series};
}

} // namespace rodwake::app::measures
