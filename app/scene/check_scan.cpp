#include "check.hpp"

#include "rodwake/core/encounter.hpp"
#include "rodwake/rods/separation_record.hpp"
#include "rodwake/scene/scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace rodwake::scene {

namespace {

std::vector<std::string> keys_of(const ScanAxis& axis) {
    return axis.key.empty() ? axis.keys : std::vector{axis.key};
}

/// A number as written; nothing for a string (it may carry a unit) or a flag.
std::optional<double> number_of(const Value& value) {
    if (const auto* real = std::get_if<double>(&value))
        return *real;
    if (const auto* whole = std::get_if<std::int64_t>(&value))
        return static_cast<double>(*whole);
    return std::nullopt;
}

void check_ends(const ScanAxis& axis, const std::string& path, const Report& report) {
    const std::optional<double> from = number_of(*axis.from), to = number_of(*axis.to);
    if (!from || !to) // with units: seen when they are resolved
        return;
    if (*from == *to)
        report(path, fmt::format("{}: from and to are both {}: the axis is empty", path, *from));
    if (axis.spacing == ScanSpacing::log && !(*from * *to > 0.0))
        report(path + ".spacing",
               fmt::format("{}: spacing \"log\" needs ends of one sign, found {} and {}", path, *from, *to));
}

void check_axis(const Scene& scene, const ScanAxis& axis, const std::string& path, const Report& report) {
    const Scan& scan = *scene.scan;
    const ScanSubject subject = scan_subject(scene);
    if (axis.key.empty() == axis.keys.empty())
        return report(path, fmt::format("{}: give key, or keys for several that vary together", path));
    if (!axis.factor.empty() && axis.factor.size() != axis.keys.size())
        return report(path + ".factor", fmt::format("{}.factor has {} numbers for {} keys", path,
                                                    axis.factor.size(), axis.keys.size()));
    for (const std::string& key : keys_of(axis)) {
        if (key == "granular.runs")
            return report(path, path +
                                    ": granular.runs is how many runs each point of the scan has: set it in "
                                    "[granular]");
        if (!can_vary(key, subject))
            return report(
                path, fmt::format("{}: {} is not what a scan{}", path, key,
                                  subject == ScanSubject::beds
                                      ? " of beds can vary: points depend on [granular] without runs, output "
                                        "and restart_from"
                                      : " can vary: points depend on [medium], [coupling], [[rods]] and "
                                        "[rods_run]"));
    }
    const bool range = axis.from && axis.to, any = axis.from || axis.to,
               grid = scan.design == ScanDesign::grid || scan.design == ScanDesign::critical;
    if (axis.values.empty() != range || (any && !range))
        report(path, fmt::format("{}: give from and to, or values", path));
    else if (!axis.values.empty() && !grid)
        report(path + ".values",
               fmt::format("{}.values: only design = \"grid\" or \"critical\" takes listed values", path));
    else if (range && grid && axis.count == 1)
        report(path + ".count", fmt::format("{}.count = 1 would use only \"from\" and ignore \"to\". For a "
                                            "single value write values = [...]",
                                            path));
    else if (range)
        check_ends(axis, path, report);
}

/// What an encounter ends with, or a group of it; "any" stands alone.
void check_between(const Scan& scan, const Report& report) {
    if (scan.between == std::vector<std::string>{"any"})
        return;
    if (scan.between.size() != 2 || scan.between[0] == scan.between[1])
        report("scan.between", "scan.between takes two different ends, such as [\"capture\", \"escape\"], or "
                               "[\"any\"] for every change of outcome");
    for (std::size_t k = 0; k < scan.between.size(); ++k) {
        const std::string& name = scan.between[k];
        const bool outcome = std::ranges::any_of(
            all_endings, [&](Ending ending) { return rodwake::to_string(ending) == name; });
        if (!outcome && name != "capture" && (name != "other" || k == 0))
            report("scan.between",
                   fmt::format(
                       "scan.between: \"{}\" is neither an outcome (contact, bound, orbit, pursuit, escape, "
                       "undecided) nor a group (capture; other, as the second)",
                       name));
    }
    if (scan.between.size() == 2 && (scan.between[0] == "capture" || scan.between[1] == "capture"))
        for (const Ending ending : all_endings)
            if (is_capture(ending) && std::ranges::count(scan.between, rodwake::to_string(ending)) > 0)
                report("scan.between", fmt::format("scan.between: {} is part of capture, so nothing lies "
                                                   "between them",
                                                   rodwake::to_string(ending)));
}

void check_critical(const Scene& scene, const Report& report) {
    const Scan& scan = *scene.scan;
    const std::string_view key = scan.solve_for;
    if (scan.solve_for.empty() || !scan.from || !scan.to)
        return report("scan", "design = \"critical\" needs solve_for, the key whose critical values are "
                              "sought, and its range, from and to");
    constexpr std::string_view of_solver[] = {"rods_run.", "noise."};
    const bool numerical =
        key != "rods_run.contact_distance" &&
        std::ranges::any_of(of_solver, [&](std::string_view table) { return key.starts_with(table); });
    if (!can_vary(key, ScanSubject::rods) || numerical)
        report("scan.solve_for",
               fmt::format("scan.solve_for = \"{}\": give a number that an encounter depends "
                           "on, in [coupling], [medium] or [[rods]], or "
                           "rods_run.contact_distance",
                           key));
    if (scene.noise)
        report("scan.design", "design = \"critical\" needs outcomes that are certain: leave [noise] out, or "
                              "take design = \"grid\" for probabilities");
    for (const ScanAxis& axis : scan.axes)
        for (const std::string& other : keys_of(axis))
            if (other == key || other.starts_with("rods_run.rtol") || other.starts_with("noise."))
                report("scan.axes", fmt::format("{} cannot be an axis of critical values of {}", other, key));
    ScanAxis range;
    range.from = scan.from, range.to = scan.to, range.spacing = scan.spacing;
    check_ends(range, "scan", report);
    check_between(scan, report);
}

/// What another design would take.
void check_design(const Scan& scan, const Report& report) {
    const bool list = scan.design == ScanDesign::list, adaptive = scan.design == ScanDesign::adaptive,
               critical = scan.design == ScanDesign::critical, file = !scan.file.empty();
    if (list && !file)
        report("scan.file", "design = \"list\" needs scan.file, a CSV whose header names the keys");
    if (!list && !critical && file)
        report("scan.file", "scan.file needs design = \"list\" or \"critical\"");
    if ((list || (critical && file)) && !scan.axes.empty())
        report("scan.axes", "with scan.file the axes are its columns");
    if (critical && scan.axes.size() > 4)
        report("scan.axes", "design = \"critical\" takes at most four axes beside solve_for");
    if (!critical && !scan.solve_for.empty())
        report("scan.solve_for", "scan.solve_for needs design = \"critical\"");
    if (!critical && (scan.from || scan.to))
        report("scan", "scan.from and scan.to need design = \"critical\": the range of an axis stands in "
                       "[[scan.axes]]");
    if (!list && !critical && scan.axes.empty())
        report("scan", "[scan] has no axes: give [[scan.axes]] with key, from and to");
    if (adaptive && scan.axes.size() > 3)
        report("scan.axes", "design = \"adaptive\" takes one, two or three axes");
    if (!adaptive && scan.boundary_tolerance)
        report("scan.boundary_tolerance",
               "scan.boundary_tolerance needs design = \"adaptive\", which finds the boundaries");
    if (!adaptive && !scan.refine.empty())
        report("scan.refine", "[[scan.refine]] needs design = \"adaptive\"");
}

void check_scanned_rods(const Scene& scene, const Report& report) {
    if (!scene.rods_run)
        report("scan", "[scan] needs [[rods]] with [rods_run], or [granular]");
    else if (scene.rods.size() < 2)
        report("scan", "[scan] of rods needs two or more [[rods]]: a single rod has no outcome");
    else if (scene.rods.size() > rods::most_followed_rods)
        report("scan", fmt::format("[scan] classifies the outcome of encounters of at most {} rods, and this "
                                   "scene has {}: use fewer rods",
                                   rods::most_followed_rods, scene.rods.size()));
    if (scene.scan->decide && scene.noise)
        report("scan.decide", "scan.decide is for rods without [noise]: leave one out");
    if (scene.rods_run && scene.rods_run->t_end_limit) {
        if (!scene.scan->decide && scene.scan->design != ScanDesign::critical)
            report("rods_run.t_end_limit", "rods_run.t_end_limit needs scan.decide = true, which continues "
                                           "points until their outcome is decided");
        if (*scene.rods_run->t_end_limit < scene.rods_run->t_end)
            report("rods_run.t_end_limit", "rods_run.t_end_limit must be at least t_end");
    }
    if (scene.medium && scene.medium->fitted)
        report("scan", "[scan] needs a medium of its own: medium.fitted = true takes it from [fit]");
    if (scene.medium && scene.medium->field != FieldBackend::exact)
        report("medium.field",
               "[scan] takes medium.field = \"exact\": its pairs are integrated many at once, "
               "which is faster than a table and not made for a measured or a dynamic field");
}

} // namespace

void check_scan(const Scene& scene, const Report& report) {
    if (!scene.scan)
        return;
    const Scan& scan = *scene.scan;
    if (scan_subject(scene) == ScanSubject::beds) {
        if (scene.scan->decide)
            report("scan.decide", "scan.decide is for scans of rods: a bed runs for granular.duration");
        if (scene.scan->design == ScanDesign::adaptive || scene.scan->design == ScanDesign::critical)
            report("scan.design", "scan.design = \"adaptive\" and \"critical\" follow where the outcome "
                                  "changes, and outcomes of "
                                  "beds are random: take grid, list, lhs or sobol");
        if (scene.granular->start == GranularStart::restart)
            report("granular.start",
                   "[scan] of beds makes the start of each run anew: granular.start = lattice or random");
    } else
        check_scanned_rods(scene, report);
    if (!scene.variants.empty())
        report("scan", "[scan] and [[variants]] do not go together: make the variants an axis");
    check_design(scan, report);
    if (scan.design == ScanDesign::critical)
        check_critical(scene, report);
    if (scan.design == ScanDesign::list)
        return;
    for (std::size_t i = 0; i < scan.axes.size(); ++i) {
        const std::string path = fmt::format("scan.axes[{}]", i);
        check_axis(scene, scan.axes[i], path, report);
        if (scan.design == ScanDesign::adaptive) {
            // The finest cells are those at the start, halved some times.
            const bool halves =
                scan.axes[i].count <= scan.resolution && scan.resolution % scan.axes[i].count == 0 &&
                std::has_single_bit(static_cast<unsigned long>(scan.resolution / scan.axes[i].count));
            if (!halves)
                report(
                    path + ".count",
                    fmt::format("{}.count = {}: with design = \"adaptive\" cells are halved until there are "
                                "scan.resolution = {} per side, which must be count times a power of two",
                                path, scan.axes[i].count, scan.resolution));
            else if (scan.axes[i].count != scan.axes.front().count)
                report(path + ".count", fmt::format("{}.count = {}: with design = \"adaptive\" all axes need "
                                                    "the same count; the first has {}",
                                                    path, scan.axes[i].count, scan.axes.front().count));
        }
    }
}

} // namespace rodwake::scene
