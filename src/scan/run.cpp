#include "rodwake/scan/run.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "work_queue.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace rodwake::scan {

namespace {

/// Points handed out at once: what bounds the memory of a scan of any size.
constexpr std::size_t slab = 1 << 16;

/// Evaluates points and counts them.
class ChunkEvaluation {
public:
    using Learn = std::function<void(const Result&)>;

    ChunkEvaluation(Ledger& ledger, const Execute& execute, const RunOptions& options)
        : ledger_(ledger), execute_(execute), options_(options) {}

    bool operator()(std::span<const Point> points, const Learn& learn) {
        const auto count = [&](const Result& result) { ++done, learn(result); };
        return evaluate_missing(ledger_, execute_, points, count, [&] { report(); });
    }

    /// The same where the total grows by these points.
    bool complete(std::span<const Point> points, const Learn& learn, Summary& summary) {
        total = done + static_cast<std::int64_t>(points.size());
        const bool finished = (*this)(points, learn);
        summary.left = total - done;
        return finished;
    }

    void report() const {
        if (options_.on_progress)
            options_.on_progress(done, std::max(done, total));
    }

    std::int64_t done = 0, total = 0;

private:
    Ledger& ledger_;
    const Execute& execute_;
    const RunOptions& options_;
};

void run_list(const Design& design, Ledger& ledger, ChunkEvaluation& evaluate, Part part, Summary& summary) {
    const PointList points(design);
    // The ledger holds some points of the list already.
    std::vector<bool> there(static_cast<std::size_t>(points.size()), false);
    ledger.for_each_id([&](std::int64_t id) {
        if (const auto number = points.number_of(id))
            there[static_cast<std::size_t>(*number)] = true;
    });
    std::vector<Point> next;
    for (std::int64_t i = part.index; i < points.size(); i += part.of) {
        ++evaluate.total;
        evaluate.done += there[static_cast<std::size_t>(i)];
    }
    summary.complete = true;
    const auto flush = [&] {
        summary.complete = summary.complete && evaluate(next, [](const Result&) {});
        next.clear();
    };
    for (std::int64_t i = part.index; i < points.size() && summary.complete; i += part.of) {
        if (!there[static_cast<std::size_t>(i)])
            next.push_back(points[i]);
        if (next.size() == slab)
            flush();
    }
    if (summary.complete && !next.empty())
        flush();
    summary.left = evaluate.total - evaluate.done;
}

/// Asks for points until the refinement is complete; false: stopped. Only what was asked for is learnt, in
/// rounds, so that a scan that is taken up asks for the same points again.
bool refine(Refinement& refinement, ChunkEvaluation& evaluate, Summary& summary) {
    for (auto points = refinement.next(); !points.empty(); points = refinement.next())
        if (!evaluate.complete(
                points, [&](const Result& result) { refinement.learn(result); }, summary))
            return false;
    return true;
}

/// One round: places that were tried are known afterwards, and those that were missed are refined.
bool audit(Refinement& refinement, const Design& design, ChunkEvaluation& evaluate, Summary& summary) {
    const std::vector<Point> points =
        audit_points(refinement, design, static_cast<std::uint32_t>(summary.audit_rounds++));
    std::vector<Result> results;
    if (!evaluate.complete(
            points, [&](const Result& result) { results.push_back(result); }, summary))
        return false;
    std::ranges::sort(results, {}, [](const Result& r) { return r.point.id; });
    summary.audit = {static_cast<std::int64_t>(results.size()), 0};
    std::vector<Lattice::LatticePoint> missed;
    for (const Result& result : results) {
        if (is_missed(refinement, result))
            missed.push_back(refinement.lattice().place(result.point.id));
        refinement.learn(result);
    }
    summary.audit.missed = static_cast<std::int64_t>(missed.size());
    summary.found_by_audit += summary.audit.missed;
    for (const Lattice::LatticePoint& position : missed)
        refinement.divide_at(position);
    return true;
}

bool trace(const Refinement& refinement, const Design& design, Ledger& ledger, const Execute& execute,
           ChunkEvaluation& evaluate, Summary& summary) {
    std::vector<OutcomeChange> edges = crossed_edges(refinement);
    // Brackets of the ledger that belong to these edges replace those one edge long.
    for (const OutcomeChange& known : ledger.crossings()) {
        const auto at = std::ranges::lower_bound(edges, known.id, {}, &OutcomeChange::id);
        const bool narrower =
            at != edges.end() && at->id == known.id && known.u_low >= at->u_low && known.u_high <= at->u_high;
        if (narrower)
            *at = known;
    }
    for (const OutcomeChange& edge : edges) // halvings that are left
        evaluate.total += static_cast<std::int64_t>(
            std::ceil(std::log2(std::max((edge.u_high - edge.u_low) / design.boundary_tolerance, 1.0))));
    const auto at = [&](std::int64_t id) {
        return std::ranges::lower_bound(edges, id, {}, &OutcomeChange::id);
    };
    for (bool going = true; going;) {
        std::vector<Point> middles;
        for (const OutcomeChange& edge : edges)
            if (edge.u_high - edge.u_low > design.boundary_tolerance)
                middles.push_back(middle(refinement, edge));
        going = !middles.empty();
        const bool finished = execute(middles, [&](std::span<const Result> results) {
            std::vector<OutcomeChange> changed;
            for (const Result& result : results) {
                bisect(*at(result.point.id), result);
                changed.push_back(*at(result.point.id));
            }
            ledger.add(changed);
            evaluate.done += static_cast<std::int64_t>(results.size());
            evaluate.report();
        });
        if (!finished) {
            summary.left = static_cast<std::int64_t>(middles.size());
            return false;
        }
    }
    summary.curves = boundary_curves(refinement, edges);
    const std::vector<OutcomeChange> whole = crossed_edges(refinement);
    double halvings = 0.0; // a point each
    for (std::size_t i = 0; i < whole.size(); ++i)
        halvings +=
            std::round(std::log2((whole[i].u_high - whole[i].u_low) / (edges[i].u_high - edges[i].u_low)));
    summary.traced = static_cast<std::int64_t>(halvings);
    summary.lost_crossings = std::ranges::count_if(
        edges, [](const OutcomeChange& edge) { return edge.outcome_low < 0 || edge.outcome_high < 0; });
    return true;
}

} // namespace

bool evaluate_missing(Ledger& ledger, const Execute& execute, std::span<const Point> points,
                      const std::function<void(const Result&)>& learn, const std::function<void()>& report) {
    std::unordered_set<std::int64_t> known;
    for (const Result& result : ledger.find(points)) {
        learn(result);
        known.insert(result.point.id);
    }
    std::vector<Point> missing;
    std::ranges::copy_if(points, std::back_inserter(missing),
                         [&](const Point& point) { return !known.contains(point.id); });
    return execute(missing, [&](std::span<const Result> results) {
        ledger.add(results);
        std::ranges::for_each(results, learn);
        report();
    });
}

void require_part(const Design& design, Part part) {
    if (design.kind == Kind::adaptive && part.of > 1)
        throw InputError("an adaptive scan cannot be computed in parts: where its points lie depends on all "
                         "results; run it with mpiexec, or take design = \"grid\"");
}

Summary run(const Design& design, Ledger& ledger, const Execute& execute, const RunOptions& options) {
    require_part(design, options.part);
    Summary summary;
    summary.requested = size(design);
    ChunkEvaluation evaluate(ledger, execute, options);
    if (design.kind != Kind::adaptive)
        run_list(design, ledger, evaluate, options.part, summary);
    else {
        Refinement refinement(design);
        constexpr int most_rounds = 8;
        bool going = refine(refinement, evaluate, summary);
        while (going && design.audit > 0 && summary.audit_rounds < most_rounds) {
            going = audit(refinement, design, evaluate, summary) && refine(refinement, evaluate, summary);
            if (summary.audit.missed == 0)
                break;
        }
        if (going && design.boundary_tolerance > 0.0)
            going = trace(refinement, design, ledger, execute, evaluate, summary);
        summary.complete = going;
        if (going)
            summary.leaves = refinement.leaves();
    }
    summary.evaluated = ledger.points();
    return summary;
}

void work(WorkQueue& queue, const Evaluate& evaluate) {
    std::vector<Result> results;
    for (auto points = queue.next(); !points.empty(); points = queue.next()) {
        results.assign(points.size(), {});
        try {
            evaluate(points, results);
        } catch (...) {
            queue.stop(); // nobody need go on
            throw;
        }
        queue.take(results);
    }
}

Execute on_threads(Evaluate evaluate, std::size_t threads, std::function<bool()> stop) {
    return [evaluate = std::move(evaluate), threads, stop = std::move(stop)](std::span<const Point> points,
                                                                             const Take& take) {
        WorkQueue queue(points, take, threads, stop);
        parallel_for(threads, threads, [&](std::size_t) { work(queue, evaluate); });
        return !queue.stopped();
    };
}

} // namespace rodwake::scan
