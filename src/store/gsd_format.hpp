#pragma once
// The container of GSD 1 and 2 (glotzerlab/gsd: gsd.h), for who writes and who reads one: a header, an index
// of chunks (sorted by frame), a list of names, and the chunks themselves, tables of N x M numbers.

#include <array>
#include <cstdint>

namespace rodwake::store {

struct GsdHeader {
    static constexpr std::uint64_t magic_number = 0x65DF65DF65DF65DF;

    std::uint64_t magic = magic_number;
    std::uint64_t index_location = 0, index_entries = 0;
    std::uint64_t names_location = 0, names_entries = 0; ///< of 64 bytes each
    std::uint32_t schema_version = 0, gsd_version = 0;   ///< major << 16 | minor
    std::array<char, 64> application{}, schema{};
    std::array<char, 80> reserved{};
};
static_assert(sizeof(GsdHeader) == 256);

struct GsdEntry {
    std::uint64_t frame = 0, rows = 0;
    std::int64_t location = 0; ///< of the numbers; 0: no entry
    std::uint32_t columns = 0;
    std::uint16_t name = 0;
    std::uint8_t type = 0, flags = 0;
};
static_assert(sizeof(GsdEntry) == 32);

constexpr std::size_t gsd_name_size = 64;

/// Numbers of GsdEntry::type.
enum class GsdType : std::uint8_t { u8 = 1, u16, u32, u64, i8, i16, i32, i64, f32, f64 };

} // namespace rodwake::store
