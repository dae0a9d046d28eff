// Files appear whole or not at all.

#include "rodwake/store/atomic_file.hpp"

#include "rodwake/core/error.hpp"
#include "scratch.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace store_test;

using Names = std::set<std::string>;

TEST_CASE("A file is written, and written over, without a temporary left") {
    const Scratch scratch;
    const std::string text("first\0 second\r\n", 15);
    store::write_atomically(scratch / "a.txt", text);
    CHECK(content(scratch / "a.txt") == text);
    store::write_atomically(scratch / "a.txt", "");
    CHECK(content(scratch / "a.txt").empty());
    CHECK(scratch.entries() == Names{"a.txt"});
}

TEST_CASE("The file is not there before commit, and the old one stands until then") {
    const Scratch scratch;
    scratch.file("a.txt", "old");
    store::PendingFile pending(scratch / "a.txt");
    std::ofstream(pending.temporary()) << "new";
    CHECK(content(scratch / "a.txt") == "old");
    CHECK(pending.temporary().parent_path() == scratch.path()); // a rename must not cross file systems
    pending.commit();
    CHECK(content(scratch / "a.txt") == "new");
    CHECK(scratch.entries() == Names{"a.txt"});
}

TEST_CASE("Without commit nothing is left") {
    const Scratch scratch;
    {
        const store::PendingFile pending(scratch / "a.txt");
        CHECK(scratch.entries().size() == 1);
    }
    CHECK(scratch.entries().empty());
}

TEST_CASE("What cannot be written says which file and why") {
    const Scratch scratch;
    scratch.file("file", "content");
    fs::create_directory(scratch / "folder");
    const auto write = [&](const std::string& name) {
        return error_of<RunError>([&] { store::write_atomically(scratch / name, "new"); });
    };
    CHECK(has(write("none/a.txt"), (scratch / "none/a.txt").string() + ": cannot write: No such file"));
    CHECK(has(write("file/a.txt"), "Not a directory"));
    CHECK(has(write("folder"), "cannot rename the finished file to: Is a directory"));
    CHECK(scratch.entries() == Names{"file", "folder"});
    CHECK(content(scratch / "file") == "content");
}
