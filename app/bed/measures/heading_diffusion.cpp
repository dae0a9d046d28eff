// Heading diffusion and speed of a rod, from the runs' tracks; the noise of the theory's rods that it makes.

#include "rodwake/measure/heading_diffusion.hpp"

#include "bed/measure_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace rodwake::app::measures {

namespace {

using measure::HeadingDiffusion, measure::HeadingTrack;
using scene::Measure, scene::Scene;

constexpr double papers_f_over_mu = 2.2; // a; arXiv 2007.04860, its fit of the wake

void reset_postprocessing_keys(Measure& m) {
    m.heading_diffusion = false;
    m.heading_lag_low = m.heading_lag_high = std::nullopt;
}

measure::HeadingOptions options_of(const Scene& scene, std::optional<double> film = {}) {
    const Measure& m = *scene.measure;
    const double high = scene::heading_lag_high(m, measured_duration(scene, film));
    return {m.block, m.heading_lag_low.value_or(0.1 * high), high};
}

/// What the scene of the theory takes; nothing for a rod that does not walk, and where no diffusion is seen.
std::string noise_of(const HeadingDiffusion& r, double a, double unit) {
    constexpr double rounding = 1e-10; // rad; a lone rod on its limit cycle turns by some 1e-16
    const double change = std::sqrt(r.square.back());
    if (change < rounding)
        return fmt::format("none: the heading changes by {:.1g} rad (rms) in {:g} s, by rounding alone",
                           change, r.lag_high);
    const double turn = std::abs(r.turn_rate.value);
    if (turn > 3.0 * r.turn_rate.error && std::pow(turn * r.lag_high, 2) > 0.1 * r.square.back())
        return fmt::format("none: the rod turns steadily, by {:.2g} +- {:.1g} rad/s", turn,
                           r.turn_rate.error);
    const Estimate reduced = r.diffusion_per_length.scaled(a * unit);
    if (reduced.count == 0 || !(reduced.value > 0.0))
        return "";
    const std::string error = reduced.known() ? fmt::format(" +- {:.2g}", reduced.error) : "";
    return fmt::format("rotational_diffusion = {:.4g}{}, with f/mu = {:.4g} a", reduced.value, error, unit);
}

struct HeadingDiffusionValues : HeadingDiffusion {
    double a;                                             ///< m
    double unit;                                          ///< f/mu, a
    Estimate per_length = diffusion_per_length.scaled(a); ///< rad^2/a

    static constexpr auto fields() {
        using R = HeadingDiffusionValues;
        return std::tuple{
            field("D_r", {"Heading diffusion $D_r$"},
                  {"rad^2/s", "half the slope of the mean-square heading change"}, &R::diffusion),
            field("D_r_low", &R::low, {"rad^2/s", "lower end of the 95 % interval of D_r"}),
            field("D_r_high", &R::high, {"rad^2/s", "upper end of it"}),
            field("D_r_cosine", {"$D_r$ from $\\langle\\cos\\Delta\\theta\\rangle$"},
                  {"rad^2/s", "decay rate of the mean cosine"}, &R::diffusion_cosine),
            field("D_r_early", {"$D_r$, short lags"}, {"rad^2/s", "from the lower half of the window alone"},
                  &R::early),
            field("D_r_late", {"$D_r$, long lags"},
                  {"rad^2/s", "from the upper half; diffusion if both agree"}, &R::late),
            field("jitter", {"Rattling of the heading"},
                  {"rad", "rms, forgotten within the shortest lag of the window"}, &R::jitter),
            field("turn_rate", {"Turning rate"},
                  {"rad/s", "mean; a steady one adds to the mean-square heading change"}, &R::turn_rate),
            field("speed", {"Speed of the rod"}, {"a/s", "along its heading"},
                  [](const R& r) { return r.speed.scaled(1.0 / r.a); }),
            field("diffusion_per_length", {"$D_r/v_0$"},
                  {"rad^2/a", "heading diffusion on the way of one bead radius"}, &R::per_length),
            field("f_over_mu", {"Unit of length $f/\\mu$"},
                  {"a", "of the next value: from [scales], else 2.2 a as in the paper"}, &R::unit),
            field("rotational_diffusion", {"$D_r f/(\\mu v_0)$"},
                  {"1", "the same in the units of the theory"},
                  [](const R& r) { return r.per_length.scaled(r.unit); }),
            field("noise", {"The theory's [noise]"}, {"", "with the same heading diffusion"},
                  [](const R& r) { return noise_of(r, r.a, r.unit); }),
            field("lag_low", &R::lag_low, {"s", "shortest lag of the fits"}),
            field("lag_high", &R::lag_high, {"s", "longest lag of the fits"}),
            field("cosine_amplitude", &R::cosine_amplitude, {"1", "of the fitted exponential at lag 0"}),
            field("blocks", &R::blocks, {"1", "of time, within which changes are taken"}),
            field("parts", &R::parts, {"1", "runs or blocks whose scatter gives the errors"})};
    }
};
struct HeadingColumns : HeadingDiffusion {
    static constexpr auto fields() {
        using R = HeadingColumns;
        return std::tuple{
            field("lag", &R::lag, {"s", "time between two headings"}),
            field("square", &R::square, {"rad^2", "mean-square heading change"}),
            field("square_error", &R::square_error, {"rad^2", "standard error (empty: unknown)"}),
            field("cosine", &R::cosine, {"1", "mean cosine of the heading change"}),
            field("cosine_error", &R::cosine_error, {"1", "standard error (empty: unknown)"}),
            field("origins", &R::origins, {"1", "starting times behind them"})};
    }
};

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius(),
                 unit = data.scene.scales ? data.scene.scales->f_over_mu / a : papers_f_over_mu;
    std::vector<HeadingTrack> tracks;
    for (const RunTables& run : data.tables)
        tracks.push_back(track_of(*data.scene.measure, run));
    const HeadingDiffusion r = measure::heading_diffusion(tracks, options_of(data.scene, data.film));
    const HeadingDiffusionValues f = {r, a, unit};
    const std::string speed = text(r.speed.scaled(1.0 / a)), noise = noise_of(r, a, unit);
    std::string line =
        fmt::format("heading diffusion {} rad^2/s over {:.3g} to {:.3g} s, speed {} a/s{}", text(r.diffusion),
                    r.lag_low, r.lag_high, speed, noise.empty() ? "" : "; [noise] " + noise);
    constexpr double rounding = 1e-24; // rad^2; of headings near 1 it is 1e-32
    if (!r.square.empty() && std::ranges::all_of(r.square, [](double square) { return square < rounding; }))
        line = fmt::format("the rod never turns: no heading diffusion; speed {} a/s", speed);
    data.row.D_r = r.diffusion;
    data.row.diffusion_per_length = f.per_length;
    return {.values = record_json(f),
            .tables = {{"heading.csv",
                        "mean-square heading change in rad^2 and mean cosine of it against the lag in s",
                        csv_of(HeadingColumns{r})}},
            .line = std::move(line)};
}

std::string describe(const Scene& scene) {
    const measure::HeadingOptions o = options_of(scene);
    return fmt::format("heading diffusion of rod {} over lags from {:.3g} to {:.3g} s", scene.measure->rod,
                       o.lag_low, o.lag_high);
}

std::vector<FileKind> files() {
    return {{"heading.csv", Lifetime::result, "heading change of the rod against the lag",
             columns_of<HeadingColumns>()}};
}

} // namespace

MeasureKind heading_diffusion() {
    return {.name = "heading_diffusion",
            .order = 90,
            .wanted = [](const Measure& m) { return m.heading_diffusion; },
            .describe = describe,
            .reset_postprocessing_keys = reset_postprocessing_keys,
            .report = report,
            .values = values_of<HeadingDiffusionValues, true>,
            .files = files};
}

} // namespace rodwake::app::measures
