#include "rodwake/store/hdf5_writer.hpp"

#include "hdf5_file.hpp"

namespace rodwake::store {

Hdf5Writer::Hdf5Writer(const std::filesystem::path& target) : file_(std::make_unique<Hdf5File>(target)) {}

Hdf5Writer::~Hdf5Writer() = default;

void Hdf5Writer::dataset(const std::string& path, std::span<const double> values,
                         const std::vector<std::size_t>& shape, const std::string& unit) {
    const std::vector<hsize_t> extent(shape.begin(), shape.end());
    const Hdf5Handle data = write_dataset(file_->get(), path, H5T_IEEE_F64LE, extent, values.data());
    write_attribute(data.get(), "unit", unit);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, double value) {
    write_attribute(open_group(file_->get(), group).get(), name, value);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, std::int64_t value) {
    write_attribute(open_group(file_->get(), group).get(), name, H5T_NATIVE_INT64, &value);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, const std::string& value) {
    write_attribute(open_group(file_->get(), group).get(), name, value);
}

void Hdf5Writer::commit() { file_->commit(); }

} // namespace rodwake::store
