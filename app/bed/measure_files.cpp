#include "measure_files.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/vti.hpp"

#include <concepts>

namespace rodwake::app {

namespace {

/// Middles of the columns (x) or rows (y).
Column middles(const measure::RodGrid& grid, char axis, double scale) {
    Column out;
    for (std::size_t k = 0; k < (axis == 'x' ? grid.columns : grid.rows); ++k)
        out.push_back((axis == 'x' ? grid.x(k) : grid.y(k)) * scale);
    return out;
}

template<class T>
concept Attribute = std::same_as<T, double> || std::same_as<T, std::int64_t> || std::same_as<T, std::string>;

} // namespace

void write_table(const std::filesystem::path& folder, const MeasureTable& table) {
    std::vector<std::string> names;
    for (const ColumnInfo& head : table.heads)
        names.emplace_back(head.name);
    store::write_atomically(folder / table.file, store::to_csv(names, table.columns));
}

void write_image(const std::filesystem::path& folder, const MeasureImage& image, double a) {
    const measure::RodGrid& grid = image.grid;
    std::vector<store::VtiArray> arrays;
    for (const ImageArray& one : image.arrays)
        arrays.push_back({one.name, one.components, one.values});
    store::write_vti(
        folder / image.file,
        {grid.columns, grid.rows, {grid.x(0) / a, grid.y(0) / a}, {grid.width / a, grid.height / a}}, arrays);
}

void put_grid(store::Hdf5Writer& out, const MeasureGrid& grid, double a) {
    const measure::RodGrid& bins = grid.grid;
    out.dataset(grid.group + "/x", middles(bins, 'x', 1.0 / a), {bins.columns}, "a");
    out.dataset(grid.group + "/y", middles(bins, 'y', 1.0 / a), {bins.rows}, "a");
    for (const GridLayer& layer : grid.layers)
        out.dataset(grid.group + "/" + layer.name, layer.values, {bins.rows, bins.columns}, layer.unit);
    out.attribute(grid.group, "spacing", bins.width / a);
    if (!bins.box.square())
        out.attribute(grid.group, "spacing_y", bins.height / a);
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

} // namespace rodwake::app
