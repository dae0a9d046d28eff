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

constexpr ValueInfo values[] = {
    {"c_Lx", "Longitudinal sound along $x$", "a/s", "from $\\omega = cq$ of the first two waves"},
    {"c_Ly", "Longitudinal sound along $y$", "a/s", "the same"},
    {"c_Ld", "Longitudinal sound, diagonal", "a/s", "along the diagonal of the box"},
    {"c_Tx", "Transverse sound along $x$", "a/s", "the same"},
    {"c_Ty", "Transverse sound along $y$", "a/s", "the same"},
    {"c_Td", "Transverse sound, diagonal", "a/s", "the same"},
    {"c_T", "Transverse sound", "a/s", "of $C_{66}$, both axes together"},
    {"density", "Density $\\rho$", "kg/m^2", "mass of the beads over the area of the box; rods do not count"},
    {"C11", "$C_{11}$", "mN/m", "$m^*\\rho c_{Lx}^2$", 1e3},
    {"C22", "$C_{22}$", "mN/m", "$m^*\\rho c_{Ly}^2$", 1e3},
    {"C12", "$C_{12}$", "mN/m", "from the diagonal by Christoffel's equation", 1e3},
    {"C66", "$C_{66}$", "mN/m", "$m^*\\rho c_T^2$ along the axes", 1e3},
    {"C11_bare", "", "mN/m", "$C_{11}$ of the bare mass of the beads, $m^* = 1$", 1e3},
    {"C22_bare", "", "mN/m", "the same of $C_{22}$", 1e3},
    {"C12_bare", "", "mN/m", "the same of $C_{12}$", 1e3},
    {"C66_bare", "", "mN/m", "the same of $C_{66}$", 1e3},
    {"inertia", "Inertia over mass $m^*$", "", "in the elastic constants; null: none is known, bare mass"},
    {"inertia_source", "Mass in the constants", "", "where $m^*$ comes from", 1.0, true},
    {"bulk", "Bulk modulus $K$", "mN/m", "of the nearest isotropic medium, $(C_{11}+C_{22}+2C_{12})/4$", 1e3},
    {"mu", "Shear modulus $\\mu$", "mN/m", "of it, $(C_{11}+C_{22}-2C_{12}+4C_{66})/8$", 1e3},
    {"eta", "$\\eta$", "", "of it, $K/\\mu = (\\lambda_L+\\mu)/\\mu$"},
    {"spread_L", "Spread of $\\rho c_L^2$", "",
     "largest less smallest over directions, in parts of $K+\\mu$: what the mean hides"},
    {"spread_T", "Spread of $\\rho c_T^2$", "", "the same in parts of $\\mu$"},
    {"drag_rate", "Damping $\\zeta/(m^* nm)$", "1/s",
     "of the modes as $q \\to 0$; a steady push has $m^*$ times it"},
    {"viscosity_L", "Longitudinal viscosity", "a^2/s", "slope of the damping against $q^2$"},
    {"viscosity_T", "Shear viscosity", "a^2/s", "the same"},
    {"temperature", "$T_{xy}$ of single beads", "m^2/s^2", "of the measured frames"},
    {"coldest", "Coldest mode", "", "smallest $T(q)/T_{xy}$; 1 in equilibrium"},
    {"travel", "", "a", "root mean square distance of a bead from its first place, last block"},
    {"kept_places", "", "", "whether that is below half a spacing, so that displacements mean something"},
    {"interval", "", "s", "between the frames of the currents"},
    {"blocks", "", "", "of time, for the errors"},
    {"frames", "", "", "measured"},
};

constexpr ColumnInfo mode_columns[] = {
    {"m", "1", "waves along the side along x"},
    {"n", "1", "waves along the side along y; (m, n) and (m, -n) are put together"},
    {"branch", "1", "0 longitudinal, 1 transverse"},
    {"q", "1/a", "wave number"},
    {"direction", "deg", "of q from +x"},
    {"polarisation", "deg", "of the longitudinal branch from q"},
    {"omega", "1/s", "frequency without damping"},
    {"omega_error", "1/s", "standard error"},
    {"gamma", "1/s", "damping rate"},
    {"gamma_error", "1/s", "standard error"},
    {"temperature", "m^2/s^2", "T(q) = <|j|^2>/N"},
    {"temperature_error", "m^2/s^2", "standard error"},
    {"displacement", "a^2", "<|u_q|^2>; empty: beads left their places"},
    {"displacement_error", "a^2", "standard error"},
    {"omega_static", "1/s", "sqrt(T(q)/(N <|u_q|^2>)); empty: beads left their places"},
    {"omega_static_error", "1/s", "standard error"},
    {"share", "1", "of <|j|^2> that is the oscillator's"}};
constexpr ColumnInfo current_columns[] = {{"m", "1", "waves along the side along x"},
                                          {"n", "1", "waves along the side along y"},
                                          {"branch", "1", "0 longitudinal, 1 transverse"},
                                          {"lag", "s", "time between the currents"},
                                          {"value", "1", "C(t)/C(0)"},
                                          {"fit", "1", "the fitted oscillator"}};
constexpr FileInfo files[] = {
    {"phonons.csv", "frequency, damping and temperature of each mode", mode_columns},
    {"currents.csv", "current correlations and their fits", current_columns}};

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

Values values_of(const PhononResult& bare, const Inertia& inertia, double a) {
    const double to_a = 1.0 / a;
    const PhononResult r = with_inertia(bare, inertia);
    return {{"c_Lx", r.c_Lx.scaled(to_a)},
            {"c_Ly", r.c_Ly.scaled(to_a)},
            {"c_Ld", r.c_Ld.scaled(to_a)},
            {"c_Tx", r.c_Tx.scaled(to_a)},
            {"c_Ty", r.c_Ty.scaled(to_a)},
            {"c_Td", r.c_Td.scaled(to_a)},
            {"c_T", shear_speed(bare).scaled(to_a)},
            {"density", r.density},
            {"C11", r.C11},
            {"C22", r.C22},
            {"C12", r.C12},
            {"C66", r.C66},
            {"C11_bare", bare.C11},
            {"C22_bare", bare.C22},
            {"C12_bare", bare.C12},
            {"C66_bare", bare.C66},
            {"inertia", inertia.factor},
            {"inertia_source", inertia.source},
            {"bulk", r.bulk},
            {"mu", r.mu},
            {"eta", r.eta},
            {"spread_L", r.spread_L},
            {"spread_T", r.spread_T},
            {"drag_rate", r.drag},
            {"viscosity_L", r.viscosity_L.scaled(to_a * to_a)},
            {"viscosity_T", r.viscosity_T.scaled(to_a * to_a)},
            {"temperature", r.temperature},
            {"coldest", coldest(r)},
            {"travel", r.travel * to_a},
            {"kept_places", r.kept_places},
            {"interval", r.step},
            {"blocks", count_value(r.blocks)},
            {"frames", count_value(r.frames)}};
}

/// Nothing measured is an empty field.
void put(std::vector<double>& row, const Estimate& e, double scale) {
    row.push_back(e.count > 0 ? e.value * scale : std::nan(""));
    row.push_back(e.count > 0 ? e.error * scale : std::nan(""));
}

std::vector<double> mode_row(const PhononMode& mode, const PhononBranch& b, double branch, double a) {
    constexpr double degrees = 180.0 / std::numbers::pi;
    std::vector<double> row = {static_cast<double>(mode.m),
                               static_cast<double>(mode.n),
                               branch,
                               mode.q() * a,
                               std::atan2(mode.qy, mode.qx) * degrees,
                               mode.polarisation * degrees};
    put(row, b.omega, 1.0);
    put(row, b.gamma, 1.0);
    put(row, b.temperature, 1.0);
    put(row, b.displacement, 1.0 / (a * a));
    put(row, b.omega_static, 1.0);
    row.push_back(b.share);
    return row;
}

struct Rows {
    std::vector<std::vector<double>> modes, currents;
};

void add_branch(Rows& rows, const PhononResult& r, const PhononMode& mode, double branch, double a) {
    const PhononBranch& b = branch == 0.0 ? mode.longitudinal : mode.transverse;
    rows.modes.push_back(mode_row(mode, b, branch, a));
    for (std::size_t lag = 0; lag < b.correlation.size(); ++lag)
        rows.currents.push_back({static_cast<double>(mode.m), static_cast<double>(mode.n), branch,
                                 r.step * static_cast<double>(lag), b.correlation[lag], b.fitted[lag]});
}

std::vector<MeasureTable> tables_of(const PhononResult& r, double a) {
    Rows rows;
    for (const PhononMode& mode : r.modes)
        for (const double branch : {0.0, 1.0})
            add_branch(rows, r, mode, branch, a);
    return {{"phonons.csv", "a row for each mode and branch; q in 1/a, rates in 1/s, angles in degrees",
             mode_columns, transposed(rows.modes, std::size(mode_columns))},
            {"currents.csv", "C(t)/C(0) of each mode and branch with the fitted oscillator; lag in s",
             current_columns, transposed(rows.currents, std::size(current_columns))}};
}

std::string line_of(const PhononResult& r, const Inertia& inertia) {
    const std::string factor =
        inertia.factor.count > 0 ? " with m* " + text(inertia.factor) : " of the bare mass";
    return fmt::format("C11 {}, C22 {}, C12 {}, C66 {} mN/m{}, eta {}; damping as q -> 0 {} /s",
                       text(r.C11.scaled(1e3)), text(r.C22.scaled(1e3)), text(r.C12.scaled(1e3)),
                       text(r.C66.scaled(1e3)), factor, text(r.eta), text(r.drag));
}

MeasureReport report(const MeasuredCase& data) {
    const double a = data.bead_radius();
    const Inertia inertia = inertia_of(data);
    const PhononResult bare = measure::reduce(measure::take<PhononAccumulator>(data.sums, "phonons")),
                       r = with_inertia(bare, inertia);
    return {.values = values_of(bare, inertia, a),
            .tables = tables_of(bare, a),
            .series = {{"c_T", shear_speed(bare).scaled(1.0 / a)},
                       {"C11", r.C11},
                       {"C22", r.C22},
                       {"C66", r.C66}},
            .line = line_of(r, inertia)};
}

} // namespace

MeasureKind phonons() {
    return {.name = "phonons",
            .order = 70,
            .wanted = [](const Measure& m) { return m.phonons; },
            .describe = describe,
            .include = include,
            .reset_late_keys = [](Measure& m) { m.inertia_factor = m.inertia_error = std::nullopt; },
            .report = report,
            .values = values,
            .files = files,
            .series = series};
}

} // namespace rodwake::app::measures
