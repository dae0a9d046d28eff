// The attributes of hdf5_input.hpp.

#include "hdf5_input.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::store {

namespace {

Hdf5Handle open_attribute(const Hdf5Input& file, const std::string& owner, const std::string& name) {
    if (!file.has(owner) || H5Aexists_by_name(file.get(), owner.c_str(), name.c_str(), H5P_DEFAULT) <= 0)
        file.refuse(fmt::format("attribute {} of {} is missing", name, owner));
    const hid_t id = H5Aopen_by_name(file.get(), owner.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    return file.handle(id, H5Aclose, fmt::format("open attribute {} of {}", name, owner));
}

hssize_t count_of(hid_t attribute) {
    const Hdf5Handle space(H5Aget_space(attribute), H5Sclose, "read an attribute's shape");
    return H5Sget_simple_extent_npoints(space.get());
}

bool is_one(hid_t attribute, hid_t type) {
    const Hdf5Handle found(H5Aget_type(attribute), H5Tclose, "read an attribute's type");
    return H5Tequal(found.get(), type) > 0 && count_of(attribute) == 1;
}

template<class Number>
Number number_attribute(const Hdf5Input& file, const std::string& owner, const std::string& name, hid_t type,
                        const char* kind) {
    const Hdf5Handle attribute = open_attribute(file, owner, name);
    Number value{};
    if (!is_one(attribute.get(), type))
        file.refuse(fmt::format("attribute {} of {} is not {}", name, owner, kind));
    if (H5Aread(attribute.get(), type, &value) < 0)
        file.refuse(fmt::format("attribute {} of {} cannot be read", name, owner));
    return value;
}

/// False if they cannot be read.
bool read_fixed(hid_t attribute, hid_t type, std::vector<std::string>& texts) {
    const std::size_t size = H5Tget_size(type);
    std::string table(size * texts.size(), '\0');
    if (H5Aread(attribute, type, table.data()) < 0)
        return false;
    for (std::size_t i = 0; i < texts.size(); ++i)
        texts[i] = table.substr(i * size, size).c_str();
    return true;
}

bool read_variable(hid_t attribute, hid_t type, std::vector<std::string>& texts) {
    std::vector<char*> rows(texts.size(), nullptr);
    if (H5Aread(attribute, type, rows.data()) < 0)
        return false;
    for (std::size_t i = 0; i < texts.size(); ++i)
        texts[i] = rows[i] ? rows[i] : "";
    const Hdf5Handle space(H5Aget_space(attribute), H5Sclose, "read an attribute's shape");
    H5Dvlen_reclaim(type, space.get(), H5P_DEFAULT, rows.data());
    return true;
}

herr_t add_name(hid_t, const char* name, const H5A_info_t*, void* names) {
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
    return 0;
}

} // namespace

double real_attribute(const Hdf5Input& file, const std::string& owner, const std::string& name) {
    return number_attribute<double>(file, owner, name, H5T_NATIVE_DOUBLE, "one double");
}

std::int64_t integer_attribute(const Hdf5Input& file, const std::string& owner, const std::string& name) {
    return number_attribute<std::int64_t>(file, owner, name, H5T_NATIVE_INT64, "one integer of 64 bits");
}

std::uint64_t unsigned_attribute(const Hdf5Input& file, const std::string& owner, const std::string& name) {
    return number_attribute<std::uint64_t>(file, owner, name, H5T_NATIVE_UINT64,
                                           "one unsigned integer of 64 bits");
}

std::vector<std::string> text_attribute(const Hdf5Input& file, const std::string& owner,
                                        const std::string& name) {
    const Hdf5Handle attribute = open_attribute(file, owner, name);
    const Hdf5Handle type = file.handle(H5Aget_type(attribute.get()), H5Tclose, "read the type of " + name);
    std::vector<std::string> texts(
        static_cast<std::size_t>(std::max<hssize_t>(0, count_of(attribute.get()))));
    if (H5Tget_class(type.get()) != H5T_STRING || texts.empty())
        file.refuse(fmt::format("attribute {} of {} is not a text", name, owner));
    const bool variable = H5Tis_variable_str(type.get()) > 0;
    if (!(variable ? read_variable : read_fixed)(attribute.get(), type.get(), texts))
        file.refuse(fmt::format("attribute {} of {} cannot be read", name, owner));
    return texts;
}

std::vector<std::string> real_attributes(const Hdf5Input& file, const std::string& owner) {
    std::vector<std::string> names;
    hsize_t start = 0;
    if (H5Aiterate_by_name(file.get(), owner.c_str(), H5_INDEX_NAME, H5_ITER_INC, &start, add_name, &names,
                           H5P_DEFAULT) < 0)
        file.refuse(fmt::format("the attributes of {} cannot be listed", owner));
    std::erase_if(names, [&](const std::string& name) {
        return !is_one(open_attribute(file, owner, name).get(), H5T_NATIVE_DOUBLE);
    });
    return names;
}

} // namespace rodwake::store
