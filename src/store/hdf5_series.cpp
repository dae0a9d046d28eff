#include "hdf5_series.hpp"

#include "hdf5_file.hpp"

namespace rodwake::store {

namespace {

std::vector<hsize_t> with_rows(hsize_t rows, const std::vector<hsize_t>& item) {
    std::vector<hsize_t> extent = {rows};
    extent.insert(extent.end(), item.begin(), item.end());
    return extent;
}

Hdf5Handle storage(const Hdf5Series::Layout& layout) {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const std::vector<hsize_t> chunk = with_rows(layout.chunk_rows, layout.item);
    H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
    if (layout.deflate) {
        H5Pset_shuffle(properties);
        H5Pset_deflate(properties, 6);
    }
    return Hdf5Handle(properties, H5Pclose, "set up chunks");
}

hid_t create(hid_t file, const std::string& path, const Hdf5Series::Layout& layout) {
    const std::vector<hsize_t> none = with_rows(0, layout.item), any = with_rows(H5S_UNLIMITED, layout.item);
    const Hdf5Handle space(H5Screate_simple(static_cast<int>(none.size()), none.data(), any.data()), H5Sclose,
                           "shape " + path);
    const Hdf5Handle links = link_with_parents(), properties = storage(layout);
    return H5Dcreate2(file, path.c_str(), layout.type, space.get(), links.get(), properties.get(),
                      H5P_DEFAULT);
}

} // namespace

Hdf5Series::Hdf5Series(hid_t file, const std::string& path, const Layout& layout)
    : path_(path), type_(layout.type), extent_(with_rows(0, layout.item)),
      data_(create(file, path, layout), H5Dclose, "create " + path) {}

void Hdf5Series::append(const void* row) {
    std::vector<hsize_t> start(extent_.size(), 0), count = extent_;
    start[0] = extent_[0]++;
    count[0] = 1;
    if (H5Dset_extent(data_.get(), extent_.data()) < 0)
        throw RunError("HDF5: cannot extend " + path_ + hdf5_reason());
    const Hdf5Handle file_space(H5Dget_space(data_.get()), H5Sclose, "read the shape of " + path_);
    const Hdf5Handle row_space(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                               H5Sclose, "shape a row of " + path_);
    H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
    if (H5Dwrite(data_.get(), type_, row_space.get(), file_space.get(), H5P_DEFAULT, row) < 0)
        throw RunError("HDF5: cannot write " + path_ + hdf5_reason());
}

} // namespace rodwake::store
