#include "rodwake/store/vti.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>

namespace rodwake::store {

namespace {

static_assert(std::endian::native == std::endian::little, "the bytes of numbers are written as they are");

constexpr std::size_t most_points = std::size_t{1} << 31; ///< extents are int in VTK

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

std::string base64(const std::string& bytes) {
    static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k)
            out += i + k <= bytes.size() ? digits[three >> (18 - 6 * k) & 63U] : '=';
    }
    return out;
}

} // namespace

void write_vti(const std::filesystem::path& target, const VtiGrid& grid, std::span<const VtiArray> arrays) {
    if (grid.nx == 0 || grid.ny == 0 || grid.nx >= most_points || grid.ny >= most_points)
        throw InputError(
            fmt::format("vti: a grid of {} x {} points; both must be from 1 to 2^31 - 1", grid.nx, grid.ny));
    for (std::size_t c = 0; c < 2; ++c) {
        if (!std::isfinite(grid.origin[c]))
            throw InputError(fmt::format("vti: the grid's origin is {}: must be finite", grid.origin[c]));
        if (!(grid.spacing[c] > 0.0) || !std::isfinite(grid.spacing[c]))
            throw InputError(
                fmt::format("vti: the grid's spacing is {}: must be positive and finite", grid.spacing[c]));
    }
    std::set<std::string> names;
    for (const VtiArray& array : arrays) {
        const auto bad = [](char c) { return c < ' ' || c > '~'; };
        if (array.name.empty() || std::ranges::any_of(array.name, bad))
            throw InputError(
                fmt::format("vti: \"{}\" is no name of a field; use printable ASCII", array.name));
        if (array.components != 1 && array.components != 3)
            throw InputError(fmt::format("vti: field {} has {} components; 1 and 3 are legal", array.name,
                                         array.components));
        if (array.values.size() != grid.nx * grid.ny * array.components)
            throw InputError(fmt::format("vti: field {} has {} values, expected {} x {} x {}", array.name,
                                         array.values.size(), grid.ny, grid.nx, array.components));
        if (std::ranges::any_of(array.values, [](double value) { return std::isinf(value); }))
            throw InputError(fmt::format("vti: field {} has infinite values", array.name));
        if (!names.insert(array.name).second)
            throw InputError(fmt::format("vti: two fields are named {}", array.name));
    }
    PendingFile file(target);
    const std::string extent = fmt::format("0 {} 0 {} 0 0", grid.nx - 1, grid.ny - 1);
    file.write(fmt::format("<?xml version=\"1.0\"?>\n"
                           "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                           "header_type=\"UInt64\">\n"
                           "  <ImageData WholeExtent=\"{0}\" Origin=\"{1} {2} 0\" Spacing=\"{3} {4} 1\">\n"
                           "    <Piece Extent=\"{0}\">\n"
                           "      <PointData>\n",
                           extent, grid.origin[0], grid.origin[1], grid.spacing[0], grid.spacing[1]));
    for (const VtiArray& array : arrays) {
        // The count of bytes and the values are one run of bytes; VTK wants no gap between them.
        const std::uint64_t count = array.values.size_bytes();
        std::string bytes(reinterpret_cast<const char*>(&count), sizeof count);
        bytes.append(reinterpret_cast<const char*>(array.values.data()), count);
        file.write(fmt::format("        <DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\" "
                               "format=\"binary\">\n{}\n        </DataArray>\n",
                               escaped(array.name), array.components, base64(bytes)));
    }
    file.write("      </PointData>\n    </Piece>\n  </ImageData>\n</VTKFile>\n");
    file.commit();
}

} // namespace rodwake::store
