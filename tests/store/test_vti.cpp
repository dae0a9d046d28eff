// Grids for ParaView: refused input, full disks. What is in them is checked by another reader in test_vti.py,
// on the files that the last test here makes.

#include "rodwake/store/vti.hpp"

#include "rodwake/core/error.hpp"
#include "scratch.hpp"
#include "small_disk.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

using namespace rodwake;
using namespace store_test;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
using Limits = std::numeric_limits<double>;

/// Numbers that tell where they belong: column + 100 row, + 0.25 component.
std::vector<double> field(std::size_t nx, std::size_t ny, std::size_t components) {
    std::vector<double> out;
    for (std::size_t j = 0; j < ny; ++j)
        for (std::size_t i = 0; i < nx; ++i)
            for (std::size_t c = 0; c < components; ++c)
                out.push_back(static_cast<double>(i + 100 * j) + 0.25 * static_cast<double>(c));
    return out;
}

struct Sample {
    store::VtiGrid grid{4, 3, {-0.1, 1.0 / 3.0}, {0.05, 2e-5}};
    std::vector<double> U = field(4, 3, 3), height = field(4, 3, 1);
    std::vector<double> bits = {
        0.1,  -0.0, Limits::denorm_min(), Limits::max(),     -Limits::max(), 1.0 / 3.0,
        1e22, -7.0, Limits::min(),        Limits::epsilon(), 5e-324,         not_a_number};

    std::vector<store::VtiArray> arrays() const {
        return {{"U", 3, U}, {"height", 1, height}, {"a<b & \"c\"", 1, bits}};
    }
};

/// The message for the sample with this change.
template<class Change>
std::string refused(Change change) {
    const Scratch scratch;
    const Sample sample;
    store::VtiGrid grid = sample.grid;
    auto arrays = sample.arrays();
    change(grid, arrays);
    const std::string text = error_of<InputError>([&] { store::write_vti(scratch / "a.vti", grid, arrays); });
    CHECK(scratch.entries().empty());
    return text;
}

} // namespace

TEST_CASE("What is no grid is refused, and nothing is left") {
    CHECK(has(refused([](auto& grid, auto&) { grid.nx = 0; }), "a grid of 0 x 3 points"));
    CHECK(has(refused([](auto& grid, auto&) { grid.ny = std::size_t{1} << 31; }), "points; both must be"));
    for (const double bad : {0.0, -1.0, not_a_number, HUGE_VAL})
        CHECK(has(refused([=](auto& grid, auto&) { grid.spacing[1] = bad; }), "spacing is"));
    CHECK(has(refused([](auto& grid, auto&) { grid.origin[0] = not_a_number; }), "origin is nan"));
}

TEST_CASE("What is no field on the grid is refused, and nothing is left") {
    const std::vector<double> bad(12, HUGE_VAL);
    CHECK(has(refused([](auto&, auto& a) { a[0].components = 2; }), "U has 2 components; 1 and 3 are legal"));
    CHECK(has(refused([](auto&, auto& a) { a[1].values = a[1].values.first(11); }),
              "height has 11 values, expected 3 x 4 x 1"));
    CHECK(has(refused([](auto&, auto& a) { a[1].components = 3; }), "has 12 values, expected 3 x 4 x 3"));
    CHECK(has(refused([&](auto&, auto& a) { a[1].values = bad; }), "height has infinite values"));
    CHECK(has(refused([](auto&, auto& a) { a[1].name = "U"; }), "two fields are named U"));
    for (const char* name : {"", "a\nb", "Stäbe"})
        CHECK(has(refused([=](auto&, auto& a) { a[1].name = name; }), "is no name of a field"));
}

TEST_CASE("A grid appears whole or not at all") {
    const Scratch scratch;
    const Sample sample;
    const auto write = [&](const std::string& name) {
        store::write_vti(scratch / name, sample.grid, sample.arrays());
    };
    CHECK(has(error_of<RunError>([&] { write("none/a.vti"); }), "a.vti: cannot write: No such file"));
    scratch.file("a.vti", "old");
    for (const rlim_t bytes : {0, 300, 900})
        CHECK(has(on_small_disk(bytes, [&] { write("a.vti"); }), "a.vti: cannot write: File too large"));
    CHECK(content(scratch / "a.vti") == "old");
    CHECK(on_small_disk(100000, [&] { write("a.vti"); }) == "done");
    CHECK(has(content(scratch / "a.vti"), "</VTKFile>"));
    CHECK(scratch.entries() == std::set<std::string>{"a.vti"});
}

/// RODWAKE_SAMPLES names a folder: grids for another reader.
TEST_CASE("Sample grids for other readers", "[.][vti_samples]") {
    const char* name = std::getenv("RODWAKE_SAMPLES");
    REQUIRE(name);
    const fs::path folder = name;
    const Sample sample;
    store::write_vti(folder / "sample.vti", sample.grid, sample.arrays());
    store::write_vti(folder / "bare.vti", sample.grid, {});
    // One point, two and three: each end of base64 (16, 24 and 32 bytes).
    for (std::size_t n = 1; n <= 3; ++n) {
        const auto values = field(n, 1, 1);
        const std::vector<store::VtiArray> one = {{"f", 1, values}};
        store::write_vti(folder / ("row" + std::to_string(n) + ".vti"), {n, 1, {0, 0}, {1, 1}}, one);
    }
}
