#include "hdf5_input.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rodwake::store {

namespace {

hid_t opened(const std::filesystem::path& path, const std::string& advice) {
    set_up_hdf5();
    const auto refuse = [&](const char* what) {
        throw InputError(fmt::format("{}: {}; {}", path.string(), what, advice));
    };
    std::error_code ignored;
    const auto kind = std::filesystem::status(path, ignored).type();
    if (kind == std::filesystem::file_type::not_found)
        refuse("no such file");
    if (kind != std::filesystem::file_type::regular)
        refuse("not a file that can be read");
    if (!hdf5_survives(path))
        refuse("the HDF5 file is damaged: the HDF5 library crashes on it, or finds no end");
    const hid_t file = open_for_reading(path);
    if (file < 0 && H5Fis_hdf5(path.c_str()) > 0)
        refuse("the HDF5 file is cut short or damaged");
    if (file < 0)
        refuse("not a readable HDF5 file");
    return file;
}

herr_t refuse_link(const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) { return -1; }

/// How links are followed: not to other files, for whoever opens a file reads that file.
Hdf5Handle within_file(hid_t kind = H5P_LINK_ACCESS) {
    const hid_t access = H5Pcreate(kind);
    H5Pset_elink_cb(access, refuse_link, nullptr);
    return Hdf5Handle(access, H5Pclose, "set up reading");
}

Hdf5Handle open_dataset(const Hdf5Input& file, const std::string& path) {
    if (!file.has(path))
        file.refuse(fmt::format("dataset {} is missing", path));
    // Rows are read once and in order: a cache of chunks would only copy them.
    Hdf5Handle access = within_file(H5P_DATASET_ACCESS);
    H5Pset_chunk_cache(access.get(), 0, 0, 0.0);
    return file.handle(H5Dopen2(file.get(), path.c_str(), access.get()), H5Dclose, "open dataset " + path);
}

double product(const std::vector<hsize_t>& shape) {
    double out = 1.0;
    for (const hsize_t extent : shape)
        out *= static_cast<double>(extent);
    return out;
}

} // namespace

Hdf5Input::Hdf5Input(std::filesystem::path path, std::string advice)
    : path_(std::move(path)), advice_(std::move(advice)),
      file_(opened(path_, advice_), H5Fclose, "open " + path_.string()) {}

void Hdf5Input::refuse(const std::string& what) const {
    throw InputError(fmt::format("{}: {}; {}", path_.string(), what, advice_));
}

Hdf5Handle Hdf5Input::handle(hid_t id, Hdf5Handle::Close close, const std::string& doing) const {
    if (id < 0)
        refuse(fmt::format("cannot {}{}: the file is damaged or of another form", doing, hdf5_reason()));
    return Hdf5Handle(id, close, doing);
}

bool Hdf5Input::has(const std::string& path) const {
    return path == "/" || H5Lexists(get(), path.c_str(), within_file().get()) > 0;
}

Hdf5Table::Hdf5Table(const Hdf5Input& file, std::string path, hid_t type)
    : file_(&file), path_(std::move(path)), type_(type), data_(open_dataset(file, path_)),
      space_(file.handle(H5Dget_space(data_.get()), H5Sclose, "read the shape of " + path_)),
      shape_(extent_of(data_.get())) {
    const Hdf5Handle found = file_->handle(H5Dget_type(get()), H5Tclose, "read the type of " + path_);
    const H5T_class_t kind = H5Tget_class(found.get());
    const bool whole = type_ == H5T_NATIVE_INT64 && (kind == H5T_INTEGER || kind == H5T_ENUM),
               real = type_ == H5T_NATIVE_DOUBLE && (kind == H5T_INTEGER || kind == H5T_FLOAT);
    if (!whole && !real && H5Tequal(found.get(), type_) <= 0)
        file_->refuse(path_ + " holds values of another type");
    if (H5Sget_simple_extent_type(space_.get()) == H5S_NULL)
        file_->refuse(path_ + " holds no values");
    // Values that were never written would be read as zeros, and a damaged shape would ask for any amount of
    // memory.
    const Hdf5Handle made = file_->handle(H5Dget_create_plist(get()), H5Pclose, "read about " + path_);
    if (H5Pget_external_count(made.get()) > 0 || H5Pget_layout(made.get()) == H5D_VIRTUAL)
        file_->refuse(
            path_ +
            " has its values in another file, which is not read; copy them into this one (h5repack does)");
    const double most = H5Pget_nfilters(made.get()) > 0 ? 1100.0 : 1.0; // deflate's best is 1032
    const double needed = product(shape_) * static_cast<double>(H5Tget_size(found.get()));
    if (H5Pget_layout(made.get()) == H5D_CHUNKED) {
        std::vector<hsize_t> sides(shape_.size());
        hsize_t chunks = 0;
        H5Pget_chunk(made.get(), static_cast<int>(sides.size()), sides.data());
        double wanted = 1.0;
        for (std::size_t k = 0; k < sides.size(); ++k)
            wanted *= std::ceil(static_cast<double>(shape_[k]) / static_cast<double>(sides[k]));
        if (wanted > 0.0 &&
            (H5Dget_num_chunks(get(), space_.get(), &chunks) < 0 || static_cast<double>(chunks) < wanted))
            file_->refuse(path_ + " is not complete");
    }
    // A dataset takes no more than the file.
    hsize_t bytes = 0;
    H5Fget_filesize(file_->get(), &bytes);
    if (needed > most * static_cast<double>(std::min(bytes, H5Dget_storage_size(get()))))
        file_->refuse(path_ + " is not complete");
}

std::size_t Hdf5Table::size() const { return static_cast<std::size_t>(product(shape_)); }

void Hdf5Table::want_shape(const std::vector<hsize_t>& wanted) const {
    if (shape_ != wanted)
        file_->refuse(fmt::format("{} is of shape {}, expected {}", path_, shape_, wanted));
}

void Hdf5Table::read(void* values) const {
    if (size() > 0 && H5Dread(get(), type_, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        file_->refuse(fmt::format("{} cannot be read{}: the file is damaged", path_, hdf5_reason()));
}

void Hdf5Table::read_rows(hsize_t first, hsize_t count, void* values) const {
    if (!store::read_rows(get(), type_, first, count, values))
        file_->refuse(fmt::format("{} cannot be read from row {} on{}: the file is damaged", path_, first,
                                  hdf5_reason()));
}

std::vector<double> read_numbers(const Hdf5Input& file, const std::string& path, const Hdf5Table& table,
                                 bool or_unknown) {
    std::vector<double> values(table.size());
    table.read(values.data());
    const auto good = [&](double value) { return std::isfinite(value) || (or_unknown && std::isnan(value)); };
    if (!std::ranges::all_of(values, good))
        file.refuse(path + " holds values that are not finite");
    return values;
}

// Attributes.

namespace {

Hdf5Handle open_attribute(const Hdf5Input& file, const std::string& owner, const std::string& name) {
    if (!file.has(owner) ||
        H5Aexists_by_name(file.get(), owner.c_str(), name.c_str(), within_file().get()) <= 0)
        file.refuse(fmt::format("attribute {} of {} is missing", name, owner));
    const hid_t id =
        H5Aopen_by_name(file.get(), owner.c_str(), name.c_str(), H5P_DEFAULT, within_file().get());
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
    const std::size_t size = variable ? 0 : H5Tget_size(type.get());
    std::vector<char*> rows(variable ? texts.size() : 0, nullptr);
    std::string table(size * texts.size(), '\0');
    if (H5Aread(attribute.get(), type.get(), variable ? static_cast<void*>(rows.data()) : table.data()) < 0)
        file.refuse(fmt::format("attribute {} of {} cannot be read", name, owner));
    for (std::size_t i = 0; i < texts.size(); ++i) {
        const char* text = variable ? rows[i] : nullptr;
        texts[i] = variable ? (text ? text : "") : table.substr(i * size, size).c_str();
    }
    if (variable) {
        const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose, "read an attribute's shape");
        H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, rows.data());
    }
    return texts;
}

std::vector<std::string> real_attributes(const Hdf5Input& file, const std::string& owner) {
    std::vector<std::string> names;
    hsize_t start = 0;
    if (H5Aiterate_by_name(file.get(), owner.c_str(), H5_INDEX_NAME, H5_ITER_INC, &start, add_name, &names,
                           within_file().get()) < 0)
        file.refuse(fmt::format("the attributes of {} cannot be listed", owner));
    std::erase_if(names, [&](const std::string& name) {
        return !is_one(open_attribute(file, owner, name).get(), H5T_NATIVE_DOUBLE);
    });
    return names;
}

} // namespace rodwake::store
