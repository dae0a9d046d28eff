#include "rodwake/store/atomic_file.hpp"

#include "rodwake/core/error.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace rodwake::store {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* doing) {
    throw RunError(path.string() + ": cannot " + doing + ": " + std::strerror(errno));
}

/// A file descriptor that closes itself.
class Descriptor {
public:
    Descriptor(const std::filesystem::path& path, int flags) : fd_(::open(path.c_str(), flags, 0644)) {}
    ~Descriptor() {
        if (fd_ >= 0)
            ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    Descriptor(Descriptor&&) = delete;
    Descriptor& operator=(Descriptor&&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

void sync(const std::filesystem::path& path, int flags) {
    const Descriptor file(path, flags);
    if (file.get() < 0 || ::fsync(file.get()) != 0)
        fail(path, "sync");
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

} // namespace

PendingFile::PendingFile(std::filesystem::path target) : target_(std::move(target)), temporary_(target_) {
    temporary_ += ".tmp" + std::to_string(::getpid());
    const Descriptor probe(temporary_, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC);
    if (probe.get() < 0)
        fail(target_, "write");
}

PendingFile::~PendingFile() {
    if (!committed_)
        ::unlink(temporary_.c_str());
}

void PendingFile::commit() {
    sync(temporary_, O_RDONLY | O_CLOEXEC);
    if (::rename(temporary_.c_str(), target_.c_str()) != 0)
        fail(target_, "rename the finished file to");
    committed_ = true;
    sync(folder_of(target_), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

void write_atomically(const std::filesystem::path& target, std::string_view content) {
    PendingFile pending(target);
    {
        const Descriptor file(pending.temporary(), O_WRONLY | O_TRUNC | O_CLOEXEC);
        while (!content.empty()) {
            const ssize_t written = ::write(file.get(), content.data(), content.size());
            if (written < 0)
                fail(target, "write");
            content.remove_prefix(static_cast<std::size_t>(written));
        }
    }
    pending.commit();
}

} // namespace rodwake::store
