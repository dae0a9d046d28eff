// Puts together the counts and timings of the stages, which say how long a plan will take.

#include "cost_parts.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/error.hpp"
#include "stage_kind.hpp"

#include <fmt/format.h>

namespace rodwake::app {

std::string duration_text(double seconds) {
    // Two digits: more would not come again.
    const auto text = [](double value) {
        return value < 99.5 ? fmt::format("{:.2g}", value) : fmt::format("{:.0f}", value);
    };
    constexpr std::pair<double, const char*> units[] = {{1e-9, "ns"}, {1e-6, "us"}, {1e-3, "ms"}};
    for (const auto& [unit, name] : units)
        if (seconds < 999.5 * unit)
            return fmt::format("{} {}", text(seconds / unit), name);
    return text(seconds) + " s";
}

std::string expected_cost(const Plan& plan, const std::filesystem::path& folder, const RunContext& context) {
    std::string text;
    for (const Stage stage : plan.stages)
        if (const auto cost_of = kind_of(stage).cost)
            try {
                text += cost_of(plan, folder, context);
            } catch (const RunError& error) { // no fault of the scene
                text +=
                    fmt::format("  {}: its cost could not be measured: {}\n", to_string(stage), error.what());
            }
    if (text.empty())
        return "  nothing to compute\n";
    if (!plan.scene.figures.empty())
        text += "  figures and report: not timed; a second, some tenths for each figure, more for films\n";
    return text;
}

} // namespace rodwake::app
