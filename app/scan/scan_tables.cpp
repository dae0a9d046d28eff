// scan.csv, cells.csv and boundary.csv.

#include "scan_tables.hpp"

#include "rodwake/app/rods.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "scan_parts.hpp"
#include "scan_values.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace rodwake::app {

namespace {

/// Shortest digits that give the number back. Counts, of which tables are full, are written as integers: the
/// same digits in a third of the time.
void append(std::string& text, double value) {
    if (!std::isfinite(value))
        return;
    std::array<char, 32> digits; // a double takes up to 24
    const bool count = value >= 0.0 && value < 1e6 && value == std::trunc(value) && !std::signbit(value);
    char* const end =
        count ? std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<long>(value)).ptr
              : fmt::format_to(digits.data(), FMT_COMPILE("{}"), value);
    text.append(digits.data(), end);
}

void append_place(std::string& text, const ScanPlan& plan, const scan::Point& point) {
    for (std::size_t k = 0; k < plan.design.axes.size(); ++k) {
        const auto value = values_of(plan.design, point)[k];
        if (plan.design.axes[k].words.empty())
            append(text, value);
        else
            text += plan.design.axes[k].words[static_cast<std::size_t>(value)];
        text += ',';
    }
}

} // namespace

std::string number_text(double value) {
    std::string text;
    append(text, value);
    return text;
}

std::string place_text(const ScanPlan& plan, const scan::Point& point) {
    std::string text;
    append_place(text, plan, point);
    return text;
}

std::string outcome_text(const ScanPlan& plan, std::int32_t outcome) {
    return outcome < 0 ? "" : plan.columns.outcomes[static_cast<std::size_t>(outcome)];
}

std::string axis_names(const ScanPlan& plan) {
    std::string names;
    for (const scan::Axis& axis : plan.design.axes)
        names += (names.empty() ? "" : ",") + axis.name;
    return names;
}

PointTable::PointTable(const std::filesystem::path& file, const ScanPlan& plan)
    : pending_(file), plan_(plan) {
    std::string head = axis_names(plan) + ",outcome,time,status";
    for (std::size_t k = 1; k < plan.columns.observables.size(); ++k)
        head += "," + plan.columns.observables[k];
    pending_.write(head + ",retries\n");
}

void PointTable::add(std::span<const scan::Result> results, std::size_t threads) {
    const std::size_t blocks = (results.size() + rows_at_once - 1) / rows_at_once;
    texts_.resize(blocks);
    parallel_for(blocks, threads, [&](std::size_t block) {
        const std::size_t first = block * rows_at_once;
        texts_[block].clear();
        for (const scan::Result& result :
             results.subspan(first, std::min(rows_at_once, results.size() - first))) {
            // "time" stands before the status, the others after it.
            std::string& text = texts_[block];
            append_place(text, plan_, result.point);
            text += outcome_text(plan_, result.ok() ? result.outcome : -1);
            text += ',';
            append(text, result.ok() ? result.values[0] : std::nan(""));
            text += ',';
            text += scan::status_names[static_cast<std::size_t>(result.status)];
            for (std::size_t k = 1; k < plan_.columns.observables.size(); ++k) {
                text += ',';
                if (plan_.columns.observables[k] == certificate_column)
                    text += result.ok() ? to_string(static_cast<Certificate>(result.values[k])) : "";
                else
                    append(text, result.ok() ? result.values[k] : std::nan(""));
            }
            text += ',';
            append(text, static_cast<double>(result.retries));
            text += '\n';
        }
    });
    for (const std::string& text : texts_)
        pending_.write(text);
}

void write_cells(const std::filesystem::path& file, const ScanPlan& plan, const scan::Summary& summary,
                 const std::vector<Certificate>& certificates) {
    const scan::Lattice lattice(plan.design);
    std::string text;
    for (const scan::Axis& axis : plan.design.axes)
        text += fmt::format("{0}_from,{0}_to,", axis.name);
    text += "outcome,certificate\n";
    for (std::size_t i = 0; i < summary.leaves.size(); ++i) {
        const scan::Leaf& leaf = summary.leaves[i];
        scan::Lattice::LatticePoint high = leaf.low;
        for (std::size_t k = 0; k < lattice.axes(); ++k)
            high[k] += leaf.side;
        const scan::Point from = lattice.point(leaf.low), to = lattice.point(high);
        for (std::size_t k = 0; k < lattice.axes(); ++k)
            for (const double end : {from.at[k], to.at[k]}) {
                append(text, end);
                text += ',';
            }
        const bool named = !leaf.mixed && leaf.outcome >= 0;
        text += (leaf.mixed ? "mixed"
                 : named    ? plan.columns.outcomes[static_cast<std::size_t>(leaf.outcome)]
                            : "") +
                "," + to_string(certificates[i]) + "\n";
    }
    store::write_atomically(file, text);
}

void write_boundary(const std::filesystem::path& file, const ScanPlan& plan, const scan::Summary& summary) {
    std::string text = "curve,between," + axis_names(plan) + ",error\n";
    for (std::size_t i = 0; i < summary.curves.size(); ++i)
        for (const scan::BoundaryPoint& point : summary.curves[i].points) {
            text += fmt::format("{},{}|{}", i,
                                plan.columns.outcomes[static_cast<std::size_t>(summary.curves[i].outcome_a)],
                                plan.columns.outcomes[static_cast<std::size_t>(summary.curves[i].outcome_b)]);
            for (std::size_t k = 0; k < plan.design.axes.size(); ++k)
                text += "," + number_text(point.at[k]);
            text += fmt::format(",{:.3g}\n", point.error);
        }
    store::write_atomically(file, text);
}

PointColumns::PointColumns(store::Hdf5Writer& h5, const ScanPlan& plan, std::int64_t rows)
    : h5_(h5), plan_(plan), rows_(static_cast<std::size_t>(rows)) {
    for (std::size_t k = 0; k < plan.design.axes.size(); ++k)
        columns_.push_back({plan.design.axes[k].name,
                            [&, k](const scan::Result& r) { return values_of(plan.design, r.point)[k]; }});
    columns_.push_back({"outcome", [](const scan::Result& r) { return r.ok() ? r.outcome : -1.0; }});
    columns_.push_back({"status", [](const scan::Result& r) { return static_cast<double>(r.status); }});
    for (std::size_t k = 0; k < plan.columns.observables.size(); ++k)
        columns_.push_back({plan.columns.observables[k],
                            [k](const scan::Result& r) { return r.ok() ? r.values[k] : std::nan(""); }});
}

void PointColumns::add(std::span<const scan::Result> results) {
    std::vector<double> block(results.size());
    for (const PointColumn& column : columns_) {
        std::ranges::transform(results, block.begin(), column.value);
        h5_.part("/points/" + column.name, block, written_, {rows_});
    }
    written_ += results.size();
}

void PointColumns::finish() {
    for (const scan::Axis& axis : plan_.design.axes)
        if (!axis.words.empty())
            h5_.attribute("/points", axis.name + "_names", fmt::format("{}", fmt::join(axis.words, ",")));
    h5_.attribute("/points", "outcome_names", fmt::format("{}", fmt::join(plan_.columns.outcomes, ",")));
    h5_.attribute("/points", "status_names", fmt::format("{}", fmt::join(scan::status_names, ",")));
    std::vector<std::string> certificates;
    certificates.reserve(all_certificates.size());
    for (const Certificate certificate : all_certificates)
        certificates.push_back(to_string(certificate));
    h5_.attribute("/points", "certificate_names", fmt::format("{}", fmt::join(certificates, ",")));
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

void TrajectorySample::write(store::Hdf5Writer& h5, const ScanPlan& plan) {
    std::vector<Stored> stored;
    for (; !kept_.empty(); kept_.pop())
        stored.push_back(kept_.top().stored);
    if (stored.empty())
        return;
    std::ranges::sort(stored, {}, &Stored::row);
    const OutputUnits units = output_units(plan.base);
    const std::size_t rods = plan.base.rods.size(), count = stored.size();
    constexpr std::size_t stored_times = 61;
    struct {
        std::vector<double> rows, t, x, y, theta;
    } paths; // columns, [S][T] or [S][T][N]
    for (const Stored& item : stored) {
        const rods::RodResult run = trajectory_of(plan, item.result, stored_times);
        const integrate::Solution& solution = run.solution;
        paths.rows.push_back(static_cast<double>(item.row));
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
    h5.dataset("/trajectories/point", paths.rows, {count}, "");
    h5.dataset("/trajectories/t", paths.t, {count, stored_times}, units.time_name);
    h5.dataset("/trajectories/x", paths.x, {count, stored_times, rods}, units.length_name);
    h5.dataset("/trajectories/y", paths.y, {count, stored_times, rods}, units.length_name);
    h5.dataset("/trajectories/theta", paths.theta, {count, stored_times, rods}, "rad");
}

} // namespace rodwake::app
