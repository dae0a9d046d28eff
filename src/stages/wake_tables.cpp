#include "rodwake/stages/wake_tables.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/block_file.hpp"
#include "rodwake/store/bytes.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>

namespace rodwake::stages {

namespace {

using elastic::PlaneTable;

/// Counted up whenever tables are made differently: files of the old way are then not found.
constexpr std::uint64_t making = 1;
constexpr std::uint32_t layout = 1;

/// FNV-1a: names differ where the inputs do, on every machine alike.
std::uint64_t hash_of(std::span<const std::uint64_t> words) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const std::uint64_t word : words)
        for (int byte = 0; byte < 8; ++byte)
            hash = (hash ^ ((word >> (8 * byte)) & 0xffU)) * 0x100000001b3U;
    return hash;
}

void put(store::ByteWriter& out, const elastic::CellTable& cells) {
    out.put_array(cells.cells_per_unit);
    out.put_array(cells.polynomial_of);
    out.put_array(cells.coefficients);
}

elastic::CellTable get_cells(store::ByteReader& in) {
    elastic::CellTable cells;
    cells.cells_per_unit = in.get_array<std::int32_t>();
    cells.polynomial_of = in.get_array<std::int32_t>();
    cells.coefficients = in.get_array<double>();
    return cells;
}

std::string encode(const PlaneTable& table) {
    store::ByteWriter out;
    for (const double number : {table.eta, table.tolerance, table.strain_error, table.gradient_error})
        out.put(number);
    out.put(table.points_checked);
    out.put(table.degree);
    out.put(table.lowest_level);
    put(out, table.strain);
    put(out, table.gradient);
    const store::Block block{"plane table", out.take(), layout};
    return store::encode_blocks({&block, 1});
}

PlaneTable decode(std::string_view bytes, const std::string& file) {
    const auto blocks = store::decode_blocks(bytes, file);
    store::ByteReader in(store::find_block(blocks, "plane table", file, layout).content, file);
    PlaneTable table;
    for (double* number : {&table.eta, &table.tolerance, &table.strain_error, &table.gradient_error})
        *number = in.get<double>();
    table.points_checked = in.get<std::int64_t>();
    table.degree = in.get<std::int32_t>();
    table.lowest_level = in.get<std::int32_t>();
    table.strain = get_cells(in);
    table.gradient = get_cells(in);
    in.finish();
    return table;
}

std::optional<PlaneTable> read(const std::filesystem::path& file, double eta, double tolerance) {
    std::ifstream in(file, std::ios::binary);
    if (!in)
        return std::nullopt;
    std::string bytes(std::filesystem::file_size(file), '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    PlaneTable table = decode(bytes, file.string());
    if (table.eta != eta || table.tolerance != tolerance)
        throw InputError(file.string() + ": is the table of another medium");
    return table;
}

} // namespace

std::filesystem::path table_folder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/')
        return std::filesystem::path(cache) / "rodwake";
    if (const char* home = std::getenv("HOME"); home && *home == '/')
        return std::filesystem::path(home) / ".cache" / "rodwake";
    return {};
}

std::string table_file_name(double eta, double tolerance) {
    const std::uint64_t words[] = {making, std::bit_cast<std::uint64_t>(eta),
                                   std::bit_cast<std::uint64_t>(tolerance)};
    return fmt::format("plane-{:016x}.rwt", hash_of(words));
}

std::shared_ptr<const PlaneTable> WakeTables::plane(double eta, double tolerance) {
    const std::scoped_lock lock(mutex_);
    auto& table = planes_[{eta, tolerance}];
    if (!table)
        table = read_or_make(eta, tolerance);
    return table;
}

elastic::PeriodicTable WakeTables::periodic(const elastic::Medium& medium, double box, double tolerance) {
    const std::scoped_lock lock(mutex_);
    const std::array key{medium.eta, medium.xi, box, tolerance};
    if (const auto known = boxes_.find(key); known != boxes_.end())
        return known->second;
    const elastic::PeriodicTable table(medium, box, tolerance, context_.thread_count());
    if (context_.log)
        context_.log(Severity::info,
                     fmt::format("table of the wake in its box: tolerance {:g}, largest error {:.2g}",
                                 tolerance, table.error()));
    return boxes_.emplace(key, table).first->second;
}

std::shared_ptr<const PlaneTable> WakeTables::read_or_make(double eta, double tolerance) const {
    const auto tell = [&](Severity severity, const std::string& text) {
        if (context_.log)
            context_.log(severity, text);
    };
    const std::filesystem::path file = folder_.empty() ? folder_ : folder_ / table_file_name(eta, tolerance);
    try {
        if (auto table = file.empty() ? std::nullopt : read(file, eta, tolerance))
            return std::make_shared<const PlaneTable>(std::move(*table));
    } catch (const std::exception& error) {
        tell(Severity::warning, fmt::format("{}; it is made anew", error.what()));
    }
    auto table = elastic::make_plane_table(eta, tolerance, context_.thread_count());
    tell(Severity::info,
         fmt::format("table of the wake: tolerance {:g}, largest error {:.2g} of {} points{}", tolerance,
                     table.strain_error, table.points_checked, file.empty() ? "" : ", " + file.string()));
    try {
        if (!file.empty()) {
            std::filesystem::create_directories(folder_);
            store::write_atomically(file, encode(table));
        }
    } catch (const std::exception& error) {
        tell(Severity::warning, fmt::format("the table of the wake is not kept: {}", error.what()));
    }
    return std::make_shared<const PlaneTable>(std::move(table));
}

} // namespace rodwake::stages
