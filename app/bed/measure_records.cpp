#include "measure_records.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/block_file.hpp"
#include "rodwake/store/bytes.hpp"

#include <fstream>
#include <iterator>

namespace rodwake::app {

namespace {

constexpr const char* block_name = "measures";
constexpr std::uint32_t layout = 2; ///< counted up when what an accumulator saves changes

} // namespace

void write_records(const std::filesystem::path& file, const MeasurePlan& plan,
                   const measure::Measures& measures) {
    store::ByteWriter out;
    out.put_text(plan.key_text);
    out.put_array(measures.save());
    const std::vector<store::Block> blocks = {{block_name, out.take(), layout}};
    store::write_atomically(file, store::encode_blocks(blocks));
}

std::optional<measure::Measures> read_records(const std::filesystem::path& file, const MeasurePlan& plan) {
    std::ifstream in(file, std::ios::binary);
    if (!in.is_open())
        return std::nullopt;
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const auto blocks = store::decode_blocks(bytes, file.string());
    store::ByteReader reader(store::find_block(blocks, block_name, file.string(), layout).content,
                             file.string());
    if (reader.get_text() != plan.key_text)
        return std::nullopt;
    const auto values = reader.get_array<double>();
    reader.finish();
    measure::Measures measures = plan.sums;
    measures.load(values, file.string());
    return measures;
}

} // namespace rodwake::app
