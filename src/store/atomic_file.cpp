#include "rodwake/store/atomic_file.hpp"

#include "descriptor.hpp"
#include "rodwake/core/error.hpp"

#include <fcntl.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cerrno>
#include <cstring>

namespace rodwake::store {

namespace {

void sync_path(const std::filesystem::path& path, int flags) {
    const Descriptor file(path, flags | O_RDONLY | O_CLOEXEC);
    if (file.get() < 0 || ::fsync(file.get()) != 0)
        system_failure(path, "sync");
}

} // namespace

PendingFile::PendingFile(std::filesystem::path target) : target_(std::move(target)), temporary_(target_) {
    temporary_ += ".tmp" + std::to_string(::getpid());
    ::unlink(temporary_.c_str()); // of a process that had our number, or a link that somebody put there
    const Descriptor probe(temporary_, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC);
    if (probe.get() < 0)
        system_failure(target_, "write");
}

PendingFile::~PendingFile() {
    if (!committed_)
        ::unlink(temporary_.c_str());
}

void PendingFile::write(std::string_view content) {
    const Descriptor file(temporary_, O_WRONLY | O_APPEND | O_CLOEXEC);
    if (file.get() < 0)
        system_failure(target_, "write");
    write_all(file.get(), content, target_);
}

void PendingFile::sync() { sync_path(temporary_, 0); }

void PendingFile::commit() {
    sync();
    if (::rename(temporary_.c_str(), target_.c_str()) != 0)
        system_failure(target_, "rename the finished file to");
    committed_ = true;
    try {
        sync_folder_of(target_);
    } catch (
        const RunError&) { // the file is whole and in place; without power the one before it may come back
    }
}

void write_atomically(const std::filesystem::path& target, std::string_view content) {
    PendingFile pending(target);
    pending.write(content);
    pending.commit();
}

namespace {

[[noreturn]] void unreadable(const std::filesystem::path& path) {
    throw InputError(path.string() + ": cannot read the file: " + std::strerror(errno));
}

} // namespace

void system_failure(const std::filesystem::path& path, const char* doing) {
    throw RunError(path.string() + ": cannot " + doing + ": " + std::strerror(errno));
}

Descriptor::Descriptor(const std::filesystem::path& path, int flags)
    : fd_(::open(path.c_str(), flags, 0644)) {}

Descriptor::~Descriptor() {
    if (fd_ >= 0)
        ::close(fd_);
}

void write_all(int file, std::string_view content, const std::filesystem::path& path) {
    while (!content.empty()) {
        const ssize_t written = ::write(file, content.data(), content.size());
        if (written < 0 && errno != EINTR)
            system_failure(path, "write");
        content.remove_prefix(written < 0 ? 0 : static_cast<std::size_t>(written));
    }
}

void sync_folder_of(const std::filesystem::path& path) {
    sync_path(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."), O_DIRECTORY);
}

std::uint64_t xxh3(std::string_view bytes, std::uint64_t seed) {
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::uint64_t content_hash(const std::filesystem::path& path, std::string_view salt) {
    const Descriptor file(path, O_RDONLY | O_CLOEXEC);
    if (file.get() < 0)
        unreadable(path);
    std::uint64_t hash = xxh3(salt);
    for (std::string block(std::size_t{1} << 22, '\0');;) {
        const ssize_t got = ::read(file.get(), block.data(), block.size());
        if (got < 0 && errno != EINTR)
            unreadable(path);
        if (got == 0)
            return hash;
        if (got > 0)
            hash = xxh3(std::string_view(block).substr(0, static_cast<std::size_t>(got)), hash);
    }
}

} // namespace rodwake::store
