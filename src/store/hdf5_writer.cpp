#include "rodwake/store/hdf5_writer.hpp"

#include "hdf5_file.hpp"

namespace rodwake::store {

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
    const Hdf5Handle source(H5Fopen(from.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                            "open " + from.string());
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
