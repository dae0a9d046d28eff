#include "hdf5_file.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <numeric>

namespace rodwake::store {

namespace {

hid_t create(const std::filesystem::path& path, const std::filesystem::path& target) {
    set_up_hdf5();
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    if (file < 0)
        throw RunError(target.string() + ": HDF5 cannot create the file" + hdf5_reason());
    return file;
}

/// The library tells the system's reason only within a longer text: "... error message = 'File too large',
/// ...".
herr_t find_reason(unsigned, const H5E_error2_t* error, void* found) {
    const std::string text = error->desc ? error->desc : "", mark = "error message = '";
    const auto start = text.find(mark);
    if (start == std::string::npos)
        return 0;
    const auto first = start + mark.size();
    *static_cast<std::string*>(found) = ": " + text.substr(first, text.find('\'', first) - first);
    return 1; // enough
}

void write_in_space(hid_t object, const std::string& name, hid_t type, hid_t space, const void* value) {
    const Hdf5Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose, "create attribute " + name);
    if (H5Awrite(attribute.get(), type, value) < 0)
        throw RunError("HDF5: cannot write attribute " + name + hdf5_reason());
}

void write_row(hid_t object, const std::string& name, hid_t type, hsize_t count, const void* values) {
    const Hdf5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose, "shape attribute " + name);
    write_in_space(object, name, type, space.get(), values);
}

Hdf5Handle string_type(std::size_t size) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, size);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return Hdf5Handle(type, H5Tclose, "make a string type");
}

} // namespace

std::string hdf5_reason() {
    std::string found;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, find_reason, &found);
    return found;
}

Hdf5File::Hdf5File(const std::filesystem::path& target)
    : pending_(target), target_(target), file_(create(pending_.temporary(), target)) {}

Hdf5File::~Hdf5File() {
    if (file_ >= 0)
        H5Fclose(file_);
}

void Hdf5File::flush() {
    if (H5Fflush(file_, H5F_SCOPE_LOCAL) < 0)
        throw RunError(target_.string() + ": HDF5 cannot write the file" + hdf5_reason());
}

void Hdf5File::commit() {
    flush();
    const herr_t closed = H5Fclose(file_);
    file_ = -1;
    if (closed < 0)
        throw RunError(target_.string() + ": HDF5 cannot finish writing the file" + hdf5_reason());
    pending_.commit();
}

Hdf5Handle link_with_parents() {
    const hid_t properties = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(properties, 1);
    return Hdf5Handle(properties, H5Pclose, "set up links");
}

Hdf5Handle open_group(hid_t file, const std::string& group) {
    if (group == "/" || H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0)
        return Hdf5Handle(H5Gopen2(file, group.c_str(), H5P_DEFAULT), H5Gclose, "open " + group);
    const Hdf5Handle links = link_with_parents();
    return Hdf5Handle(H5Gcreate2(file, group.c_str(), links.get(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                      "create " + group);
}

Hdf5Handle write_dataset(hid_t file, const std::string& path, hid_t type, const std::vector<hsize_t>& extent,
                         const void* values) {
    const bool empty = std::ranges::find(extent, hsize_t{0}) != extent.end();
    const Hdf5Handle space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr),
                           H5Sclose, "shape " + path);
    const Hdf5Handle links = link_with_parents();
    const hid_t data =
        H5Dcreate2(file, path.c_str(), type, space.get(), links.get(), H5P_DEFAULT, H5P_DEFAULT);
    if (data >= 0 && !empty && H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
        const std::string reason = hdf5_reason();
        H5Dclose(data);
        throw RunError("HDF5: cannot write " + path + reason);
    }
    return Hdf5Handle(data, H5Dclose, "create " + path);
}

namespace {

void make_dataset(hid_t file, const std::string& path, const std::vector<hsize_t>& extent,
                  const std::string& unit) {
    const Hdf5Handle space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr),
                           H5Sclose, "shape " + path);
    const Hdf5Handle links = link_with_parents();
    const Hdf5Handle data(
        H5Dcreate2(file, path.c_str(), H5T_IEEE_F64LE, space.get(), links.get(), H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose, "create " + path);
    if (!unit.empty())
        write_attribute(data.get(), "unit", unit);
}

} // namespace

void write_part(hid_t file, const std::string& path, std::span<const double> values, hsize_t first,
                const std::vector<hsize_t>& extent, const std::string& unit) {
    if (H5Lexists(file, path.c_str(), H5P_DEFAULT) <= 0)
        make_dataset(file, path, extent, unit);
    if (values.empty())
        return;
    const Hdf5Handle data(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
    const hsize_t row =
        std::accumulate(extent.begin() + 1, extent.end(), hsize_t{1}, std::multiplies<hsize_t>());
    if (row == 0 || values.size() % row != 0)
        throw RunError(fmt::format("HDF5: {}: {} values are no whole rows of {}", path, values.size(), row));
    std::vector<hsize_t> start(extent.size(), 0), count = extent;
    start[0] = first;
    count[0] = values.size() / row;
    const Hdf5Handle there(H5Dget_space(data.get()), H5Sclose, "read the shape of " + path);
    const Hdf5Handle here(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose,
                          "shape a part of " + path);
    if (H5Sselect_hyperslab(there.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
        H5Dwrite(data.get(), H5T_NATIVE_DOUBLE, here.get(), there.get(), H5P_DEFAULT, values.data()) < 0)
        throw RunError("HDF5: cannot write " + path + hdf5_reason());
}

void write_attribute(hid_t object, const std::string& name, hid_t type, const void* value) {
    const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a scalar");
    write_in_space(object, name, type, space.get(), value);
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
    const Hdf5Handle type = string_type(value.size() + 1);
    write_attribute(object, name, type.get(), value.c_str());
}

void write_attribute(hid_t object, const std::string& name, double value) {
    write_attribute(object, name, H5T_NATIVE_DOUBLE, &value);
}

void write_attribute(hid_t object, const std::string& name, std::span<const std::int32_t> values) {
    write_row(object, name, H5T_NATIVE_INT32, values.size(), values.data());
}

void write_attribute(hid_t object, const std::string& name, std::span<const std::string> values) {
    std::size_t longest = 0;
    for (const std::string& value : values)
        longest = std::max(longest, value.size());
    std::string table(values.size() * (longest + 1), '\0');
    for (std::size_t i = 0; i < values.size(); ++i)
        std::ranges::copy(values[i], table.begin() + static_cast<std::ptrdiff_t>(i * (longest + 1)));
    write_row(object, name, string_type(longest + 1).get(), values.size(), table.data());
}

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
