#include "rodwake/store/hdf5_reader.hpp"

#include "hdf5_file.hpp"
#include "hdf5_input.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::store {

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

std::string Hdf5Reader::text(const std::string& group, const std::string& name) const {
    const Hdf5Guard guard;
    return one_text(*file_, group, name);
}

} // namespace rodwake::store
