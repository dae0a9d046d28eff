// Tables of wakes are kept from run to run, and never trusted blindly.

#include "rodwake/stages/wake_tables.hpp"

#include <catch2/catch.hpp>

#include <unistd.h>

#include <cstdlib>
#include <fstream>

using namespace rodwake;
using stages::WakeTables;

namespace {

constexpr double eta = 0.7, tolerance = 3e-2;

/// A folder of its own, removed at the end.
struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("rodwake_tables_" + std::to_string(::getpid()));
    Folder() { std::filesystem::remove_all(path); }
    ~Folder() { std::filesystem::remove_all(path); }

    std::filesystem::path file() const { return path / stages::table_file_name(eta, tolerance); }
};

struct Listener {
    std::string text;
    stages::RunContext context;
    Listener() {
        context.log = [this](stages::Severity, const std::string& line) { text += line + "\n"; };
    }
};

} // namespace

TEST_CASE("a table is made once and read afterwards") {
    const Folder folder;
    Listener first, second;
    WakeTables making(first.context, folder.path);
    const auto made = making.plane(eta, tolerance);
    CHECK(first.text.find("largest error") != std::string::npos);
    CHECK(std::filesystem::exists(folder.file()));
    CHECK(making.plane(eta, tolerance) == made);
    WakeTables reading(second.context, folder.path);
    CHECK(*reading.plane(eta, tolerance) == *made);
    CHECK(second.text.empty());
    CHECK(stages::table_file_name(eta, tolerance) != stages::table_file_name(eta, 2.0 * tolerance));
}

TEST_CASE("a damaged table is made anew, with a word") {
    const Folder folder;
    Listener quiet, listener;
    const auto made = WakeTables(quiet.context, folder.path).plane(eta, tolerance);
    {
        std::fstream file(folder.file(), std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(5000);
        file.put('\x5a');
        file.put('\xa5');
    }
    CHECK(*WakeTables(listener.context, folder.path).plane(eta, tolerance) == *made);
    CHECK(listener.text.find("made anew") != std::string::npos);
    Listener third;
    CHECK(*WakeTables(third.context, folder.path).plane(eta, tolerance) == *made); // and kept again
    CHECK(third.text.empty());
}

TEST_CASE("without a folder to write to a table serves its run") {
    Listener listener;
    CHECK(WakeTables(listener.context, "").plane(eta, tolerance)->strain_error <= tolerance);
    CHECK(WakeTables(listener.context, "/proc/nowhere").plane(eta, tolerance)->strain_error <= tolerance);
    CHECK(listener.text.find("not kept") != std::string::npos);
}
