// The executor on threads: every point once, whoever evaluates it.

#include "maps.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/scan/proportion.hpp"
#include "scan/work_queue.hpp"

#include <catch2/catch.hpp>

#include <thread>

using namespace scan_test;

namespace {

std::vector<Point> points_of(const Design& design) {
    const PointList list(design);
    std::vector<Point> points;
    for (std::int64_t id = 0; id < list.size(); ++id)
        points.push_back(list[id]);
    return points;
}

/// Results by number, and whether the executor came to the end.
struct Taken {
    std::map<std::int64_t, std::string> rows;
    std::size_t results = 0;
    bool complete = false;
};

Taken taken(const Execute& execute, const std::vector<Point>& points) {
    Taken all;
    all.complete = execute(points, [&](std::span<const Result> results) {
        for (const Result& r : results) {
            all.rows[r.point.id] = text_of(r, 2);
            ++all.results;
        }
    });
    return all;
}

} // namespace

TEST_CASE("All points are evaluated once, to the same results, by any number of threads", "[threads]") {
    const auto points = points_of(grid(37, 29));
    Tally one;
    const Taken alone = taken(on_threads(evaluate(circle(0.5), &one), 1, nullptr), points);
    CHECK(alone.complete);
    CHECK(alone.rows.size() == points.size());
    for (const std::size_t threads : {2, 4, 13}) {
        Tally tally;
        const Taken many = taken(on_threads(evaluate(circle(0.5), &tally), threads, nullptr), points);
        CHECK(many.complete);
        CHECK(many.results == points.size());
        CHECK(many.rows == alone.rows);
        CHECK(tally.size() == points.size());
        CHECK(tally.most() == 1);
    }
}

TEST_CASE("More threads than points, and no points", "[threads]") {
    const auto points = points_of(grid(2, 1));
    CHECK(taken(on_threads(evaluate(circle(0.5)), 8, nullptr), points).rows.size() == 2);
    CHECK(taken(on_threads(evaluate(circle(0.5)), 8, nullptr), {}).complete);
    CHECK(taken(on_threads(evaluate(circle(0.5)), 2, [] { return true; }), {}).complete);
}

TEST_CASE("A stop is heard between chunks; what was evaluated until then is kept", "[threads]") {
    const auto points = points_of(grid(40, 40));
    for (const std::size_t threads : {1, 4}) {
        Tally tally;
        std::atomic<int> asked = 0;
        const auto stop = [&] { return ++asked > 5; };
        const Taken some = taken(on_threads(evaluate(circle(0.5), &tally), threads, stop), points);
        CHECK_FALSE(some.complete);
        CHECK(some.rows.size() < points.size());
        CHECK(some.rows.size() == tally.size());
        CHECK(some.results == some.rows.size());
    }
    CHECK(taken(on_threads(evaluate(circle(0.5)), 2, [] { return true; }), points).rows.empty());
}

TEST_CASE("A stop after the last point changes nothing", "[threads]") {
    const auto points = points_of(grid(3, 3));
    std::atomic<std::size_t> evaluated = 0;
    const Evaluate one = [&](std::span<const Point> some, std::span<Result> results) {
        evaluate(circle(0.5))(some, results);
        evaluated += some.size();
    };
    const Taken all = taken(on_threads(one, 1, [&] { return evaluated == points.size(); }), points);
    CHECK(all.complete);
    CHECK(all.rows.size() == points.size());
}

TEST_CASE("Points that were stopped in the middle are as if they had not been begun", "[threads]") {
    const auto points = points_of(grid(20, 20));
    std::atomic<bool> stopping = false;
    const Evaluate one = [&](std::span<const Point> some, std::span<Result> results) {
        for (std::size_t i = 0; i < some.size(); ++i) {
            results[i] = result_of(circle(0.5), some[i]);
            if (some[i].id >= 100)
                stopping = true;
            if (stopping)
                results[i].status = Status::stopped;
        }
    };
    for (const std::size_t threads : {1, 3}) {
        stopping = false;
        const Taken some = taken(on_threads(one, threads, nullptr), points);
        CHECK_FALSE(some.complete);
        CHECK(some.rows.size() <= 100);
        for (const auto& [id, row] : some.rows)
            CHECK_THAT(row, !Catch::Contains("stopped"));
    }
}

TEST_CASE("Results are taken by one thread at a time", "[threads]") {
    const auto points = points_of(grid(50, 50));
    std::atomic<int> inside = 0, most = 0;
    on_threads(evaluate(circle(0.5)), 4, nullptr)(points, [&](std::span<const Result>) {
        most = std::max<int>(most, ++inside);
        std::this_thread::yield();
        --inside;
    });
    CHECK(most == 1);
}

TEST_CASE("If results cannot be taken, the error comes out and nobody goes on", "[threads]") {
    const auto points = points_of(grid(100, 100));
    for (const std::size_t threads : {1, 4}) {
        Tally tally;
        std::atomic<int> calls = 0;
        const Take full = [&](std::span<const Result>) {
            ++calls;
            throw rodwake::RunError("disk full");
        };
        CHECK_THROWS_AS(on_threads(evaluate(circle(0.5), &tally), threads, nullptr)(points, full),
                        rodwake::RunError);
        CHECK(calls <= static_cast<int>(threads)); // chunks that were out already
        CHECK(tally.size() < points.size());
    }
}

TEST_CASE("Chunks follow the cost of points, and leave work for all at the end", "[threads]") {
    ChunkSize size(4);
    CHECK(size.next(1000) == 1); // nothing is known
    size.learn(1, 1e-3);
    CHECK(size.next(1000) == 10); // 10 ms
    CHECK(size.next(40) == 5);    // two rounds for each of four
    CHECK(size.next(3) == 1);
    ChunkSize fast(1);
    fast.learn(1, 0.0);
    CHECK(fast.next(1'000'000) == 4096);
    CHECK(fast.next(1) == 1);
    ChunkSize slow(2);
    slow.learn(1, 100.0);
    CHECK(slow.next(1000) == 1);
}

// --- Points that are evaluated in several runs: ids, order, how many go on with how many, and their means

namespace {

Design repeated(long runs, std::vector<double> costs = {}) {
    Design design = grid(3, 2);
    design.runs = runs;
    design.costs = std::move(costs);
    return design;
}

std::vector<std::int64_t> ids(const Design& design) {
    const PointList points(design);
    std::vector<std::int64_t> found;
    for (std::int64_t i = 0; i < points.size(); ++i)
        found.push_back(points[i].id);
    return found;
}

std::string numbers_that_do_not_return(const Design& design) {
    const PointList points(design);
    std::string wrong;
    for (std::int64_t i = 0; i < points.size(); ++i)
        if (points.number_of(points[i].id) != i)
            wrong += std::to_string(i) + " ";
    return wrong;
}

/// Outcome by the run alone; the third run of every place fails.
Evaluate by_run(Tally* tally = nullptr) {
    return [tally](std::span<const Point> points, std::span<Result> results) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::int64_t run = run_of(points[i].id);
            results[i] = result_of([&](const At&) { return run == 2 ? -1 : run < 2 ? 0 : 1; }, points[i]);
            results[i].values[0] = static_cast<double>(run);
            if (tally)
                tally->add(points[i].id);
        }
    };
}

Summary run_runs(const Design& design, const std::filesystem::path& file, const Evaluate& one, Part part = {},
                 std::size_t threads = 1) {
    return run_scan(design, file, on_threads(one, threads, nullptr), {part, nullptr});
}

Result finished(std::int64_t id, int outcome, double sum, double product) {
    Result result;
    result.point = {id, {0.25, 0.5}};
    result.outcome = outcome;
    result.values[0] = sum;
    result.values[1] = product;
    return result;
}

} // namespace

TEST_CASE("The id of a run does not depend on how many runs there are") {
    CHECK(id_of_run(0, 3) == 3);
    CHECK(place_of_run(id_of_run(7, max_runs - 1)) == 7);
    CHECK(run_of(id_of_run(7, max_runs - 1)) == max_runs - 1);
    for (const std::int64_t id : ids(repeated(2)))
        CHECK(PointList(repeated(5)).number_of(id));
}

TEST_CASE("Every place of a design comes with every run once, with its values") {
    const Design design = repeated(4), single = grid(3, 2);
    CHECK(places(design) == 6);
    CHECK(size(design) == 24);
    const PointList points(design), once(single);
    std::set<std::int64_t> all;
    for (std::int64_t i = 0; i < points.size(); ++i) {
        const Point point = points[i];
        all.insert(point.id);
        CHECK(point.at == once[place_of_run(point.id)].at);
    }
    CHECK(all.size() == 24);
    CHECK_FALSE(points.number_of(id_of_run(0, 4)));
    CHECK_FALSE(points.number_of(id_of_run(6, 0)));
    CHECK_FALSE(points.number_of(-1));
    CHECK_FALSE(once.number_of(6));
}

TEST_CASE("Dear places come first, those of one cost in their order") {
    CHECK(ids(repeated(1, {1.0, 5.0, 1.0, 3.0, 5.0, 0.0})) ==
          std::vector<std::int64_t>{id_of_run(1, 0), id_of_run(4, 0), id_of_run(3, 0), id_of_run(0, 0),
                                    id_of_run(2, 0), id_of_run(5, 0)});
    for (const Design& design :
         {repeated(1), repeated(3), repeated(3, {1.0, 5.0, 1.0, 3.0, 5.0, 0.0}), grid(4, 5)})
        CHECK(numbers_that_do_not_return(design).empty());
}

TEST_CASE("Runs that cannot be counted are refused") {
    Design design = repeated(max_runs);
    design.axes[0].count = design.axes[1].count = 3'000'000;
    CHECK_THROWS_AS(size(design), rodwake::InputError);
}

TEST_CASE("More runs go on with those that are known, on any number of threads", "[threads]") {
    const Scratch scratch;
    Tally tally;
    CHECK(run_runs(repeated(2), scratch / "l", by_run(&tally)).complete);
    const Summary more =
        run_runs(repeated(5, {0.0, 2.0, 1.0, 0.0, 0.0, 0.0}), scratch / "l", by_run(&tally), {}, 3);
    CHECK(more.complete);
    CHECK(more.requested == 30);
    CHECK(more.evaluated == 30);
    CHECK(tally.size() == 30);
    CHECK(tally.most() == 1);
}

TEST_CASE("Shares of repeated points are all points together") {
    const Scratch scratch;
    Tally tally;
    for (const std::int64_t i : {0, 1, 2})
        CHECK(run_runs(repeated(4), scratch / ("l" + std::to_string(i)), by_run(&tally), {i, 3}).complete);
    CHECK(tally.size() == 24);
    CHECK(tally.most() == 1);
}

TEST_CASE("The mean of runs leaves out what failed and what has no number") {
    std::vector<Result> runs = {finished(id_of_run(4, 0), 1, 1.0, std::nan("")),
                                finished(id_of_run(4, 1), 0, 2.0, 7.0),
                                finished(id_of_run(4, 2), 1, 6.0, 9.0)};
    Result gone = finished(id_of_run(4, 3), 0, 1000.0, 1000.0);
    gone.status = Status::failed;
    runs.push_back(gone);
    const PointMean mean = mean_of_runs(runs, columns);
    CHECK(mean.point.id == 4);
    CHECK(mean.point.at[1] == 0.5);
    CHECK(mean.runs == 3);
    CHECK(mean.failed == 1);
    CHECK(mean.status == Status::ok);
    CHECK(mean.outcome == 1);
    CHECK(mean.outcomes[0].count == 1);
    CHECK(mean.outcomes[1].value() == Approx(2.0 / 3.0));
    CHECK(mean.values[0].value == Approx(3.0));
    CHECK(mean.values[0].error == Approx(std::sqrt(7.0 / 3.0))); // s^2 = 7 of 1, 2, 6
    CHECK(mean.values[1].value == Approx(8.0));
    CHECK(mean.values[1].error == Approx(1.0));
    CHECK(mean.values[1].count == 2);
}

TEST_CASE("Of one run the error is unknown, of none there is no number") {
    const Result one = finished(id_of_run(2, 0), 2, 4.0, std::nan(""));
    const PointMean single = mean_of_runs(std::span(&one, 1), columns);
    CHECK(single.values[0].value == 4.0);
    CHECK(std::isnan(single.values[0].error));
    CHECK(std::isnan(single.values[1].value));
    Result gone = one;
    gone.status = Status::time_limit;
    const PointMean none = mean_of_runs(std::span(&gone, 1), columns);
    CHECK(none.status == Status::time_limit);
    CHECK(none.outcome == -1);
    CHECK(std::isnan(none.values[0].value));
    CHECK(std::isnan(none.outcomes[0].value()));
    CHECK_THROWS_AS(mean_of_runs({}, columns), rodwake::InputError);
}

TEST_CASE("Means of a ledger are those of its places, in order") {
    const Scratch scratch;
    run_runs(repeated(4, {0.0, 1.0, 2.0, 3.0, 4.0, 5.0}), scratch / "l", by_run());
    const Ledger ledger(scratch / "l", head_of(repeated(4)));
    const std::vector<PointMean> means = means_of(ledger);
    REQUIRE(means.size() == 6);
    for (std::size_t k = 0; k < 6; ++k) {
        CHECK(means[k].point.id == static_cast<std::int64_t>(k));
        CHECK(means[k].runs == 3);
        CHECK(means[k].failed == 1);
        CHECK(means[k].outcome == 0);
        CHECK(means[k].values[0].value == Approx(4.0 / 3.0)); // of runs 0, 1, 3
    }
}

TEST_CASE("Intervals of proportions are those of Clopper and Pearson") {
    // closed forms: none of n has (1 - high)^n = tail, all of n low^n = tail; 5 of 10 by their table
    CHECK(Proportion{0, 10}.low(0.025) == 0.0);
    CHECK(Proportion{0, 10}.high(0.025) == Approx(1.0 - std::pow(0.025, 0.1)));
    CHECK(Proportion{10, 10}.low(0.025) == Approx(std::pow(0.025, 0.1)));
    CHECK(Proportion{10, 10}.high(0.025) == 1.0);
    CHECK(Proportion{5, 10}.low(0.025) == Approx(0.1871).margin(5e-5));
    // Wilson's interval is where (p - count/of)^2 = z^2 p (1 - p)/of.
    const auto [low, high] = Proportion{3, 10}.wilson(1.96);
    for (const double p : {low, high})
        CHECK((p - 0.3) * (p - 0.3) == Approx(1.96 * 1.96 * p * (1.0 - p) / 10.0));
    CHECK(low < 0.3);
    CHECK(high > 0.3);
    CHECK(Proportion{0, 10}.wilson(1.96).first == 0.0);
    CHECK(Proportion{10, 10}.wilson(1.96).second == 1.0);
    CHECK(Proportion{0, 0}.wilson(1.96) == std::pair{0.0, 1.0});
    CHECK(Proportion{5, 10}.high(0.025) == Approx(0.8129).margin(5e-5));
    CHECK(Proportion{0, 0}.low(0.025) == 0.0);
    CHECK(Proportion{0, 0}.high(0.025) == 1.0);
}
