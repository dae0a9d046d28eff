// The full disk of these tests must be full, and must tell what happened on it.

#include "small_disk.hpp"

#include "rodwake/store/atomic_file.hpp"
#include "scratch.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace store_test;

TEST_CASE("on_small_disk tells how the work ended") {
    CHECK(on_small_disk(1000, [] {}) == "done");
    CHECK(on_small_disk(1000, [] { throw RunError("why"); }) == "why");
    CHECK(on_small_disk(1000, [] { throw InputError("why"); }) == "another error: why");
    CHECK(on_small_disk(1000, [] { ::raise(SIGKILL); }) == "signal 9");
    CHECK(on_small_disk(1000, [] { std::abort(); }) == "signal 6");
}

TEST_CASE("A full disk leaves the old file and no temporary") {
    const Scratch scratch;
    scratch.file("a", "old");
    const auto write = [&](std::size_t size) {
        store::write_atomically(scratch / "a", std::string(size, 'x'));
    };
    CHECK(has(on_small_disk(1000, [&] { write(1001); }),
              (scratch / "a").string() + ": cannot write: File too large"));
    CHECK(content(scratch / "a") == "old");
    CHECK(on_small_disk(1000, [&] { write(1000); }) == "done");
    CHECK(content(scratch / "a").size() == 1000);
    CHECK(scratch.entries() == std::set<std::string>{"a"});
}

TEST_CASE("A link in the place of the temporary is not followed") {
    const Scratch scratch;
    scratch.file("precious", "precious");
    std::filesystem::create_symlink(scratch / "precious",
                                    (scratch / "a.tmp").string() + std::to_string(::getpid()));
    store::write_atomically(scratch / "a", "new");
    CHECK(content(scratch / "precious") == "precious");
    CHECK(content(scratch / "a") == "new");
    CHECK(scratch.entries() == std::set<std::string>{"a", "precious"});
}
