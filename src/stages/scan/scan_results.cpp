#include "scan_results.hpp"

#include "rodwake/core/rng.hpp"
#include "rodwake/scene/document.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/hdf5_writer.hpp"
#include "scan_bed_results.hpp"
#include "scan_rods.hpp"
#include "scan_tables.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <queue>

namespace rodwake::stages {

namespace {

using assembly::ScanPlan;
using nlohmann::ordered_json;

constexpr std::size_t stored_times = 61;

struct Stored {
    std::int64_t row; ///< of scan.csv, from 0
    scan::Result result;
};

/// Points whose trajectories are stored: random, the same ones whoever evaluated them.
std::vector<Stored> sample(const scan::Ledger& ledger, std::size_t count) {
    using Entry = std::pair<std::uint64_t, Stored>;
    const auto less = [](const Entry& a, const Entry& b) { return a.first < b.first; };
    std::priority_queue<Entry, std::vector<Entry>, decltype(less)> kept(less);
    std::int64_t row = 0;
    ledger.for_each([&](const scan::Result& result) {
        const auto id = static_cast<std::uint64_t>(result.point.id);
        RandomStream random(id, 0x73616d70);
        const std::uint64_t rank = random.bits();
        if (result.ok() && result.values[0] > 0.0)
            kept.push({rank, {row, result}});
        if (kept.size() > count)
            kept.pop();
        ++row;
    });
    std::vector<Stored> found;
    for (; !kept.empty(); kept.pop())
        found.push_back(kept.top().second);
    std::ranges::sort(found, {}, &Stored::row);
    return found;
}

template<class Names>
std::string joined(const Names& names) {
    std::string text;
    for (const auto& name : names)
        text += (text.empty() ? "" : ",") + std::string(name);
    return text;
}

/// A column of /points: where its numbers come from.
struct Column {
    std::string name;
    std::function<double(const scan::Result&)> value;
};

std::vector<Column> columns_of(const ScanPlan& plan) {
    std::vector<Column> columns;
    for (std::size_t k = 0; k < plan.design.axes.size(); ++k)
        columns.push_back({plan.design.axes[k].name, [k](const scan::Result& r) { return r.point.at[k]; }});
    columns.push_back({"outcome", [](const scan::Result& r) { return r.ok() ? r.outcome : -1.0; }});
    columns.push_back({"status", [](const scan::Result& r) { return static_cast<double>(r.status); }});
    for (std::size_t k = 0; k < plan.columns.observables.size(); ++k)
        columns.push_back({plan.columns.observables[k],
                           [k](const scan::Result& r) { return r.ok() ? r.values[k] : std::nan(""); }});
    return columns;
}

/// In one pass over the ledger, some rows at a time, so that memory does not grow with it.
void write_columns(store::Hdf5Writer& h5, const ScanPlan& plan, const scan::Ledger& ledger) {
    constexpr std::size_t rows_at_once = 1 << 14;
    const std::vector<Column> columns = columns_of(plan);
    const auto rows = static_cast<std::size_t>(ledger.points());
    std::vector<std::vector<double>> block(columns.size());
    std::size_t written = 0;
    const auto flush = [&] {
        for (std::size_t k = 0; k < columns.size(); ++k)
            h5.part("/points/" + columns[k].name, block[k], written, rows);
        written += block.front().size();
        for (std::vector<double>& column : block)
            column.clear();
    };
    ledger.for_each([&](const scan::Result& result) {
        for (std::size_t k = 0; k < columns.size(); ++k)
            block[k].push_back(columns[k].value(result));
        if (block.front().size() == rows_at_once)
            flush();
    });
    flush();
}

void write_names(store::Hdf5Writer& h5, const ScanPlan& plan) {
    for (const scan::Axis& axis : plan.design.axes)
        if (!axis.words.empty())
            h5.attribute("/points", axis.name + "_names", joined(axis.words));
    h5.attribute("/points", "outcome_names", joined(plan.columns.outcomes));
    h5.attribute("/points", "status_names", joined(scan::status_names));
}

/// One column of the trajectories, [S][T] or [S][T][N].
struct Paths {
    std::vector<double> rows, t, x, y, theta;
};

void add_path(Paths& paths, const Stored& one, const rods::RodResult& run, const assembly::OutputUnits& units,
              std::size_t rods) {
    paths.rows.push_back(static_cast<double>(one.row));
    const integrate::Solution& solution = run.solution;
    for (std::size_t i = 0; i < stored_times; ++i) {
        const bool there = i < solution.states.size();
        const std::vector<double>& y = there ? solution.states[i] : solution.final_state;
        paths.t.push_back((there ? solution.times[i] : solution.final_time) * units.time);
        for (std::size_t rod = 0; rod < rods; ++rod) {
            paths.x.push_back(y[3 * rod] * units.length);
            paths.y.push_back(y[3 * rod + 1] * units.length);
            paths.theta.push_back(y[3 * rod + 2]);
        }
    }
}

void write_trajectories(store::Hdf5Writer& h5, const ScanPlan& plan, const std::vector<Stored>& stored) {
    const assembly::OutputUnits units = assembly::output_units(plan.base);
    const std::size_t rods = plan.base.rods.size();
    Paths paths;
    for (const Stored& one : stored)
        add_path(paths, one, trajectory_of(plan, one.result, stored_times), units, rods);
    const std::size_t count = stored.size();
    h5.dataset("/trajectories/point", paths.rows, {count}, "");
    h5.dataset("/trajectories/t", paths.t, {count, stored_times}, units.time_name);
    h5.dataset("/trajectories/x", paths.x, {count, stored_times, rods}, units.length_name);
    h5.dataset("/trajectories/y", paths.y, {count, stored_times, rods}, units.length_name);
    h5.dataset("/trajectories/theta", paths.theta, {count, stored_times, rods}, "rad");
}

void write_h5(const std::filesystem::path& file, const ScanPlan& plan, const scene::Scan& keys,
              const scan::Ledger& ledger, bool complete) {
    store::Hdf5Writer h5(file);
    write_columns(h5, plan, ledger);
    write_names(h5, plan);
    const std::vector<Stored> stored = sample(ledger, static_cast<std::size_t>(keys.trajectories));
    if (!stored.empty() && plan.base.rods_run && complete)
        write_trajectories(h5, plan, stored);
    h5.commit();
}

bool of_beds(const ScanPlan& plan) { return plan.subject == scene::ScanSubject::beds; }

const char* spacing_name(scan::Spacing spacing) {
    static constexpr const char* names[] = {"linear", "log", "listed"};
    return names[static_cast<std::size_t>(spacing)];
}

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
    ordered_json out = {{"key", axis.name},
                        {"keys", keys},
                        {"factors", factors},
                        {"symbol", info.symbol},
                        {"label", plan.labels[number]},
                        {"unit", si ? info.unit_si : info.unit_reduced},
                        {"spacing", spacing_name(axis.spacing)},
                        {"from", axis.from},
                        {"to", axis.to},
                        {"count", axis.count}};
    if (!axis.words.empty())
        out["values"] = axis.words;
    else if (axis.spacing == scan::Spacing::listed)
        out["values"] = axis.values;
    return out;
}

ordered_json boundary_json(const scan::Summary& summary, double tolerance) {
    if (tolerance == 0.0)
        return nullptr;
    std::size_t points = 0;
    for (const scan::Curve& curve : summary.curves)
        points += curve.points.size();
    return {{"curves", summary.curves.size()},
            {"points", points},
            {"tolerance", tolerance},
            {"evaluated", summary.traced},
            {"gaps", summary.lost_crossings}};
}

ordered_json rods_json(const ScanPlan& plan) {
    const assembly::OutputUnits units = assembly::output_units(plan.base);
    return {{"subject", "rods"},
            {"rods", plan.base.rods.size()},
            {"units", {{"length", units.length_name}, {"time", units.time_name}}}};
}

/// What is requested, evaluated and failed there are runs.
ordered_json bed_json(const ScanPlan& plan) {
    const scene::Granular& bed = *plan.base.granular;
    const bool varied = std::ranges::count(plan.keys, "granular.bead_radius", &ScanPlan::VariedKey::key) > 0;
    return {{"subject", "beds"},
            {"rods", bed.rods.size()},
            {"points", scan::places(plan.design)},
            {"runs", plan.design.runs},
            {"bead_radius", varied ? ordered_json(nullptr) : ordered_json(bed.bead_radius)},
            {"units", {{"length", "a"}, {"time", "s"}}}};
}

std::string scan_json(const ScanPlan& plan, const scan::Ledger& ledger, const scan::Summary& summary,
                      double wall_seconds) {
    const scan::Counts counts = ledger.counts();
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
    out["boundary"] = boundary_json(summary, plan.design.boundary_tolerance);
    if (of_beds(plan))
        out.update(bed_json(plan));
    else
        out.update(rods_json(plan));
    return out.dump(2) + "\n";
}

void write_rod_results(const std::filesystem::path& folder, const ScanPlan& plan, const scene::Scan& keys,
                       const scan::Ledger& ledger, const scan::Summary& summary) {
    write_points(folder / "scan.csv", plan, ledger);
    if (!summary.leaves.empty())
        write_cells(folder / "cells.csv", plan, summary);
    if (!summary.curves.empty())
        write_boundary(folder / "boundary.csv", plan, summary);
    write_h5(folder / "scan.h5", plan, keys, ledger, summary.complete);
}

} // namespace

void write_scan(const std::filesystem::path& folder, const ScanPlan& plan, const scene::Scan& keys,
                const scan::Ledger& ledger, const scan::Summary& summary, double wall_seconds) {
    if (of_beds(plan))
        write_bed_results(folder, plan, ledger);
    else
        write_rod_results(folder, plan, keys, ledger, summary);
    // last: whoever finds it finds everything
    store::write_atomically(folder / "scan.json", scan_json(plan, ledger, summary, wall_seconds));
}

} // namespace rodwake::stages
