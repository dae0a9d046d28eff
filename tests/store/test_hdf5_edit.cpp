// The helpers that spoil files must do it, or fail.

#include "hdf5_edit.hpp"
#include "stored_frames.hpp"

#include <catch2/catch.hpp>

#include <cstdio>

using namespace store_test;

TEST_CASE("Hdf5Edit fails where it cannot do its work") {
    const Scratch scratch;
    scratch.file("text", "text");
    CHECK_THROWS(Hdf5Edit(scratch / "text"));
    CHECK_THROWS(Hdf5Edit(scratch / "none"));
    write_h5md(scratch / "t", SampleFrames());
    const std::string species = "particles/trajectory/species";
    {
        const Hdf5Edit file(scratch / "t");
        CHECK_THROWS(file.remove("none"));
        CHECK_THROWS(file.remove_attribute("parameters", "none"));
        CHECK_THROWS(file.set("none", 0, 1.0));
        CHECK_THROWS(file.set(species, 15, 1.0));
        CHECK_THROWS(file.resize("particles/trajectory/mass", 3)); // of fixed size
        CHECK_THROWS(file.replace("none", H5T_IEEE_F64LE, {1}));
        CHECK_THROWS(file.attribute("none", "a", H5T_NATIVE_INT32, nullptr));
        CHECK_THROWS(file.link("none", "other"));
        CHECK_THROWS(file.chunk("particles/trajectory/velocity/value", 4)); // it has four
    }
    CHECK(holds(scratch / "t", SampleFrames()));
}

TEST_CASE("What is printed to the standard error is seen") {
    CHECK(printed_to_error([] { std::fputs("text", stderr); }) == "text");
    CHECK(printed_to_error([] {}).empty());
    const Scratch scratch;
    const auto unasked = [&] { // HDF5 prints errors unless it is silenced
        H5Eset_auto2(H5E_DEFAULT, reinterpret_cast<H5E_auto2_t>(H5Eprint2), stderr);
        H5Fopen((scratch / "none").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    };
    CHECK_FALSE(printed_to_error(unasked).empty());
}
