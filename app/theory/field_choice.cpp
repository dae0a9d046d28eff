#include "rodwake/app/plan.hpp"

#include "rodwake/app/rods.hpp"
#include "rodwake/elastic/periodic_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

using elastic::PeriodicTable;
using scene::FieldBackend;

/// Seconds.
struct Cost {
    double make, heading, wake;
};

/// Fewer rods are summed one wake at a time, more by the batch.
constexpr double batch_rods = 8.0;

Cost exact_cost(bool box, double rods) {
    return box ? Cost{0.0, 110e-6, 3e-6} : Cost{0.0, 0.0, rods < batch_rods ? 75e-9 : 15e-9};
}

Cost plane_table_cost(double tolerance) {
    return {2.0, 0.0, tolerance >= 1e-4 ? 40e-9 : tolerance >= 1e-6 ? 70e-9 : 100e-9};
}

Cost box_table_cost(std::size_t bytes) {
    return {0.05 + 0.03e-6 * static_cast<double>(bytes), 0.2e-6, 1.5e-6};
}

double start_extent(const scene::Scene& scene) {
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (const scene::Rod& rod : scene.rods)
        for (std::size_t k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], rod.position[k]);
            high[k] = std::max(high[k], rod.position[k]);
        }
    return std::max(high[0] - low[0], high[1] - low[1]);
}

double evaluations(const scene::Scene& scene, double extent) {
    const scene::RodsRun& run = *scene.rods_run;
    return 130.0 * run.t_end * std::sqrt(static_cast<double>(scene.rods.size())) / extent *
           std::max(1.0, std::pow(1e-6 / run.rtol, 1.0 / 6.0));
}

double seconds(const Cost& cost, double rods, double evaluations) {
    return cost.make + evaluations * (rods * cost.heading + rods * rods * cost.wake);
}

FieldChoice exact(std::string why) { return {FieldBackend::exact, 0.0, std::move(why)}; }

/// What no cost can settle: no run, no wake, or what tables do not have.
std::string why_exact(const scene::Scene& scene, double tolerance) {
    if (!scene.rods_run || scene.rods.empty() || !couplings_of(scene).any())
        return "no rod turns in a wake";
    const scene::RodsRun& run = *scene.rods_run;
    if (run.turning_tolerance > 0.0 || run.precision != elastic::Accuracy::full)
        return "rods_run asks for sums that only the exact field has";
    const scene::Medium& m = *scene.medium;
    if (!m.periodic)
        return scene.rods.size() < 2 ? "no rod turns in a wake" : "";
    if (!m.periodic->square())
        return "tables are of square boxes";
    if (tolerance < PeriodicTable::smallest_tolerance)
        return fmt::format("tables of a box reach {:g}, not {:g}", PeriodicTable::smallest_tolerance,
                           tolerance);
    // where the first try misses the tolerance the next takes twice as much
    if (PeriodicTable::expected_bytes({m.eta, m.xi}, m.periodic->x, tolerance) >
        PeriodicTable::memory_limit / 2)
        return "a table of this box would be too large";
    return "";
}

/// Cheaper of the two.
FieldChoice cheaper(const scene::Scene& scene, double tolerance) {
    const scene::Medium& m = *scene.medium;
    const auto rods = static_cast<double>(scene.rods.size());
    const bool box = m.periodic.has_value();
    const double count = evaluations(scene, box ? m.periodic->mean_side() : start_extent(scene));
    const Cost table =
        box ? box_table_cost(PeriodicTable::expected_bytes({m.eta, m.xi}, m.periodic->x, tolerance))
            : plane_table_cost(tolerance);
    const double by_table = seconds(table, rods, count),
                 exactly = seconds(exact_cost(box, rods), rods, count);
    const std::string why =
        fmt::format("some {:.1g} right-hand sides take about {:.1g} s exactly, {:.1g} s by a table of {:g}",
                    count, exactly, by_table, tolerance);
    return by_table < exactly ? FieldChoice{FieldBackend::table, tolerance, why} : exact(why);
}

} // namespace

const char* to_string(FieldBackend backend) {
    switch (backend) {
    case FieldBackend::exact:
        return "exact";
    case FieldBackend::table:
        return "table";
    case FieldBackend::measured:
        return "measured";
    case FieldBackend::dynamic:
        return "dynamic";
    case FieldBackend::automatic:
        break;
    }
    return "auto";
}

FieldChoice field_choice(const scene::Scene& scene) {
    if (!scene.medium)
        return {};
    const scene::Medium& m = *scene.medium;
    const double asked = m.table.value_or(scene::FieldTable{}).tolerance;
    if (m.field != FieldBackend::automatic)
        return {m.field, m.field == FieldBackend::table ? asked : 0.0, ""};
    const double rtol = scene.rods_run ? scene.rods_run->rtol : asked, wanted = m.table ? asked : rtol;
    const double tolerance =
        m.periodic ? std::min(wanted, PeriodicTable::largest_tolerance) : std::clamp(wanted, 1e-12, 0.1);
    std::string why = why_exact(scene, tolerance);
    return why.empty() ? cheaper(scene, tolerance) : exact(std::move(why));
}

scene::Scene with_field(scene::Scene scene, const FieldChoice& choice) {
    if (!scene.medium || scene.medium->field != FieldBackend::automatic)
        return scene;
    scene.medium->field = choice.backend;
    if (choice.backend == FieldBackend::table)
        scene.medium->table = scene::FieldTable{choice.tolerance};
    return scene;
}

} // namespace rodwake::app
