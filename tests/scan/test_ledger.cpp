// The ledger: what goes in comes out.

#include "ledger_rows.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

using namespace scan_test;
using rodwake::InputError;
using store_test::error_of;
using store_test::has;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> texts(const Ledger& ledger) {
    std::vector<std::string> rows;
    ledger.for_each([&](const Result& r) { rows.push_back(text_of(r, ledger.head().axes.size())); });
    return rows;
}

} // namespace

TEST_CASE("Rows come back to the bit, in the order of the points") {
    const Scratch scratch;
    std::vector<Result> results = {succeeded(std::int64_t{1} << 61, 1e-320, 2.0),
                                   succeeded(7, std::nextafter(0.1, 1.0), 1.0), succeeded(0, -1.0)};
    results[0].values = {std::numeric_limits<double>::quiet_NaN(), 1e308};
    results[1].retries = 2;
    results[1].set_cause("retried: it's \"slow\"");
    {
        Ledger ledger(scratch / "l", ledger_head());
        ledger.add(results);
    }
    const Ledger ledger(scratch / "l", ledger_head());
    std::ranges::sort(results, {}, [](const Result& r) { return r.point.id; });
    std::vector<std::string> expected;
    for (const Result& r : results)
        expected.push_back(text_of(r, 2));
    CHECK(texts(ledger) == expected);
    REQUIRE(ledger.find(7));
    CHECK(text_of(*ledger.find(7), 2) == expected[1]);
    CHECK(ledger.find(7)->seconds == 1e-4);
    CHECK_FALSE(ledger.find(8));
    std::vector<std::int64_t> ids;
    ledger.for_each_id([&](std::int64_t id) { ids.push_back(id); });
    CHECK(ids == std::vector<std::int64_t>{0, 7, std::int64_t{1} << 61});
}

TEST_CASE("The text of a row tells every bit") {
    const Result one = succeeded(1, 0.1);
    const auto differs = [&](const auto& change) {
        Result other = one;
        change(other);
        return text_of(other, 2) != text_of(one, 2);
    };
    CHECK_FALSE(differs([](Result& r) { r.seconds = 9.0; }));
    CHECK(differs([](Result& r) { r.point.id = 2; }));
    CHECK(differs([](Result& r) { r.point.at[0] = std::nextafter(0.1, 1.0); }));
    CHECK(differs([](Result& r) { r.point.at[1] = 1.0; }));
    CHECK(differs([](Result& r) { r.outcome = 0; }));
    CHECK(differs([](Result& r) { r.values[1] = -0.0; }));
    CHECK(differs([](Result& r) { r.retries = 1; }));
    CHECK(differs([](Result& r) { r.set_cause("x"); }));
    CHECK(differs([](Result& r) { r.status = Status::failed; }));
}

TEST_CASE("Every status comes back, and values of failures do not count") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    for (const Status status : {Status::failed, Status::time_limit, Status::not_finite, Status::exception}) {
        ledger.add(std::vector{failed(static_cast<std::int64_t>(status), status)});
        const auto found = ledger.find(static_cast<std::int64_t>(status));
        REQUIRE(found);
        CHECK(found->status == status);
        CHECK(found->outcome == -1);
        CHECK(found->retries == 3);
        CHECK(found->cause_text() == "too many steps");
        CHECK(std::isnan(found->values[0]));
    }
}

TEST_CASE("A point that succeeded without an outcome stays so") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    Result none = succeeded(1, 0.1);
    none.outcome = -1;
    ledger.add(std::vector{none});
    CHECK(ledger.find(1)->ok());
    CHECK(ledger.find(1)->outcome == -1);
    CHECK(ledger.counts().outcomes == std::map<std::string, std::int64_t>{{"", 1}});
}

TEST_CASE("A point that is added again replaces its row") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    ledger.add(std::vector{failed(3), succeeded(4, 0.2)});
    ledger.add(std::vector{succeeded(3, 0.5)});
    CHECK(ledger.counts().points == 2);
    CHECK(ledger.find(3)->ok());
}

TEST_CASE("Counts are by outcome, and by cause of failure") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    Result inside = succeeded(1, 0.1);
    inside.outcome = 0;
    inside.set_cause("retried"); // no failure
    ledger.add(std::vector{inside, succeeded(2, 0.2), succeeded(3, 0.3), failed(4), failed(5),
                           failed(6, Status::exception, "")});
    const Counts counts = ledger.counts();
    CHECK(counts.points == 6);
    CHECK(counts.failed == 3);
    CHECK(counts.outcomes == std::map<std::string, std::int64_t>{{"in", 1}, {"out", 2}});
    CHECK(counts.causes ==
          std::map<std::string, std::int64_t>{{"failed: too many steps", 2}, {"exception", 1}});
    CHECK(counts.seconds == Approx(6e-4)); // six summands
    ledger.sync();
    CHECK(counts_of(scratch / "l").points == 6);
}

TEST_CASE("Chunks that overlap come out in the order of the points") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    std::vector<std::int64_t> expected;
    for (std::int64_t chunk = 0; chunk < 7; ++chunk) { // ids 0 to 69, dealt out; each seventh failed
        std::vector<Result> results;
        for (std::int64_t id = chunk; id < 70; id += 7)
            results.push_back(id % 7 == 3 ? failed(id) : succeeded(id, 0.01 * static_cast<double>(id)));
        ledger.add(results);
    }
    std::int64_t next = 0;
    ledger.for_each([&](const Result& r) {
        CHECK(r.point.id == next++);
        CHECK(r.ok() == (r.point.id % 7 != 3));
    });
    CHECK(next == 70);
    CHECK(ledger.points() == 70);
}

TEST_CASE("A point that succeeded is replaced within its chunk, and the others stay") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    ledger.add(std::vector{succeeded(1, 0.1), succeeded(2, 0.2), succeeded(3, 0.3)});
    Result other = succeeded(2, 0.2);
    other.values[0] = 7.0;
    other.outcome = 0;
    ledger.add(std::vector{other, failed(3)});
    CHECK(ledger.points() == 3);
    CHECK(ledger.find(1)->values[0] == 0.1);
    CHECK(ledger.find(2)->values[0] == 7.0);
    CHECK_FALSE(ledger.find(3)->ok());
    CHECK(ledger.counts().outcomes == std::map<std::string, std::int64_t>{{"in", 1}, {"out", 1}});
    CHECK(ledger.counts().failed == 1);
}

TEST_CASE("Of a point that is added twice at once the last counts") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    ledger.add(std::vector{succeeded(2, 0.2), succeeded(1, 0.1), succeeded(2, 0.25)});
    CHECK(ledger.counts().points == 2);
    CHECK(ledger.find(2)->point.at[0] == 0.25);
}

TEST_CASE("Points are found together, in their order") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    ledger.add(std::vector{succeeded(5, 0.5), failed(9), succeeded(1, 0.1)});
    const auto found = ledger.find(std::vector<Point>{{9, {}}, {2, {}}, {1, {}}});
    REQUIRE(found.size() == 2);
    CHECK(found[0].point.id == 1);
    CHECK(found[1].point.id == 9);
    CHECK(ledger.find(std::vector<Point>{{2, {}}}).empty());
}

TEST_CASE("Crossings come back to the bit, in order, the newest") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    ledger.add(std::vector<OutcomeChange>{{9, 0, 1, 0.1, 0.2}, {4, 1, -1, 1.0 / 3.0, 0.5}});
    ledger.add(std::vector<OutcomeChange>{{9, 0, 1, 0.1, 0.15}});
    const auto found = ledger.crossings();
    REQUIRE(found.size() == 2);
    CHECK(found[0].id == 4);
    CHECK(found[0].outcome_low == 1);
    CHECK(found[0].outcome_high == -1);
    CHECK(found[0].u_low == 1.0 / 3.0);
    CHECK(found[1].id == 9);
    CHECK(found[1].u_high == 0.15);
}

TEST_CASE("Failed points are forgotten, and brackets that end at a failure") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    ledger.add(std::vector{succeeded(1, 0.1), failed(2), failed(3, Status::time_limit)});
    ledger.add(std::vector<OutcomeChange>{{1, 0, 1, 0.1, 0.2}, {2, 0, -1, 0.3, 0.4}, {3, -1, 1, 0.5, 0.6}});
    CHECK(ledger.forget_failed() == 2);
    CHECK(ledger.counts().points == 1);
    CHECK(ledger.counts().failed == 0);
    REQUIRE(ledger.crossings().size() == 1);
    CHECK(ledger.crossings()[0].id == 1);
    CHECK(ledger.forget_failed() == 0);
}

TEST_CASE("Ledgers of shares merge; what succeeded anywhere counts") {
    const Scratch scratch;
    Ledger whole(scratch / "whole", ledger_head());
    whole.add(std::vector{succeeded(1, 0.1), failed(2)});
    {
        Ledger share(scratch / "share", ledger_head());
        share.add(std::vector{failed(1), succeeded(2, 0.2), succeeded(3, 0.3), failed(4)});
    }
    whole.merge(scratch / "share");
    CHECK(whole.counts().points == 4);
    CHECK(whole.find(1)->ok());
    CHECK(whole.find(2)->ok());
    CHECK(whole.find(3)->ok());
    CHECK_FALSE(whole.find(4)->ok());
    const auto rows = texts(whole);
    whole.merge(scratch / "share");
    CHECK(texts(whole) == rows);
    CHECK(has(error_of<InputError>([&] { whole.merge(scratch / "nowhere"); }), "no such ledger"));
    CHECK_FALSE(fs::exists(scratch / "nowhere"));
    LedgerHead other = ledger_head();
    other.description = "another scan";
    { const Ledger stranger(scratch / "stranger", other); }
    CHECK(has(error_of<InputError>([&] { whole.merge(scratch / "stranger"); }), "another scan"));
}
