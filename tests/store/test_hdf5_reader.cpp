// Result files read back: bit for bit what was written, and an error that names the file for everything else.

#include "rodwake/store/hdf5_reader.hpp"
#include "rodwake/store/hdf5_writer.hpp"

#include "hdf5_edit.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <hdf5.h>

#include <atomic>
#include <bit>
#include <chrono>
#include <cstring>
#include <limits>
#include <thread>

using namespace rodwake;
using namespace store_test;

namespace {

using Limits = std::numeric_limits<double>;
const std::vector<double> values = {0.1, -0.0, Limits::denorm_min(), Limits::max(), -1.0 / 3.0, 6.0};

void write_example(const fs::path& path) {
    store::Hdf5Writer out(path);
    out.attribute("/", "schema", std::int64_t{-7});
    out.attribute("/", "title", std::string("zwei Stäbe"));
    out.attribute("/", "empty", std::string());
    out.attribute("/medium", "eta", 1.5);
    out.dataset("/field/grid/Ux", values, {2, 3}, "f/mu");
    out.dataset("/row", std::span(values).first(4), {4}, "m");
    out.dataset("/none", {}, {0, 3}, "s");
    out.commit();
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// The message of what the example, spoilt like this, is asked for.
template<class Spoil, class Ask>
std::string message(const Scratch& scratch, Spoil spoil, Ask ask) {
    write_example(scratch / "r.h5");
    spoil(Hdf5Edit(scratch / "r.h5"));
    const store::Hdf5Reader in(scratch / "r.h5");
    const std::string text = error_of<InputError>([&] { ask(in); });
    CHECK(has(text, (scratch / "r.h5").string() + ": "));
    CHECK(has(text, "; give a result file as rodwake writes it"));
    return text;
}

const auto as_it_is = [](const Hdf5Edit&) {};

} // namespace

TEST_CASE("Datasets come back with their bits, shapes and units") {
    const Scratch scratch;
    write_example(scratch / "r.h5");
    const store::Hdf5Reader in(scratch / "r.h5");
    const store::Hdf5Dataset grid = in.dataset("/field/grid/Ux"), row = in.dataset("/row"),
                             none = in.dataset("/none");
    CHECK(same_bits(grid.values, values));
    CHECK(grid.shape == std::vector<std::size_t>{2, 3});
    CHECK(grid.unit == "f/mu");
    CHECK(same_bits(row.values, {values.begin(), values.begin() + 4}));
    CHECK_FALSE(same_bits(row.values, {0.1, 0.0, values[2], values[3]})); // a sign of zero is seen
    CHECK_FALSE(same_bits(row.values, values));
    CHECK(row.shape == std::vector<std::size_t>{4});
    CHECK(row.unit == "m");
    CHECK(none.values.empty());
    CHECK(none.shape == std::vector<std::size_t>{0, 3});
}

TEST_CASE("Attributes come back, and what is there is known") {
    const Scratch scratch;
    write_example(scratch / "r.h5");
    store::Hdf5Reader opened(scratch / "r.h5");
    const store::Hdf5Reader in = std::move(opened);
    CHECK(in.integer("/", "schema") == -7);
    CHECK(in.text("/", "title") == "zwei Stäbe");
    CHECK(in.text("/", "empty").empty());
    CHECK(in.real("/medium", "eta") == 1.5);
    for (const char* path : {"/", "/field", "/field/grid/Ux", "/medium"})
        CHECK(in.has(path));
    for (const char* path : {"/fiel", "/field/grid/Ux/a", "/no/such/thing"})
        CHECK_FALSE(in.has(path));
}

TEST_CASE("Texts of other writers, which are of variable length, are read") {
    const Scratch scratch;
    write_example(scratch / "r.h5");
    {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, H5T_VARIABLE);
        const char* text = "von anderswo";
        Hdf5Edit(scratch / "r.h5").attribute("/row", "unit", type, &text);
        H5Tclose(type);
    }
    CHECK(store::Hdf5Reader(scratch / "r.h5").dataset("/row").unit == "von anderswo");
}

TEST_CASE("What is missing or of another kind is named") {
    const Scratch scratch;
    using In = store::Hdf5Reader;
    const auto asked = [&](auto ask) { return message(scratch, as_it_is, ask); };
    CHECK(has(asked([](const In& in) { in.dataset("/a/b"); }), "dataset /a/b is missing"));
    CHECK(has(asked([](const In& in) { in.dataset("/field"); }), "cannot open dataset /field"));
    CHECK(has(asked([](const In& in) { in.dataset("/"); }), "cannot open dataset /"));
    CHECK(has(asked([](const In& in) { in.real("/medium", "nu"); }), "attribute nu of /medium is missing"));
    CHECK(has(asked([](const In& in) { in.real("/mediun", "nu"); }), "attribute nu of /mediun is missing"));
    CHECK(has(asked([](const In& in) { in.real("/", "schema"); }), "schema of / is not one double"));
    CHECK(has(asked([](const In& in) { in.integer("/medium", "eta"); }), "is not one integer of 64 bits"));
    CHECK(has(asked([](const In& in) { in.integer("/", "title"); }), "is not one integer of 64 bits"));
    CHECK(has(asked([](const In& in) { in.text("/medium", "eta"); }), "eta of /medium is not a text"));
}

TEST_CASE("Datasets that are spoilt are refused") {
    const Scratch scratch;
    const auto row = [](const store::Hdf5Reader& in) { in.dataset("/row"); };
    const auto spoilt = [&](auto spoil) { return message(scratch, spoil, row); };
    CHECK(has(spoilt([](const Hdf5Edit& f) { f.set("/row", 2, Limits::quiet_NaN()); }),
              "/row holds values that are not finite"));
    CHECK(has(spoilt([](const Hdf5Edit& f) { f.remove_attribute("/row", "unit"); }),
              "attribute unit of /row is missing"));
    CHECK(has(spoilt([](const Hdf5Edit& f) { f.replace("/row", H5T_IEEE_F32LE, {4}); }),
              "/row holds values of another type"));
    const double two[] = {1.0, Limits::infinity()};
    CHECK(has(spoilt([&](const Hdf5Edit& f) { f.attribute("/row", "unit", H5T_NATIVE_DOUBLE, two); }),
              "unit of /row is not a text"));
    CHECK(has(spoilt([&](const Hdf5Edit& f) { f.attribute("/row", "unit", H5T_C_S1, "ms", 2); }),
              "unit of /row is a list of texts, expected one"));
    const auto eta = [](const store::Hdf5Reader& in) { in.real("/medium", "eta"); };
    const auto set_eta = [&](const double* value, hsize_t count) {
        return [=](const Hdf5Edit& f) { f.attribute("/medium", "eta", H5T_NATIVE_DOUBLE, value, count); };
    };
    CHECK(has(message(scratch, set_eta(two, 2), eta), "eta of /medium is not one double"));
    CHECK(has(message(scratch, set_eta(two + 1, 1), eta), "eta of /medium is not finite"));
}

TEST_CASE("Files that are not HDF5, or not whole, are refused in silence") {
    const Scratch scratch;
    const auto opened = [&](const std::string& name) {
        return error_of<InputError>([&] { store::Hdf5Reader(scratch / name).dataset("/row"); });
    };
    write_example(scratch / "whole");
    const std::string whole = content(scratch / "whole");
    CHECK(printed_to_error([&] {
              scratch.file("text", "text");
              CHECK(has(opened("text"), "text: not a readable HDF5 file; give"));
              CHECK(has(opened("none"), "none: no such file; give"));
              for (std::size_t length = 0; length < whole.size(); length += 61) {
                  scratch.file("cut", whole.substr(0, length));
                  CHECK(has(opened("cut"), "cut: "));
              }
          }).empty());
}

TEST_CASE("A value that is not the one that was written is refused") {
    const Scratch scratch;
    const auto with = [&](auto spoil) {
        write_example(scratch / "r.h5");
        std::string bytes = content(scratch / "r.h5");
        const double wanted = -1.0 / 3.0; // in the grid alone
        const auto at = bytes.find(std::string(reinterpret_cast<const char*>(&wanted), sizeof wanted));
        REQUIRE(at != std::string::npos);
        bytes[at] = static_cast<char>(bytes[at] ^ 1); // a last digit
        scratch.file("r.h5", bytes);
        spoil(Hdf5Edit(scratch / "r.h5"));
        return store::Hdf5Reader(scratch / "r.h5").dataset("/field/grid/Ux").values[4];
    };
    CHECK(
        has(error_of<InputError>([&] { with(as_it_is); }), "/field/grid/Ux is damaged: its values are not"));
    CHECK(with([](const Hdf5Edit& f) { f.remove_attribute("/field/grid/Ux", "xxh3"); }) ==
          Approx(-1.0 / 3.0).epsilon(1e-9));
}

TEST_CASE("What lies in another file is not read") {
    const Scratch scratch;
    write_example(scratch / "other.h5");
    write_example(scratch / "r.h5");
    {
        const hid_t file = H5Fopen((scratch / "r.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        REQUIRE(H5Lcreate_external("other.h5", "/field", file, "link", H5P_DEFAULT, H5P_DEFAULT) >= 0);
        const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
        REQUIRE(H5Pset_external(made, (scratch / "other.h5").c_str(), 0, 32) >= 0);
        const hsize_t four = 4;
        const hid_t space = H5Screate_simple(1, &four, nullptr);
        H5Dclose(H5Dcreate2(file, "outside", H5T_IEEE_F64LE, space, H5P_DEFAULT, made, H5P_DEFAULT));
        H5Sclose(space);
        H5Pclose(made);
        H5Fclose(file);
    }
    const store::Hdf5Reader in(scratch / "r.h5");
    CHECK(in.dataset("/row").values.size() == 4);
    CHECK_THROWS_AS(in.dataset("/link/grid/Ux"), InputError);
    CHECK(has(error_of<InputError>([&] { in.dataset("/outside"); }), "has its values in another file"));
}

TEST_CASE("A changed byte takes the file with it, not the program") {
    const Scratch scratch;
    write_example(scratch / "whole.h5");
    const std::string whole = content(scratch / "whole.h5");
    std::size_t refused = 0;
    for (std::size_t place = 9; place < whole.size(); place += whole.size() / 97) {
        std::string bytes = whole;
        bytes[place] = static_cast<char>(~bytes[place]);
        scratch.file("r.h5", bytes);
        try {
            store::list_hdf5(scratch / "r.h5");
            store::Hdf5Reader(scratch / "r.h5").dataset("/row");
        } catch (const InputError&) {
            ++refused;
        }
    }
    CHECK(refused > 0);
}

TEST_CASE("Files are opened while others are inside HDF5, by themselves or by rodwake") {
    const Scratch scratch;
    write_example(scratch / "other.h5");
    std::atomic<bool> done = false;
    std::thread other([&] { // as h5py may be
        while (!done) {
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            H5Fclose(H5Fopen((scratch / "other.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
        }
    });
    std::vector<std::thread> team;
    std::atomic<int> whole = 0;
    for (int number = 0; number < 2; ++number)
        team.emplace_back([&, number] {
            const auto path = scratch / fmt::format("{}.h5", number);
            for (int round = 0; round < 10; ++round) {
                write_example(path);
                whole += store::Hdf5Reader(path).dataset("/row").values.size() == 4;
            }
        });
    for (std::thread& one : team)
        one.join();
    done = true;
    other.join();
    CHECK(whole == 20);
}
