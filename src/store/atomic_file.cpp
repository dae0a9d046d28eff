#include "rodwake/store/atomic_file.hpp"

#include "descriptor.hpp"
#include "rodwake/core/error.hpp"

#include <fcntl.h>
#include <unistd.h>

namespace rodwake::store {

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

void PendingFile::sync() { sync_file(temporary_); }

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

} // namespace rodwake::store
