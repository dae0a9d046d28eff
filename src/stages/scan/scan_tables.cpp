// scan.csv, cells.csv and boundary.csv.

#include "scan_tables.hpp"

#include "rodwake/store/atomic_file.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::stages {

namespace {

using assembly::ScanPlan;

/// Shortest digits that give the number back.
void append(std::string& text, double value) {
    if (std::isfinite(value))
        fmt::format_to(std::back_inserter(text), "{}", value);
}

/// "time" stands before the status, the others after it.
void append_row(std::string& text, const ScanPlan& plan, const scan::Result& r) {
    text += place_text(plan, r.point);
    text += outcome_text(plan, r.ok() ? r.outcome : -1);
    text += ',';
    append(text, r.ok() ? r.values[0] : std::nan(""));
    text += ',';
    text += scan::status_names[static_cast<std::size_t>(r.status)];
    for (std::size_t k = 1; k < plan.columns.observables.size(); ++k) {
        text += ',';
        append(text, r.ok() ? r.values[k] : std::nan(""));
    }
    fmt::format_to(std::back_inserter(text), ",{}\n", r.retries);
}

std::string between(const ScanPlan& plan, const scan::Curve& curve) {
    return plan.columns.outcomes[static_cast<std::size_t>(curve.outcome_a)] + "|" +
           plan.columns.outcomes[static_cast<std::size_t>(curve.outcome_b)];
}

} // namespace

std::string number_text(double value) {
    std::string text;
    append(text, value);
    return text;
}

std::string axis_text(const scan::Axis& axis, double value) {
    return axis.words.empty() ? number_text(value) : axis.words[static_cast<std::size_t>(value)];
}

std::string place_text(const ScanPlan& plan, const scan::Point& point) {
    std::string text;
    for (std::size_t k = 0; k < plan.design.axes.size(); ++k)
        text += axis_text(plan.design.axes[k], point.at[k]) + ",";
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
    : pending_(file), plan_(plan), text_(axis_names(plan) + ",outcome,time,status") {
    for (std::size_t k = 1; k < plan.columns.observables.size(); ++k)
        text_ += "," + plan.columns.observables[k];
    text_ += ",retries\n";
}

void PointTable::add(const scan::Result& result) {
    append_row(text_, plan_, result);
    if (text_.size() > 1 << 20)
        flush();
}

void PointTable::flush() {
    pending_.write(text_);
    text_.clear();
}

void PointTable::commit() {
    flush();
    pending_.commit();
}

void write_cells(const std::filesystem::path& file, const ScanPlan& plan, const scan::Summary& summary) {
    const scan::Lattice lattice(plan.design);
    std::string text;
    for (const scan::Axis& axis : plan.design.axes)
        text += fmt::format("{0}_from,{0}_to,", axis.name);
    text += "outcome\n";
    for (const scan::Leaf& leaf : summary.leaves) {
        scan::Lattice::Place high = leaf.low;
        for (std::size_t k = 0; k < lattice.axes(); ++k)
            high[k] += leaf.side;
        const scan::Point from = lattice.point(leaf.low), to = lattice.point(high);
        for (std::size_t k = 0; k < lattice.axes(); ++k)
            text += number_text(from.at[k]) + "," + number_text(to.at[k]) + ",";
        const bool named = !leaf.mixed && leaf.outcome >= 0;
        text += (leaf.mixed ? "mixed"
                 : named    ? plan.columns.outcomes[static_cast<std::size_t>(leaf.outcome)]
                            : "") +
                std::string("\n");
    }
    store::write_atomically(file, text);
}

void write_boundary(const std::filesystem::path& file, const ScanPlan& plan, const scan::Summary& summary) {
    std::string text = "curve,between," + axis_names(plan) + ",error\n";
    for (std::size_t i = 0; i < summary.curves.size(); ++i)
        for (const scan::BoundaryPoint& point : summary.curves[i].points) {
            text += fmt::format("{},{}", i, between(plan, summary.curves[i]));
            for (std::size_t k = 0; k < plan.design.axes.size(); ++k)
                text += "," + number_text(point.at[k]);
            text += fmt::format(",{:.3g}\n", point.error);
        }
    store::write_atomically(file, text);
}

} // namespace rodwake::stages
