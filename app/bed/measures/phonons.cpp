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

constexpr double degrees = 180.0 / std::numbers::pi;

/// One mode and branch, for phonons.csv.
struct ModeRow {
    const PhononMode& mode;
    const PhononBranch& b;
    double branch, a; ///< 0 longitudinal, 1 transverse; m

    static constexpr auto fields() {
        using R = const ModeRow&;
        return std::tuple{
            field("m", {"1", "waves along the side along x"}, [](R r) { return r.mode.m; }),
            field("n", {"1", "waves along the side along y; (m, n) and (m, -n) are put together"},
                  [](R r) { return r.mode.n; }),
            field("branch", {"1", "0 longitudinal, 1 transverse"}, [](R r) { return r.branch; }),
            field("q", {"1/a", "wave number"}, [](R r) { return r.mode.q() * r.a; }),
            field("direction", {"deg", "of q from +x"},
                  [](R r) { return std::atan2(r.mode.qy, r.mode.qx) * degrees; }),
            field("polarisation", {"deg", "of the longitudinal branch from q"},
                  [](R r) { return r.mode.polarisation * degrees; }),
            field("omega", {"1/s", "frequency without damping"}, [](R r) { return r.b.omega; }),
            field("gamma", {"1/s", "damping rate"}, [](R r) { return r.b.gamma; }),
            field("temperature", {"m^2/s^2", "T(q) = <|j|^2>/N"}, [](R r) { return r.b.temperature; }),
            field("displacement", {"a^2", "<|u_q|^2> (empty: beads left their sites)"},
                  [](R r) { return r.b.displacement.scaled(1.0 / (r.a * r.a)); }),
            field("omega_static", {"1/s", "sqrt(T(q)/(N <|u_q|^2>)) (empty: beads left their sites)"},
                  [](R r) { return r.b.omega_static; }),
            field("share", {"1", "of <|j|^2> that is the oscillator's"}, [](R r) { return r.b.share; })};
    }
};

/// One lag of it, for currents.csv.
struct CurrentRow {
    ModeRow of;
    std::size_t lag;
    double step; ///< s

    static constexpr auto fields() {
        using C = const CurrentRow&;
        return std::tuple{
            field("m", {"1", "waves along the side along x"}, [](C c) { return c.of.mode.m; }),
            field("n", {"1", "waves along the side along y"}, [](C c) { return c.of.mode.n; }),
            field("branch", {"1", "0 longitudinal, 1 transverse"}, [](C c) { return c.of.branch; }),
            field("lag", {"s", "time between the currents"},
                  [](C c) { return c.step * static_cast<double>(c.lag); }),
            field("value", {"1", "C(t)/C(0)"}, [](C c) { return c.of.b.correlation[c.lag]; }),
            field("fit", {"1", "the fitted oscillator"}, [](C c) { return c.of.b.fitted[c.lag]; })};
    }
};

struct PhononValues : PhononResult { ///< with the inertia
    PhononResult bare;               ///< with the bare mass of the beads
    Inertia inertia;
    double a; ///< m
    double to_a = 1.0 / a;

    static constexpr auto fields() {
        using R = PhononValues;
        return std::tuple{
            field("c_Lx", {"Longitudinal sound along $x$"},
                  {"a/s", "from $\\omega = cq$ of the first two waves"},
                  [](const R& r) { return r.c_Lx.scaled(r.to_a); }),
            field("c_Ly", {"Longitudinal sound along $y$"}, {"a/s", "the same"},
                  [](const R& r) { return r.c_Ly.scaled(r.to_a); }),
            field("c_Ld", {"Longitudinal sound, diagonal"}, {"a/s", "along the diagonal of the box"},
                  [](const R& r) { return r.c_Ld.scaled(r.to_a); }),
            field("c_Tx", {"Transverse sound along $x$"}, {"a/s", "the same"},
                  [](const R& r) { return r.c_Tx.scaled(r.to_a); }),
            field("c_Ty", {"Transverse sound along $y$"}, {"a/s", "the same"},
                  [](const R& r) { return r.c_Ty.scaled(r.to_a); }),
            field("c_Td", {"Transverse sound, diagonal"}, {"a/s", "the same"},
                  [](const R& r) { return r.c_Td.scaled(r.to_a); }),
            field("c_T", {"Transverse sound"}, {"a/s", "of $C_{66}$, both axes together"},
                  [](const R& r) { return shear_speed(r.bare).scaled(r.to_a); }),
            field("density", {"Density $\\rho$"},
                  {"kg/m^2", "mass of the beads over the area of the box; rods do not count"}, &R::density),
            field("C11", {"$C_{11}$", "mN/m"}, {"N/m", "$m^*\\rho c_{Lx}^2$"}, &R::C11),
            field("C22", {"$C_{22}$", "mN/m"}, {"N/m", "$m^*\\rho c_{Ly}^2$"}, &R::C22),
            field("C12", {"$C_{12}$", "mN/m"}, {"N/m", "from the diagonal by Christoffel's equation"},
                  &R::C12),
            field("C66", {"$C_{66}$", "mN/m"}, {"N/m", "$m^*\\rho c_T^2$ along the axes"}, &R::C66),
            field("C11_bare", {"", "mN/m"}, {"N/m", "$C_{11}$ of the bare mass of the beads, $m^* = 1$"},
                  [](const R& r) { return r.bare.C11; }),
            field("C22_bare", {"", "mN/m"}, {"N/m", "the same of $C_{22}$"},
                  [](const R& r) { return r.bare.C22; }),
            field("C12_bare", {"", "mN/m"}, {"N/m", "the same of $C_{12}$"},
                  [](const R& r) { return r.bare.C12; }),
            field("C66_bare", {"", "mN/m"}, {"N/m", "the same of $C_{66}$"},
                  [](const R& r) { return r.bare.C66; }),
            field("inertia", {"Inertia over mass $m^*$"},
                  {"1", "in the elastic constants (null: none is known, bare mass)"},
                  [](const R& r) { return r.inertia.factor; }),
            field("inertia_source", {"Mass in the constants"}, {"", "where $m^*$ comes from"},
                  [](const R& r) { return r.inertia.source; }),
            field("bulk", {"Bulk modulus $K$", "mN/m"},
                  {"N/m", "of the nearest isotropic medium, $(C_{11}+C_{22}+2C_{12})/4$"}, &R::bulk),
            field("mu", {"Shear modulus $\\mu$", "mN/m"},
                  {"N/m", "of it, $(C_{11}+C_{22}-2C_{12}+4C_{66})/8$"}, &R::mu),
            field("eta", {"$\\eta$"}, {"1", "of it, $K/\\mu = (\\lambda_L+\\mu)/\\mu$"}, &R::eta),
            field("spread_L", {"Spread of $\\rho c_L^2$"},
                  {"1", "largest less smallest over directions, in parts of $K+\\mu$: what the mean hides"},
                  &R::spread_L),
            field("spread_T", {"Spread of $\\rho c_T^2$"}, {"1", "the same in parts of $\\mu$"},
                  &R::spread_T),
            field("drag_rate", {"Damping $\\zeta/(m^* nm)$"},
                  {"1/s", "of the modes as $q \\to 0$; a steady push has $m^*$ times it"}, &R::drag),
            field("viscosity_L", {"Longitudinal viscosity"}, {"a^2/s", "slope of the damping against $q^2$"},
                  [](const R& r) { return r.viscosity_L.scaled(r.to_a * r.to_a); }),
            field("viscosity_T", {"Shear viscosity"}, {"a^2/s", "the same"},
                  [](const R& r) { return r.viscosity_T.scaled(r.to_a * r.to_a); }),
            field("temperature", {"$T_{xy}$ of single beads"}, {"m^2/s^2", "of the measured frames"},
                  &R::temperature),
            field("coldest", {"Coldest mode"}, {"1", "smallest $T(q)/T_{xy}$; 1 in equilibrium"},
                  [](const R& r) {
                      double least = INFINITY;
                      for (const PhononMode& mode : r.modes)
                          for (const PhononBranch* branch : {&mode.longitudinal, &mode.transverse})
                              least = std::min(least, branch->temperature.value / r.temperature.value);
                      return least;
                  }),
            field("travel", {"a", "root mean square distance of a bead from its first position, last block"},
                  [](const R& r) { return r.travel * r.to_a; }),
            field("kept_places", &R::kept_places,
                  {"1", "whether that is below half a spacing, so that displacements mean something"}),
            field("interval", &R::step, {"s", "between the frames of the currents"}),
            field("blocks", &R::blocks, {"1", "of time, for the errors"}),
            field("frames", &R::frames, {"1", "measured"})};
    }
};

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius();
    const Inertia inertia = inertia_of(data);
    const PhononResult bare = measure::reduce(measure::take<PhononAccumulator>(data.sums, "phonons"));
    // The elastic constants take m*; eta and the spreads are ratios and do not change. Their errors are
    // independent, since sound speeds do not know the drift of the whole bed.
    PhononResult r = bare;
    const Estimate& mass = inertia.factor;
    for (Estimate* constant : {&r.C11, &r.C22, &r.C12, &r.C66, &r.bulk, &r.mu})
        if (constant->count > 0 && mass.count > 0)
            *constant = {constant->value * mass.value,
                         std::hypot(constant->error * mass.value, constant->value * mass.error),
                         constant->count};
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
    const PhononValues f = {r, bare, inertia, a};
    data.row.c_T = shear_speed(bare).scaled(f.to_a);
    data.row.C11 = r.C11;
    data.row.C22 = r.C22;
    data.row.C66 = r.C66;
    return {
        .values = record_json(f),
        .tables = {{"phonons.csv",
                    "a row for each mode and branch; q in 1/a, rates in 1/s, angles in degrees",
                    csv_of(modes)},
                   {"currents.csv", "C(t)/C(0) of each mode and branch with the fitted oscillator; lag in s",
                    csv_of(currents)}},
        .line = fmt::format("C11 {}, C22 {}, C12 {}, C66 {} mN/m{}, eta {}; damping as q -> 0 {} /s",
                            text(r.C11.scaled(1e3)), text(r.C22.scaled(1e3)), text(r.C12.scaled(1e3)),
                            text(r.C66.scaled(1e3)), factor, text(r.eta), text(r.drag))};
}

std::vector<FileKind> files() {
    return {
        {"phonons.csv", Lifetime::result, "frequency, damping and temperature of each mode",
         columns_of<ModeRow>()},
        {"currents.csv", Lifetime::result, "current correlations and their fits", columns_of<CurrentRow>()}};
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
        .values = values_of<PhononValues, true>,
        .files = files};
}

} // namespace rodwake::app::measures
