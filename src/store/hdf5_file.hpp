#pragma once
// An HDF5 file that appears at commit, and the few calls everything in it is made of.

#include "hdf5_handle.hpp"
#include "rodwake/store/atomic_file.hpp"

#include <span>
#include <vector>

namespace rodwake::store {

class Hdf5File {
public:
    explicit Hdf5File(const std::filesystem::path& target);
    ~Hdf5File();
    Hdf5File(const Hdf5File&) = delete;
    Hdf5File& operator=(const Hdf5File&) = delete;
    Hdf5File(Hdf5File&&) = delete;
    Hdf5File& operator=(Hdf5File&&) = delete;
    hid_t get() const { return file_; }

    /// Everything handed to HDF5 is with the system afterwards. Throws RunError with the system's reason.
    void flush();
    /// Closes and renames. Handles to objects of the file must be closed before. Throws RunError.
    void commit();

private:
    PendingFile pending_;
    std::filesystem::path target_;
    hid_t file_;
};

/// Makes the groups on the way to what is created.
Hdf5Handle link_with_parents();
/// Made if it is not there.
Hdf5Handle open_group(hid_t file, const std::string& group);

/// A dataset of these extents (none: a scalar); no data if there are no elements.
Hdf5Handle write_dataset(hid_t file, const std::string& path, hid_t type, const std::vector<hsize_t>& extent,
                         const void* values);

/// Whole rows, from `first` on, of a dataset of this extent, made if it is not there; an empty unit is left
/// out. Throws RunError.
void write_part(hid_t file, const std::string& path, std::span<const double> values, hsize_t first,
                const std::vector<hsize_t>& extent, const std::string& unit);

void write_attribute(hid_t object, const std::string& name, hid_t type, const void* value);
/// Of fixed length.
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_attribute(hid_t object, const std::string& name, double value);
/// One-dimensional; strings of fixed length.
void write_attribute(hid_t object, const std::string& name, std::span<const std::int32_t> values);
void write_attribute(hid_t object, const std::string& name, std::span<const std::string> values);

/// A dataset that grows along its first dimension, row by row.
class Hdf5Series {
public:
    struct Layout {
        hid_t type;                ///< in memory and in the file
        std::vector<hsize_t> item; ///< extents of a row; none: a number
        hsize_t chunk_rows;
        bool deflate; ///< shuffled and deflated
    };
    Hdf5Series(hid_t file, const std::string& path, const Layout& layout);

    /// `row` has the elements of a row in C order. Throws RunError with the system's reason.
    void append(const void* row);

private:
    std::string path_;
    hid_t type_;
    std::vector<hsize_t> extent_; ///< of the whole
    Hdf5Handle data_;
};

} // namespace rodwake::store
