#include "scan_columns.hpp"

#include "bed/granular_summary.hpp"
#include "run/catalogue.hpp"

#include <algorithm>
#include <iterator>
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
    {"leader", "1", "rod that was ahead when the pair had turned most"}};

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

/// Of beds: those of their summaries, but for the time, which has one meaning with rods and with beds.
std::vector<ColumnInfo> numbers_of_beds() {
    std::vector<ColumnInfo> columns;
    for (const SummaryNumber& number : summary_numbers({"<k>"}, true))
        if (!number.scan_column.empty() && number.scan_column != numbers[0].name)
            columns.push_back(column_info(number.scan_column, number.unit, number.meaning));
    return columns;
}

std::vector<ColumnInfo> with_errors() {
    std::vector<ColumnInfo> told(std::begin(numbers), std::end(numbers)),
        columns(std::begin(others), std::end(others));
    std::ranges::copy(numbers_of_beds(), std::back_inserter(told));
    for (const ColumnInfo& column : told) {
        columns.push_back(column);
        columns.push_back(column_info(std::string(column.name) + "_error", column.unit,
                                      "standard error of the mean; empty: unknown"));
    }
    return columns;
}

} // namespace

std::span<const ColumnInfo> scan_columns() {
    static const std::vector<ColumnInfo> columns = with_errors();
    return columns;
}

} // namespace rodwake::app
