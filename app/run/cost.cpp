// What a plan will cost, from a short measurement of each part on this machine: the stages that are quick to
// describe, and the table of all.

#include "cost_parts.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "rodwake/fitting/problem.hpp"
#include "scan/scan_rods.hpp"
#include "theory/wake_fields.hpp"

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

// --- fits -------------------------------------------------------------------------------------------------

/// Seconds of one evaluation at the start, with its derivatives or without.
double evaluation_time(const fitting::Problem& problem, bool derivatives) {
    std::vector<double> start;
    for (const std::size_t i : fitting::free_parameters(problem))
        start.push_back(problem.parameters[i].start);
    const std::vector<double> values = fitting::all_values(problem, start);
    const auto rows = static_cast<Eigen::Index>(problem.residuals);
    Eigen::VectorXd residuals(rows);
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(values.size()));
    return seconds_of([&] { problem.evaluate(values, residuals, derivatives ? &jacobian : nullptr); },
                      0.2 * cost_budget);
}

std::vector<CostRow> fit_rows(const Plan& plan, double whole) {
    const auto each = [](double seconds) { return duration_text(seconds) + " an evaluation"; };
    const double residuals = std::min(whole, evaluation_time(plan.fit_plan->problem, false));
    std::vector<CostRow> rows = {
        {"residuals", each(residuals), residuals / whole, {}},
        {"derivatives by the parameters", each(whole - residuals), 1.0 - residuals / whole, {}}};
    if (scene::Fit keys = *plan.scene.fit; keys.box && !keys.profiles.empty()) {
        keys.box.reset();
        const double plane = evaluation_time(fit_plan(keys, *plan.fit).problem, true);
        rows.push_back(
            {"images in the box (fit.box), of these", each(whole - plane), {}, 1.0 - plane / whole});
    }
    if (const long starts = plan.scene.fit->search.starts; starts > 1)
        rows.push_back({"fit.starts = 1", "", {}, 1.0 - 1.0 / static_cast<double>(starts)});
    return rows;
}

std::string fit_cost(const Plan& plan) {
    constexpr double evaluations = 50.0; // of a start with gradients
    const scene::Fit& keys = *plan.scene.fit;
    const double all = evaluations * static_cast<double>(keys.search.starts);
    std::string text = fmt::format("  fit: {} start{}, about {:.0f} evaluations of the model",
                                   keys.search.starts, keys.search.starts == 1 ? "" : "s", all);
    if (!plan.fit_plan)
        return text + "; their time is known when the run has made the data\n";
    const double each = evaluation_time(plan.fit_plan->problem, true);
    return text +
           fmt::format(", {} residuals, about {}\n", plan.fit_plan->problem.residuals,
                       duration_text(all * each)) +
           cost_table(fit_rows(plan, each));
}

// --- field maps -------------------------------------------------------------------------------------------

/// Seconds of a point of a row of the grid.
double point_time(const elastic::Wake& wake, elastic::FieldRequest request) {
    constexpr int points = 100;
    const auto row = [&] {
        for (int i = 0; i < points; ++i)
            wake.at(0.03 * i - 1.0, 0.7, request);
    };
    return seconds_of(row, 0.1 * cost_budget) / points;
}

std::string field_cost(const Plan& plan, const std::filesystem::path& folder, const RunContext& context) {
    const scene::Scene& scene = plan.scene;
    const elastic::Medium medium{scene.medium->eta, scene.medium->xi};
    const bool measured = scene.medium->field == scene::FieldBackend::measured;
    const auto field = measured ? elastic::exact_field(medium, scene.medium->periodic)
                                : WakeFields(context, folder, make_silent_logger()).of(scene);
    const auto wake = field->wake(0.0);
    const elastic::FieldRequest all{.displacement = true, .strain = true, .polar = true};
    const double whole = point_time(*wake, all);
    std::vector<CostRow> rows = {
        {"displacement, strain, polar vectors", duration_text(whole) + " a point", 1.0, {}}};
    if (field->box()) {
        const double plane = point_time(*elastic::exact_field(medium)->wake(0.0), all);
        rows.push_back({"images in the box (medium.periodic), of these",
                        duration_text(std::max(0.0, whole - plane)) + " a point",
                        {},
                        1.0 - plane / whole});
    }
    return fmt::format("  field maps: about {}{}\n",
                       duration_text(whole * static_cast<double>(scene.field->nx * scene.field->ny)),
                       measured ? " in the field of theory, and some seconds for smoothing the measured one"
                                : "") +
           cost_table(rows);
}

// --- scans of rods ----------------------------------------------------------------------------------------

/// A few points spread over the scan stand for all.
double seconds_of_point(const ScanPlan& plan, double budget) {
    scan::Design spread = plan.design;
    if (spread.kind != scan::Kind::list)
        spread.kind = scan::Kind::sobol;
    spread.samples = 256;
    const scan::PointList points(spread);
    const scan::Evaluate evaluate = evaluate_rods(plan, nullptr);
    const Stopwatch watch;
    std::int64_t done = 0;
    while (done < points.size() && watch.seconds() < budget) {
        const scan::Point one[] = {points[done++]};
        scan::Result result[1];
        evaluate(one, result);
    }
    return watch.seconds() / static_cast<double>(done);
}

bool varies(const ScanPlan& plan, std::string_view key) {
    return std::ranges::any_of(plan.keys, [&](const auto& one) { return one.key == key; });
}

std::vector<CostRow> scan_rows(const ScanPlan& plan, double whole) {
    std::vector<CostRow> rows;
    const auto add = [&](std::string setting, const ScanPlan& other) {
        const double each = seconds_of_point(other, 0.3 * cost_budget);
        rows.push_back({std::move(setting), duration_text(each) + " a point", {}, 1.0 - each / whole});
    };
    ScanPlan other = plan;
    scene::RodsRun& run = *other.base.rods_run;
    if (run.rtol < 1e-3 && !varies(plan, "rods_run.rtol")) {
        run.rtol = std::min(100.0 * run.rtol, 1e-3);
        run.atol *= run.rtol / plan.base.rods_run->rtol;
        add(fmt::format("rods_run.rtol = {:g} instead of {:g}", run.rtol, plan.base.rods_run->rtol), other);
    }
    const bool varied = std::ranges::any_of(rods::coupling_list, [&](const rods::Coupling& c) {
        return c.polar && varies(plan, "coupling." + std::string(c.name));
    });
    if (plan.base.coupling && couplings_of(plan.base).polar() && !varied) {
        other = plan;
        static_cast<rods::Couplings&>(*other.base.coupling) = rods::without(*other.base.coupling, true);
        add(fmt::format("no polar turning ({})", rods::coupling_names(true)), other);
    }
    return rows;
}

/// Of an adaptive scan which one boundary crosses. For each of the finest cells on that, the shipped scans
/// evaluate 10 to 25 points around it and bisect 1 to 4 edges.
double expected_points(const scan::Design& design) {
    if (design.kind != scan::Kind::adaptive)
        return static_cast<double>(scan::size(design));
    constexpr double around = 16.0, edges = 3.0;
    double start = 1.0;
    for (const scan::Axis& axis : design.axes)
        start *= static_cast<double>(axis.count + 1);
    const auto side = static_cast<double>(design.resolution);
    const double crossed = std::pow(side, static_cast<double>(design.axes.size()) - 1.0),
                 halvings = design.boundary_tolerance > 0.0
                                ? std::max(0.0, -std::log2(side * design.boundary_tolerance))
                                : 0.0,
                 lattice = start + static_cast<double>(design.audit) + around * crossed;
    return std::min(lattice, static_cast<double>(scan::places(design))) + edges * crossed * halvings;
}

std::string scan_cost(const ScanPlan& plan) {
    const double each = seconds_of_point(plan, 0.4 * cost_budget), points = expected_points(plan.design);
    return fmt::format("  scan: {:.2g} ms a point, {:.3g} points{}, about {:.2g} CPU seconds\n", 1e3 * each,
                       points, plan.design.kind == scan::Kind::adaptive ? " if one boundary crosses it" : "",
                       each * points) +
           cost_table(scan_rows(plan, each));
}

/// Failures are told, not thrown: a cost that cannot be measured is no fault of the scene.
std::string guarded(Stage stage, const std::function<std::string()>& cost) {
    try {
        return cost();
    } catch (const RunError& error) {
        return fmt::format("  {}: its cost could not be measured: {}\n", to_string(stage), error.what());
    }
}

std::string cost_of(Stage stage, const Plan& plan, const std::filesystem::path& folder,
                    const RunContext& context) {
    switch (stage) {
    case Stage::granular:
        return bed_cost(plan);
    case Stage::measure:
        return plan.has(Stage::granular) ? "" : "  measures: about as long as reading the trajectory takes\n";
    case Stage::fit:
        return fit_cost(plan);
    case Stage::field:
        return plan.scene.field->x.empty() ? "" : field_cost(plan, folder, context);
    case Stage::rods:
        return rods_cost(plan, folder, context);
    case Stage::order: // reads what the stage before it left
    case Stage::tradeoff:
        return "";
    case Stage::scan:
        break;
    }
    return plan.scan->subject == scene::ScanSubject::beds ? bed_scan_cost(plan) : scan_cost(*plan.scan);
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
        text += guarded(stage, [&] { return cost_of(stage, plan, folder, context); });
    if (text.empty())
        return "  nothing to compute\n";
    if (!plan.scene.figures.empty())
        text += "  figures and report: not timed; a second, some tenths for each figure, more for films\n";
    return text;
}

} // namespace rodwake::app
