// Scans from beginning to end: stopped, taken up, refined further, in shares.

#include "lattice_checks.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

using namespace scan_test;
namespace fs = std::filesystem;

namespace {

/// With audits that find something, and boundaries.
Design busy() {
    Design design = adaptive(2, 16, 128);
    design.audit = 500;
    design.boundary_tolerance = 1e-4;
    return design;
}

Map busy_map() {
    return [](const At& at) {
        return circle(0.05, 0.06, 0.06)(at) == 0 ? 2 : at[0] > 0.8 && at[1] > 0.8 ? -1 : circle(0.6)(at);
    };
}

/// Stopped before chunk `chunks` and taken up, again and again.
int runs_until_complete(const Design& design, const fs::path& file, Evaluate one, long chunks,
                        std::size_t chunk) {
    int runs = 0;
    for (bool complete = false; !complete && runs < 100'000; ++runs) {
        Counter counter{chunk, chunks};
        complete = run_scan(design, file, counter(one)).complete;
    }
    return runs;
}

} // namespace

TEST_CASE("A grid is evaluated whole, and a finished one does nothing") {
    const Scratch scratch;
    Tally tally;
    const Summary summary = run_scan(grid(30, 20), scratch / "l", circle(0.5), &tally);
    CHECK(summary.complete);
    CHECK(summary.requested == 600);
    CHECK(summary.evaluated == 600);
    CHECK(summary.left == 0);
    CHECK(tally.size() == 600);
    const Summary again = run_scan(grid(30, 20), scratch / "l", circle(0.5), &tally);
    CHECK(again.complete);
    CHECK(tally.most() == 1);
}

TEST_CASE("A grid that is stopped after every chunk and taken up is the uninterrupted one") {
    const Scratch scratch;
    run_scan(grid(30, 20), scratch / "whole", circle(0.5));
    for (const long chunks : {1, 3, 10}) {
        Tally tally;
        const fs::path file = scratch / ("l" + std::to_string(chunks));
        CHECK(runs_until_complete(grid(30, 20), file, evaluate(circle(0.5), &tally), chunks, 7) > 1);
        CHECK(rows_of(grid(30, 20), file) == rows_of(grid(30, 20), scratch / "whole"));
        CHECK(tally.most() == 1);
    }
}

TEST_CASE("An adaptive scan that is stopped and taken up asks for the same points") {
    const Scratch scratch;
    const Design design = busy();
    const Summary whole = run_scan(design, scratch / "whole", busy_map());
    REQUIRE(whole.found_by_audit > 0);
    REQUIRE(whole.curves.size() >= 2);
    for (const long chunks : {1, 2, 5, 20}) {
        const fs::path file = scratch / ("l" + std::to_string(chunks));
        CHECK(runs_until_complete(design, file, evaluate(busy_map()), chunks, 311) > 1);
        CHECK(rows_of(design, file) == rows_of(design, scratch / "whole"));
    }
}

TEST_CASE("Stopped scans tell what is left, and progress does not go back") {
    const Scratch scratch;
    Counter counter{7, 10};
    RunOptions options;
    std::int64_t last = 0;
    bool forward = true;
    options.on_progress = [&](std::int64_t done, std::int64_t total) {
        forward = forward && done >= last && total >= done;
        last = done;
    };
    const Summary stopped = run_scan(grid(30, 20), scratch / "l", counter(evaluate(circle(0.5))), options);
    CHECK_FALSE(stopped.complete);
    CHECK(stopped.evaluated == 70);
    CHECK(stopped.left == 530);
    CHECK(stopped.leaves.empty());
    CHECK(last == 70);
    for (const long chunks : {1, 5, 20}) {
        last = 0;
        Counter few{97, chunks};
        const Summary some =
            run_scan(busy(), scratch / std::to_string(chunks), few(evaluate(busy_map())), options);
        CHECK_FALSE(some.complete);
        CHECK(some.left > 0);
    }
    last = 0;
    Counter rest{97};
    CHECK(run_scan(busy(), scratch / "5", rest(evaluate(busy_map())), options).left == 0);
    CHECK(forward);
}

TEST_CASE("Four threads make the ledger of one", "[threads]") {
    const Scratch scratch;
    for (const Design& design : {busy(), grid(40, 40)}) {
        const std::string name = to_string(design.kind);
        const Summary one =
            run_scan(design, scratch / (name + "1"), on_threads(evaluate(busy_map()), 1, nullptr));
        const Summary four =
            run_scan(design, scratch / (name + "4"), on_threads(evaluate(busy_map()), 4, nullptr));
        CHECK(rows_of(design, scratch / (name + "1")) == rows_of(design, scratch / (name + "4")));
        CHECK(one.curves.size() == four.curves.size());
    }
}

TEST_CASE("Rows of ledgers that differ in a bit differ") {
    const Scratch scratch;
    run_scan(grid(3, 3), scratch / "a", circle(0.5));
    run_scan(grid(3, 3), scratch / "b", circle(0.5));
    CHECK(rows_of(grid(3, 3), scratch / "a") == rows_of(grid(3, 3), scratch / "b"));
    {
        Ledger ledger(scratch / "b", head_of(grid(3, 3)));
        Result one = *ledger.find(4);
        one.values[0] = std::nextafter(one.values[0], 9.0);
        ledger.add(std::vector{one});
    }
    CHECK(rows_of(grid(3, 3), scratch / "a") != rows_of(grid(3, 3), scratch / "b"));
    Ledger(scratch / "a", head_of(grid(3, 3))).add(std::vector<OutcomeChange>{{1, 0, 1, 0.0, 1.0}});
    CHECK(rows_of(grid(3, 3), scratch / "a").size() == 10);
}

TEST_CASE("A raised resolution goes on with the points it has") {
    const Scratch scratch;
    Design design = busy();
    Tally tally;
    run_scan(design, scratch / "l", busy_map(), &tally);
    const std::size_t before = ids_of(design, scratch / "l").size();
    design.resolution = 512;
    const Summary raised = run_scan(design, scratch / "l", busy_map(), &tally);
    CHECK(raised.complete);
    const auto ids = ids_of(design, scratch / "l");
    CHECK(ids.size() > before);
    CHECK(wrong_places(Lattice(design), raised.leaves, busy_map()) == 0);
    Design bare = design; // without the audit, whose places follow from the cells
    bare.audit = 0;
    Tally anew;
    bare.boundary_tolerance = 0.0;
    run_scan(bare, scratch / "anew", busy_map(), &anew);
    CHECK(std::ranges::includes(ids, anew.ids()));
}

TEST_CASE("No point is evaluated twice as the resolution is raised step by step") {
    const Scratch scratch;
    Design design = adaptive(2, 16, 32);
    Tally tally;
    for (; design.resolution <= 512; design.resolution *= 2)
        run_scan(design, scratch / "l", circle(0.6), &tally);
    CHECK(tally.most() == 1);
    design.resolution = 512;
    Tally anew;
    const Summary whole = run_scan(design, scratch / "anew", circle(0.6), &anew);
    CHECK(tally.ids() == anew.ids());
    CHECK(run_scan(design, scratch / "l", circle(0.6), &tally).leaves.size() == whole.leaves.size());
    CHECK(tally.most() == 1);
}

TEST_CASE("A finer tolerance goes on with the brackets it has") {
    const Scratch scratch;
    Design design = adaptive(2, 16, 64);
    design.boundary_tolerance = 1e-4;
    run_scan(design, scratch / "l", circle(0.6));
    design.boundary_tolerance = 1e-6;
    Tally more, anew;
    const Summary finer = run_scan(design, scratch / "l", circle(0.6), &more);
    const Summary whole = run_scan(design, scratch / "anew", circle(0.6), &anew);
    REQUIRE(finer.curves.size() == 1);
    REQUIRE(finer.curves[0].points.size() == whole.curves[0].points.size());
    for (std::size_t i = 0; i < whole.curves[0].points.size(); ++i) {
        CHECK(finer.curves[0].points[i].at == whole.curves[0].points[i].at);
        CHECK(finer.curves[0].points[i].error == whole.curves[0].points[i].error);
    }
    CHECK(rows_of(design, scratch / "l") == rows_of(design, scratch / "anew"));
    CHECK(more.size() < anew.size());
}

TEST_CASE("More samples begin with those that are there") {
    const Scratch scratch;
    Design design = grid(2, 2);
    design.kind = Kind::sobol;
    design.samples = 100;
    Tally tally;
    run_scan(design, scratch / "l", circle(0.5), &tally);
    design.samples = 250;
    run_scan(design, scratch / "l", circle(0.5), &tally);
    CHECK(tally.size() == 250);
    CHECK(tally.most() == 1);
}

TEST_CASE("Shares merged are the whole, and each is computed once") {
    const Scratch scratch;
    const Design design = grid(23, 17);
    run_scan(design, scratch / "whole", circle(0.5));
    Tally tally;
    Ledger merged(scratch / "merged", head_of(design));
    for (const std::int64_t i : {2, 0, 3, 1}) {
        Counter counter{13};
        RunOptions options;
        options.part = {i, 4};
        const fs::path file = scratch / ("part" + std::to_string(i));
        const Summary share = run_scan(design, file, counter(evaluate(circle(0.5), &tally)), options);
        CHECK(share.complete);
        CHECK(share.requested == 391);
        CHECK(share.evaluated == (i < 3 ? 98 : 97));
        merged.merge(file);
    }
    CHECK(tally.size() == 391);
    CHECK(tally.most() == 1);
    CHECK(rows_of(design, scratch / "merged") == rows_of(design, scratch / "whole"));
}

TEST_CASE("Of more shares than points some are empty") {
    const Scratch scratch;
    Counter counter{13};
    RunOptions options;
    options.part = {7, 10};
    const Summary share = run_scan(grid(2, 2), scratch / "l", counter(evaluate(circle(0.5))), options);
    CHECK(share.complete);
    CHECK(share.evaluated == 0);
    CHECK(share.left == 0);
}

TEST_CASE("An adaptive scan has no shares") {
    const Scratch scratch;
    Counter counter{13};
    RunOptions options;
    options.part = {0, 2};
    CHECK_THROWS_AS(run_scan(adaptive(2, 4, 8), scratch / "l", counter(evaluate(circle(0.5))), options),
                    rodwake::InputError);
}
