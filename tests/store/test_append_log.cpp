// Records of one size: appended, read, cut back to a checkpoint's count; foreign and damaged files are
// refused.

#include "rodwake/store/append_log.hpp"

#include "rodwake/core/error.hpp"
#include "scratch.hpp"
#include "small_disk.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace store_test;
using store::AppendLog;

namespace {

constexpr std::size_t size = 24, stride = size + 8, header = 32;

std::vector<std::byte> record(int i) {
    std::vector<std::byte> bytes(size, static_cast<std::byte>(i));
    bytes[0] = static_cast<std::byte>(i >> 8);
    return bytes;
}

void append(AppendLog& log, int first, int last) {
    for (int i = first; i < last; ++i)
        log.append(record(i));
}

bool holds(AppendLog& log, int count) {
    for (int i = 0; i < count; ++i)
        if (log.read(static_cast<std::size_t>(i)) != record(i))
            return false;
    return log.records() == static_cast<std::size_t>(count);
}

std::string refusal(const fs::path& path, std::size_t bytes, std::size_t keep) {
    return error_of<InputError>([&] { AppendLog(path, bytes, keep); });
}

} // namespace

TEST_CASE("Records are appended and read, buffered or not") {
    const Scratch scratch;
    {
        AppendLog log(scratch / "log", size, 0);
        CHECK(log.records() == 0);
        append(log, 0, 10);
        CHECK(holds(log, 10));
        append(log, 10, 50000); // 1.6 MB: more than the buffer
        CHECK(log.records() == 50000);
        log.sync();
        CHECK(fs::file_size(scratch / "log") == header + 50000 * stride);
        append(log, 50000, 50010);
    }
    AppendLog log(scratch / "log", size, 50010);
    CHECK(holds(log, 50010));
    CHECK_THROWS_AS(log.read(50010), std::invalid_argument);
    CHECK_THROWS_AS(log.append(std::vector<std::byte>(size + 1)), std::invalid_argument);
}

TEST_CASE("The helper that compares records sees a difference") {
    const Scratch scratch;
    AppendLog log(scratch / "log", size, 0);
    append(log, 0, 3);
    log.append(record(7));
    CHECK_FALSE(holds(log, 4));
    CHECK_FALSE(holds(log, 3));
}

TEST_CASE("Records after a checkpoint are dropped, also a last one that is cut off") {
    const Scratch scratch;
    {
        AppendLog log(scratch / "log", size, 0);
        append(log, 0, 20);
    }
    fs::resize_file(scratch / "log", header + 19 * stride + 5);
    CHECK(has(refusal(scratch / "log", size, 20), "holds 19 records, 20 are needed"));
    {
        AppendLog log(scratch / "log", size, 12);
        CHECK(fs::file_size(scratch / "log") == header + 12 * stride);
        append(log, 12, 15);
        CHECK(holds(log, 15));
    }
    AppendLog again(scratch / "log", size, 0);
    CHECK(again.records() == 0);
    CHECK(fs::file_size(scratch / "log") == header);
}

TEST_CASE("Files that are no such log are refused and left as they are") {
    const Scratch scratch;
    const std::string text = "t,x\n0,1\nsome other table of numbers, longer than a header\n";
    scratch.file("table.csv", text);
    for (const std::size_t keep : {0, 1})
        CHECK(has(refusal(scratch / "table.csv", size, keep), "not a record log of rodwake"));
    CHECK(content(scratch / "table.csv") == text);
    scratch.file("empty", "");
    CHECK(has(refusal(scratch / "empty", size, 0), "not a record log"));
    CHECK(has(refusal(scratch / "none", size, 3), "none: is missing; 3 records of it are needed"));
    fs::create_directory(scratch / "folder");
    CHECK(has(error_of<RunError>([&] { AppendLog(scratch / "folder", size, 0); }), "Is a directory"));
    CHECK(has(error_of<RunError>([&] { AppendLog(scratch / "none/log", size, 0); }), "No such file"));
    CHECK_THROWS_AS(AppendLog(scratch / "log", 0, 0), std::invalid_argument);
}

TEST_CASE("Every bit of header and records counts") {
    const Scratch scratch;
    {
        AppendLog log(scratch / "log", size, 0);
        append(log, 0, 3);
    }
    const std::string whole = content(scratch / "log");
    CHECK(has(refusal(scratch / "log", size + 1, 3), "has records of 24 bytes, expected 25"));
    for (std::size_t bit = 0; bit < 8 * header; ++bit) {
        std::string damaged = whole;
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
        scratch.file("damaged", damaged);
        CHECK_FALSE(refusal(scratch / "damaged", size, 3).empty());
    }
    for (std::size_t bit = 0; bit < 8 * stride; ++bit) {
        std::string damaged = whole;
        damaged[header + stride + bit / 8] =
            static_cast<char>(damaged[header + stride + bit / 8] ^ (1 << (bit % 8)));
        scratch.file("damaged", damaged);
        AppendLog log(scratch / "damaged", size, 3);
        CHECK(log.read(0) == record(0));
        CHECK(has(error_of<InputError>([&] { log.read(1); }), "damaged: record 1 is damaged"));
        CHECK(log.read(2) == record(2));
    }
    scratch.file("swapped", whole.substr(0, header) + whole.substr(header + stride, stride) +
                                whole.substr(header, stride) + whole.substr(header + 2 * stride));
    AppendLog log(scratch / "swapped", size, 3);
    CHECK(has(error_of<InputError>([&] { log.read(0); }), "record 0 is damaged"));
}

TEST_CASE("A full disk is told, and what a checkpoint counted on is still there") {
    const Scratch scratch;
    {
        AppendLog log(scratch / "log", size, 0);
        append(log, 0, 100);
    }
    const auto go_on = [&](int last) {
        return on_small_disk(header + 150 * stride + 3, [&] {
            AppendLog log(scratch / "log", size, 100);
            append(log, 100, last);
            log.sync();
        });
    };
    CHECK(go_on(150) == "done");
    CHECK(go_on(151) == (scratch / "log").string() + ": cannot write: File too large");
    CHECK(go_on(50000) == (scratch / "log").string() + ": cannot write: File too large");
    AppendLog log(scratch / "log", size, 100);
    CHECK(holds(log, 100));
}
