// Sound in the bed: current correlations, frequencies and damping of modes, elastic constants.

#include "rodwake/measure/phonons.hpp"

#include "bed/measure_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::app::measures {

namespace {

using measure::PhononAccumulator, measure::PhononBranch, measure::PhononMode, measure::PhononResult;
using scene::Measure, scene::Scene;

constexpr SeriesInfo series[] = {{{"c_T", "a/s", "speed of transverse sound"}},
                                 {{"C11", "N/m", "elastic constant along x"}},
                                 {{"C22", "N/m", "elastic constant along y"}},
                                 {{"C66", "N/m", "shear constant"}}};

measure::PhononOptions options_of(const Measure& m) {
    return {static_cast<std::size_t>(m.phonon_waves), m.phonon_lag.value_or(std::min(1.0, 0.5 * m.block)),
            m.block};
}

/// Every frame that is measured: its own interval decides how dense those are.
void include(const Scene& scene, MeasurePlan& plan) {
    plan.sums.include(
        "phonons", measure::Accumulator(PhononAccumulator(plan.sums.layout(), options_of(*scene.measure))));
}

std::string describe(const Scene& scene) {
    const measure::PhononOptions o = options_of(*scene.measure);
    return fmt::format("currents of modes up to {} waves along a side, lags up to {:g} s", o.shells,
                       o.longest_lag);
}

Estimate shear_speed(const PhononResult& r) {
    const double c = std::sqrt(r.C66.value / r.density);
    return r.C66.count == 0 ? Estimate{} : Estimate{c, 0.5 * c * r.C66.error / r.C66.value, r.C66.count};
}

/// m* times it; their errors are independent, since sound speeds do not know the drift of the whole bed.
Estimate with_inertia(const Estimate& constant, const Inertia& inertia) {
    if (constant.count == 0 || inertia.factor.count == 0)
        return constant;
    const double value = constant.value * inertia.factor.value;
    return {value, std::hypot(constant.error * inertia.factor.value, constant.value * inertia.factor.error),
            constant.count};
}

/// The elastic constants with m*; eta and the spreads are ratios and do not change.
PhononResult with_inertia(PhononResult r, const Inertia& inertia) {
    for (Estimate* constant : {&r.C11, &r.C22, &r.C12, &r.C66, &r.bulk, &r.mu})
        *constant = with_inertia(*constant, inertia);
    return r;
}

double coldest(const PhononResult& r) {
    double least = INFINITY;
    for (const PhononMode& mode : r.modes)
        for (const PhononBranch* branch : {&mode.longitudinal, &mode.transverse})
            least = std::min(least, branch->temperature.value / r.temperature.value);
    return least;
}

/// One mode and branch, for phonons.csv.
struct ModeRow {
    const PhononMode& mode;
    const PhononBranch& b;
    double branch, a; ///< 0 longitudinal, 1 transverse; m
};
using R = const ModeRow&;

/// Nothing measured is an empty field.
double value_or_empty(const Estimate& e, double scale = 1.0) {
    return e.count > 0 ? e.value * scale : std::nan("");
}
double error_or_empty(const Estimate& e, double scale = 1.0) {
    return e.count > 0 ? e.error * scale : std::nan("");
}

constexpr double degrees = 180.0 / std::numbers::pi;
constexpr RowColumn<ModeRow> mode_columns[] = {
    {{"m", "1", "waves along the side along x"}, [](R r) { return r.mode.m; }},
    {{"n", "1", "waves along the side along y; (m, n) and (m, -n) are put together"},
     [](R r) { return r.mode.n; }},
    {{"branch", "1", "0 longitudinal, 1 transverse"}, [](R r) { return r.branch; }},
    {{"q", "1/a", "wave number"}, [](R r) { return r.mode.q() * r.a; }},
    {{"direction", "deg", "of q from +x"}, [](R r) { return std::atan2(r.mode.qy, r.mode.qx) * degrees; }},
    {{"polarisation", "deg", "of the longitudinal branch from q"},
     [](R r) { return r.mode.polarisation * degrees; }},
    {{"omega", "1/s", "frequency without damping"}, [](R r) { return value_or_empty(r.b.omega); }},
    {{"omega_error", "1/s", "standard error"}, [](R r) { return error_or_empty(r.b.omega); }},
    {{"gamma", "1/s", "damping rate"}, [](R r) { return value_or_empty(r.b.gamma); }},
    {{"gamma_error", "1/s", "standard error"}, [](R r) { return error_or_empty(r.b.gamma); }},
    {{"temperature", "m^2/s^2", "T(q) = <|j|^2>/N"}, [](R r) { return value_or_empty(r.b.temperature); }},
    {{"temperature_error", "m^2/s^2", "standard error"}, [](R r) { return error_or_empty(r.b.temperature); }},
    {{"displacement", "a^2", "<|u_q|^2> (empty: beads left their sites)"},
     [](R r) { return value_or_empty(r.b.displacement, 1.0 / (r.a * r.a)); }},
    {{"displacement_error", "a^2", "standard error"},
     [](R r) { return error_or_empty(r.b.displacement, 1.0 / (r.a * r.a)); }},
    {{"omega_static", "1/s", "sqrt(T(q)/(N <|u_q|^2>)) (empty: beads left their sites)"},
     [](R r) { return value_or_empty(r.b.omega_static); }},
    {{"omega_static_error", "1/s", "standard error"}, [](R r) { return error_or_empty(r.b.omega_static); }},
    {{"share", "1", "of <|j|^2> that is the oscillator's"}, [](R r) { return r.b.share; }}};

/// One lag of it, for currents.csv.
struct CurrentRow {
    ModeRow of;
    std::size_t lag;
    double step; ///< s
};
using C = const CurrentRow&;
constexpr RowColumn<CurrentRow> current_columns[] = {
    {{"m", "1", "waves along the side along x"}, [](C c) { return c.of.mode.m; }},
    {{"n", "1", "waves along the side along y"}, [](C c) { return c.of.mode.n; }},
    {{"branch", "1", "0 longitudinal, 1 transverse"}, [](C c) { return c.of.branch; }},
    {{"lag", "s", "time between the currents"}, [](C c) { return c.step * static_cast<double>(c.lag); }},
    {{"value", "1", "C(t)/C(0)"}, [](C c) { return c.of.b.correlation[c.lag]; }},
    {{"fit", "1", "the fitted oscillator"}, [](C c) { return c.of.b.fitted[c.lag]; }}};
constexpr auto mode_infos = infos_of(mode_columns);
constexpr auto current_infos = infos_of(current_columns);
constexpr FileInfo files[] = {{"phonons.csv", "frequency, damping and temperature of each mode", mode_infos},
                              {"currents.csv", "current correlations and their fits", current_infos}};

struct PhononValues {
    const PhononResult &bare, &r; ///< with the bare mass of the beads, and with the inertia
    const Inertia& inertia;
    double a; ///< m
    double to_a = 1.0 / a;
};
using F = const PhononValues&;

constexpr ResultValue<PhononValues> values[] = {
    {{"c_Lx", "Longitudinal sound along $x$", "a/s", "from $\\omega = cq$ of the first two waves"},
     [](F f) { return f.r.c_Lx.scaled(f.to_a); }},
    {{"c_Ly", "Longitudinal sound along $y$", "a/s", "the same"},
     [](F f) { return f.r.c_Ly.scaled(f.to_a); }},
    {{"c_Ld", "Longitudinal sound, diagonal", "a/s", "along the diagonal of the box"},
     [](F f) { return f.r.c_Ld.scaled(f.to_a); }},
    {{"c_Tx", "Transverse sound along $x$", "a/s", "the same"}, [](F f) { return f.r.c_Tx.scaled(f.to_a); }},
    {{"c_Ty", "Transverse sound along $y$", "a/s", "the same"}, [](F f) { return f.r.c_Ty.scaled(f.to_a); }},
    {{"c_Td", "Transverse sound, diagonal", "a/s", "the same"}, [](F f) { return f.r.c_Td.scaled(f.to_a); }},
    {{"c_T", "Transverse sound", "a/s", "of $C_{66}$, both axes together"},
     [](F f) { return shear_speed(f.bare).scaled(f.to_a); }},
    {{"density", "Density $\\rho$", "kg/m^2",
      "mass of the beads over the area of the box; rods do not count"},
     [](F f) { return f.r.density; }},
    {{"C11", "$C_{11}$", "mN/m", "$m^*\\rho c_{Lx}^2$", 1e3}, [](F f) { return f.r.C11; }},
    {{"C22", "$C_{22}$", "mN/m", "$m^*\\rho c_{Ly}^2$", 1e3}, [](F f) { return f.r.C22; }},
    {{"C12", "$C_{12}$", "mN/m", "from the diagonal by Christoffel's equation", 1e3},
     [](F f) { return f.r.C12; }},
    {{"C66", "$C_{66}$", "mN/m", "$m^*\\rho c_T^2$ along the axes", 1e3}, [](F f) { return f.r.C66; }},
    {{"C11_bare", "", "mN/m", "$C_{11}$ of the bare mass of the beads, $m^* = 1$", 1e3},
     [](F f) { return f.bare.C11; }},
    {{"C22_bare", "", "mN/m", "the same of $C_{22}$", 1e3}, [](F f) { return f.bare.C22; }},
    {{"C12_bare", "", "mN/m", "the same of $C_{12}$", 1e3}, [](F f) { return f.bare.C12; }},
    {{"C66_bare", "", "mN/m", "the same of $C_{66}$", 1e3}, [](F f) { return f.bare.C66; }},
    {{"inertia", "Inertia over mass $m^*$", "", "in the elastic constants (null: none is known, bare mass)"},
     [](F f) { return f.inertia.factor; }},
    {{"inertia_source", "Mass in the constants", "", "where $m^*$ comes from", 1.0, true},
     [](F f) { return f.inertia.source; }},
    {{"bulk", "Bulk modulus $K$", "mN/m", "of the nearest isotropic medium, $(C_{11}+C_{22}+2C_{12})/4$",
      1e3},
     [](F f) { return f.r.bulk; }},
    {{"mu", "Shear modulus $\\mu$", "mN/m", "of it, $(C_{11}+C_{22}-2C_{12}+4C_{66})/8$", 1e3},
     [](F f) { return f.r.mu; }},
    {{"eta", "$\\eta$", "", "of it, $K/\\mu = (\\lambda_L+\\mu)/\\mu$"}, [](F f) { return f.r.eta; }},
    {{"spread_L", "Spread of $\\rho c_L^2$", "",
      "largest less smallest over directions, in parts of $K+\\mu$: what the mean hides"},
     [](F f) { return f.r.spread_L; }},
    {{"spread_T", "Spread of $\\rho c_T^2$", "", "the same in parts of $\\mu$"},
     [](F f) { return f.r.spread_T; }},
    {{"drag_rate", "Damping $\\zeta/(m^* nm)$", "1/s",
      "of the modes as $q \\to 0$; a steady push has $m^*$ times it"},
     [](F f) { return f.r.drag; }},
    {{"viscosity_L", "Longitudinal viscosity", "a^2/s", "slope of the damping against $q^2$"},
     [](F f) { return f.r.viscosity_L.scaled(f.to_a * f.to_a); }},
    {{"viscosity_T", "Shear viscosity", "a^2/s", "the same"},
     [](F f) { return f.r.viscosity_T.scaled(f.to_a * f.to_a); }},
    {{"temperature", "$T_{xy}$ of single beads", "m^2/s^2", "of the measured frames"},
     [](F f) { return f.r.temperature; }},
    {{"coldest", "Coldest mode", "", "smallest $T(q)/T_{xy}$; 1 in equilibrium"},
     [](F f) { return coldest(f.r); }},
    {{"travel", "", "a", "root mean square distance of a bead from its first position, last block"},
     [](F f) { return f.r.travel * f.to_a; }},
    {{"kept_places", "", "", "whether that is below half a spacing, so that displacements mean something"},
     [](F f) { return f.r.kept_places; }},
    {{"interval", "", "s", "between the frames of the currents"}, [](F f) { return f.r.step; }},
    {{"blocks", "", "", "of time, for the errors"}, [](F f) { return f.r.blocks; }},
    {{"frames", "", "", "measured"}, [](F f) { return f.r.frames; }},
};
constexpr auto value_infos = infos_of(values);

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius();
    const Inertia inertia = inertia_of(data);
    const PhononResult bare = measure::reduce(measure::take<PhononAccumulator>(data.sums, "phonons")),
                       r = with_inertia(bare, inertia);
    std::vector<ModeRow> modes;
    std::vector<CurrentRow> currents;
    for (const PhononMode& mode : bare.modes) {
        modes.push_back({mode, mode.longitudinal, 0.0, a});
        modes.push_back({mode, mode.transverse, 1.0, a});
    }
    for (const ModeRow& mode : modes)
        for (std::size_t lag = 0; lag < mode.b.correlation.size(); ++lag)
            currents.push_back({mode, lag, bare.step});
    const std::string factor =
        inertia.factor.count > 0 ? " with m* " + text(inertia.factor) : " of the bare mass";
    return {
        .values = values_of(values, PhononValues{bare, r, inertia, a}),
        .tables =
            std::vector<MeasureTable>{
                {"phonons.csv", "a row for each mode and branch; q in 1/a, rates in 1/s, angles in degrees",
                 mode_infos, columns_of(mode_columns, modes)},
                {"currents.csv", "C(t)/C(0) of each mode and branch with the fitted oscillator; lag in s",
                 current_infos, columns_of(current_columns, currents)}},
        .line = fmt::format("C11 {}, C22 {}, C12 {}, C66 {} mN/m{}, eta {}; damping as q -> 0 {} /s",
                            text(r.C11.scaled(1e3)), text(r.C22.scaled(1e3)), text(r.C12.scaled(1e3)),
                            text(r.C66.scaled(1e3)), factor, text(r.eta), text(r.drag))};
}

} // namespace

MeasureKind phonons() {
    return {
        .name = "phonons",
        .order = 70,
        .wanted = [](const Measure& m) { return m.phonons; },
        .describe = describe,
        .include = include,
        .reset_postprocessing_keys = [](Measure& m) { m.inertia_factor = m.inertia_error = std::nullopt; },
        .report = report,
        .values = value_infos,
        .files = files,
        .series = series};
}

} // namespace rodwake::app::measures
