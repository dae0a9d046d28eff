#include "scan_columns.hpp"

#include "bed/granular_summary.hpp"
#include "bed/run_tables.hpp"
#include "run/record_table.hpp"
#include "scan_values.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

namespace rodwake::app {

namespace {

constexpr ColumnInfo others[] = {
    {"outcome", "1",
     "contact, pursuit, escape or undecided, of beds without a pair finished; of several runs the most "
     "frequent; empty: the point failed"},
    {"status", "1", "ok, failed, time_limit, not_finite or exception; of several runs ok if one finished"},
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
    {"<k>_low", "1", "lower end of the 95 % interval of the share (Clopper and Pearson)"},
    {"<k>_high", "1", "upper end of the 95 % interval of the share (Clopper and Pearson)"}};

/// Of a point, of several runs their means: of rods, and of beds what their rods do and their summaries tell.
std::vector<ColumnInfo> numbers() {
    std::vector<ColumnInfo> all;
    const auto is_there = [&](std::string_view name) {
        return std::ranges::find(all, name, &ColumnInfo::name) != all.end();
    };
    add_number_columns<EncounterEnd>(all);
    add_number_columns<CaptureNumbers>(all);
    std::vector<ColumnInfo> of_beds;
    add_number_columns<PairNumbers>(of_beds);
    for (const SummaryNumber& number : summary_numbers({"<k>"}, true))
        if (!number.scan_column.empty())
            of_beds.push_back(column_info(number.scan_column, number.unit, number.meaning));
    for (const ColumnInfo& column : of_beds)
        if (!is_there(column.name))
            all.push_back(column);
    return all;
}

std::vector<ColumnInfo> with_errors() {
    std::vector<ColumnInfo> columns(std::begin(others), std::end(others));
    for (const ColumnInfo& column : numbers()) {
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
