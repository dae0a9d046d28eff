// The lock is the system's own (flock), so it goes with its process however that ends; what stands in the
// file only tells whose it is.

#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace rodwake::app {

namespace {

std::string content_of(int file) {
    std::array<char, 256> text{};
    const ssize_t size = ::pread(file, text.data(), text.size(), 0);
    std::string found(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
    while (!found.empty() && found.back() == '\n')
        found.pop_back();
    return found;
}

/// "process 1234 on host name"
std::string own_name() {
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    return fmt::format("process {} on host {}", ::getpid(), host.data());
}

/// Whether the open file is still the one of that name: its owner removes it when done.
bool is_current(int file, const std::string& name) {
    struct stat open_one {
    }, named{};
    return ::fstat(file, &open_one) == 0 && ::stat(name.c_str(), &named) == 0 &&
           open_one.st_ino == named.st_ino && open_one.st_dev == named.st_dev;
}

int opened(const std::string& name) {
    const int file = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file < 0)
        throw RunError(fmt::format("{}: cannot make the lock: {}", name, std::strerror(errno)));
    return file;
}

} // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : name_((folder / "rodwake.lock").string()) {
    const std::string& name = name_;
    file_ = opened(name);
    bool held = ::flock(file_, LOCK_EX | LOCK_NB) == 0;
    while (held && !is_current(file_, name)) { // its owner removed it in between
        ::close(file_);
        file_ = opened(name);
        held = ::flock(file_, LOCK_EX | LOCK_NB) == 0;
    }
    const std::string owner = content_of(file_);
    if (!held) {
        ::close(std::exchange(file_, -1));
        throw InputError(
            fmt::format("{}: {} works in this folder; wait for it, or choose another folder with -o",
                        folder.string(), owner.empty() ? "another process" : owner));
    }
    taken_over_ = owner;
    const std::string text = own_name() + "\n";
    if (::ftruncate(file_, 0) != 0 ||
        ::pwrite(file_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
        const std::string why = std::strerror(errno);
        ::unlink(name.c_str());
        ::close(std::exchange(file_, -1));
        throw RunError(fmt::format("{}: cannot write the lock: {}", name, why));
    }
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : name_(std::move(other.name_)), file_(std::exchange(other.file_, -1)),
      taken_over_(std::move(other.taken_over_)) {}

FolderLock::~FolderLock() {
    if (file_ < 0)
        return;
    ::unlink(name_.c_str()); // before it is let go: whoever opened it meanwhile looks again
    ::close(file_);
}

} // namespace rodwake::app
