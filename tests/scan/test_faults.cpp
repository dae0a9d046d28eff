// Points that fail: the others stay as they are, and only they are evaluated again.

#include "lattice_checks.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>

using namespace scan_test;

namespace {

/// The evaluation with faults at 5 % of the points, by their number: an exception, a value that is no number,
/// a limit of time.
Evaluate with_faults(Map map, Tally* tally = nullptr) {
    return [map = std::move(map), tally](std::span<const Point> points, std::span<Result> results) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            results[i] = result_of(map, points[i]);
            if (tally)
                tally->add(points[i].id);
            rodwake::RandomStream random(static_cast<std::uint64_t>(points[i].id), 7);
            if (random.uniform() >= 0.05)
                continue;
            static constexpr Status faults[] = {Status::exception, Status::not_finite, Status::time_limit};
            results[i].status = faults[points[i].id % 3];
            results[i].values[0] = std::nan("");
            results[i].set_cause("injected");
        }
    };
}

} // namespace

TEST_CASE("Faults leave the other points as they are, and only they are evaluated again") {
    const Scratch scratch;
    const Design design = grid(50, 50);
    run_scan(design, scratch / "clean", circle(0.5));
    Counter counter{100};
    run_scan(design, scratch / "l", counter(with_faults(circle(0.5))));
    std::set<std::int64_t> faulty;
    {
        Ledger clean(scratch / "clean", head_of(design)), ledger(scratch / "l", head_of(design));
        std::int64_t alike = 0;
        ledger.for_each([&](const Result& r) {
            if (r.ok())
                alike += text_of(r, 2) == text_of(*clean.find(r.point.id), 2);
            else
                faulty.insert(r.point.id);
        });
        CHECK(alike + static_cast<std::int64_t>(faulty.size()) == 2500);
        const Counts counts = ledger.counts();
        CHECK(counts.failed == static_cast<std::int64_t>(faulty.size()));
        CHECK(counts.causes.size() == 3);
        CHECK(counts.causes.contains("time_limit: injected"));
        // 125 of 2500 with a standard deviation of 11; the stream is fixed
        CHECK(std::abs(static_cast<double>(counts.failed) - 125.0) < 50.0);
        CHECK(ledger.forget_failed() == counts.failed);
    }
    Tally tally;
    const Summary again = run_scan(design, scratch / "l", circle(0.5), &tally);
    CHECK(again.complete);
    CHECK(tally.ids() == faulty);
    CHECK(tally.most() == 1);
    CHECK(rows_of(design, scratch / "l") == rows_of(design, scratch / "clean"));
}

TEST_CASE("Without being forgotten, failed points are not evaluated again") {
    const Scratch scratch;
    Tally tally;
    Counter counter{100};
    run_scan(grid(20, 20), scratch / "l", counter(with_faults(circle(0.5), &tally)));
    run_scan(grid(20, 20), scratch / "l", counter(with_faults(circle(0.5), &tally)));
    CHECK(tally.most() == 1);
}

TEST_CASE("Adaptive scans get over faults; forgotten and run again they are as without") {
    const Scratch scratch;
    Design design = adaptive(2, 16, 128);
    design.audit = 500;
    design.boundary_tolerance = 1e-4;
    run_scan(design, scratch / "clean", circle(0.6));
    Counter counter{100};
    const Summary faulty = run_scan(design, scratch / "l", counter(with_faults(circle(0.6))));
    CHECK(faulty.complete);
    std::set<std::int64_t> failed;
    {
        Ledger ledger(scratch / "l", head_of(design));
        ledger.for_each([&](const Result& r) {
            if (!r.ok())
                failed.insert(r.point.id);
        });
        CHECK(ledger.forget_failed() == static_cast<std::int64_t>(failed.size()));
    }
    Tally tally;
    const Summary again = run_scan(design, scratch / "l", circle(0.6), &tally);
    CHECK(again.complete);
    CHECK(wrong_places(Lattice(design), again.leaves, circle(0.6)) == 0);
    REQUIRE(again.curves.size() == 1); // as brackets that had met a fault are begun again
    Ledger ledger(scratch / "l", head_of(design)), clean(scratch / "clean", head_of(design));
    CHECK(ledger.counts().failed == 0);
    std::set<std::int64_t> edges;
    for (const OutcomeChange& crossing : clean.crossings())
        edges.insert(crossing.id);
    CHECK(again.curves[0].points.size() == edges.size() + 1);
}

TEST_CASE("A full disk ends the scan with the error, and it goes on later") {
    const Scratch scratch;
    long left = 3;
    Counter counter{10};
    const Execute failing = [&](std::span<const Point> points, const Take& take) {
        return counter(evaluate(circle(0.5)))(points, [&](std::span<const Result> results) {
            if (left-- == 0)
                throw rodwake::RunError("disk full");
            take(results);
        });
    };
    CHECK_THROWS_AS(run_scan(grid(10, 10), scratch / "l", failing), rodwake::RunError);
    CHECK(ids_of(grid(10, 10), scratch / "l").size() == 30);
    CHECK(run_scan(grid(10, 10), scratch / "l", circle(0.5)).complete);
    CHECK(ids_of(grid(10, 10), scratch / "l").size() == 100);
}
