#pragma once
// A dataset that grows along its first dimension, row by row.

#include "hdf5_handle.hpp"

#include <vector>

namespace rodwake::store {

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
