#include "rodwake/store/block_file.hpp"

#include "descriptor.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/archive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace rodwake::store {

namespace {

constexpr std::string_view block_magic = "RWKBLOC\n";
constexpr std::uint32_t block_version = 2, block_order = 0x01020304, other_order = 0x04030201;
constexpr std::size_t block_header_size = 40, block_overhead = 24;

template<class Integer>
void put(std::string& out, Integer value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Integer at an offset that is known to be inside.
template<class Integer>
Integer peek(std::string_view bytes, std::size_t offset) {
    Integer value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

std::size_t encoded_size(std::span<const Block> blocks) {
    std::size_t size = block_header_size + 8;
    for (const Block& block : blocks)
        size += block_overhead + block.name.size() + block.content.size();
    return size;
}

/// Walks over the bytes of a file and says what is wrong with them.
class Decoder {
public:
    Decoder(std::string_view bytes, const std::string& file_name) : bytes_(bytes), file_(file_name) {}

    std::vector<Block> decode() {
        check_magic();
        check_header();
        const auto count = peek<std::uint64_t>(bytes_, 24);
        std::vector<Block> blocks;
        while (blocks.size() < count)
            blocks.push_back(next_block(blocks.size() + 1));
        if (at_ + 8 != bytes_.size())
            fail("damaged: its blocks end at byte {} and not at {}", at_, bytes_.size() - 8);
        if (peek<std::uint64_t>(bytes_, at_) != xxh3(bytes_.substr(0, at_)))
            fail("damaged: the checksum of the whole file does not match");
        return blocks;
    }

private:
    template<class... Values>
    [[noreturn]] void fail(fmt::format_string<Values...> what, Values&&... values) const {
        throw InputError(file_ + ": " + fmt::format(what, std::forward<Values>(values)...));
    }

    void check_magic() const {
        if (bytes_.empty())
            fail("not a checkpoint: the file is empty");
        const std::size_t common = std::min(bytes_.size(), block_magic.size());
        if (bytes_.substr(0, common) != block_magic.substr(0, common))
            fail("not a checkpoint, or its first bytes are damaged");
        if (bytes_.size() < block_header_size + 8)
            fail("truncated checkpoint: {} bytes, at least {} expected", bytes_.size(),
                 block_header_size + 8);
    }

    void check_header() {
        if (peek<std::uint32_t>(bytes_, 12) == other_order)
            fail("written on a machine with the other byte order; it can only be resumed on such a machine");
        if (peek<std::uint64_t>(bytes_, 32) != xxh3(bytes_.substr(0, 32)))
            fail("damaged header");
        if (const auto found = peek<std::uint32_t>(bytes_, 8); found != block_version)
            fail("checkpoint of format version {}; this program reads version {}", found, block_version);
        if (peek<std::uint32_t>(bytes_, 12) != block_order)
            fail("checkpoint of an unknown byte order");
        check_length(peek<std::uint64_t>(bytes_, 16));
        at_ = block_header_size;
    }

    void check_length(std::uint64_t wanted) const {
        if (bytes_.size() < wanted)
            fail("truncated checkpoint: {} bytes, {} expected", bytes_.size(), wanted);
        if (bytes_.size() > wanted)
            fail("damaged checkpoint: longer than expected, {} bytes instead of {}", bytes_.size(), wanted);
    }

    /// Bytes that the block may use: what follows but the last checksum.
    std::size_t left() const { return bytes_.size() - 8 - at_; }

    Block next_block(std::size_t number) {
        if (left() < block_overhead)
            fail("damaged block number {}: no room for it", number);
        const std::uint64_t name = peek<std::uint32_t>(bytes_, at_),
                            content = peek<std::uint64_t>(bytes_, at_ + 8);
        const auto layout = peek<std::uint32_t>(bytes_, at_ + 4);
        const std::size_t room = left() - block_overhead;
        if (name > room || content > room - name)
            fail("damaged block number {}: its length goes beyond the end of the file", number);
        const std::string_view block = bytes_.substr(at_, 16 + name + content);
        if (peek<std::uint64_t>(bytes_, at_ + block.size()) != xxh3(block))
            fail("damaged block \"{}\"", printable(block.substr(16, name)));
        at_ += block.size() + 8;
        const auto* first = reinterpret_cast<const std::byte*>(block.data() + 16 + name);
        return {std::string(block.substr(16, name)), std::vector<std::byte>(first, first + content), layout};
    }

    /// A name that may be damaged.
    static std::string printable(std::string_view name) {
        std::string text(name.substr(0, 40));
        std::ranges::replace_if(
            text, [](char c) { return c < ' ' || c > '~'; }, '?');
        return text;
    }

    std::string_view bytes_;
    const std::string& file_;
    std::size_t at_ = 0;
};

} // namespace

std::string encode_blocks(std::span<const Block> blocks) {
    std::string out(block_magic);
    out.reserve(encoded_size(blocks));
    put(out, block_version);
    put(out, block_order);
    put(out, std::uint64_t{encoded_size(blocks)});
    put(out, std::uint64_t{blocks.size()});
    put(out, xxh3(out));
    for (const Block& block : blocks) {
        const std::size_t start = out.size();
        put(out, static_cast<std::uint32_t>(block.name.size()));
        put(out, block.layout);
        put(out, std::uint64_t{block.content.size()});
        out += block.name;
        out += as_text(block.content);
        put(out, xxh3(std::string_view(out).substr(start)));
    }
    put(out, xxh3(out));
    return out;
}

std::vector<Block> decode_blocks(std::string_view bytes, const std::string& file_name) {
    return Decoder(bytes, file_name).decode();
}

const Block& find_block(std::span<const Block> blocks, std::string_view name, const std::string& file_name,
                        std::uint32_t layout) {
    const auto found = std::ranges::find(blocks, name, &Block::name);
    if (found == blocks.end())
        throw InputError(fmt::format("{}: the checkpoint has no block \"{}\"", file_name, name));
    if (found->layout != layout)
        throw InputError(fmt::format("{}: block \"{}\" has layout {}; this program reads layout {}",
                                     file_name, name, found->layout, layout));
    return *found;
}

std::uint32_t layout_hash(const std::string& layout) { return static_cast<std::uint32_t>(xxh3(layout)); }

const Block& find_archive(std::span<const Block> blocks, std::string_view name, const std::string& file,
                          std::uint32_t layout) {
    const auto found = std::ranges::find(blocks, name, &Block::name);
    if (found != blocks.end() && found->layout == layout)
        return *found;
    throw InputError(file + ": written by another version of rodwake with a different layout: resume with "
                            "that version, choose another folder with -o, or --force to start again");
}

void ByteWriter::append(const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), begin, begin + size);
}

void ByteReader::fail(const std::string& what) const { throw InputError(where_ + ": " + what); }

void ByteReader::copy(void* to, std::size_t size) {
    if (size > rest_.size())
        fail(fmt::format("ends early: {} bytes are left, {} expected", rest_.size(), size));
    if (size > 0)
        std::memcpy(to, rest_.data(), size);
    rest_ = rest_.subspan(size);
}

std::size_t ByteReader::array_size(std::size_t element) {
    if (const auto found = get<std::uint64_t>(); found != element)
        fail(fmt::format("values of {} bytes, expected {}", found, element));
    const auto count = get<std::uint64_t>();
    if (count > rest_.size() / element)
        fail(fmt::format("ends early: {} bytes are left, {} values of {} bytes expected", rest_.size(), count,
                         element));
    return count;
}

void ByteReader::want_size(std::size_t found, std::size_t wanted) const {
    if (found != wanted)
        fail(fmt::format("{} values, expected {}", found, wanted));
}

std::string ByteReader::get_text() {
    const std::vector<char> text = get_array<char>();
    return std::string(text.begin(), text.end());
}

void ByteReader::finish() const {
    if (!rest_.empty())
        fail(fmt::format("{} bytes are left over", rest_.size()));
}

} // namespace rodwake::store
