// Result files: what is written is listed again with shapes, units and attributes, and appears whole or not
// at all. Values are read back by another library in tests/cli (h5py).

#include "rodwake/store/hdf5_reader.hpp"
#include "rodwake/store/hdf5_writer.hpp"

#include "rodwake/core/error.hpp"
#include "scratch.hpp"

#include <catch2/catch.hpp>

#include <hdf5.h>

#include <limits>

using namespace rodwake;
using namespace store_test;

namespace {

std::vector<double> read_dataset(const fs::path& path, const char* name) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    REQUIRE(file >= 0);
    const hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
    REQUIRE(data >= 0);
    const hid_t space = H5Dget_space(data);
    std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    REQUIRE(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
    H5Sclose(space);
    H5Dclose(data);
    H5Fclose(file);
    return values;
}

void write_example(store::Hdf5Writer& out) {
    out.attribute("/", "schema", std::int64_t{1});
    out.attribute("/", "title", std::string("zwei Stäbe"));
    out.attribute("/medium", "eta", 1.5);
    out.attribute("/rods/scene", "label", std::string());
    out.dataset("/field/grid/Ux", std::vector<double>{1, 2, 3, 4, 5, 6}, {2, 3}, "f/mu");
    out.dataset("/rods/scene/t", {}, {0}, "s");
}

} // namespace

TEST_CASE("The listing shows groups, shapes, units and attributes") {
    const Scratch scratch;
    store::Hdf5Writer out(scratch / "r.h5");
    write_example(out);
    out.commit();
    const std::string text = store::list_hdf5(scratch / "r.h5");
    INFO(text);
    for (const char* line : {"/  schema = 1  title = \"zwei Stäbe\"\n", "/medium  eta = 1.5\n",
                             "/field/grid\n", "/field/grid/Ux [2][3]  unit = \"f/mu\"\n",
                             "/rods/scene  label = \"\"\n", "/rods/scene/t [0]  unit = \"s\"\n"})
        CHECK(has(text, line));
    CHECK(scratch.entries() == std::set<std::string>{"r.h5"});
}

TEST_CASE("Numbers keep their bits") {
    const Scratch scratch;
    using Limits = std::numeric_limits<double>;
    const std::vector<double> values = {0.1, -0.0, Limits::denorm_min(), Limits::max()};
    store::Hdf5Writer out(scratch / "r.h5");
    out.dataset("/a/b/c", values, {4}, "1");
    out.commit();
    CHECK(read_dataset(scratch / "r.h5", "/a/b/c") == values);
}

TEST_CASE("A column written in parts is that column") {
    const Scratch scratch;
    store::Hdf5Writer out(scratch / "r.h5");
    out.part("/points/x", {}, 0, {5});
    out.part("/points/x", std::vector<double>{3, 4, 5}, 2, {5});
    out.part("/points/x", std::vector<double>{1, 2}, 0, {5});
    out.part("/points/none", {}, 0, {0});
    CHECK_THROWS_AS(out.part("/points/x", std::vector<double>{1, 2}, 4, {5}), RunError);
    out.commit();
    CHECK(read_dataset(scratch / "r.h5", "/points/x") == std::vector<double>{1, 2, 3, 4, 5});
    CHECK(read_dataset(scratch / "r.h5", "/points/none").empty());
}

TEST_CASE("Rows of a table written in parts, of whole rows only, are that table") {
    const Scratch scratch;
    store::Hdf5Writer out(scratch / "r.h5");
    out.part("/frames", std::vector<double>{3, 4, 5, 6}, 1, {3, 2});
    out.part("/frames", std::vector<double>{1, 2}, 0, {3, 2});
    CHECK_THROWS(out.part("/frames", std::vector<double>{1, 2, 3}, 0, {3, 2}));
    out.commit();
    CHECK(read_dataset(scratch / "r.h5", "/frames") == std::vector<double>{1, 2, 3, 4, 5, 6});
}

TEST_CASE("The file appears at commit; without it nothing is left and an old one stands") {
    const Scratch scratch;
    scratch.file("old.h5", "old");
    {
        store::Hdf5Writer out(scratch / "old.h5");
        write_example(out);
        CHECK(content(scratch / "old.h5") == "old");
    }
    CHECK(content(scratch / "old.h5") == "old");
    CHECK(scratch.entries() == std::set<std::string>{"old.h5"});
}

TEST_CASE("What HDF5 refuses is an error") {
    const Scratch scratch;
    CHECK(has(error_of<RunError>([&] { store::Hdf5Writer(scratch / "none/r.h5"); }),
              "cannot write: No such file"));
    store::Hdf5Writer out(scratch / "r.h5");
    out.dataset("/a", std::vector<double>{1.0}, {1}, "1");
    CHECK(
        has(error_of<RunError>([&] { out.dataset("/a", std::vector<double>{1.0}, {1}, "1"); }), "create /a"));
    out.attribute("/g", "n", 1.0);
    CHECK(has(error_of<RunError>([&] { out.attribute("/g", "n", 2.0); }), "create attribute n"));
}

TEST_CASE("Files that are not HDF5 are refused") {
    const Scratch scratch;
    const auto listed = [&](const std::string& name) {
        return error_of<InputError>([&] { store::list_hdf5(scratch / name); });
    };
    scratch.file("text.h5", "text");
    CHECK(has(listed("text.h5"), "text.h5: not a readable HDF5 file"));
    CHECK(has(listed("none.h5"), "none.h5: not a readable HDF5 file"));
    {
        store::Hdf5Writer out(scratch / "whole.h5");
        write_example(out);
        out.commit();
    }
    const std::string whole = content(scratch / "whole.h5");
    scratch.file("cut.h5", whole.substr(0, whole.size() / 2));
    CHECK(has(listed("cut.h5"), "cut.h5: "));
}
