// Journals: what goes in comes out after any end of the process; what is damaged is recognised.

#include "rodwake/store/journal.hpp"

#include "kept_structs.hpp"
#include "rodwake/core/error.hpp"
#include "scratch.hpp"
#include "small_disk.hpp"
#include "store/descriptor.hpp"

#include <catch2/catch.hpp>

#include <csignal>

using namespace rodwake;
using namespace store_test;
using store::Journal;
using enum Journal::OfAnother;

namespace {

/// Of the length 0 to 99 bytes, its number in each.
std::vector<std::byte> record(int i) {
    return std::vector<std::byte>(static_cast<std::size_t>(i * 7 % 100), static_cast<std::byte>(i));
}

void append(Journal& journal, int first, int last) {
    for (int i = first; i < last; ++i)
        journal.append(static_cast<std::uint32_t>(i % 3), record(i));
}

bool holds(Journal& journal, int count) {
    bool all = journal.size() == static_cast<std::size_t>(count);
    for (int i = 0; all && i < count; ++i)
        all = journal.read(static_cast<std::size_t>(i)) == record(i) &&
              journal.layout(static_cast<std::size_t>(i)) == static_cast<std::uint32_t>(i % 3);
    return all;
}

fs::path made(const Scratch& scratch, int count) {
    Journal journal(scratch / "j", "key", replace);
    append(journal, 0, count);
    return scratch / "j";
}

std::string refusal(const fs::path& file, std::string_view key = "key") {
    return error_of<InputError>([&] { Journal(file, key, refuse); });
}

} // namespace

TEST_CASE("Records are appended and read, buffered or not") {
    const Scratch scratch;
    {
        Journal journal(scratch / "j", "key", refuse);
        CHECK(journal.size() == 0);
        append(journal, 0, 10);
        CHECK(holds(journal, 10));
        append(journal, 10, 50000); // 3.7 MB: more than the buffer
        CHECK(holds(journal, 50000));
        journal.sync();
        append(journal, 50000, 50010);
        CHECK(has(error_of<InputError>([&] { journal.read(50010); }), "it ends before record 50010"));
    }
    Journal journal(scratch / "j", "key", refuse);
    CHECK(journal.key() == "key");
    CHECK(holds(journal, 50010));
    append(journal, 50010, 50020);
    CHECK(holds(journal, 50020));
    CHECK_FALSE(holds(journal, 50019)); // the helper sees a difference
}

TEST_CASE("Values are kept by their layout") {
    const Scratch scratch;
    Journal journal(scratch / "j", "key", replace);
    journal.add(std::vector<double>{1.0, -0.0});
    journal.add(std::string("text"));
    journal.add(std::vector<double>{});
    CHECK(journal.all<std::vector<double>>() == std::vector<std::vector<double>>{{1.0, -0.0}, {}});
    CHECK(journal.get<std::string>(1) == "text");
    CHECK_FALSE(journal.get<std::string>(0));
}

TEST_CASE("A value is written as a whole, and refused if it is cut or of another layout") {
    const Scratch scratch;
    const Pose pose{{1.0, 2.0}, 3.0F, true};
    const std::string bytes = store::journal_of("key", pose);
    Journal journal(scratch.file("pose", bytes));
    CHECK((journal.key() == "key" && journal.value<Pose>() == pose));
    CHECK(has(error_of<InputError>([&] { journal.value<Poses>(); }),
              "pose: written by another version of rodwake"));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const fs::path cut = scratch.file("cut", bytes.substr(0, size));
        INFO("size " << size);
        CHECK_FALSE(error_of<InputError>([&] { Journal(cut).value<Pose>(); }).empty());
    }
}

TEST_CASE("The checksum is XXH3-64") {
    // Test vectors of the xxHash project for the empty input and seed 0.
    CHECK(store::xxh3("") == 0x2D06800538D394C2ULL);
    CHECK(store::xxh3("a") != store::xxh3("b"));
    CHECK(store::xxh3("a", 1) != store::xxh3("a", 2));
}

TEST_CASE("A journal of other work is refused or replaced") {
    const Scratch scratch;
    made(scratch, 20);
    CHECK(has(refusal(scratch / "j", "other"), "is the journal of other work"));
    CHECK(holds(*std::make_unique<Journal>(scratch / "j"), 20));
    CHECK_FALSE(Journal(scratch / "j", "key", replace).replaced());
    {
        const Journal other(scratch / "j", "other", replace);
        CHECK((other.replaced() && other.size() == 0));
    }
    CHECK(Journal(scratch / "j").key() == "other");
}

TEST_CASE("What came after a checkpoint is dropped") {
    const Scratch scratch;
    made(scratch, 20);
    {
        Journal journal(scratch / "j", "key", refuse);
        CHECK(has(error_of<InputError>([&] { journal.keep(21); }), "holds 20 records, 21 are needed"));
        journal.keep(12);
        append(journal, 12, 15);
        CHECK(holds(journal, 15));
    }
    CHECK(holds(*std::make_unique<Journal>(scratch / "j"), 15));
    Journal journal(scratch / "j", "key", refuse);
    journal.keep(0);
    append(journal, 0, 3);
    CHECK(holds(journal, 3));
}

TEST_CASE("Files that are no journal are refused and left as they are") {
    const Scratch scratch;
    const std::string text = "t,x\n0,1\nsome other table of numbers\n";
    scratch.file("table.csv", text);
    CHECK(has(refusal(scratch / "table.csv"), "is not a journal of rodwake"));
    CHECK(content(scratch / "table.csv") == text);
    CHECK(has(error_of<InputError>([&] { Journal(scratch / "none"); }), "No such file"));
    fs::create_directory(scratch / "folder");
    CHECK(has(error_of<RunError>([&] { Journal(scratch / "folder", "key", refuse); }), "Is a directory"));
    CHECK(has(error_of<RunError>([&] { Journal(scratch / "none/j", "key", refuse); }), "No such file"));
    scratch.file("empty", ""); // killed before the first write
    CHECK(Journal(scratch / "empty", "key", refuse).size() == 0);
}

TEST_CASE("A journal that was cut anywhere keeps its whole records") {
    const Scratch scratch;
    made(scratch, 30);
    const std::string whole = content(scratch / "j");
    std::size_t before = 0;
    for (std::size_t size = 16 + 16 + 3 + 8; size <= whole.size(); ++size) {
        scratch.file("cut", whole.substr(0, size));
        Journal journal(scratch / "cut", "key", refuse);
        const std::size_t kept = journal.size();
        CHECK((kept == before || kept == before + 1));
        CHECK(holds(journal, static_cast<int>(kept)));
        before = kept;
        append(journal, static_cast<int>(kept), static_cast<int>(kept) + 2);
        CHECK(holds(journal, static_cast<int>(kept) + 2));
    }
    CHECK(before == 30);
    for (std::size_t size = 1; size < 16 + 16 + 3 + 8; ++size) // the head is written whole or not at all
        CHECK(has(refusal(scratch.file("cut", whole.substr(0, size))), "journal"));
}

TEST_CASE("Every bit counts, and damage costs no record before it") {
    const Scratch scratch;
    made(scratch, 12);
    const std::string whole = content(scratch / "j");
    for (std::size_t at = 0; at < whole.size(); ++at) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
        scratch.file("damaged", damaged);
        INFO("byte " << at);
        std::optional<Journal> journal;
        try {
            journal.emplace(scratch / "damaged");
        } catch (const InputError&) { // head or key
            continue;
        }
        std::size_t wrong = (12 - journal->size()) + (journal->key() != "key");
        for (std::size_t i = 0; i < journal->size(); ++i)
            try {
                const std::vector<std::byte> found = journal->read(i);
                CHECK(found == record(static_cast<int>(i)));
            } catch (const InputError& error) {
                CHECK(has(error.what(), "is damaged"));
                ++wrong;
            }
        CHECK(wrong > 0);
    }
}

TEST_CASE("Records cannot change places") {
    const Scratch scratch;
    {
        Journal journal(scratch / "j", "key", replace);
        journal.append(0, std::vector<std::byte>(8, std::byte{1}));
        journal.append(0, std::vector<std::byte>(8, std::byte{2}));
    }
    std::string bytes = content(scratch / "j");
    constexpr std::size_t record_size = 16 + 8 + 8;
    const std::size_t first = bytes.size() - 2 * record_size;
    std::rotate(bytes.begin() + static_cast<std::ptrdiff_t>(first),
                bytes.begin() + static_cast<std::ptrdiff_t>(first + record_size), bytes.end());
    CHECK(Journal(scratch.file("swapped", bytes)).size() == 0);
}

TEST_CASE("A full disk ends with an error, and what was flushed before stays") {
    const Scratch scratch;
    const std::string reported = on_small_disk(300'000, [&] {
        Journal journal(scratch / "j", "key", replace);
        for (int i = 0; i < 100; ++i) {
            journal.append(0, std::vector<std::byte>(10'000, static_cast<std::byte>(i)));
            journal.flush();
        }
    });
    CHECK(has(reported, "what was written before is kept, and the same command resumes from there"));
    Journal journal(scratch / "j", "key", refuse);
    CHECK(journal.size() > 20);
    for (std::size_t i = 0; i < journal.size(); ++i)
        CHECK(journal.read(i) == std::vector<std::byte>(10'000, static_cast<std::byte>(i)));
}

TEST_CASE("A process that is killed keeps what it had flushed") {
    const Scratch scratch;
    const std::string reported = on_small_disk(100'000'000, [&] {
        Journal journal(scratch / "j", "key", replace);
        append(journal, 0, 10);
        journal.flush();
        append(journal, 10, 20);
        ::raise(SIGKILL);
    });
    REQUIRE(reported == "signal 9");
    CHECK(holds(*std::make_unique<Journal>(scratch / "j"), 10));
}

TEST_CASE("Another process reads while one writes") {
    const Scratch scratch;
    Journal writer(scratch / "j", "key", replace);
    for (int i = 0; i < 20; ++i) {
        append(writer, i, i + 1);
        writer.flush();
        CHECK(holds(*std::make_unique<Journal>(scratch / "j"), i + 1));
    }
}
