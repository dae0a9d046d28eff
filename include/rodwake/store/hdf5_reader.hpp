#pragma once
// Reads back what Hdf5Writer wrote: datasets of doubles with their units, attributes of groups. Whatever is
// missing, damaged, not finite or of another kind is an InputError that names the file.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rodwake::store {

class Hdf5Input;

/// Values in C order.
struct Hdf5Dataset {
    std::vector<double> values;
    std::vector<std::size_t> shape;
    std::string unit;
};

class Hdf5Reader {
public:
    explicit Hdf5Reader(const std::filesystem::path& path);
    ~Hdf5Reader();
    Hdf5Reader(Hdf5Reader&&) noexcept;
    Hdf5Reader& operator=(Hdf5Reader&&) noexcept;

    /// Whether there is such a group or dataset.
    bool has(const std::string& path) const;
    /// At an absolute path ("/field/grid/Ux"); with `or_unknown` values may be NaN.
    Hdf5Dataset dataset(const std::string& path, bool or_unknown = false) const;

    /// Attributes of a group ("/" or "/medium"); each must be of the kind that is asked for.
    double real(const std::string& group, const std::string& name) const;
    std::int64_t integer(const std::string& group, const std::string& name) const;
    bool has_attribute(const std::string& group, const std::string& name) const;
    std::string text(const std::string& group, const std::string& name) const;

private:
    std::unique_ptr<Hdf5Input> file_;
};

/// What a result file holds, in words: one line for each group (with its attributes) and dataset (with shape
/// and unit). Throws InputError if the file is not HDF5 or cannot be read.
std::string list_hdf5(const std::filesystem::path& path);

} // namespace rodwake::store
