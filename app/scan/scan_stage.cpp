// The scan stage: ledger, executor, results.

#include "rodwake/app/evaluate.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/core/error.hpp"
#include "run/log.hpp"
#include "run/stage_list.hpp"
#include "scan_beds.hpp"
#include "scan_request.hpp"
#include "scan_results.hpp"
#include "scan_rods.hpp"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <set>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

scan::Evaluate evaluate_of(const ScanPlan& plan, const fs::path& folder, const RunContext& context,
                           const Logger& log) {
    return of_beds(plan) ? evaluate_beds(plan, folder, context, log) : evaluate_rods(plan, context.stop);
}

scan::Execute executor_of(const Session& session, const ScanPlan& plan) {
    const RunContext& context = session.context;
    const auto evaluate = evaluate_of(plan, session.directory.path(), context, session.log);
    if (context.executor)
        return context.executor(evaluate, context.stop);
    return scan::on_threads(evaluate, context.thread_count(), context.stop);
}

void merge_shares(const Session& session, scan::Ledger& ledger) {
    const std::vector<fs::path> shares = shares_in(session.directory.path());
    for (const fs::path& share : shares)
        ledger.merge(share);
    session.log->info("scan: {} shares taken over", shares.size());
}

/// Runs of beds whose files are gone are made again.
void forget_lost(const Session& session, scan::Ledger& ledger) {
    const auto lost = session.directory.lost().find(to_string(Stage::scan));
    std::set<std::int64_t> ids;
    if (lost != session.directory.lost().end())
        for (const std::string& name : lost->second)
            if (const auto id = bed_of(name))
                ids.insert(*id);
    ledger.forget(std::vector(ids.begin(), ids.end()));
}

void prepare(const Session& session, scan::Ledger& ledger) {
    forget_lost(session, ledger);
    if (session.context.scan.merge)
        merge_shares(session, ledger);
    if (session.context.scan.rerun_failed)
        session.log->info("scan: {} points that failed are evaluated again", ledger.forget_failed());
    if (const std::int64_t done = ledger.points(); done > 0)
        session.log->info("scan: {} points are in the ledger already", done);
}

std::string counts_text(const scan::Counts& counts) {
    std::string text;
    for (const auto& [name, points] : counts.outcomes)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, points);
    return text;
}

void tell_audit(const Session& session, const scan::Summary& summary) {
    if (summary.audit.tried == 0)
        return;
    session.log->info("scan: audit of {} random places outside the boundary: {} missed, at most {:.2g} of "
                      "the area (95 %){}",
                      summary.audit.tried, summary.audit.missed, summary.audit.upper_bound(),
                      summary.found_by_audit > 0
                          ? fmt::format("; {} found before and refined", summary.found_by_audit)
                          : "");
}

/// "coupling.kappa = 3, rods.1.position.0 = 1"
std::string place_text(const std::vector<scan::Axis>& axes, const scan::Point& point) {
    std::string text;
    for (std::size_t k = 0; k < axes.size(); ++k) {
        const auto& words = axes[k].words;
        text += fmt::format("{}{} = {}", k ? ", " : "", axes[k].name,
                            words.empty() ? fmt::format("{:.6g}", point.at[k])
                                          : words[static_cast<std::size_t>(point.at[k])]);
    }
    return text;
}

/// Each cause with how many points have it, and one of them.
void tell_causes(const Session& session, const scan::Ledger& ledger, const scan::Counts& counts) {
    std::vector<scan::Point> ids;
    for (const auto& [cause, id] : counts.examples)
        ids.push_back({id, {}});
    std::map<std::int64_t, scan::Point> examples;
    for (const scan::Result& one : ledger.find(ids))
        examples[one.point.id] = one.point;
    for (const auto& [cause, points] : counts.causes) {
        session.log->warn("scan:   {:>8}  {}", points, cause);
        session.log->warn("scan:   {:>8}  {} at {}", "", points == 1 ? "this was" : "one of them",
                          place_text(ledger.head().axes, examples[counts.examples.at(cause)]));
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
    tell_audit(session, summary);
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

void serve_scan(const Plan& plan, const fs::path& folder, const RunContext& context, scan::MpiJob& job) {
    job.serve(point_evaluator(*plan.scan, folder, context));
}

StageEnd run_scan_stage(Session& session) {
    const auto start = std::chrono::steady_clock::now();
    const ScanPlan& plan = *session.plan.scan;
    scan::Ledger ledger(session.directory.file("ledger.sqlite"), ledger_head(plan));
    prepare(session, ledger);
    Progress progress(session.context, "scan", 0.0, of_beds(plan) ? "runs" : "points");
    scan::RunOptions options;
    options.part = session.context.scan.part;
    options.on_progress = [&](std::int64_t done, std::int64_t total) {
        progress.update(static_cast<double>(done), static_cast<double>(total));
    };
    const scan::Summary summary = scan::run(plan.design, ledger, executor_of(session, plan), options);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    ledger.settle();
    const scan::Counts counts = ledger.counts();
    write_scan(session.directory.path(), plan, *session.plan.scene.scan, ledger, counts, summary,
               took.count(), session.context.thread_count());
    return report(session, ledger, counts, summary);
}

} // namespace rodwake::app
