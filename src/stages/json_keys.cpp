// The keys of JSON files whose names do not say all; those of measure.json are told by the measures.

#include "catalogue.hpp"

namespace rodwake::stages {

namespace {

constexpr ColumnInfo outcome_keys[] = {
    {"outcome", "1", "contact, pursuit, escape or undecided"},
    {"time", "{time}", "of contact, else the time reached"},
    {"min_separation", "{length}", "smallest separation of any pair at any time"},
    {"min_separation_time", "{time}", "when that was"},
    {"pair", "1", "the two rods that the outcome is about, else the closest"},
    {"turn", "rad", "of each rod from start to end"},
    {"own_turn", "rad", "of that, by the rod's own field (a dynamic medium)"},
    {"reason", "1", "the outcome in words, with its numbers"},
    {"solver", "1", "method, form, field, tolerances, how it ended, steps and evaluations"},
    {"ensemble", "1", "endings of the runs in fields drawn from the measured one's errors"}};

constexpr ColumnInfo noise_keys[] = {
    {"runs", "1", "runs with noise"},
    {"endings", "1", "how many ended in each outcome, and how many failed"},
    {"capture_probability", "1", "share of contact and pursuit among the runs that did not fail"},
    {"capture_low", "1", "lower end of its 95 % interval (Wilson)"},
    {"capture_high", "1", "upper end of its 95 % interval (Wilson)"},
    {"first_contact_time", "{time}", "mean over the runs in contact, its standard error, their number"},
    {"runs_at_time", "1", "runs that got to each of the output times"},
    {"mean_square_displacement", "{length}^2", "[time][rod], of the runs that got there"},
    {"heading_correlation", "1", "[time][rod], mean cos(theta(t) - theta(0))"}};

constexpr ColumnInfo scan_keys[] = {
    {"requested", "1", "points asked for, of an adaptive scan those of the full grid; of beds runs"},
    {"evaluated", "1", "points that were evaluated; of beds runs"},
    {"failed", "1", "of those, the ones that failed"},
    {"left", "1", "points not evaluated yet"},
    {"causes", "1", "failed points by cause; causes that differ in numbers only are one"},
    {"outcomes", "1", "points of each outcome"},
    {"missed_rate", "1", "share of the audited places where the refinement had missed another outcome"},
    {"missed_rate_high", "1", "upper end of its 95 % interval"},
    {"boundary", "1", "curves between outcomes, their points, tolerance and gaps"},
    {"wall_seconds", "s", "of the last command"},
    {"cpu_seconds", "s", "summed over the points"}};

constexpr ColumnInfo summary_keys[] = {
    {"simulated_time", "s", "from t = 0"},
    {"T_xy", "m^2/s^2", "(var vx + var vy)/2 of the beads, mean from t = 0"},
    {"T_z", "m^2/s^2", "var vz of the beads, mean from t = 0"},
    {"psi6", "1", "mean |psi6| of the beads from t = 0"},
    {"pressure", "N/m", "mean, xx, xy, yy, in the plane"},
    {"max_overlap", "a", "largest overlap, of the smaller radius"},
    {"mean_speed", "m/s", "of each rod (rods) along its heading, thin end first positive"},
    {"net_turn", "rad", "of each rod from t = 0 to the end"},
    {"force", "N", "of each rod on the beads along its heading, mean from t = 0"},
    {"thrust", "N", "of the plates on each rod along its heading, mean from t = 0"},
    {"separation_change", "m", "of two rods (pair) across their mean first heading, outwards positive"},
    {"half_box_time", "s", "when the two rods had come half a box; null: they have not"},
    {"phi_b", "1", "area fraction of the beads alone"},
    {"state_hash", "1", "of the last state: equal for equal bits"},
    {"absorbing_state", "1", "whether the beads came to rest for good"},
    {"cost", "s", "of wall clock, by part"}};

constexpr ColumnInfo fit_keys[] = {
    {"parameters", "1", "of each: value, stderr, low and high (95 %), start, bounds, unit"},
    {"correlation", "1", "matrix of the free parameters"},
    {"chi2", "1", "sum of the squared residuals over their errors"},
    {"dof", "1", "independent data less free parameters"},
    {"termination", "1", "why the search ended"}};

} // namespace

std::span<const ColumnInfo> names_in(const FileKind& kind) {
    if (kind.pattern == "outcome.json")
        return outcome_keys;
    if (kind.pattern == "noise.json")
        return noise_keys;
    if (kind.pattern == "scan.json")
        return scan_keys;
    if (kind.pattern == "summary.json")
        return summary_keys;
    return kind.pattern == "fit.json" ? std::span<const ColumnInfo>(fit_keys) : kind.columns;
}

} // namespace rodwake::stages
