// The lock is the system's own (flock), so it goes with its process however that ends; what stands in the
// file only tells whose it is. Where the file system has no such locks, the file is the lock.

#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
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

/// Whether a process of that name, as own_name() tells it, has run on this host and does no more.
bool is_gone(const std::string& owner) {
    const std::string own = own_name();
    const std::size_t host = own.find(" on host ");
    return owner.starts_with("process ") && owner.ends_with(own.substr(host)) &&
           ::kill(std::atoi(owner.c_str() + std::strlen("process ")), 0) != 0 && errno == ESRCH;
}

} // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : name_((folder / "rodwake.lock").string()) {
    const std::string& name = name_;
    std::string owner;
    for (bool held = false; !held;) {
        file_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
        const bool made = file_ >= 0;
        if (!made && errno == EEXIST)
            file_ = ::open(name.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
        if (file_ < 0 && errno == ENOENT && std::filesystem::is_directory(folder))
            continue; // its owner removed it in between
        if (file_ < 0)
            throw RunError(fmt::format("{}: cannot make the lock: {}", name, std::strerror(errno)));
        int failed = 0;
        while ((failed = ::flock(file_, LOCK_EX | LOCK_NB) == 0 ? 0 : errno) == EINTR) {
        }
        owner = content_of(file_);
        held = failed == 0 && is_current(file_, name);
        // Some network file systems lock no files: there it counts who made the file.
        if (failed != 0 && failed != EWOULDBLOCK) {
            const bool left = !made && is_gone(owner) && is_current(file_, name);
            if (made)
                doubt_ = fmt::format("{}: this file system cannot lock files ({}); {} keeps other commands "
                                     "out, and stays if this one is killed",
                                     folder.string(), std::strerror(failed), name);
            else if (left) {
                taken_over_ = owner;
                ::unlink(name.c_str());
            }
            held = made;
            failed = made || left ? 0 : failed;
        }
        if (!held)
            ::close(std::exchange(file_, -1));
        if (failed != 0)
            throw InputError(fmt::format(
                "{}: {} works in this folder; wait for it, or choose another folder with -o{}",
                folder.string(), owner.empty() ? "another process" : owner,
                failed == EWOULDBLOCK ? ""
                                      : fmt::format("; this file system cannot lock files ({}), so if that "
                                                    "process is gone, remove {}",
                                                    std::strerror(failed), name)));
    }
    if (taken_over_.empty())
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
      taken_over_(std::move(other.taken_over_)), doubt_(std::move(other.doubt_)) {}

FolderLock::~FolderLock() {
    if (file_ < 0)
        return;
    ::unlink(name_.c_str()); // before it is let go: whoever opened it meanwhile looks again
    ::close(file_);
}

} // namespace rodwake::app
