#include "sqlite.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <fstream>
#include <unistd.h>

namespace rodwake::scan {

namespace {

/// Whether there is something beside the file that SQLite goes by when it opens it.
bool has_beside(const std::filesystem::path& file, const char* ending) {
    std::error_code none;
    const auto size = std::filesystem::file_size(file.string() + ending, none);
    return !none && size > 0;
}

/// SQLite reads a last page that was cut short as rows of zeros. A log may hold the page, and a journal takes
/// back what was being written when the disk was full.
void require_whole_pages(const std::filesystem::path& file) {
    std::array<char, 18> head{}; // ends with the size of pages, big-endian; 1 stands for 65536
    if (has_beside(file, "-wal") || has_beside(file, "-journal"))
        return;
    if (!std::ifstream(file, std::ios::binary).read(head.data(), head.size()))
        return;
    const auto byte = [&](std::size_t i) {
        return static_cast<unsigned>(static_cast<unsigned char>(head[i]));
    };
    const unsigned page = byte(16) * 256U + byte(17);
    if (std::string_view(head.data(), 15) == "SQLite format 3" && page > 1 &&
        std::filesystem::file_size(file) % page != 0)
        throw InputError(file.string() + ": is damaged: the file was cut short");
}

/// Of a network file system that locks no files SQLite would say that another process has the file.
bool can_be_locked(const std::filesystem::path& file, int flags) {
    const bool writes = (flags & SQLITE_OPEN_READWRITE) != 0;
    const int id = ::open(file.c_str(), O_CLOEXEC | (writes ? O_RDWR | O_CREAT : O_RDONLY), 0644);
    if (id < 0)
        return true; // SQLite says why
    struct flock lock {};
    lock.l_type = F_RDLCK, lock.l_whence = SEEK_SET, lock.l_len = 1;
    const bool can = ::fcntl(id, F_SETLK, &lock) == 0 || errno == EAGAIN || errno == EACCES;
    ::close(id);
    return can;
}

} // namespace

Connection::Connection(const std::filesystem::path& file, int flags) : file_(file) {
    require_whole_pages(file);
    const bool locks = can_be_locked(file, flags);
    sqlite3* handle = nullptr;
    const int code = sqlite3_open_v2(file.c_str(), &handle, flags, locks ? nullptr : "unix-none");
    handle_.reset(handle);
    require(code);
    sqlite3_extended_result_codes(handle, 1);
    if (!locks) // its log would need shared memory, and so locks, otherwise; the folder is ours alone
        run("PRAGMA locking_mode = EXCLUSIVE");
    sqlite3_busy_timeout(handle, 10'000); // ms: whoever reads it meanwhile
}

void Connection::run(const std::string& sql) const {
    require(sqlite3_exec(get(), sql.c_str(), nullptr, nullptr, nullptr));
}

void Connection::require(int code) const {
    if (code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE)
        return;
    const std::string why = handle_ ? sqlite3_errmsg(get()) : sqlite3_errstr(code);
    if ((code & 0xff) == SQLITE_NOTADB || (code & 0xff) == SQLITE_CORRUPT)
        throw InputError(fmt::format("{}: is not a ledger, or damaged ({})", file_.string(), why));
    throw RunError(fmt::format("{}: {}; what was committed is kept, and the same command goes on from there",
                               file_.string(), why));
}

Statement::Statement(const Connection& connection, const std::string& sql) : connection_(connection) {
    sqlite3_stmt* handle = nullptr;
    const int code = sqlite3_prepare_v3(connection.get(), sql.c_str(), static_cast<int>(sql.size()),
                                        SQLITE_PREPARE_PERSISTENT, &handle, nullptr);
    handle_.reset(handle);
    connection.require(code);
}

bool Statement::step() {
    const int code = sqlite3_step(handle_.get());
    if (code == SQLITE_ROW)
        return true;
    sqlite3_reset(handle_.get());
    connection_.require(code);
    return false;
}

} // namespace rodwake::scan
