#pragma once
// Files appear whole or not at all: written beside their place under a temporary name, synced, renamed.

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace rodwake::store {

/// Temporary name in the same folder, made this file's by commit() and removed if commit() never comes.
class PendingFile {
public:
    /// Throws RunError if the folder is not writable.
    explicit PendingFile(std::filesystem::path target);
    ~PendingFile();
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;
    PendingFile(PendingFile&&) = delete;
    PendingFile& operator=(PendingFile&&) = delete;

    const std::filesystem::path& temporary() const { return temporary_; }
    /// Appends to the temporary file. Throws RunError naming the target and the system's reason.
    void write(std::string_view content);
    /// fsync of the temporary file. Throws RunError.
    void sync();
    /// fsync, rename, fsync of the folder. Throws RunError.
    void commit();

private:
    std::filesystem::path target_, temporary_;
    bool committed_ = false;
};

/// Throws RunError naming the file and the system's reason.
void write_atomically(const std::filesystem::path& target, std::string_view content);

/// A hash of the content (XXH3, block by block), which begins with that of `salt`. Throws RunError.
std::uint64_t content_hash(const std::filesystem::path& file, std::string_view salt);

/// fsync of the folder that this file is in: what was renamed and removed there stays so, and comes before
/// what follows. Throws RunError.
void sync_folder_of(const std::filesystem::path& path);

} // namespace rodwake::store
