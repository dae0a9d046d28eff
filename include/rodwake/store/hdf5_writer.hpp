#pragma once
// Writes one HDF5 file of doubles with attributes; it appears under its name only when committed.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rodwake::store {

class Hdf5File;

/// Takes what the HDF5 library needs for itself, else taken at its first file. Without the memory for that,
/// HDF5 1.10 ends the program: better before there is anything to lose.
void prepare_hdf5();

class Hdf5Writer {
public:
    /// Throws RunError if the file cannot be made.
    explicit Hdf5Writer(const std::filesystem::path& target);
    ~Hdf5Writer();
    Hdf5Writer(const Hdf5Writer&) = delete;
    Hdf5Writer& operator=(const Hdf5Writer&) = delete;
    Hdf5Writer(Hdf5Writer&&) = delete;
    Hdf5Writer& operator=(Hdf5Writer&&) = delete;

    /// Dataset of doubles in C order at an absolute path ("/field/grid/Ux"); groups on the way are made.
    /// `unit` becomes its attribute of that name.
    void dataset(const std::string& path, std::span<const double> values,
                 const std::vector<std::size_t>& shape, const std::string& unit);

    /// 0, 1, 2, ... as what other datasets count along: a dimension scale, as NetCDF4 has them.
    void scale(const std::string& path, std::size_t count);
    /// Names the scales of all dimensions of a dataset.
    void dimensions(const std::string& path, const std::vector<std::string>& scales);

    /// Whole rows, from `first` on, of a dataset of this shape (its first extent counts the rows), which the
    /// first call makes: for what is longer than one wants to hold. An empty `unit` is left out.
    void part(const std::string& path, std::span<const double> values, std::size_t first,
              const std::vector<std::size_t>& shape, const std::string& unit = "");

    /// Attribute of a group ("/" or "/medium"), which is made if missing.
    void attribute(const std::string& group, const std::string& name, double value);
    void attribute(const std::string& group, const std::string& name, std::int64_t value);
    void attribute(const std::string& group, const std::string& name, const std::string& value);

    /// Takes a group with everything in it over from another file; nothing if that has none such. Throws
    /// RunError.
    void copy_group(const std::filesystem::path& from, const std::string& group);

    /// Closes and renames the file into place. Throws RunError.
    void commit();

private:
    std::unique_ptr<Hdf5File> file_;
};

} // namespace rodwake::store
