#pragma once
// An HDF5 file opened for reading, its datasets and attributes. Whatever is missing, damaged or of another
// kind is an InputError that names the file, says what was found and what to do next.

#include "hdf5_handle.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rodwake::store {

class Hdf5Input {
public:
    /// `advice` ends every message: what to do next.
    Hdf5Input(std::filesystem::path path, std::string advice);

    hid_t get() const { return file_.get(); }
    [[noreturn]] void refuse(const std::string& what) const;
    /// The handle, or an InputError that says what could not be done.
    Hdf5Handle handle(hid_t id, Hdf5Handle::Close close, const std::string& doing) const;
    bool has(const std::string& path) const;

private:
    std::filesystem::path path_;
    std::string advice_;
    Hdf5Handle file_;
};

/// H5Fopen for reading; of a file system that has no locks without one. The usual way comes first: who else
/// in this process has the file open (h5py shares the library) has opened it so, and both have to agree.
hid_t open_for_reading(const std::filesystem::path& path);

/// False if HDF5 crashes on what is in the file, or does not come to an end: a child process looks first.
bool hdf5_survives(const std::filesystem::path& path);

/// A dataset of numbers of one type, which is that of the file: values come bit for bit. Whole numbers of any
/// size, and of an enumeration, come as H5T_NATIVE_INT64 if asked for as such, and numbers of any kind as
/// H5T_NATIVE_DOUBLE. Must not outlive the file.
class Hdf5Table {
public:
    Hdf5Table(const Hdf5Input& file, std::string path, hid_t type);

    const std::vector<hsize_t>& shape() const { return shape_; }
    std::size_t size() const; ///< of all elements
    void want_shape(const std::vector<hsize_t>& wanted) const;
    void read(void* values) const;
    /// `count` entries of the first dimension from `first` on.
    void read_rows(hsize_t first, hsize_t count, void* values) const;
    hid_t get() const { return data_.get(); }

private:
    const Hdf5Input* file_;
    std::string path_;
    hid_t type_;
    Hdf5Handle data_, space_;
    std::vector<hsize_t> shape_;
};

/// Numbers of all elements; InputError if one is not finite, but for NaN where that may stand for unknown.
std::vector<double> read_numbers(const Hdf5Input& file, const std::string& path, const Hdf5Table& table,
                                 bool or_unknown);

/// Attributes of the group or dataset `owner`. The number must be a double, an int64 or a uint64 in the file.
double real_attribute(const Hdf5Input& file, const std::string& owner, const std::string& name);
std::int64_t integer_attribute(const Hdf5Input& file, const std::string& owner, const std::string& name);
std::uint64_t unsigned_attribute(const Hdf5Input& file, const std::string& owner, const std::string& name);
/// One text or a list of texts.
std::vector<std::string> text_attribute(const Hdf5Input& file, const std::string& owner,
                                        const std::string& name);
/// Names of the attributes of `owner` that are one double each, in the order of the alphabet.
std::vector<std::string> real_attributes(const Hdf5Input& file, const std::string& owner);

} // namespace rodwake::store
