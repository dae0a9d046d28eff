// The executor on threads: every point once, whoever evaluates it.

#include "maps.hpp"
#include "rodwake/core/error.hpp"
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
            CHECK(row.find("stopped") == std::string::npos);
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
