#include "rodwake/store/hdf5_writer.hpp"

#include "hdf5_handle.hpp"

namespace rodwake::store {

namespace {

hid_t create(const std::filesystem::path& path) {
    set_up_hdf5();
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    if (file < 0)
        throw RunError(path.string() + ": HDF5 cannot create the file");
    return file;
}

Hdf5Handle link_with_parents() {
    Hdf5Handle properties(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "set up links");
    H5Pset_create_intermediate_group(properties.get(), 1);
    return Hdf5Handle(H5Pcopy(properties.get()), H5Pclose, "set up links");
}

Hdf5Handle open_group(hid_t file, const std::string& group) {
    if (group == "/" || H5Lexists(file, group.c_str(), H5P_DEFAULT) > 0)
        return Hdf5Handle(H5Gopen2(file, group.c_str(), H5P_DEFAULT), H5Gclose, "open " + group);
    const Hdf5Handle links = link_with_parents();
    return Hdf5Handle(H5Gcreate2(file, group.c_str(), links.get(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                      "create " + group);
}

void write_attribute(hid_t object, const std::string& name, hid_t type, const void* value) {
    const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a scalar");
    const Hdf5Handle attribute(H5Acreate2(object, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose, "create attribute " + name);
    if (H5Awrite(attribute.get(), type, value) < 0)
        throw RunError("HDF5: cannot write attribute " + name);
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
    const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a string type");
    H5Tset_size(type.get(), value.size() + 1);
    H5Tset_cset(type.get(), H5T_CSET_UTF8);
    write_attribute(object, name, type.get(), value.c_str());
}

} // namespace

Hdf5Writer::Hdf5Writer(const std::filesystem::path& target)
    : pending_(target), file_(create(pending_.temporary())) {}

Hdf5Writer::~Hdf5Writer() {
    if (file_ >= 0)
        H5Fclose(file_);
}

void Hdf5Writer::dataset(const std::string& path, std::span<const double> values,
                         const std::vector<std::size_t>& shape, const std::string& unit) {
    const std::vector<hsize_t> extent(shape.begin(), shape.end());
    const Hdf5Handle space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr),
                           H5Sclose, "shape " + path);
    const Hdf5Handle links = link_with_parents();
    const Hdf5Handle data(
        H5Dcreate2(file_, path.c_str(), H5T_IEEE_F64LE, space.get(), links.get(), H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose, "create " + path);
    if (!values.empty() &&
        H5Dwrite(data.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
        throw RunError("HDF5: cannot write " + path);
    write_attribute(data.get(), "unit", unit);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, double value) {
    write_attribute(open_group(file_, group).get(), name, H5T_NATIVE_DOUBLE, &value);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, std::int64_t value) {
    write_attribute(open_group(file_, group).get(), name, H5T_NATIVE_INT64, &value);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, const std::string& value) {
    write_attribute(open_group(file_, group).get(), name, value);
}

void Hdf5Writer::commit() {
    const herr_t closed = H5Fclose(file_);
    file_ = -1;
    if (closed < 0)
        throw RunError("HDF5: cannot finish writing (is the disk full?)");
    pending_.commit();
}

} // namespace rodwake::store
