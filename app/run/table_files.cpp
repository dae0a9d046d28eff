#include "table_files.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/block_file.hpp"
#include "rodwake/store/bytes.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace rodwake::app {

namespace {

using elastic::PeriodicTableData;
using elastic::PlaneTable;

constexpr std::uint32_t layout = 1;
constexpr const char *of_plane = "plane table", *of_box = "box table"; // names of their blocks

std::string one_block(const char* name, store::ByteWriter& content) {
    const store::Block block{name, content.take(), layout};
    return store::encode_blocks({&block, 1});
}

void put(store::ByteWriter& out, const elastic::CellTable& cells) {
    out.put_array(cells.cells_per_unit);
    out.put_array(cells.polynomial_of);
    out.put_array(cells.coefficients);
}

/// Of polynomials with `rows` coefficients each, to which its numbers must lead. Throws InputError.
elastic::CellTable get_cells(store::ByteReader& in, std::size_t rows, const std::string& file) {
    elastic::CellTable cells;
    cells.cells_per_unit = in.get_array<std::int32_t>();
    cells.polynomial_of = in.get_array<std::int32_t>();
    cells.coefficients = in.get_array<double>();
    std::size_t count = 0;
    bool sound = cells.cells_per_unit.size() < 100 && cells.coefficients.size() % rows == 0;
    for (const std::int32_t n : cells.cells_per_unit) {
        sound = sound && n >= 1 && n < 10'000;
        count += sound ? 8 * static_cast<std::size_t>(n) * static_cast<std::size_t>(n) : 0;
    }
    const auto polynomials = static_cast<std::int64_t>(cells.coefficients.size() / rows);
    for (const std::int32_t number : cells.polynomial_of)
        sound = sound && number >= -1 && number < polynomials;
    if (!sound || count != cells.polynomial_of.size())
        throw InputError(file + ": is damaged: the cells of the table do not fit together");
    return cells;
}

} // namespace

std::string encode(const PlaneTable& table) {
    store::ByteWriter out;
    for (const double number : {table.eta, table.tolerance, table.strain_error, table.gradient_error})
        out.put(number);
    out.put(table.points_checked);
    out.put(table.degree);
    out.put(table.lowest_level);
    put(out, table.strain);
    put(out, table.gradient);
    return one_block(of_plane, out);
}

template<>
PlaneTable decode(std::string_view bytes, const std::string& file) {
    const auto blocks = store::decode_blocks(bytes, file);
    store::ByteReader in(store::find_block(blocks, of_plane, file, layout).content, file);
    PlaneTable table;
    for (double* number : {&table.eta, &table.tolerance, &table.strain_error, &table.gradient_error})
        *number = in.get<double>();
    table.points_checked = in.get<std::int64_t>();
    table.degree = in.get<std::int32_t>();
    table.lowest_level = in.get<std::int32_t>();
    if (table.degree < 1 || table.degree > 20 || std::abs(table.lowest_level) > 200)
        throw InputError(fmt::format("{}: is damaged: a table of degree {} from level {} on", file,
                                     table.degree, table.lowest_level));
    const auto terms = static_cast<std::size_t>((table.degree + 1) * (table.degree + 1));
    table.strain = get_cells(in, 3 * terms, file);
    table.gradient = get_cells(in, 6 * terms, file);
    in.finish();
    return table;
}

std::string encode(const PeriodicTableData& table) {
    store::ByteWriter out;
    for (const double number : {table.eta, table.xi, table.box, table.tolerance, table.error})
        out.put(number);
    out.put(table.place_pieces);
    out.put(table.angle_pieces);
    for (const std::vector<double>& coefficients : table.coefficients)
        out.put_array(coefficients);
    return one_block(of_box, out);
}

template<>
PeriodicTableData decode(std::string_view bytes, const std::string& file) {
    const auto blocks = store::decode_blocks(bytes, file);
    store::ByteReader in(store::find_block(blocks, of_box, file, layout).content, file);
    PeriodicTableData table;
    for (double* number : {&table.eta, &table.xi, &table.box, &table.tolerance, &table.error})
        *number = in.get<double>();
    table.place_pieces = in.get<std::int32_t>();
    table.angle_pieces = in.get<std::int32_t>();
    for (std::vector<double>& coefficients : table.coefficients)
        coefficients = in.get_array<double>();
    in.finish();
    return table;
}

} // namespace rodwake::app
