#pragma once
// Values to bytes and back, in the machine's own byte order. Lengths and sizes are stored with arrays, so
// that reading what was not written is an error and never a guess.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace rodwake::store {

/// What may be copied byte by byte. Structures should have no padding: it would write what is in memory
/// there.
template<class T>
concept Plain = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>;

class ByteWriter {
public:
    template<Plain T>
    void put(const T& value) {
        append(&value, sizeof value);
    }
    /// Size of an element, number of elements, elements.
    template<Plain T>
    void put_array(std::span<const T> values) {
        put(std::uint64_t{sizeof(T)});
        put(std::uint64_t{values.size()});
        append(values.data(), values.size_bytes());
    }
    template<Plain T>
    void put_array(const std::vector<T>& values) {
        put_array(std::span<const T>(values));
    }
    void put_text(std::string_view text) { put_array(std::span<const char>(text)); }

    /// What was put so far; the writer is empty afterwards.
    std::vector<std::byte> take() { return std::exchange(bytes_, {}); }

private:
    void append(const void* data, std::size_t size);

    std::vector<std::byte> bytes_;
};

/// Gives back in the same order what a ByteWriter got. Every failure is an InputError that begins with
/// `where`.
class ByteReader {
public:
    ByteReader(std::span<const std::byte> bytes, std::string where)
        : rest_(bytes), where_(std::move(where)) {}

    template<Plain T>
    T get() {
        T value;
        copy(&value, sizeof value);
        return value;
    }
    template<Plain T>
    std::vector<T> get_array() {
        std::vector<T> values(array_size(sizeof(T)));
        copy(values.data(), values.size() * sizeof(T));
        return values;
    }
    std::string get_text();

    /// Throws if there is something left.
    void finish() const;

private:
    [[noreturn]] void fail(const std::string& what) const;
    void copy(void* to, std::size_t size);
    /// Number of elements of the array that follows; they are there.
    std::size_t array_size(std::size_t element);

    std::span<const std::byte> rest_;
    std::string where_;
};

} // namespace rodwake::store
