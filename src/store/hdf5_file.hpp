#pragma once
// An HDF5 file that appears at commit, and the few calls everything in it is made of.
//
// HDF5 writes when it likes, so a write that failed may show only when something is closed, or not at all.
// All that was written is closed explicitly; datasets carry the checksum of their bytes; and before the file
// gets its name it is opened again and read.

#include "descriptor.hpp"
#include "hdf5_handle.hpp"
#include "rodwake/store/atomic_file.hpp"

#include <optional>
#include <span>
#include <vector>

namespace rodwake::store {

/// Attribute of a dataset: XXH3-64 of its bytes in C order, in hexadecimal.
inline constexpr const char* checksum_name = "xxh3";
std::string checksum_text(std::uint64_t checksum);

/// Rows of a dataset as they were written; a scalar is one.
struct WrittenRows {
    std::string path;
    hid_t type;
    hsize_t first, count;
    std::uint64_t checksum;
};

class Hdf5File {
public:
    explicit Hdf5File(const std::filesystem::path& target);
    ~Hdf5File();
    Hdf5File(const Hdf5File&) = delete;
    Hdf5File& operator=(const Hdf5File&) = delete;
    Hdf5File(Hdf5File&&) = delete;
    Hdf5File& operator=(Hdf5File&&) = delete;
    hid_t get() const { return file_; }

    /// A dataset of these extents (none: a scalar), of a type that is the same in memory and in the file; no
    /// data if there are no elements. Throws RunError.
    void dataset(const std::string& path, hid_t type, const std::vector<hsize_t>& extent, const void* values,
                 const std::optional<std::string>& unit = std::nullopt);

    /// Whole rows, from `first` on, of a dataset of this extent, made if it is not there. Throws RunError.
    void part(const std::string& path, std::span<const double> values, hsize_t first,
              const std::vector<hsize_t>& extent, const std::string& unit);

    /// What commit() looks for when it reads back.
    void expect(const std::vector<WrittenRows>& rows);

    /// Closes, reads back and renames. Handles to objects of the file must be closed before. Throws RunError.
    void commit();

private:
    PendingFile pending_;
    std::filesystem::path target_;
    hid_t file_;
    std::vector<WrittenRows> expected_;
};

/// Made if it is not there.
Hdf5Handle open_group(hid_t file, const std::string& group);

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
    struct ElementLayout {
        hid_t type;                ///< in memory and in the file
        std::vector<hsize_t> item; ///< extents of a row; none: a number
        hsize_t chunk_rows;
        bool deflate; ///< shuffled and deflated
    };
    Hdf5Series(hid_t file, const std::string& path, const ElementLayout& layout);

    /// `row` has the elements of a row in C order. Throws RunError with the system's reason.
    void append(const void* row);
    /// Ends the dataset; some of its rows, the first and the last among them, to be looked for. Throws
    /// RunError.
    std::vector<WrittenRows> close();

private:
    std::string path_;
    hid_t type_;
    std::vector<hsize_t> extent_;          ///< of the whole
    std::vector<std::uint64_t> checksums_; ///< of the rows
    Hdf5Handle data_;
};

} // namespace rodwake::store
