// Two generations of a checkpoint: whatever happens to one, or on a full disk, the other is there.

#include "rodwake/store/generations.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/journal.hpp"
#include "scratch.hpp"
#include "small_disk.hpp"

#include <catch2/catch.hpp>

using namespace rodwake;
using namespace store_test;

using Names = std::set<std::string>;

namespace {

std::string generation(char letter, std::size_t size = 1000) {
    return store::journal_of("state", std::string(size, letter));
}

std::string content_of(const fs::path& file) { return store::Journal(file).value<std::string>(); }

/// Letter of the generation that is found; '-' if there is none.
char loaded(const fs::path& target) {
    const auto found = store::find_generation(target);
    return found ? content_of(found->file).front() : '-';
}

} // namespace

TEST_CASE("The newest is loaded, the one before is kept, older ones go") {
    const Scratch scratch;
    const fs::path target = scratch / "run.rwc";
    CHECK_FALSE(store::find_generation(target));
    store::write_generation(target, generation('a'));
    CHECK(scratch.entries() == Names{"run.rwc"});
    CHECK(loaded(target) == 'a');
    for (const char letter : {'b', 'c'})
        store::write_generation(target, generation(letter));
    const auto newest = store::find_generation(target);
    REQUIRE(newest);
    CHECK(loaded(target) == 'c');
    CHECK(newest->file == target);
    CHECK(newest->notice.empty());
    CHECK(loaded(scratch / "run.rwc.previous") == 'b');
    CHECK(scratch.entries() == Names{"run.rwc", "run.rwc.previous"});
    store::remove_generations(target);
    CHECK(scratch.entries().empty());
    store::remove_generations(target);
}

TEST_CASE("A damaged or missing newest is reported and the previous used") {
    const Scratch scratch;
    const fs::path target = scratch / "run.rwc";
    store::write_generation(target, generation('a'));
    store::write_generation(target, generation('b'));
    scratch.file("run.rwc", generation('b').substr(0, 500));
    auto found = store::find_generation(target);
    REQUIRE(found);
    CHECK(loaded(target) == 'a');
    CHECK(found->file == store::previous_generation(target));
    CHECK(has(found->notice, target.string() + ": is damaged"));
    CHECK(has(found->notice, "resuming from " + target.string() + ".previous"));
    fs::remove(target);
    found = store::find_generation(target);
    REQUIRE(found);
    CHECK(has(found->notice, target.string() + ": is missing; resuming"));
}

TEST_CASE("If none is whole, both reasons are reported") {
    const Scratch scratch;
    const fs::path target = scratch / "run.rwc";
    const auto refusal = [&] { return error_of<InputError>([&] { store::find_generation(target); }); };
    scratch.file("run.rwc", "");
    CHECK(has(refusal(), "run.rwc: is not a journal"));
    scratch.file("run.rwc.previous", "x");
    CHECK(has(refusal(), "; " + target.string() + ".previous: is not a journal"));
    fs::remove(target);
    CHECK(has(refusal(), "run.rwc: is missing; " + target.string() + ".previous: is not a journal"));
}

TEST_CASE("A folder in its place is neither read nor moved") {
    const Scratch scratch;
    const fs::path target = scratch / "run.rwc";
    fs::create_directory(target);
    CHECK(has(error_of<RunError>([&] { store::find_generation(target); }), "Is a directory"));
    CHECK(
        has(error_of<RunError>([&] { store::write_generation(target, generation('a')); }), "Is a directory"));
    CHECK(scratch.entries() == Names{"run.rwc"});
}

TEST_CASE("A damaged newest does not push out a whole previous") {
    const Scratch scratch;
    const fs::path target = scratch / "run.rwc";
    store::write_generation(target, generation('a'));
    store::write_generation(target, generation('b'));
    scratch.file("run.rwc", "damaged");
    store::write_generation(target, generation('c'));
    CHECK(loaded(target) == 'c');
    CHECK(loaded(store::previous_generation(target)) == 'a');
}

TEST_CASE("A full disk leaves both generations") {
    const Scratch scratch;
    const fs::path target = scratch / "run.rwc";
    store::write_generation(target, generation('a'));
    store::write_generation(target, generation('b'));
    const std::string large = generation('c', 100000);
    for (const rlim_t bytes : {0, 1, 4096, 100000})
        CHECK(on_small_disk(bytes, [&] { store::write_generation(target, large); }) ==
              target.string() + ": cannot write: File too large");
    CHECK(loaded(target) == 'b');
    CHECK(loaded(store::previous_generation(target)) == 'a');
    CHECK(scratch.entries() == Names{"run.rwc", "run.rwc.previous"});
}

TEST_CASE("Killed at any moment, a whole generation is found", "[.][long]") {
    // 300 writers killed after 0 to 30 ms: within opening, writing, syncing and either renaming.
    const Scratch scratch;
    const fs::path target = scratch / "run.rwc";
    store::write_generation(target, generation('a', 300000));
    for (unsigned i = 0; i < 300; ++i) {
        const pid_t pid = ::fork();
        if (pid == 0)
            for (char letter = 'a';; letter = letter == 'z' ? 'a' : static_cast<char>(letter + 1))
                store::write_generation(target, generation(letter, 300000));
        ::usleep(100 * i);
        ::kill(pid, SIGKILL);
        ::waitpid(pid, nullptr, 0);
        const auto found = store::find_generation(target);
        REQUIRE(found);
        REQUIRE(content_of(found->file).size() == 300000);
    }
}
