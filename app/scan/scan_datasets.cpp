#include "scan_datasets.hpp"

#include "rodwake/app/rods.hpp"
#include "rodwake/core/rng.hpp"
#include "scan_rods.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

constexpr std::size_t stored_times = 61;

template<class Names>
std::string joined(const Names& names) {
    std::string text;
    for (const auto& name : names)
        text += (text.empty() ? "" : ",") + std::string(name);
    return text;
}

} // namespace

PointColumns::PointColumns(store::Hdf5Writer& h5, const ScanPlan& plan, std::int64_t rows)
    : h5_(h5), plan_(plan), columns_(columns_of(plan)), rows_(static_cast<std::size_t>(rows)) {}

std::vector<PointColumns::Column> PointColumns::columns_of(const ScanPlan& plan) {
    std::vector<Column> columns;
    for (std::size_t k = 0; k < plan.design.axes.size(); ++k)
        columns.push_back({plan.design.axes[k].name,
                           [&, k](const scan::Result& r) { return values_of(plan.design, r.point)[k]; }});
    columns.push_back({"outcome", [](const scan::Result& r) { return r.ok() ? r.outcome : -1.0; }});
    columns.push_back({"status", [](const scan::Result& r) { return static_cast<double>(r.status); }});
    for (std::size_t k = 0; k < plan.columns.observables.size(); ++k)
        columns.push_back({plan.columns.observables[k],
                           [k](const scan::Result& r) { return r.ok() ? r.values[k] : std::nan(""); }});
    return columns;
}

void PointColumns::add(std::span<const scan::Result> results) {
    std::vector<double> block(results.size());
    for (const Column& column : columns_) {
        std::ranges::transform(results, block.begin(), column.value);
        h5_.part("/points/" + column.name, block, written_, {rows_});
    }
    written_ += results.size();
}

void PointColumns::finish() {
    for (const scan::Axis& axis : plan_.design.axes)
        if (!axis.words.empty())
            h5_.attribute("/points", axis.name + "_names", joined(axis.words));
    h5_.attribute("/points", "outcome_names", joined(plan_.columns.outcomes));
    h5_.attribute("/points", "status_names", joined(scan::status_names));
}

void TrajectorySample::add(const scan::Result& result) {
    const std::int64_t row = rows_++;
    if (count_ == 0 || !result.ok() || result.values[0] <= 0.0)
        return;
    RandomStream random(static_cast<std::uint64_t>(result.point.id), 0x73616d70);
    const std::uint64_t rank = random.bits();
    if (kept_.size() == count_ && !(rank < kept_.top().rank))
        return;
    kept_.push({rank, {row, result}});
    if (kept_.size() > count_)
        kept_.pop();
}

std::vector<TrajectorySample::Stored> TrajectorySample::take() {
    std::vector<Stored> found;
    for (; !kept_.empty(); kept_.pop())
        found.push_back(kept_.top().stored);
    std::ranges::sort(found, {}, &Stored::row);
    return found;
}

/// One column of the trajectories, [S][T] or [S][T][N].
struct TrajectorySample::Paths {
    std::vector<double> rows, t, x, y, theta;
};

void TrajectorySample::add_path(Paths& paths, const Stored& one, const ScanPlan& plan) {
    const rods::RodResult run = trajectory_of(plan, one.result, stored_times);
    const OutputUnits units = output_units(plan.base);
    paths.rows.push_back(static_cast<double>(one.row));
    const integrate::Solution& solution = run.solution;
    for (std::size_t i = 0; i < stored_times; ++i) {
        const bool there = i < solution.states.size();
        const std::vector<double>& y = there ? solution.states[i] : solution.final_state;
        paths.t.push_back((there ? solution.times[i] : solution.final_time) * units.time);
        for (std::size_t rod = 0; rod < plan.base.rods.size(); ++rod) {
            paths.x.push_back(y[3 * rod] * units.length);
            paths.y.push_back(y[3 * rod + 1] * units.length);
            paths.theta.push_back(y[3 * rod + 2]);
        }
    }
}

void TrajectorySample::write(store::Hdf5Writer& h5, const ScanPlan& plan) {
    const std::vector<Stored> stored = take();
    if (stored.empty())
        return;
    const OutputUnits units = output_units(plan.base);
    const std::size_t rods = plan.base.rods.size();
    Paths paths;
    for (const Stored& one : stored)
        add_path(paths, one, plan);
    const std::size_t count = stored.size();
    h5.dataset("/trajectories/point", paths.rows, {count}, "");
    h5.dataset("/trajectories/t", paths.t, {count, stored_times}, units.time_name);
    h5.dataset("/trajectories/x", paths.x, {count, stored_times, rods}, units.length_name);
    h5.dataset("/trajectories/y", paths.y, {count, stored_times, rods}, units.length_name);
    h5.dataset("/trajectories/theta", paths.theta, {count, stored_times, rods}, "rad");
}

} // namespace rodwake::app
