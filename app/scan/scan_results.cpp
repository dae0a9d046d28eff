#include "scan_parts.hpp"

#include "rodwake/core/json_text.hpp"
#include "rodwake/scan/proportion.hpp"
#include "rodwake/scene/document.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/hdf5_writer.hpp"
#include "scan_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {
using nlohmann::ordered_json;

ordered_json axis_json(const ScanPlan& plan, std::size_t number) {
    const scan::Axis& axis = plan.design.axes[number];
    const scene::KeyInfo info = scene::key_info(axis.name).value_or(scene::KeyInfo{});
    const bool si = plan.base.units == scene::UnitSystem::si;
    ordered_json keys = ordered_json::array(), factors = ordered_json::array();
    for (const ScanPlan::VariedKey& key : plan.keys)
        if (key.axis == number) {
            keys.push_back(key.key);
            factors.push_back(key.factor);
        }
    static constexpr const char* names[] = {"linear", "log", "listed"};
    ordered_json out = {{"key", axis.name},
                        {"keys", keys},
                        {"factors", factors},
                        {"symbol", info.symbol},
                        {"label", plan.labels[number]},
                        {"unit", si ? info.unit_si : info.unit_reduced},
                        {"spacing", names[static_cast<std::size_t>(axis.spacing)]},
                        {"from", axis.from},
                        {"to", axis.to},
                        {"count", axis.count}};
    if (!axis.words.empty())
        out["values"] = axis.words;
    else if (axis.spacing == scan::Spacing::listed)
        out["values"] = axis.values;
    return out;
}

template<class Number>
ordered_json by_certificate(const std::array<Number, 3>& numbers) {
    ordered_json out = ordered_json::object();
    for (const Certificate certificate : all_certificates)
        out[to_string(certificate)] = numbers[static_cast<std::size_t>(certificate)];
    return out;
}

std::string scan_json(const ScanPlan& plan, const scan::Counts& counts, const scan::Summary& summary,
                      const ScanCertificates& certificates, double wall_seconds) {
    const bool adaptive = plan.design.kind == scan::Kind::adaptive, audited = summary.audit.tried > 0;
    ordered_json out = {{"design", scan::to_string(plan.design.kind)},
                        {"complete", summary.complete},
                        {"requested", summary.requested},
                        {"evaluated", counts.points},
                        {"failed", counts.failed},
                        {"left", summary.left},
                        {"wall_seconds", wall_seconds},
                        {"cpu_seconds", counts.seconds}};
    const auto of_audit = [&](double value) { return audited ? ordered_json(value) : ordered_json(nullptr); };
    out["missed_rate"] = adaptive ? of_audit(summary.audit.rate()) : ordered_json(nullptr);
    out["missed_rate_high"] = adaptive ? of_audit(summary.audit.upper_bound()) : ordered_json(nullptr);
    out["audited"] = summary.audit.tried;
    out["missed"] = summary.audit.missed;
    out["audit_rounds"] = summary.audit_rounds;
    out["found_by_audit"] = summary.found_by_audit;
    out["resolution"] = adaptive ? ordered_json(plan.design.resolution) : ordered_json(nullptr);
    out["axes"] = ordered_json::array();
    for (std::size_t k = 0; k < plan.design.axes.size(); ++k)
        out["axes"].push_back(axis_json(plan, k));
    out["outcomes"] = ordered_json::object();
    for (const std::string& name : plan.columns.outcomes)
        out["outcomes"][name] = counts.outcomes.contains(name) ? counts.outcomes.at(name) : 0;
    out["causes"] = counts.causes;
    out["boundary"] = nullptr;
    if (const double tolerance = plan.design.boundary_tolerance; tolerance != 0.0) {
        std::size_t points = 0;
        for (const scan::Curve& curve : summary.curves)
            points += curve.points.size();
        out["boundary"] = {{"curves", summary.curves.size()},
                           {"points", points},
                           {"tolerance", tolerance},
                           {"evaluated", summary.traced},
                           {"gaps", summary.lost_crossings}};
    }
    if (of_beds(plan)) {
        // The numbers requested, evaluated and failed count runs.
        const scene::Granular& bed = *plan.base.granular;
        const bool varied =
            std::ranges::count(plan.keys, "granular.bead_radius", &ScanPlan::VariedKey::key) > 0;
        out.update(
            ordered_json{{"subject", "beds"},
                         {"rods", bed.rods.size()},
                         {"points", scan::places(plan.design)},
                         {"runs", plan.design.runs},
                         {"bead_radius", varied ? ordered_json(nullptr) : ordered_json(bed.bead_radius)},
                         {"units", {{"length", "a"}, {"time", "s"}}}});
    } else {
        out["certificates"] = by_certificate(certificates.points);
        out["certified_area"] =
            certificates.cells.empty() ? ordered_json(nullptr) : by_certificate(certificates.area);
        const OutputUnits units = output_units(plan.base);
        out.update(ordered_json{{"subject", "rods"},
                                {"rods", plan.base.rods.size()},
                                {"units", {{"length", units.length_name}, {"time", units.time_name}}}});
    }
    return json_text(out, 2) + "\n";
}

} // namespace

void write_scan(const std::filesystem::path& folder, const ScanPlan& plan, const scene::Scan& keys,
                const scan::Ledger& ledger, const scan::Counts& counts, const scan::Summary& summary,
                const ScanCertificates& certificates, double wall_seconds, std::size_t threads) {
    if (of_beds(plan))
        write_bed_results(folder, plan, ledger);
    else {
        // scan.csv and scan.h5 in one pass over the ledger, some points at a time. A scan that was stopped
        // has no time for trajectories.
        constexpr std::size_t rows_at_once = 1 << 14;
        PointTable table(folder / "scan.csv", plan);
        store::Hdf5Writer h5(folder / "scan.h5");
        PointColumns columns(h5, plan, ledger.points());
        TrajectorySample sample(summary.complete ? static_cast<std::size_t>(keys.trajectories) : 0);
        std::vector<scan::Result> rows;
        const auto flush = [&] {
            table.add(rows, threads);
            columns.add(rows);
            for (const scan::Result& result : rows)
                sample.add(result);
            rows.clear();
        };
        ledger.for_each([&](const scan::Result& result) {
            rows.push_back(result);
            if (rows.size() == rows_at_once)
                flush();
        });
        flush();
        table.commit();
        columns.finish();
        sample.write(h5, plan);
        h5.commit();
        if (!summary.leaves.empty())
            write_cells(folder / "cells.csv", plan, summary, certificates.cells);
        if (!summary.curves.empty())
            write_boundary(folder / "boundary.csv", plan, summary);
    }
    if (counts.failed > 0) {
        // failures.csv lists the points that failed, and why.
        std::string text = axis_names(plan) + ",status,retries,cause\n";
        ledger.for_each([&](const scan::Result& result) {
            if (result.ok())
                return;
            std::string cause; // quoted, as CSV does it
            for (const char c : result.cause_text())
                cause += c == '"' ? "\"\"" : std::string(1, c);
            text += fmt::format("{}{},{},\"{}\"\n", place_text(plan, result.point),
                                scan::status_names[static_cast<std::size_t>(result.status)], result.retries,
                                cause);
        });
        store::write_atomically(folder / "failures.csv", text);
    } else
        std::filesystem::remove(folder / "failures.csv"); // of points that succeeded since
    // last: whoever finds it finds everything
    store::write_atomically(folder / "scan.json",
                            scan_json(plan, counts, summary, certificates, wall_seconds));
}

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

/// What stands behind the status; `time` itself stands before it.
TableColumns<PointMean> mean_columns(const ScanPlan& plan) {
    TableColumns<PointMean> columns = {
        {"runs", [](const PointMean& m) { return static_cast<double>(m.runs); }},
        {"failed_runs", [](const PointMean& m) { return static_cast<double>(m.failed); }}};
    if (plan.columns.outcomes.size() > 1) {
        for (std::size_t k = 0; k < plan.columns.outcomes.size(); ++k) {
            const std::string& name = plan.columns.outcomes[k];
            columns.push_back({name, [k](const PointMean& m) { return m.outcomes[k].value(); }});
            columns.push_back({name + "_low", [k](const PointMean& m) { return m.outcomes[k].low(tail); }});
            columns.push_back({name + "_high", [k](const PointMean& m) { return m.outcomes[k].high(tail); }});
        }
    }
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

} // namespace

void write_bed_results(const std::filesystem::path& folder, const ScanPlan& plan,
                       const scan::Ledger& ledger) {
    const std::vector<PointMean> means = scan::means_of(ledger);
    const TableColumns<PointMean> columns = mean_columns(plan);
    std::string text = axis_names(plan) + ",outcome,time,status" + names_of(columns);
    for (const PointMean& mean : means)
        text += fmt::format("{}{},{},{}", place_text(plan, mean.point), outcome_text(plan, mean.outcome),
                            number_text(mean.values.front().value), status_text(mean.status)) +
                cells_of(columns, mean);
    store::write_atomically(folder / "scan.csv", text);
    const TableColumns<Result> of_runs = run_columns(plan);
    store::PendingFile pending(folder / "scan_runs.csv");
    pending.write(axis_names(plan) + ",point,run,outcome,time,status" + names_of(of_runs));
    ledger.for_each([&](const Result& r) {
        pending.write(fmt::format("{}{},{},{},{},{}", place_text(plan, r.point),
                                  scan::place_of_run(r.point.id) + 1, scan::run_of(r.point.id) + 1,
                                  outcome_text(plan, r.ok() ? r.outcome : -1),
                                  r.ok() ? number_text(r.values[0]) : "", status_text(r.status)) +
                      cells_of(of_runs, r));
    });
    pending.commit();
    store::Hdf5Writer h5(folder / "scan.h5");
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

} // namespace rodwake::app
