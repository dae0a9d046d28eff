#pragma once
// POSIX files: descriptors that close themselves, writes that come through whole or say why not; and the
// checksum of what is in them.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace rodwake::store {

/// Throws RunError "<path>: cannot <doing>: <the system's reason>", from errno.
[[noreturn]] void system_failure(const std::filesystem::path& path, const char* doing);

/// Not open (get() < 0) if the system refused; errno tells why.
class Descriptor {
public:
    Descriptor(const std::filesystem::path& path, int flags);
    ~Descriptor();
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    Descriptor(Descriptor&&) = delete;
    Descriptor& operator=(Descriptor&&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

/// All of it at the descriptor's place. Throws RunError naming `path`.
void write_all(int file, std::string_view content, const std::filesystem::path& path);

inline std::string_view as_text(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// XXH3-64, the checksum of every binary file written here.
std::uint64_t xxh3(std::string_view bytes, std::uint64_t seed = 0);

} // namespace rodwake::store
