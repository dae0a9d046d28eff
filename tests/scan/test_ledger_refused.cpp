// What is no ledger of this scan is refused; full disks, kills and other connections lose nothing.

#include "ledger_rows.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/journal.hpp"
#include "store/small_disk.hpp"

#include <catch2/catch.hpp>

using namespace scan_test;
using rodwake::InputError;
using rodwake::RunError;
using store_test::content;
using store_test::error_of;
using store_test::has;
namespace fs = std::filesystem;

namespace {

std::string refusal(const fs::path& file) {
    return error_of<InputError>([&] { const Ledger ledger(file, ledger_head()); });
}

/// A ledger of 500 points in five records.
fs::path made(const Scratch& scratch, const char* name) {
    Ledger ledger(scratch / name, ledger_head());
    for (std::int64_t first = 0; first < 500; first += 100) {
        std::vector<Result> results;
        for (std::int64_t id = first; id < first + 100; ++id)
            results.push_back(succeeded(id, 0.001 * static_cast<double>(id)));
        ledger.add(results);
    }
    return scratch / name;
}

} // namespace

TEST_CASE("The ledger of another scan is refused") {
    const Scratch scratch;
    { const Ledger ledger(scratch / "l", ledger_head()); }
    const auto refused = [&](const auto& change) {
        LedgerHead other = ledger_head();
        change(other);
        return has(error_of<InputError>([&] { const Ledger ledger(scratch / "l", other); }),
                   (scratch / "l").string() + ": is the ledger of another scan");
    };
    CHECK(refused([](LedgerHead& h) { h.description += " of another scene"; }));
    CHECK(refused([](LedgerHead& h) { h.axes[0].name = "medium.alpha"; }));
    CHECK(refused([](LedgerHead& h) { h.axes.pop_back(); }));
    CHECK(refused([](LedgerHead& h) { h.columns.observables.emplace_back("turn0"); }));
    CHECK_NOTHROW(Ledger(scratch / "l", ledger_head()));
}

TEST_CASE("What is no ledger is refused and left as it is") {
    const Scratch scratch;
    const fs::path text = scratch.file("text", "These are notes about rods and nothing else.");
    CHECK(has(refusal(text), "is not a journal of rodwake"));
    CHECK(content(text).starts_with("These are notes"));
    CHECK(has(error_of<InputError>([&] { counts_of(text); }), "is not a journal of rodwake"));
    for (const char* key : {"starts of a fit", "a\n{}", "a\n[1]"}) {
        const fs::path other = scratch / "other";
        { const rodwake::store::Journal journal(other, key, rodwake::store::Journal::OfAnother::replace); }
        CHECK(has(refusal(other), "is a journal, but not the ledger of a scan"));
        CHECK(has(error_of<InputError>([&] { counts_of(other); }), "not the ledger of a scan"));
    }
    CHECK(has(error_of<InputError>([&] { counts_of(scratch / "nowhere"); }), "no such ledger"));
    fs::create_directory(scratch / "folder");
    CHECK_THROWS_AS(Ledger(scratch / "folder", ledger_head()), RunError);
    CHECK_THROWS_AS(Ledger(scratch / "no/such/folder/l", ledger_head()), RunError);
}

TEST_CASE("An empty file is a ledger that was never begun") { // killed before its first write
    const Scratch scratch;
    scratch.file("l", "");
    CHECK(counts_of(scratch / "l").points == 0);
    Ledger ledger(scratch / "l", ledger_head());
    ledger.add(std::vector{succeeded(1, 0.1)});
    CHECK(ledger.counts().points == 1);
}

TEST_CASE("Points of damaged records are evaluated again, the others stay") {
    const Scratch scratch;
    const std::string whole = content(made(scratch, "l"));
    for (std::size_t at = 600; at < whole.size(); at += 997) { // behind the key
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 4);
        scratch.file("damaged", damaged);
        Ledger ledger(scratch / "damaged", ledger_head());
        INFO("byte " << at << " of " << whole.size());
        CHECK(ledger.points() < 500);
        CHECK(ledger.points() % 100 == 0);
        ledger.for_each(
            [](const Result& r) { CHECK(r.point.at[0] == 0.001 * static_cast<double>(r.point.id)); });
        std::vector<Result> again;
        for (std::int64_t id = 0; id < 500; ++id)
            if (!ledger.find(id))
                again.push_back(succeeded(id, 0.001 * static_cast<double>(id)));
        ledger.add(again);
        CHECK(ledger.points() == 500);
        CHECK(Ledger(scratch / "damaged", ledger_head()).points() == 500);
    }
    Ledger ledger(scratch / "l", ledger_head());
    CHECK(ledger.damaged() == 0);
}

TEST_CASE("A full disk ends with an error, and what was committed stays") {
    const Scratch scratch;
    std::vector<Result> chunk(100, succeeded(0, 0.1));
    const auto fill = [&] {
        Ledger ledger(scratch / "l", ledger_head());
        for (std::int64_t first = 0; first < 100'000; first += 100) {
            for (std::int64_t i = 0; i < 100; ++i)
                chunk[static_cast<std::size_t>(i)].point.id = first + i;
            ledger.add(chunk);
        }
    };
    const std::string reported = store_test::on_small_disk(1'000'000, fill);
    INFO(reported);
    CHECK(has(reported, (scratch / "l").string() + ": "));
    CHECK(has(reported, "what was written before is kept, and the same command resumes from there"));
    Ledger ledger(scratch / "l", ledger_head());
    const std::int64_t kept = ledger.counts().points;
    CHECK(kept > 0);
    CHECK(kept % 100 == 0); // chunks whole or not at all
    std::int64_t next = 0;
    ledger.for_each_id([&](std::int64_t id) { next += id == next; });
    CHECK(next == kept);
    ledger.add(std::vector{succeeded(1'000'000, 0.1)});
    CHECK(ledger.counts().points == kept + 1);
}

TEST_CASE("A process that is killed loses what it had not committed, and no more") {
    const Scratch scratch;
    const std::string reported = store_test::on_small_disk(100'000'000, [&] {
        Ledger ledger(scratch / "l", ledger_head());
        ledger.add(std::vector{succeeded(1, 0.1), succeeded(2, 0.2)});
        ledger.add(std::vector{succeeded(3, 0.3)});
        ::raise(SIGKILL);
    });
    REQUIRE(reported == "signal 9");
    CHECK(counts_of(scratch / "l").points == 3);
    CHECK(Ledger(scratch / "l", ledger_head()).counts().points == 3);
}

TEST_CASE("Another process reads while one writes") {
    const Scratch scratch;
    Ledger writer(scratch / "l", ledger_head());
    for (std::int64_t id = 0; id < 20; ++id) {
        writer.add(std::vector{succeeded(id, 0.1)});
        CHECK(counts_of(scratch / "l").points == id + 1);
        CHECK(Ledger(scratch / "l").find(id)->point.at[0] == 0.1);
    }
}
