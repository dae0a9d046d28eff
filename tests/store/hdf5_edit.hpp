#pragma once
// Spoils HDF5 files on purpose: takes things away, changes numbers, shapes and types. And what a piece of
// work prints to the standard error.

#include "scratch.hpp"

#include <hdf5.h>

#include <cstdio>
#include <functional>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace store_test {

/// Each call throws if it cannot do its work, so that no test takes a whole file for a spoilt one.
class Hdf5Edit {
public:
    explicit Hdf5Edit(const fs::path& path) : file_(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT)) {
        want(file_ >= 0, "open", path.string());
    }
    ~Hdf5Edit() { H5Fclose(file_); }
    Hdf5Edit(const Hdf5Edit&) = delete;
    Hdf5Edit& operator=(const Hdf5Edit&) = delete;
    Hdf5Edit(Hdf5Edit&&) = delete;
    Hdf5Edit& operator=(Hdf5Edit&&) = delete;

    void remove(const std::string& path) const {
        want(H5Ldelete(file_, path.c_str(), H5P_DEFAULT) >= 0, "remove", path);
    }
    /// The object gets another name besides its own.
    void link(const std::string& path, const std::string& name) const {
        want(H5Lcreate_hard(file_, path.c_str(), file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT) >= 0, "link",
             path);
    }
    void remove_attribute(const std::string& owner, const std::string& name) const {
        want(H5Adelete_by_name(file_, owner.c_str(), name.c_str(), H5P_DEFAULT) >= 0, "remove", name);
    }
    /// One element, counted in C order; the checksum goes.
    void set(const std::string& path, std::size_t index, double value) const {
        with_dataset(path, [&](hid_t data) {
            std::vector<double> all(count(data));
            want(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) >= 0, "read",
                 path);
            all.at(index) = value;
            if (H5Aexists(data, "xxh3") > 0)
                want(H5Adelete(data, "xxh3") >= 0, "remove checksum of", path);
            want(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) >= 0, "write",
                 path);
        });
    }
    /// Rows `a` and `b` of frame `frame` change places.
    void swap(const std::string& path, std::size_t frame, std::size_t a, std::size_t b) const {
        with_dataset(path, [&](hid_t data) {
            const hid_t space = H5Dget_space(data);
            std::vector<hsize_t> extent(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
            H5Sget_simple_extent_dims(space, extent.data(), nullptr);
            H5Sclose(space);
            const std::size_t width = extent.size() > 2 ? extent[2] : 1, first = frame * extent.at(1) * width;
            std::vector<double> all(count(data));
            want(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) >= 0, "read",
                 path);
            for (std::size_t k = 0; k < width; ++k)
                std::swap(all.at(first + a * width + k), all.at(first + b * width + k));
            want(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) >= 0, "write",
                 path);
        });
    }
    void scale(const std::string& path, double factor) const {
        with_dataset(path, [&](hid_t data) {
            std::vector<double> all(count(data));
            want(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) >= 0, "read",
                 path);
            for (double& one : all)
                one *= factor;
            want(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) >= 0, "write",
                 path);
        });
    }
    void text_attribute(const std::string& owner, const std::string& name, const std::string& text) const {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, text.size());
        attribute(owner, name, type, text.data());
        H5Tclose(type);
    }
    /// Of the first dimension; what is new is zero and not written.
    void resize(const std::string& path, hsize_t rows) const {
        with_dataset(path, [&](hid_t data) {
            const hid_t space = H5Dget_space(data);
            std::vector<hsize_t> extent(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
            H5Sget_simple_extent_dims(space, extent.data(), nullptr);
            H5Sclose(space);
            extent.at(0) = rows;
            want(H5Dset_extent(data, extent.data()) >= 0, "resize", path);
        });
    }
    /// By ones of this type and shape.
    void replace(const std::string& path, hid_t type, const std::vector<hsize_t>& shape) const {
        remove(path);
        const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
        const hid_t data =
            H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        want(data >= 0, "replace", path);
        const std::vector<double> ones(count(data), 1.0);
        want(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, ones.data()) >= 0, "write",
             path);
        H5Dclose(data);
        H5Sclose(space);
    }
    /// In place of one of the same name.
    void attribute(const std::string& owner, const std::string& name, hid_t type, const void* value,
                   hsize_t count = 1) const {
        if (H5Aexists_by_name(file_, owner.c_str(), name.c_str(), H5P_DEFAULT) > 0)
            remove_attribute(owner, name);
        const hid_t space = H5Screate_simple(1, &count, nullptr);
        const hid_t made = H5Acreate_by_name(file_, owner.c_str(), name.c_str(), type, space, H5P_DEFAULT,
                                             H5P_DEFAULT, H5P_DEFAULT);
        want(made >= 0 && H5Awrite(made, type, value) >= 0, "write attribute", name);
        H5Aclose(made);
        H5Sclose(space);
    }
    /// Where the stored bytes of chunk `index` of a dataset are in the file.
    std::pair<std::size_t, std::size_t> chunk(const std::string& path, hsize_t index) const {
        haddr_t address = 0;
        hsize_t size = 0;
        with_dataset(path, [&](hid_t data) {
            const hid_t space = H5Dget_space(data);
            std::vector<hsize_t> start(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
            unsigned mask = 0;
            want(H5Dget_chunk_info(data, space, index, start.data(), &mask, &address, &size) >= 0 &&
                     address != HADDR_UNDEF,
                 "find", path);
            H5Sclose(space);
        });
        return {address, size};
    }

private:
    hid_t file_;

    static void want(bool done, const std::string& doing, const std::string& what) {
        if (!done)
            throw std::runtime_error("cannot " + doing + " " + what);
    }
    static std::size_t count(hid_t data) {
        const hid_t space = H5Dget_space(data);
        const auto points = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
        H5Sclose(space);
        return points;
    }
    void with_dataset(const std::string& path, const std::function<void(hid_t)>& work) const {
        const hid_t data = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
        want(data >= 0, "open", path);
        work(data);
        H5Dclose(data);
    }
};

/// What the work prints to the standard error, of this program and of its libraries.
template<class Work>
std::string printed_to_error(Work work) {
    const Scratch scratch;
    std::fflush(stderr);
    const int kept = ::dup(2);
    std::FILE* const file = std::fopen((scratch / "err").c_str(), "w");
    ::dup2(::fileno(file), 2);
    work();
    std::fflush(stderr);
    ::dup2(kept, 2);
    ::close(kept);
    std::fclose(file);
    return content(scratch / "err");
}

} // namespace store_test
