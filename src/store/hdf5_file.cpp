#include "hdf5_file.hpp"

#include "hdf5_input.hpp"
#include "rodwake/store/hdf5_reader.hpp"
#include "rodwake/store/hdf5_writer.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace rodwake::store {

void prepare_hdf5() { set_up_hdf5(); }

std::vector<hsize_t> extent_of(hid_t dataset) {
    const Hdf5Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
    std::vector<hsize_t> extent(
        static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space.get()))));
    H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
    return extent;
}

namespace {

/// A lock on the temporary, which is ours alone, would be held on by any process forked while it is open.
Hdf5Handle without_locks() {
    Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "set up access to a file");
    H5Pset_file_locking(access.get(), false, true);
    return access;
}

} // namespace

hid_t open_for_reading(const std::filesystem::path& path) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    return file >= 0 ? file : H5Fopen(path.c_str(), H5F_ACC_RDONLY, without_locks().get());
}

namespace {

hid_t create(const std::filesystem::path& path, const std::filesystem::path& target) {
    set_up_hdf5();
    const Hdf5Handle access = without_locks(); // until the reason of a failure is known
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get());
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
    Hdf5Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "create attribute " + name);
    if (H5Awrite(attribute.get(), type, value) < 0)
        throw RunError("HDF5: cannot write attribute " + name + hdf5_reason());
    attribute.close("write attribute " + name);
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

/// Of the extents from the `from`th on; 1 for none.
hsize_t product(const std::vector<hsize_t>& extent, std::size_t from) {
    return std::accumulate(extent.begin() + static_cast<std::ptrdiff_t>(std::min(from, extent.size())),
                           extent.end(), hsize_t{1}, std::multiplies<hsize_t>());
}

/// Rows of a dataset, in the file and in memory.
struct RowSelection {
    Hdf5Handle file, memory;

    RowSelection(hid_t dataset, hsize_t first, hsize_t count)
        : RowSelection(dataset, extent_of(dataset), first, count) {}

private:
    RowSelection(hid_t dataset, std::vector<hsize_t> extent, hsize_t first, hsize_t count)
        : file(H5Dget_space(dataset), H5Sclose, "read a shape"),
          memory(
              H5Screate_simple(static_cast<int>(extent.size()), (extent[0] = count, extent.data()), nullptr),
              H5Sclose, "shape rows") {
        std::vector<hsize_t> start(extent.size(), 0);
        start[0] = first;
        if (H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr) <
            0)
            throw RunError("HDF5: cannot select rows" + hdf5_reason());
    }
};

/// Makes the groups on the way to what is created.
Hdf5Handle link_with_parents() {
    const hid_t properties = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(properties, 1);
    return Hdf5Handle(properties, H5Pclose, "set up links");
}

Hdf5Handle create_dataset(hid_t file, const std::string& path, hid_t type,
                          const std::vector<hsize_t>& extent) {
    const Hdf5Handle space(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr),
                           H5Sclose, "shape " + path);
    const Hdf5Handle links = link_with_parents(),
                     properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "set up a dataset");
    H5Pset_obj_track_times(properties.get(), false); // the same numbers make the same bytes
    return Hdf5Handle(
        H5Dcreate2(file, path.c_str(), type, space.get(), links.get(), properties.get(), H5P_DEFAULT),
        H5Dclose, "create " + path);
}

/// Of rows as they are in the file.
std::uint64_t checksum_of(hid_t data, hid_t type, hsize_t first, hsize_t count) {
    std::string bytes(count * product(extent_of(data), 1) * H5Tget_size(type), '\0');
    if (!bytes.empty() && !read_rows(data, type, first, count, bytes.data()))
        throw RunError("HDF5: cannot read back" + hdf5_reason());
    return xxh3(bytes);
}

/// Datasets with a checksum: those that were copied, too. An exception must not cross HDF5's C code.
herr_t require_checksum(hid_t root, const char* name, const H5O_info_t* info, void*) try {
    if (info->type != H5O_TYPE_DATASET || H5Aexists_by_name(root, name, checksum_name, H5P_DEFAULT) <= 0)
        return 0;
    const Hdf5Handle attribute(H5Aopen_by_name(root, name, checksum_name, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                               "read a checksum"),
        text(H5Aget_type(attribute.get()), H5Tclose, "read a checksum"),
        data(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose, "read back"),
        type(H5Dget_type(data.get()), H5Tclose, "read back");
    std::string stored(H5Tget_size(text.get()), '\0');
    const std::vector<hsize_t> extent = extent_of(data.get());
    const hsize_t count = extent.empty() ? 1 : extent[0];
    return H5Aread(attribute.get(), text.get(), stored.data()) >= 0 &&
                   stored.c_str() == checksum_text(checksum_of(data.get(), type.get(), 0, count))
               ? 0
               : -1;
} catch (const std::exception&) {
    return -1;
}

} // namespace

std::string checksum_text(std::uint64_t checksum) { return fmt::format("{:016x}", checksum); }

bool read_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, void* values) {
    if (extent_of(dataset).empty())
        return H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0;
    const RowSelection selected(dataset, first, count);
    return H5Dread(dataset, type, selected.memory.get(), selected.file.get(), H5P_DEFAULT, values) >= 0;
}

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

void Hdf5File::dataset(const std::string& path, hid_t type, const std::vector<hsize_t>& extent,
                       const void* values, const std::optional<std::string>& unit) {
    const hsize_t elements = product(extent, 0);
    Hdf5Handle data = create_dataset(file_, path, type, extent);
    if (unit)
        write_attribute(data.get(), "unit", *unit);
    if (elements > 0 && H5Dwrite(data.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        throw RunError("HDF5: cannot write " + path + hdf5_reason());
    const std::uint64_t checksum = xxh3({static_cast<const char*>(values), elements * H5Tget_size(type)});
    write_attribute(data.get(), checksum_name, checksum_text(checksum));
    data.close("write " + path);
    expect({{path, type, 0, extent.empty() ? 1 : extent[0], checksum}});
}

void Hdf5File::part(const std::string& path, std::span<const double> values, hsize_t first,
                    const std::vector<hsize_t>& extent, const std::string& unit) {
    const hid_t type = H5T_IEEE_F64LE;
    const bool there = H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0;
    Hdf5Handle data = there ? Hdf5Handle(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path)
                            : create_dataset(file_, path, type, extent);
    if (!there && !unit.empty())
        write_attribute(data.get(), "unit", unit);
    if (values.empty())
        return data.close("write " + path);
    const hsize_t row = product(extent, 1), count = row == 0 ? 0 : values.size() / row;
    if (count * row != values.size())
        throw RunError(fmt::format("HDF5: {}: {} values are no whole rows of {}", path, values.size(), row));
    const RowSelection selected(data.get(), first, count);
    if (H5Dwrite(data.get(), type, selected.memory.get(), selected.file.get(), H5P_DEFAULT, values.data()) <
        0)
        throw RunError("HDF5: cannot write " + path + hdf5_reason());
    data.close("write " + path);
    expect({{path, type, first, count, xxh3(as_text(std::as_bytes(values)))}});
}

void Hdf5File::expect(const std::vector<WrittenRows>& rows) {
    expected_.insert(expected_.end(), rows.begin(), rows.end());
}

void Hdf5File::commit() {
    const bool flushed = H5Fflush(file_, H5F_SCOPE_LOCAL) >= 0;
    const std::string reason = flushed ? "" : hdf5_reason();
    const bool closed = H5Fclose(std::exchange(file_, -1)) >= 0;
    if (!flushed || !closed)
        throw RunError(target_.string() + ": HDF5 cannot write the file" +
                       (flushed ? hdf5_reason() : reason));
    {
        // Read back through the library to verify what was written.
        const Hdf5Handle access = without_locks();
        const Hdf5Handle file(H5Fopen(pending_.temporary().c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose,
                              "read back " + target_.string());
        const auto lost = [&](const std::string& what) {
            throw RunError(fmt::format("{}: {} is not in the file as it was written: the system lost it",
                                       target_.string(), what));
        };
        for (const WrittenRows& rows : expected_) {
            const Hdf5Handle data(H5Dopen2(file.get(), rows.path.c_str(), H5P_DEFAULT), H5Dclose,
                                  "read back " + rows.path);
            if (checksum_of(data.get(), rows.type, rows.first, rows.count) != rows.checksum)
                lost(rows.path);
        }
        if (H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_INC, require_checksum, nullptr, H5O_INFO_BASIC) < 0)
            lost("a dataset");
    }
    pending_.commit();
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

hid_t create(hid_t file, const std::string& path, const Hdf5Series::ElementLayout& layout) {
    const std::vector<hsize_t> none = with_rows(0, layout.item), any = with_rows(H5S_UNLIMITED, layout.item);
    const Hdf5Handle space(H5Screate_simple(static_cast<int>(none.size()), none.data(), any.data()), H5Sclose,
                           "shape " + path);
    const Hdf5Handle links = link_with_parents(),
                     properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "set up chunks");
    const std::vector<hsize_t> chunk = with_rows(layout.chunk_rows, layout.item);
    H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data());
    if (layout.deflate) {
        H5Pset_shuffle(properties.get());
        H5Pset_deflate(properties.get(), 6);
    }
    return H5Dcreate2(file, path.c_str(), layout.type, space.get(), links.get(), properties.get(),
                      H5P_DEFAULT);
}

} // namespace

Hdf5Series::Hdf5Series(hid_t file, const std::string& path, const ElementLayout& layout)
    : path_(path), type_(layout.type), extent_(with_rows(0, layout.item)),
      data_(create(file, path, layout), H5Dclose, "create " + path) {}

void Hdf5Series::append(const void* row) {
    const hsize_t first = extent_[0]++;
    if (H5Dset_extent(data_.get(), extent_.data()) < 0)
        throw RunError("HDF5: cannot extend " + path_ + hdf5_reason());
    const RowSelection selected(data_.get(), first, 1);
    if (H5Dwrite(data_.get(), type_, selected.memory.get(), selected.file.get(), H5P_DEFAULT, row) < 0)
        throw RunError("HDF5: cannot write " + path_ + hdf5_reason());
    checksums_.push_back(xxh3({static_cast<const char*>(row), product(extent_, 1) * H5Tget_size(type_)}));
}

std::vector<WrittenRows> Hdf5Series::close() {
    constexpr std::size_t most = 16; // rows that are read again
    data_.close("write " + path_);
    std::vector<WrittenRows> rows;
    const std::size_t count = std::min(most, checksums_.size());
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t row = count == 1 ? 0 : k * (checksums_.size() - 1) / (count - 1);
        rows.push_back({path_, type_, row, 1, checksums_[row]});
    }
    return rows;
}

namespace {

const std::string result_advice =
    "give a result file as rodwake writes it, or repeat the run if this should be one";

std::string one_text(const Hdf5Input& file, const std::string& owner, const std::string& name) {
    const auto texts = text_attribute(file, owner, name);
    if (texts.size() != 1)
        file.refuse(fmt::format("attribute {} of {} is a list of texts, expected one", name, owner));
    return texts[0];
}

} // namespace

Hdf5Reader::Hdf5Reader(const std::filesystem::path& path)
    : file_((Hdf5Guard(), std::make_unique<Hdf5Input>(path, result_advice))) {}

Hdf5Reader::~Hdf5Reader() {
    const Hdf5Guard guard;
    file_.reset();
}
Hdf5Reader::Hdf5Reader(Hdf5Reader&&) noexcept = default;
Hdf5Reader& Hdf5Reader::operator=(Hdf5Reader&&) noexcept = default;

bool Hdf5Reader::has(const std::string& path) const {
    const Hdf5Guard guard;
    return file_->has(path);
}

Hdf5Dataset Hdf5Reader::dataset(const std::string& path, bool or_unknown) const {
    const Hdf5Guard guard;
    const Hdf5Table table(*file_, path, H5T_IEEE_F64LE);
    const auto& shape = table.shape();
    Hdf5Dataset out{read_numbers(*file_, path, table, or_unknown),
                    {shape.begin(), shape.end()},
                    one_text(*file_, path, "unit")};
    if (H5Aexists(table.get(), checksum_name) > 0 && // files of earlier versions have none
        one_text(*file_, path, checksum_name) !=
            checksum_text(xxh3(as_text(std::as_bytes(std::span(out.values))))))
        file_->refuse(
            fmt::format("{} is damaged: its values are not those that were written (if they were changed on "
                        "purpose, remove its attribute {})",
                        path, checksum_name));
    return out;
}

double Hdf5Reader::real(const std::string& group, const std::string& name) const {
    const Hdf5Guard guard;
    const double value = real_attribute(*file_, group, name);
    if (!std::isfinite(value))
        file_->refuse(fmt::format("attribute {} of {} is not finite", name, group));
    return value;
}

std::int64_t Hdf5Reader::integer(const std::string& group, const std::string& name) const {
    const Hdf5Guard guard;
    return integer_attribute(*file_, group, name);
}

bool Hdf5Reader::has_attribute(const std::string& group, const std::string& name) const {
    const Hdf5Guard guard;
    return file_->has(group) && H5Aexists_by_name(file_->get(), group.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

std::string Hdf5Reader::text(const std::string& group, const std::string& name) const {
    const Hdf5Guard guard;
    return one_text(*file_, group, name);
}

Hdf5Writer::Hdf5Writer(const std::filesystem::path& target)
    : file_((Hdf5Guard(), std::make_unique<Hdf5File>(target))) {}

Hdf5Writer::~Hdf5Writer() {
    const Hdf5Guard guard;
    file_.reset();
}

void Hdf5Writer::dataset(const std::string& path, std::span<const double> values,
                         const std::vector<std::size_t>& shape, const std::string& unit) {
    const Hdf5Guard guard;
    const std::vector<hsize_t> extent(shape.begin(), shape.end());
    file_->dataset(path, H5T_IEEE_F64LE, extent, values.data(), unit);
}

void Hdf5Writer::scale(const std::string& path, std::size_t count) {
    const Hdf5Guard guard;
    std::vector<std::int64_t> values(count);
    std::iota(values.begin(), values.end(), 0);
    file_->dataset(path, H5T_STD_I64LE, {count}, values.data());
    const Hdf5Handle data(H5Dopen2(file_->get(), path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
    if (H5DSset_scale(data.get(), path.substr(path.rfind('/') + 1).c_str()) < 0)
        throw RunError("HDF5: cannot make a dimension of " + path + hdf5_reason());
}

void Hdf5Writer::dimensions(const std::string& path, const std::vector<std::string>& scales) {
    const Hdf5Guard guard;
    const Hdf5Handle data(H5Dopen2(file_->get(), path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
    for (std::size_t i = 0; i < scales.size(); ++i) {
        const Hdf5Handle scale(H5Dopen2(file_->get(), scales[i].c_str(), H5P_DEFAULT), H5Dclose,
                               "open " + scales[i]);
        if (H5DSattach_scale(data.get(), scale.get(), static_cast<unsigned>(i)) < 0)
            throw RunError("HDF5: cannot name the dimensions of " + path + hdf5_reason());
    }
}

void Hdf5Writer::part(const std::string& path, std::span<const double> values, std::size_t first,
                      const std::vector<std::size_t>& shape, const std::string& unit) {
    const Hdf5Guard guard;
    const std::vector<hsize_t> extent(shape.begin(), shape.end());
    file_->part(path, values, first, extent, unit);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, double value) {
    const Hdf5Guard guard;
    write_attribute(open_group(file_->get(), group).get(), name, value);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, std::int64_t value) {
    const Hdf5Guard guard;
    write_attribute(open_group(file_->get(), group).get(), name, H5T_NATIVE_INT64, &value);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, const std::string& value) {
    const Hdf5Guard guard;
    write_attribute(open_group(file_->get(), group).get(), name, value);
}

void Hdf5Writer::copy_group(const std::filesystem::path& from, const std::string& group) {
    const Hdf5Guard guard;
    const Hdf5Handle source(open_for_reading(from), H5Fclose, "open " + from.string());
    if (H5Lexists(source.get(), group.c_str(), H5P_DEFAULT) <= 0)
        return;
    if (H5Ocopy(source.get(), group.c_str(), file_->get(), group.c_str(), H5P_DEFAULT, H5P_DEFAULT) < 0)
        throw RunError(from.string() + ": HDF5 cannot copy " + group + hdf5_reason());
}

void Hdf5Writer::commit() {
    const Hdf5Guard guard;
    file_->commit();
}

} // namespace rodwake::store
