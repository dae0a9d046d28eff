// The scan stage: ledger, executor, results.

#include "critical.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/scan_problem.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/stopwatch.hpp"
#include "run/cost_parts.hpp"
#include "run/log.hpp"
#include "run/record_table.hpp"
#include "run/stage_kind.hpp"
#include "scan_parts.hpp"
#include "scan_values.hpp"
#include "theory/wake_fields.hpp"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <set>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

scan::Evaluate evaluate_of(const ScanPlan& plan, const fs::path& folder, const RunContext& context,
                           const Logger& log) {
    if (of_beds(plan))
        return evaluate_beds(plan, folder, context, log);
    if (!plan.critical)
        return evaluate_rods(plan, context.stop);
    return [coarse = evaluate_rods(plan, context.stop), brackets = evaluate_brackets(plan, context.stop)](
               std::span<const scan::Point> points, std::span<scan::Result> results) {
        const bool narrow = !points.empty() && points.front().id >= first_bracket;
        (narrow ? brackets : coarse)(points, results);
    };
}

void prepare(const Session& session, scan::Ledger& ledger) {
    // Runs of beds whose files are gone are made again.
    const auto lost = session.directory.lost().find(to_string(Stage::scan));
    std::set<std::int64_t> ids;
    if (lost != session.directory.lost().end())
        for (const std::string& name : lost->second)
            if (const auto id = bed_of(name))
                ids.insert(*id);
    ledger.forget(std::vector(ids.begin(), ids.end()));
    if (session.context.scan.merge) {
        const std::vector<fs::path> shares = shares_in(session.directory.path());
        for (const fs::path& share : shares)
            ledger.merge(share);
        session.log->info("scan: {} shares taken over", shares.size());
    }
    if (session.context.scan.rerun_failed)
        session.log->info("scan: {} points that failed are evaluated again", ledger.forget_failed());
    if (ledger.damaged() > 0)
        session.log->warn("scan: {} records of the ledger are damaged; their points are evaluated again",
                          ledger.damaged());
    if (const std::int64_t done = ledger.points(); done > 0)
        session.log->info("scan: {} points are in the ledger already", done);
}

std::string counts_text(const scan::Counts& counts) {
    std::string text;
    for (const auto& [name, points] : counts.outcomes)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, points);
    return text;
}

/// Points that are undecided at the limit, by the criteria that they fail.
scan::Counts undecided_points(const scan::Ledger& ledger) {
    scan::Counts counts;
    std::map<std::string, std::string> texts; // of the first point that has the pattern
    ledger.for_each([&](const scan::Result& result) {
        if (!result.ok() || result.outcome != static_cast<std::int32_t>(Ending::undecided))
            return;
        const std::string cause(result.cause_text());
        const std::string& text = texts.try_emplace(scan::cause_pattern(cause), cause).first->second;
        ++counts.points;
        ++counts.causes[text];
        counts.examples.try_emplace(text, result.point.id);
    });
    return counts;
}

/// Each cause with how many points have it, and one of them.
void tell_causes(const Session& session, const scan::Ledger& ledger, const scan::Counts& counts) {
    std::vector<scan::Point> ids;
    for (const auto& [cause, id] : counts.examples)
        ids.push_back({id, {}});
    std::map<std::int64_t, scan::Point> examples;
    for (const scan::Result& result : ledger.find(ids))
        examples[result.point.id] = result.point;
    for (const auto& [cause, points] : counts.causes) {
        std::string position; // "coupling.kappa = 3, rods.1.position.0 = 1"
        const std::vector<scan::Axis>& axes = ledger.head().axes;
        for (std::size_t k = 0; k < axes.size(); ++k) {
            const double value = examples[counts.examples.at(cause)].at[k];
            position += fmt::format("{}{} = {}", k ? ", " : "", axes[k].name,
                                    axes[k].words.empty() ? fmt::format("{:.6g}", value)
                                                          : axes[k].words[static_cast<std::size_t>(value)]);
        }
        session.log->warn("scan:   {:>8}  {}", points, cause);
        session.log->warn("scan:   {:>8}  {} at {}", "", points == 1 ? "this was" : "one of them", position);
    }
}

StageEnd report(const Session& session, const scan::Ledger& ledger, const scan::Counts& counts,
                const scan::Summary& summary) {
    const char* what = of_beds(*session.plan.scan) ? "runs" : "points";
    if (counts.points > summary.requested) // an adaptive scan of a higher resolution came before
        session.log->info("scan: {} {} in the ledger, of a finer scan too: {}", counts.points, what,
                          counts_text(counts));
    else
        session.log->info("scan: {} of {} {} evaluated: {}", counts.points, summary.requested, what,
                          counts_text(counts));
    if (session.plan.scan->decide && summary.complete)
        if (const scan::Counts undecided = undecided_points(ledger); undecided.points > 0) {
            session.log->warn("scan: {} points are undecided at rods_run.t_end_limit", undecided.points);
            tell_causes(session, ledger, undecided);
        }
    if (summary.audit.tried > 0)
        session.log->info(
            "scan: audit of {} random points outside the boundary: {} missed, at most {:.2g} of "
            "the area (95 %){}",
            summary.audit.tried, summary.audit.missed, summary.audit.upper_bound(),
            summary.found_by_audit > 0 ? fmt::format("; {} found before and refined", summary.found_by_audit)
                                       : "");
    if (summary.lost_crossings > 0)
        session.log->warn("scan: the boundary has {} gaps, where points failed while it was traced; "
                          "--rerun-failed tries them again",
                          summary.lost_crossings);
    if (!summary.complete)
        return StageEnd::interrupted;
    if (counts.failed == 0)
        return summary.lost_crossings > 0 ? StageEnd::incomplete : StageEnd::finished;
    session.log->warn("scan: {} {} failed; --rerun-failed evaluates them again", counts.failed, what);
    tell_causes(session, ledger, counts);
    return StageEnd::incomplete;
}

} // namespace

scan::Evaluate point_evaluator(const ScanPlan& plan, const fs::path& folder, const RunContext& context) {
    return evaluate_of(plan, folder, context, make_silent_logger());
}

namespace {

/// The brackets of the coarse pass, narrowed, and how many failed; nothing: stopped. Brackets that are done
/// are in a ledger of their own, with which the same call goes on.
std::optional<std::size_t> solve_critical(const Session& session, const scan::Ledger& ledger,
                                          const scan::Execute& execute, Progress& progress) {
    const ScanPlan& plan = *session.plan.scan;
    const fs::path folder = session.directory.path();
    scan::Ledger found(folder / critical_ledger, {plan.description, plan.design.axes, columns_of_critical()});
    if (session.context.scan.rerun_failed)
        found.forget_failed();
    const CriticalSearch search =
        find_critical(plan, ledger, found, execute, [&](std::int64_t done, std::int64_t total) {
            progress.update(static_cast<double>(done), static_cast<double>(total));
        });
    found.sync();
    if (!search.complete)
        return std::nullopt;
    write_critical(folder, plan, ledger, search);
    std::map<std::string, int> kinds;
    for (const scan::Result& result : search.values)
        ++kinds[critical_kinds[static_cast<std::size_t>(result.outcome)]];
    std::string text;
    for (const auto& [kind, count] : kinds)
        text += fmt::format("{}{} {}", text.empty() ? ": " : ", ", kind, count);
    session.log->info("scan: {} critical values of {}{}", search.values.size(), plan.design.axes.back().name,
                      text);
    if (!search.failed.empty())
        session.log->warn(
            "scan: {} brackets failed; critical.json has the causes, --rerun-failed tries them again",
            search.failed.size());
    return search.failed.size();
}

StageEnd run_scan(Session& session) {
    const auto start = std::chrono::steady_clock::now();
    const ScanPlan& plan = *session.plan.scan;
    scan::Ledger ledger(session.directory.file(scan::ledger_file), ledger_head(plan));
    prepare(session, ledger);
    Progress progress(session.context, "scan", 0.0, of_beds(plan) ? "runs" : "points");
    scan::RunOptions options;
    options.part = session.context.scan.part;
    options.on_progress = [&](std::int64_t done, std::int64_t total) {
        progress.update(static_cast<double>(done), static_cast<double>(total));
    };
    scan::Design design = plan.design;
    design.side = side_of_pursuit(plan);
    const RunContext& context = session.context;
    const auto evaluate = evaluate_of(plan, session.directory.path(), context, session.log);
    const scan::Execute execute = context.executor
                                      ? context.executor(evaluate, context.stop)
                                      : scan::on_threads(evaluate, context.thread_count(), context.stop);
    scan::Summary summary = scan::run(design, ledger, execute, options);
    std::size_t failed = 0;
    if (plan.critical && summary.complete && options.part.of == 1) { // a share has no neighbours
        const auto brackets = solve_critical(session, ledger, execute, progress);
        summary.complete = brackets.has_value();
        failed = brackets.value_or(0);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    const scan::Counts counts = ledger.counts();
    // mpiexec kills its ranks a second after the signal, too soon for large tables; the ledger holds it all.
    if (!summary.complete && session.context.executor)
        return report(session, ledger, counts, summary);
    ledger.sync();
    const ScanCertificates certificates =
        certificates_of(plan, ledger, summary, session.context.thread_count());
    write_scan(session.directory.path(), plan, *session.plan.scene.scan, ledger, counts, summary,
               certificates, took.count(), session.context.thread_count());
    if (plan.certificates)
        session.log->info("scan: {}", certificates_text(certificates));
    const StageEnd end = report(session, ledger, counts, summary);
    return end == StageEnd::finished && failed > 0 ? StageEnd::incomplete : end;
}

std::string scan_cost(const ScanPlan& plan) {
    // Twenty points spread over the scan stand for all, or as many as there is time for.
    ScanPlan spread = plan;
    if (spread.design.kind != scan::Kind::list)
        spread.design.kind = scan::Kind::sobol;
    spread.design.samples = 20;
    const scan::PointList sample(spread.design);
    const scan::Evaluate evaluate = evaluate_rods(spread, nullptr);
    const Stopwatch watch;
    std::int64_t done = 0;
    while (done < std::min<std::int64_t>(20, sample.size()) && watch.seconds() < cost_budget) {
        const scan::Point one[] = {sample[done++]};
        scan::Result result[1];
        evaluate(one, result);
    }
    const double each = watch.seconds() / static_cast<double>(done);

    // An adaptive scan is assumed to be crossed by one boundary. For each of the finest cells on that, the
    // shipped scans evaluate 10 to 25 points around it and bisect 1 to 4 edges.
    const scan::Design& design = plan.design;
    double points = 0.0;
    if (design.kind == scan::Kind::adaptive) {
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
        points = std::min(lattice, static_cast<double>(scan::places(design))) + edges * crossed * halvings;
    } else
        points = static_cast<double>(scan::size(design));
    std::string text = fmt::format(
        "  scan: {:.2g} ms a point, {:.3g} points{}, about {:.2g} CPU seconds\n", 1e3 * each, points,
        plan.design.kind == scan::Kind::adaptive ? " if one boundary crosses it" : "", each * points);
    if (plan.critical) { // near a critical value encounters take about five times as long
        const auto values = static_cast<double>(plan.design.axes.back().values.size());
        text += fmt::format(
            "  critical values: {:.3g} encounters bracket the values of a point; each value takes 2 to 20 "
            "more, and 3 to 20 at rtol/100: about {:.2g} CPU seconds if each point has one\n",
            values, points / values * 5.0 * 15.0 * each);
    }
    return text;
}

constexpr ColumnInfo cells_columns[] = {
    {"outcome", "1", "of all corners of the cell; mixed: they differ"},
    {"certificate", "1",
     "verified: no pair within the cell ends otherwise; checked: the corners are verified or checked; open"}};
constexpr ColumnInfo failures_columns[] = {{"status", "1", "failed, time_limit, not_finite or exception"},
                                           {"retries", "1", "attempts before the last"},
                                           {"cause", "1", "why the last attempt failed"}};
constexpr ColumnInfo boundary_columns[] = {
    {"curve", "1", "number of the curve; its rows are in order along it"},
    {"between", "1", "the two outcomes"},
    {"error", "1", "half the bracket, as a fraction of the axis"}};

std::vector<FileKind> scan_files() {
    using enum Lifetime;
    // As critical.csv has them: kinds and outcomes as words.
    static const std::vector<ColumnInfo> critical_columns = [] {
        std::vector<ColumnInfo> all = {
            {"kind", "1", "grazing, separatrix, unbinding or fold"},
            {"branch", "1", "number of the curve of values of neighbouring points, from 0"}};
        add_number_columns<CriticalValue>(all);
        std::erase_if(
            all, [](const ColumnInfo& column) { return column.name == field_names<CriticalValue>().back(); });
        return all;
    }();
    return {
        {scan::ledger_file, kept, "the points of the scan, of beds the runs: what the same command resumes"},
        {critical_ledger, kept, "the brackets of critical values that are done"},
        {"critical.csv", result, "critical values of a key, a row a value", critical_columns},
        {"critical.json", result, "of each point how many critical values there are, or why none"},
        {"scan.h5", result, "the points of the scan and a sample of trajectories as datasets"},
        {"scan.json", result, "axes, counts, causes of failures, rate of what was missed"},
        {"scan.html", result, "the scan to explore in a browser"},
        {"cells.csv", result, "cells of the refinement that were not divided", cells_columns},
        {"boundary.csv", result, "boundaries between outcomes as curves", boundary_columns},
        {"scan.csv", result,
         "one row per point, in the order of the design: the axes, then these columns; for beds means over "
         "the runs",
         scan_columns()},
        {"failures.csv", result, "the points that failed, with their causes", failures_columns},
        {"scan_runs.csv", result, "one row per run of a scan of beds", scan_columns()}};
}

} // namespace

StageKind scan_stage() {
    return {.stage = Stage::scan,
            .has_table = [](const scene::Scene& s) { return s.scan.has_value(); },
            .wanted = [](const scene::Scene& s) { return s.scan.has_value(); },
            .key = scan_key,
            .files = scan_files,
            .read =
                [](PlanInputs& inputs, const scene::Scene& scene, const InputRequest& request) {
                    if (request.check)
                        read_field_file(inputs, scene, request);
                    inputs.list = read_scan_list(scene);
                },
            .run = run_scan,
            .serve = [](const Plan& plan, const fs::path& folder, const RunContext& context,
                        scan::MpiJob& job) { job.serve(point_evaluator(*plan.scan, folder, context)); },
            .require = [](const Plan& plan, const fs::path& folder,
                          const RunContext& context) { require_scan(*plan.scan, folder, context); },
            .cost =
                [](const Plan& plan, const fs::path&, const RunContext&) {
                    return of_beds(*plan.scan) ? bed_scan_cost(plan) : scan_cost(*plan.scan);
                },
            .grows =
                [](const scene::Scene& old, const scene::Scene& s) {
                    const bool beds = scan_subject(s) == scene::ScanSubject::beds;
                    return old.scan != s.scan || (beds && wants_more_runs(old, s));
                }};
}

} // namespace rodwake::app
