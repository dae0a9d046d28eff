#pragma once
// Checkpoint container: named blocks of bytes, every bit of the file covered by a checksum.
//
//   8   magic "RWKBLOC\n"          4 4 8  length of the name, layout, length of the content
//   4   format version, 2               name, content
//   4   0x01020304                 8    XXH3-64 of the five above
//   8   length of the file         ... one after the other for each block, then
//   8   number of blocks           8    XXH3-64 of everything before
//   8   XXH3-64 of the 32 bytes above
//
// Unsigned integers in the byte order of the machine that wrote it; files of the other order are refused. The
// first 40 bytes keep this layout in every version.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::store {

struct Block {
    std::string name;
    std::vector<std::byte> content;
    std::uint32_t layout =
        1; ///< of the content: its owner counts it up when the meaning of the bytes changes

    bool operator==(const Block&) const = default;
};

/// Names should be distinct: find_block takes the first.
std::string encode_blocks(std::span<const Block> blocks);

/// Throws InputError "<file_name>: ..." that says what is wrong: not a checkpoint, other version or byte
/// order, truncated, too long, damaged header, damaged block "<name>".
std::vector<Block> decode_blocks(std::string_view bytes, const std::string& file_name);

/// Throws InputError if there is no block of this name, or it has another layout.
const Block& find_block(std::span<const Block> blocks, std::string_view name, const std::string& file_name,
                        std::uint32_t layout = 1);

} // namespace rodwake::store
