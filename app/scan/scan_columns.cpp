#include "scan_columns.hpp"

#include <deque>
#include <string>
#include <vector>

namespace rodwake::app {

namespace {

/// Numbers of a run; of several runs their mean, with a column of standard errors.
constexpr ColumnInfo numbers[] = {
    {"time", "{scan time}", "of contact, else the time reached"},
    {"delta_y", "a",
     "change of the separation when the pair had come half a box, outwards positive; empty: it has not"},
    {"last_change", "a", "change of the separation at the end, outwards positive"},
    {"separation", "a", "at the start, across the mean first heading"},
    {"min_separation", "{scan length}", "smallest separation of two rods"},
    {"turn<k>", "rad", "of rod k from start to end; in beds + is towards the other rod's first place"},
    {"non_reciprocity", "1", "(|turn of the rear| - |turn of the front|)/(their sum)"},
    {"leader", "1", "rod that was ahead when the pair had turned most"},
    {"T_xy", "m^2/s^2", "mean over the run"},
    {"T_z", "m^2/s^2", "mean over the run"},
    {"psi6", "1", "as in summary.json: neighbours nearer than granular.order_cutoff"},
    {"pressure", "N/m", "of the bed in the plane, mean over directions and the run"},
    {"max_overlap", "radii", "largest overlap of two bodies since the start"},
    {"mean_speed<k>", "m/s", "of rod k along its heading, thin end first positive"},
    {"force<k>", "N", "of rod k on the beads along its heading, mean from t = 0"}};

constexpr ColumnInfo others[] = {
    {"outcome", "1",
     "contact, pursuit, escape or undecided, of beds without a pair finished; of several runs the most "
     "frequent; empty: the point failed"},
    {"status", "1", "ok, failed, time_limit, not_finite or exception; of several runs ok if one finished"},
    {"min_separation_time", "{scan time}", "when the separation was smallest"},
    {"final_separation", "{scan length}", "at the end"},
    {"final_angle", "rad", "between the headings at the end"},
    {"steps", "1", "of the solver"},
    {"rhs_evaluations", "1", "of the right-hand side"},
    {"retries", "1", "attempts before the last"},
    {"point", "1", "number of the point, from 1, as its folder"},
    {"run", "1", "number of the run, from 1, as its folder"},
    {"runs", "1", "runs that finished, over which the row has means"},
    {"failed_runs", "1", "runs that failed"},
    {"delta_y_runs", "1", "runs that came half a box"},
    {"contact", "1", "share of the runs"},
    {"pursuit", "1", "share of the runs"},
    {"escape", "1", "share of the runs"},
    {"undecided", "1", "share of the runs"},
    {"capture_probability", "1", "share of the runs with noise in contact or pursuit"},
    {"capture_probability_low", "1", "lower end of its 95 % interval (Wilson); itself without noise"},
    {"capture_probability_high", "1", "upper end of its 95 % interval (Wilson); itself without noise"},
    {"capture_runs", "1", "runs with noise behind it; 1 without noise"},
    {"<k>_low", "1", "lower end of the 95 % interval of the share (Clopper and Pearson)"},
    {"<k>_high", "1", "upper end of the 95 % interval of the share (Clopper and Pearson)"}};

std::vector<ColumnInfo> with_errors() {
    static std::deque<std::string> names; // owns them
    std::vector<ColumnInfo> columns(std::begin(others), std::end(others));
    for (const ColumnInfo& column : numbers) {
        columns.push_back(column);
        columns.push_back({names.emplace_back(std::string(column.name) + "_error"), column.unit,
                           "standard error of the mean; empty: unknown"});
    }
    return columns;
}

} // namespace

std::span<const ColumnInfo> scan_columns() {
    static const std::vector<ColumnInfo> columns = with_errors();
    return columns;
}

} // namespace rodwake::app
