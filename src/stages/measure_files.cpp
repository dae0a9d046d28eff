#include "measure_files.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/vti.hpp"

#include <concepts>

namespace rodwake::stages {

namespace {

using assembly::Column;

Column middles(const measure::RodGrid& grid, double scale) {
    Column out;
    for (std::size_t k = 0; k < grid.n; ++k)
        out.push_back(grid.middle(k) * scale);
    return out;
}

template<class T>
concept Attribute = std::same_as<T, double> || std::same_as<T, std::int64_t> || std::same_as<T, std::string>;

} // namespace

void write_table(const std::filesystem::path& folder, const assembly::MeasureTable& table) {
    std::vector<std::string> names;
    for (const assembly::ColumnInfo& head : table.heads)
        names.emplace_back(head.name);
    store::write_atomically(folder / table.file, store::to_csv(names, table.columns));
}

void write_image(const std::filesystem::path& folder, const assembly::MeasureImage& image, double a) {
    const double first = image.grid.middle(0) / a, spacing = image.grid.spacing / a;
    std::vector<store::VtiArray> arrays;
    for (const assembly::ImageArray& one : image.arrays)
        arrays.push_back({one.name, one.components, one.values});
    store::write_vti(folder / image.file, {image.grid.n, image.grid.n, {first, first}, {spacing, spacing}},
                     arrays);
}

void put_grid(store::Hdf5Writer& out, const assembly::MeasureGrid& grid, double a) {
    const std::size_t n = grid.grid.n;
    for (const char* axis : {"x", "y"})
        out.dataset(grid.group + "/" + axis, middles(grid.grid, 1.0 / a), {n}, "a");
    for (const assembly::GridLayer& layer : grid.layers)
        out.dataset(grid.group + "/" + layer.name, layer.values, {n, n}, layer.unit);
    out.attribute(grid.group, "spacing", grid.grid.spacing / a);
    for (const auto& attribute : grid.attributes)
        std::visit(
            [&]<class T>(const T& value) {
                if constexpr (Attribute<T>)
                    out.attribute(grid.group, attribute.name, value);
                else
                    throw RunError(grid.group + ": attribute " + attribute.name +
                                   " is neither number nor text");
            },
            attribute.value);
}

} // namespace rodwake::stages
