// A checkpoint comes back as it was written, or is refused with the reason: any bit flipped, cut off
// anywhere, anything added.

#include "rodwake/store/block_file.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/store/bytes.hpp"
#include "scratch.hpp"
#include "store/descriptor.hpp"

#include <catch2/catch.hpp>

#include <cstring>

using namespace rodwake;
using namespace store_test;
using store::Block;

namespace {

/// Like a checkpoint of a run: some large arrays of doubles, small blocks, an empty one.
std::vector<Block> example(std::size_t beads) {
    RandomStream random(7);
    store::ByteWriter out;
    std::vector<Block> blocks;
    for (const char* name : {"beads", "velocities"}) {
        std::vector<double> values(3 * beads);
        for (double& value : values)
            value = random.uniform(-1.0, 1.0);
        out.put_array(values);
        blocks.push_back({name, out.take(), 1});
    }
    out.put(std::int64_t{123456});
    out.put_text("schema = 1\n");
    blocks.push_back({"run", out.take(), 1});
    blocks.push_back({"rods", {}, 1});
    return blocks;
}

std::string refusal(std::string_view bytes) {
    return error_of<InputError>([&] { store::decode_blocks(bytes, "c"); });
}

/// Number of flips of a single bit, at random places, that were not noticed.
int unnoticed(std::string bytes, int flips) {
    RandomStream random(11);
    int count = 0;
    for (int i = 0; i < flips; ++i) {
        const std::uint64_t bit = random.bits() % (8 * bytes.size());
        const char mask = static_cast<char>(1U << (bit % 8));
        bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ mask);
        try {
            store::decode_blocks(bytes, "c");
            ++count;
        } catch (const InputError&) { // as it should be
        }
        bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ mask);
    }
    REQUIRE_NOTHROW(store::decode_blocks(bytes, "c")); // all were undone
    return count;
}

/// With another value in the header, and a header checksum that fits.
template<class Value>
std::string with_header(std::string bytes, std::size_t offset, Value value) {
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    const std::uint64_t check = store::xxh3(std::string_view(bytes).substr(0, 32));
    std::memcpy(bytes.data() + 32, &check, 8);
    return bytes;
}

} // namespace

TEST_CASE("Blocks come back as they were") {
    for (const auto& blocks : {std::vector<Block>{}, example(0), example(100)})
        CHECK(store::decode_blocks(store::encode_blocks(blocks), "c") == blocks);
    const auto blocks = example(10);
    CHECK(store::find_block(blocks, "run", "c") == blocks[2]);
    CHECK(error_of<InputError>([&] { store::find_block(blocks, "lid", "c"); }) ==
          "c: the checkpoint has no block \"lid\"");
}

TEST_CASE("The checksum is XXH3-64") {
    // Test vectors of the xxHash project for the empty input and seed 0.
    CHECK(store::xxh3("") == 0x2D06800538D394C2ULL);
    CHECK(store::xxh3("a") != store::xxh3("b"));
    CHECK(store::xxh3("a", 1) != store::xxh3("a", 2));
}

TEST_CASE("Every single bit of a small checkpoint counts") {
    std::string bytes = store::encode_blocks(example(2));
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        std::string flipped = bytes;
        flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << (bit % 8)));
        if (refusal(flipped).empty())
            FAIL("bit " << bit);
    }
}

TEST_CASE("Random bit flips are noticed") {
    const std::string bytes = store::encode_blocks(example(200));
    CHECK(bytes.size() > 9600);
    CHECK(unnoticed(bytes, 20000) == 0);
}

TEST_CASE("A hundred thousand random bit flips are noticed", "[.][long]") {
    const std::string bytes = store::encode_blocks(example(2100));
    CHECK(bytes.size() > 100000);
    CHECK(unnoticed(bytes, 100000) == 0);
}

TEST_CASE("A checkpoint cut off anywhere, or gone on after its end, is refused") {
    const std::string bytes = store::encode_blocks(example(2100));
    for (std::size_t length = 1; length < bytes.size(); ++length)
        if (!has(refusal(std::string_view(bytes).substr(0, length)), "truncated checkpoint"))
            FAIL("length " << length);
    for (std::size_t more : {1, 7, 8, 24, 1000}) {
        CHECK(has(refusal(bytes + std::string(more, '\0')), "longer than expected"));
        CHECK(has(refusal(bytes + bytes.substr(bytes.size() - more)), "longer than expected"));
    }
    CHECK(has(refusal(bytes + bytes), "longer than expected"));
}

TEST_CASE("The message says what is wrong") {
    const std::string bytes = store::encode_blocks(example(20));
    CHECK(refusal("") == "c: not a checkpoint: the file is empty");
    CHECK(has(refusal("schema = 1\n[medium]\n"), "c: not a checkpoint"));
    CHECK(has(refusal(std::string(1000, '\0')), "c: not a checkpoint"));
    CHECK(refusal(with_header(bytes, 8, std::uint32_t{1})) ==
          "c: checkpoint of format version 1; this program reads version 2");
    CHECK(has(refusal(with_header(bytes, 12, std::uint32_t{0x04030201})), "other byte order"));
    CHECK(has(refusal(with_header(bytes, 12, std::uint32_t{5})), "unknown byte order"));
    std::string damaged = bytes;
    damaged[20] = '\7';
    CHECK(refusal(damaged) == "c: damaged header");
    damaged = bytes;
    damaged[100] = static_cast<char>(~damaged[100]); // within the first array
    CHECK(refusal(damaged) == "c: damaged block \"beads\"");
    damaged = bytes;
    damaged[56] = '\1'; // the first letter of a name
    CHECK(refusal(damaged) == "c: damaged block \"?eads\"");
    damaged = bytes;
    damaged[43] = '\x7f'; // the highest byte of the name's length
    CHECK(has(refusal(damaged), "damaged block number 1: its length goes beyond the end"));
    damaged = bytes;
    damaged.back() = static_cast<char>(~damaged.back());
    CHECK(has(refusal(damaged), "the checksum of the whole file does not match"));
}

TEST_CASE("A block of another layout is refused by its reader") {
    const std::vector<Block> blocks = {{"state", {std::byte{1}}, 3}};
    const auto read = store::decode_blocks(store::encode_blocks(blocks), "c");
    CHECK(read == blocks);
    CHECK(store::find_block(read, "state", "c", 3) == blocks[0]);
    CHECK(error_of<InputError>([&] { store::find_block(read, "state", "c"); }) ==
          "c: block \"state\" has layout 3; this program reads layout 1");
}

TEST_CASE("A header that lies about the number of blocks is refused") {
    const std::string bytes = store::encode_blocks(example(20));
    CHECK(has(refusal(with_header(bytes, 24, std::uint64_t{3})), "its blocks end at byte"));
    CHECK(has(refusal(with_header(bytes, 24, std::uint64_t{5})), "damaged block number 5: no room"));
    CHECK(has(refusal(with_header(bytes, 24, ~std::uint64_t{0})), "damaged block number 5: no room"));
}
