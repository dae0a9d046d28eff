#include "scan_bed_results.hpp"

#include "rodwake/scan/point_mean.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/hdf5_writer.hpp"
#include "scan_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {
using scan::PointMean;
using scan::Result;

constexpr double tail = 0.025; ///< on each side of a 95 % interval

/// A column of numbers of a table whose rows are of this kind.
template<class Row>
struct TableColumn {
    std::string name;
    std::function<double(const Row&)> value;
};
template<class Row>
using TableColumns = std::vector<TableColumn<Row>>;

void add_shares(TableColumns<PointMean>& columns, const ScanPlan& plan) {
    for (std::size_t k = 0; k < plan.columns.outcomes.size(); ++k) {
        const std::string& name = plan.columns.outcomes[k];
        columns.push_back({name, [k](const PointMean& m) { return m.outcomes[k].value(); }});
        columns.push_back({name + "_low", [k](const PointMean& m) { return m.outcomes[k].low(tail); }});
        columns.push_back({name + "_high", [k](const PointMean& m) { return m.outcomes[k].high(tail); }});
    }
}

/// What stands behind the status; `time` itself stands before it.
TableColumns<PointMean> mean_columns(const ScanPlan& plan) {
    TableColumns<PointMean> columns = {
        {"runs", [](const PointMean& m) { return static_cast<double>(m.runs); }},
        {"failed_runs", [](const PointMean& m) { return static_cast<double>(m.failed); }}};
    if (plan.columns.outcomes.size() > 1)
        add_shares(columns, plan);
    for (std::size_t k = 0; k < plan.columns.observables.size(); ++k) {
        const std::string& name = plan.columns.observables[k];
        if (k > 0)
            columns.push_back({name, [k](const PointMean& m) { return m.values[k].value; }});
        columns.push_back({name + "_error", [k](const PointMean& m) { return m.values[k].error; }});
        if (name == "delta_y") // of the runs that came half a box
            columns.push_back(
                {"delta_y_runs", [k](const PointMean& m) { return static_cast<double>(m.values[k].count); }});
    }
    return columns;
}

TableColumns<Result> run_columns(const ScanPlan& plan) {
    TableColumns<Result> columns;
    for (std::size_t k = 1; k < plan.columns.observables.size(); ++k)
        columns.push_back({plan.columns.observables[k],
                           [k](const Result& r) { return r.ok() ? r.values[k] : std::nan(""); }});
    return columns;
}

template<class Row>
std::string names_of(const TableColumns<Row>& columns) {
    std::string names;
    for (const TableColumn<Row>& column : columns)
        names += "," + column.name;
    return names + "\n";
}

template<class Row>
std::string cells_of(const TableColumns<Row>& columns, const Row& row) {
    std::string cells;
    for (const TableColumn<Row>& column : columns)
        cells += "," + number_text(column.value(row));
    return cells + "\n";
}

std::string status_text(scan::Status status) { return scan::status_names[static_cast<std::size_t>(status)]; }

void write_means(const std::filesystem::path& file, const ScanPlan& plan,
                 const std::vector<PointMean>& means) {
    const TableColumns<PointMean> columns = mean_columns(plan);
    std::string text = axis_names(plan) + ",outcome,time,status" + names_of(columns);
    for (const PointMean& mean : means)
        text += fmt::format("{}{},{},{}", place_text(plan, mean.point), outcome_text(plan, mean.outcome),
                            number_text(mean.values.front().value), status_text(mean.status)) +
                cells_of(columns, mean);
    store::write_atomically(file, text);
}

void write_runs(const std::filesystem::path& file, const ScanPlan& plan, const scan::Ledger& ledger) {
    const TableColumns<Result> columns = run_columns(plan);
    store::PendingFile pending(file);
    pending.write(axis_names(plan) + ",point,run,outcome,time,status" + names_of(columns));
    ledger.for_each([&](const Result& r) {
        pending.write(fmt::format("{}{},{},{},{},{}", place_text(plan, r.point),
                                  scan::place_of_run(r.point.id) + 1, scan::run_of(r.point.id) + 1,
                                  outcome_text(plan, r.ok() ? r.outcome : -1),
                                  r.ok() ? number_text(r.values[0]) : "", status_text(r.status)) +
                      cells_of(columns, r));
    });
    pending.commit();
}

template<class Row>
void write_group(store::Hdf5Writer& h5, const std::string& group, const ScanPlan& plan,
                 TableColumns<Row> columns, std::span<const Row> rows) {
    for (std::size_t k = plan.design.axes.size(); k-- > 0;)
        columns.insert(columns.begin(), {plan.design.axes[k].name, [&, k](const Row& row) {
                                             return values_of(plan.design, row.point)[k];
                                         }});
    columns.push_back({"outcome", [](const Row& row) { return static_cast<double>(row.outcome); }});
    columns.push_back({"status", [](const Row& row) { return static_cast<double>(row.status); }});
    std::vector<double> values(rows.size());
    for (const TableColumn<Row>& column : columns) {
        std::ranges::transform(rows, values.begin(), column.value);
        h5.dataset(group + "/" + column.name, values, {values.size()}, "");
    }
    for (const scan::Axis& axis : plan.design.axes)
        if (!axis.words.empty())
            h5.attribute(group, axis.name + "_names", fmt::format("{}", fmt::join(axis.words, ",")));
    h5.attribute(group, "outcome_names", fmt::format("{}", fmt::join(plan.columns.outcomes, ",")));
    h5.attribute(group, "status_names", fmt::format("{}", fmt::join(scan::status_names, ",")));
}

void write_datasets(const std::filesystem::path& file, const ScanPlan& plan, const scan::Ledger& ledger,
                    const std::vector<PointMean>& means) {
    store::Hdf5Writer h5(file);
    TableColumns<PointMean> points = mean_columns(plan);
    points.push_back({"time", [](const PointMean& m) { return m.values.front().value; }});
    write_group<PointMean>(h5, "/points", plan, points, means);
    std::vector<Result> all;
    ledger.for_each([&](const Result& r) { all.push_back(r); });
    TableColumns<Result> runs = run_columns(plan);
    runs.push_back({"time", [](const Result& r) { return r.ok() ? r.values[0] : std::nan(""); }});
    runs.push_back(
        {"point", [](const Result& r) { return static_cast<double>(scan::place_of_run(r.point.id) + 1); }});
    runs.push_back(
        {"run", [](const Result& r) { return static_cast<double>(scan::run_of(r.point.id) + 1); }});
    write_group<Result>(h5, "/runs", plan, runs, all);
    h5.commit();
}

} // namespace

void write_bed_results(const std::filesystem::path& folder, const ScanPlan& plan,
                       const scan::Ledger& ledger) {
    const std::vector<PointMean> means = scan::means_of(ledger);
    write_means(folder / "scan.csv", plan, means);
    write_runs(folder / "scan_runs.csv", plan, ledger);
    write_datasets(folder / "scan.h5", plan, ledger, means);
}

} // namespace rodwake::app
