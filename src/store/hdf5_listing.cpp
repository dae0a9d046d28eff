#include "rodwake/store/hdf5_reader.hpp"

#include "hdf5_handle.hpp"

#include <fmt/format.h>
#include <vector>

namespace rodwake::store {

namespace {

/// One string, or several as a list.
std::string string_attribute(hid_t attribute, hid_t type, std::size_t count) {
    if (H5Tis_variable_str(type) > 0)
        return "(variable-length string)";
    const std::size_t size = H5Tget_size(type);
    std::string table(size * count, '\0');
    if (H5Aread(attribute, type, table.data()) < 0)
        throw RunError("HDF5: cannot read an attribute");
    std::vector<std::string> values;
    for (std::size_t i = 0; i < count; ++i)
        values.push_back(fmt::format("\"{}\"", std::string(table.substr(i * size, size).c_str())));
    return fmt::format("{}", fmt::join(values, ", "));
}

std::string attribute_value(hid_t attribute) {
    const Hdf5Handle type(H5Aget_type(attribute), H5Tclose, "read an attribute's type");
    const Hdf5Handle space(H5Aget_space(attribute), H5Sclose, "read an attribute's shape");
    const hssize_t count = H5Sget_simple_extent_npoints(space.get());
    if (H5Tget_class(type.get()) == H5T_STRING && count >= 0)
        return string_attribute(attribute, type.get(), static_cast<std::size_t>(count));
    if (count != 1)
        return "(array)";
    double value = 0.0;
    H5Aread(attribute, H5T_NATIVE_DOUBLE, &value);
    return fmt::format("{}", value);
}

/// An exception must not cross HDF5's C code: it becomes the iteration's failure code.
template<class Work>
herr_t guarded(Work work) {
    try {
        work();
        return 0;
    } catch (...) {
        return -1;
    }
}

herr_t append_attribute(hid_t object, const char* name, const H5A_info_t*, void* text) {
    return guarded([&] {
        const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "open an attribute");
        *static_cast<std::string*>(text) += fmt::format("  {} = {}", name, attribute_value(attribute.get()));
    });
}

std::string shape_of(hid_t dataset) {
    const Hdf5Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
    std::vector<hsize_t> extent(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
    H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
    return fmt::format("[{}]", fmt::join(extent, "]["));
}

herr_t append_object(hid_t root, const char* name, const H5O_info_t* info, void* text) {
    return guarded([&] {
        auto& out = *static_cast<std::string*>(text);
        const Hdf5Handle object(H5Oopen(root, name, H5P_DEFAULT), H5Oclose, "open an object");
        out += std::string_view(name) == "." ? "/" : std::string("/") + name;
        if (info->type == H5O_TYPE_DATASET)
            out += " " + shape_of(object.get());
        hsize_t start = 0;
        if (H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_INC, &start, append_attribute, &out) < 0)
            throw RunError("HDF5: cannot read attributes");
        out += "\n";
    });
}

} // namespace

std::string list_hdf5(const std::filesystem::path& path) {
    const Hdf5Guard guard;
    set_up_hdf5();
    const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (id < 0)
        throw InputError(path.string() + ": not a readable HDF5 file");
    const Hdf5Handle file(id, H5Fclose, "open " + path.string());
    std::string text;
    if (H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_INC, append_object, &text, H5O_INFO_BASIC) < 0)
        throw InputError(path.string() + ": the HDF5 file is damaged");
    return text;
}

} // namespace rodwake::store
