// Tables of wakes are kept from run to run, and never trusted blindly.

#include "rodwake/app/wake_tables.hpp"
#include "rodwake/core/error.hpp"
#include "store/scratch.hpp"

#include <catch2/catch.hpp>

#include <fstream>

using namespace rodwake;
using app::WakeTables;

namespace {

constexpr double eta = 0.7, tolerance = 3e-2;
constexpr elastic::Medium in_box{eta, 2.0};
constexpr double box = 1.5, box_tolerance = 1e-3;

struct Folder {
    store_test::Scratch scratch;
    std::filesystem::path path = scratch.path();

    std::filesystem::path file() const { return path / app::table_file_name(eta, tolerance); }
    std::filesystem::path box_file() const { return path / app::table_file_name(in_box, box, box_tolerance); }
};

struct Listener {
    std::string text;
    app::RunContext context;
    Listener() {
        context.log = [this](app::Severity, const std::string& line) { text += line + "\n"; };
    }
};

void damage(const std::filesystem::path& name) {
    std::fstream file(name, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(5000);
    file.put('\x5a');
    file.put('\xa5');
}

} // namespace

TEST_CASE("a table is made once and read afterwards", "[threads]") {
    const Folder folder;
    Listener first, second;
    WakeTables making(first.context, folder.path);
    const auto made = making.plane(eta, tolerance);
    CHECK_THAT(first.text, Catch::Contains("largest error"));
    CHECK(std::filesystem::exists(folder.file()));
    CHECK(making.plane(eta, tolerance) == made);
    WakeTables reading(second.context, folder.path);
    CHECK(*reading.plane(eta, tolerance) == *made);
    CHECK(second.text.empty());
    CHECK(app::table_file_name(eta, tolerance) != app::table_file_name(eta, 2.0 * tolerance));
}

TEST_CASE("a damaged table is made anew, with a word") {
    const Folder folder;
    Listener quiet, listener;
    const auto made = WakeTables(quiet.context, folder.path).plane(eta, tolerance);
    damage(folder.file());
    CHECK(*WakeTables(listener.context, folder.path).plane(eta, tolerance) == *made);
    CHECK_THAT(listener.text, Catch::Contains("will be recomputed"));
    Listener third;
    CHECK(*WakeTables(third.context, folder.path).plane(eta, tolerance) == *made); // and kept again
    CHECK(third.text.empty());
}

TEST_CASE("without a folder to write to a table serves its run") {
    Listener listener;
    CHECK(WakeTables(listener.context, "").plane(eta, tolerance)->strain_error <= tolerance);
    CHECK(WakeTables(listener.context, "/proc/nowhere").plane(eta, tolerance)->strain_error <= tolerance);
    CHECK_THAT(listener.text, Catch::Contains("not kept"));
}

TEST_CASE("a table of a box is kept as those of the plane are") {
    const Folder folder;
    Listener first, second, third;
    WakeTables making(first.context, folder.path);
    const auto made = making.periodic(in_box, box, box_tolerance);
    CHECK_THAT(first.text, Catch::Contains("in its box: tolerance 0.001, largest error"));
    CHECK(std::filesystem::exists(folder.box_file()));
    const auto read = WakeTables(second.context, folder.path).periodic(in_box, box, box_tolerance);
    CHECK(second.text.empty());
    CHECK(read.data() == made.data());
    CHECK(read.error() <= box_tolerance);
    // also what is worked out from the numbers of the file
    CHECK(read.self_image_field(0.3, {.strain = true}).strain.xy ==
          made.self_image_field(0.3, {.strain = true}).strain.xy);
    CHECK(read.at({0.1, 0.2, 0.3}, 0.5, 0.6, {.strain = true}).strain.xx ==
          made.at({0.1, 0.2, 0.3}, 0.5, 0.6, {.strain = true}).strain.xx);
    damage(folder.box_file());
    CHECK(WakeTables(third.context, folder.path).periodic(in_box, box, box_tolerance).data() == made.data());
    CHECK_THAT(third.text, Catch::Contains("will be recomputed"));
    CHECK(app::table_file_name(in_box, box, box_tolerance) !=
          app::table_file_name({in_box.eta, 2.5}, box, box_tolerance));
}

TEST_CASE("numbers that are no table of a box are refused") {
    const elastic::PeriodicTableData good = elastic::PeriodicTable(in_box, box, box_tolerance).data();
    elastic::PeriodicTableData bad = good;
    bad.coefficients[2].pop_back();
    CHECK_THROWS_AS(elastic::PeriodicTable(bad), InputError);
    bad = good;
    bad.place_pieces = 0;
    CHECK_THROWS_AS(elastic::PeriodicTable(bad), InputError);
    bad = good;
    bad.xi = -1.0;
    CHECK_THROWS_AS(elastic::PeriodicTable(bad), InputError);
}
