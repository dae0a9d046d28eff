#pragma once
// Fields on plane grids as VTK image data (.vti), as ParaView and VTK read them: point data, little-endian
// doubles in base64 after a UInt64 count of bytes, so every bit is kept and the file is plain XML.

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace rodwake::store {

/// Points (origin + (i, j) spacing), i < nx, j < ny, at z = 0.
struct VtiGrid {
    std::size_t nx = 0, ny = 0;
    std::array<double, 2> origin{}, spacing{};
};

/// A scalar (1 component) or a vector (3) at each point.
struct VtiArray {
    std::string name;
    std::size_t components = 1;
    std::span<const double> values; ///< [ny][nx][components]; NaN: unknown
};

/// The file appears whole or not at all. Throws InputError for what is no grid or no field on it: no points,
/// spacings not positive, counts that do not fit, names that are empty, double or not text, infinite values;
/// RunError with the system's reason if it cannot be written.
void write_vti(const std::filesystem::path& target, const VtiGrid& grid, std::span<const VtiArray> arrays);

} // namespace rodwake::store
