// What a plan will cost: the stages' own measurements, put together, and how tables of costs look.

#include "cost_parts.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/error.hpp"
#include "stage_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace rodwake::app {

namespace {

/// More digits would not come again.
std::string two_digits(double value) {
    return value < 99.5 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
}

/// Less than this share of a stage is not told from nothing in so short a time.
constexpr double resolution = 0.02;

std::string saving_text(const std::optional<double>& saved) {
    if (!saved)
        return "";
    if (std::abs(*saved) < resolution)
        return "next to nothing";
    return *saved > 0.0 ? percent_text(*saved) : fmt::format("nothing, takes {} more", percent_text(-*saved));
}

/// Failures are told, not thrown: a cost that cannot be measured is no fault of the scene.
std::string guarded(Stage stage, const std::function<std::string()>& cost) {
    try {
        return cost();
    } catch (const RunError& error) {
        return fmt::format("  {}: its cost could not be measured: {}\n", to_string(stage), error.what());
    }
}

} // namespace

std::string duration_text(double seconds) {
    constexpr std::pair<double, const char*> units[] = {{1e-9, "ns"}, {1e-6, "us"}, {1e-3, "ms"}};
    for (const auto& [unit, name] : units)
        if (seconds < 999.5 * unit)
            return fmt::format("{} {}", two_digits(seconds / unit), name);
    return two_digits(seconds) + " s";
}

std::string percent_text(double share) {
    return share < 0.001 ? "< 0.1 %" : fmt::format("{:.{}f} %", 100.0 * share, share < 0.0995 ? 1 : 0);
}

std::string cost_table(std::span<const CostRow> rows) {
    if (rows.empty())
        return "";
    const CostRow head{"part or setting", "takes", {}, {}};
    std::size_t term = head.term.size(), each = head.each.size();
    for (const CostRow& row : rows) {
        term = std::max(term, row.term.size());
        each = std::max(each, row.each.size());
    }
    std::string text = fmt::format("    {:{}}  {:>{}}  {:>7}  {}\n", head.term, term, head.each, each,
                                   "share", "left out or chosen, it saves");
    for (const CostRow& row : rows) {
        std::string line = fmt::format("    {:{}}  {:>{}}  {:>7}  {}", row.term, term, row.each, each,
                                       row.share ? percent_text(*row.share) : "", saving_text(row.saved));
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text;
}

std::string expected_cost(const Plan& plan, const std::filesystem::path& folder, const RunContext& context) {
    std::string text;
    for (const Stage stage : plan.stages)
        if (const auto cost_of = kind_of(stage).cost)
            text += guarded(stage, [&] { return cost_of(plan, folder, context); });
    if (text.empty())
        return "  nothing to compute\n";
    if (!plan.scene.figures.empty())
        text += "  figures and report: not timed; a second, some tenths for each figure, more for films\n";
    return text;
}

} // namespace rodwake::app
