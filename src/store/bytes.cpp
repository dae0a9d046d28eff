#include "rodwake/store/bytes.hpp"

#include "descriptor.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/archive.hpp"

#include <fmt/format.h>

namespace rodwake::store {

std::uint32_t layout_hash(const std::string& layout) { return static_cast<std::uint32_t>(xxh3(layout)); }

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

std::string ByteReader::get_text() {
    const std::vector<char> text = get_array<char>();
    return std::string(text.begin(), text.end());
}

void ByteReader::finish() const {
    if (!rest_.empty())
        fail(fmt::format("{} bytes are left over", rest_.size()));
}

} // namespace rodwake::store
