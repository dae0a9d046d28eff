// What is no ledger of this scan is refused; full disks, kills and other connections lose nothing.

#include "ledger_rows.hpp"
#include "rodwake/core/error.hpp"
#include "scan/sqlite.hpp"
#include "store/small_disk.hpp"

#include <catch2/catch.hpp>

#include <thread>

using namespace scan_test;
using rodwake::InputError;
using rodwake::RunError;
using store_test::content;
using store_test::error_of;
using store_test::has;
namespace fs = std::filesystem;

namespace {

void change(const fs::path& file, const std::string& sql) {
    Connection(file, SQLITE_OPEN_READWRITE).run(sql);
}

std::string refusal(const fs::path& file) {
    return error_of<InputError>([&] { const Ledger ledger(file, ledger_head()); });
}

/// A ledger of 500 points, settled into one file.
fs::path made(const Scratch& scratch, const char* name) {
    Ledger ledger(scratch / name, ledger_head());
    std::vector<Result> results;
    for (std::int64_t id = 0; id < 500; ++id)
        results.push_back(succeeded(id, 0.001 * static_cast<double>(id)));
    ledger.add(results);
    ledger.settle();
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

TEST_CASE("A ledger of another format is refused by its number and version") {
    for (const char* format : {"1", "3"}) {
        const Scratch scratch;
        const fs::path file = made(scratch, "l");
        change(file, std::string("UPDATE meta SET value = '") + format +
                         "' WHERE key = 'format'; UPDATE meta SET value = '9.1' WHERE key = 'rodwake'");
        const std::string told = std::string("is a ledger of format ") + format +
                                 ", and this version of rodwake knows 2; rodwake 9.1 made it";
        CHECK(has(refusal(file), told));
        CHECK(has(error_of<InputError>([&] { counts_of(file); }), told));
    }
}

TEST_CASE("What is no ledger is refused and left as it is") {
    const Scratch scratch;
    const fs::path text =
        scratch.file("text", "These are notes about rods and nothing else. " + std::string(2000, '.'));
    CHECK(has(refusal(text), "is not a ledger, or damaged"));
    CHECK(content(text).starts_with("These are notes"));
    CHECK(has(error_of<InputError>([&] { counts_of(text); }), "is not a ledger, or damaged"));
    change(scratch.file("other", ""), "CREATE TABLE points (x); INSERT INTO points VALUES (1)");
    CHECK(has(refusal(scratch / "other"), "not a ledger of rodwake"));
    change(scratch.file("third", ""), "CREATE TABLE people (x)");
    CHECK(has(refusal(scratch / "third"), "not a ledger of rodwake"));
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

TEST_CASE("A ledger that was cut short anywhere is refused") {
    const Scratch scratch;
    const std::string whole = content(made(scratch, "l"));
    std::set<std::size_t> sizes;
    for (std::size_t size = 4096; size < whole.size(); size += 4096) // whole pages
        sizes.insert(size);
    for (std::size_t size = 20; size < whole.size(); size += whole.size() / 61)
        sizes.insert(size);
    for (const std::size_t size : sizes) {
        const fs::path cut = scratch.file("cut" + std::to_string(size), whole.substr(0, size));
        INFO("the first " << size << " bytes of " << whole.size());
        CHECK(has(error_of<InputError>([&] {
                      const Ledger ledger(cut, ledger_head());
                      ledger.for_each([](const Result&) {});
                  }),
                  "damaged"));
    }
}

TEST_CASE("Words that no version writes are damage") {
    for (const char* sql : {"UPDATE causes SET status = 'redo'", "UPDATE causes SET outcome = 'capture'",
                            "UPDATE causes SET \"rods_run.method\" = 'euler'"}) {
        const Scratch scratch;
        const fs::path file = made(scratch, "l");
        Ledger(file, ledger_head()).add(std::vector{failed(3)});
        change(file, sql);
        const Ledger ledger(file, ledger_head());
        INFO(sql);
        CHECK(has(error_of<InputError>([&] { ledger.for_each([](const Result&) {}); }), "point 3"));
    }
}

TEST_CASE("Records that no version writes are damage") {
    const std::string whole = "UPDATE chunks SET data = CAST(substr(data, 1, length(data) - 8) || ";
    for (const std::string& sql : {whole + "x'6300000000000000' AS BLOB)", // outcome 99
                                   std::string("UPDATE chunks SET data = substr(data, 2)"),
                                   std::string("UPDATE chunks SET data = x''")}) {
        const Scratch scratch;
        const fs::path file = made(scratch, "l");
        change(file, sql);
        INFO(sql);
        CHECK(has(error_of<InputError>([&] {
                      const Ledger ledger(file, ledger_head());
                      ledger.for_each([](const Result&) {});
                  }),
                  "damaged"));
    }
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
    const std::string told = store_test::on_small_disk(1'000'000, fill);
    INFO(told);
    CHECK(has(told, (scratch / "l").string() + ": "));
    CHECK(has(told, "what was committed is kept, and the same command goes on from there"));
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
    const std::string told = store_test::on_small_disk(100'000'000, [&] {
        Ledger ledger(scratch / "l", ledger_head());
        ledger.add(std::vector{succeeded(1, 0.1), succeeded(2, 0.2)});
        ledger.add(std::vector{succeeded(3, 0.3)});
        ::raise(SIGKILL);
    });
    REQUIRE(told == "signal 9");
    CHECK(counts_of(scratch / "l").points == 3);
    CHECK(Ledger(scratch / "l", ledger_head()).counts().points == 3);
}

TEST_CASE("Another connection reads while one writes") {
    const Scratch scratch;
    Ledger writer(scratch / "l", ledger_head());
    const Ledger reader(scratch / "l", ledger_head());
    for (std::int64_t id = 0; id < 20; ++id) {
        writer.add(std::vector{succeeded(id, 0.1)});
        CHECK(reader.counts().points == id + 1);
        CHECK(counts_of(scratch / "l").points == id + 1);
    }
    std::int64_t seen = 0; // a reader in the middle of the table does not hold the writer up
    reader.for_each([&](const Result& r) {
        if (seen++ == 0)
            writer.add(std::vector{succeeded(1000 + r.point.id, 0.1)});
    });
    CHECK(seen == 20);
    CHECK(reader.counts().points == 21);
    writer.settle();
    CHECK(reader.counts().points == 21);
}

TEST_CASE("Two that write wait for each other") {
    const Scratch scratch;
    { const Ledger ledger(scratch / "l", ledger_head()); }
    const auto write = [&](std::int64_t from) {
        Ledger ledger(scratch / "l", ledger_head());
        for (std::int64_t id = from; id < from + 50; ++id)
            ledger.add(std::vector{succeeded(id, 0.1)});
    };
    std::jthread other(write, 1000);
    write(0);
    other.join();
    CHECK(counts_of(scratch / "l").points == 100);
}

TEST_CASE("A settled ledger is one file that can be copied") {
    const Scratch scratch;
    Ledger ledger(scratch / "l", ledger_head());
    ledger.add(std::vector{succeeded(1, 0.1)});
    ledger.settle();
    fs::copy_file(scratch / "l", scratch / "copy");
    CHECK(counts_of(scratch / "copy").points == 1);
}
