#include "rodwake/store/append_log.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"

#include "descriptor.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <stdexcept>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace rodwake::store {

namespace {

constexpr std::string_view magic = "RWKRECS\n";
constexpr std::uint32_t version = 1, byte_order = 0x01020304;
constexpr std::size_t header_size = 32, buffer_size = std::size_t{1} << 20;

std::string header(std::uint64_t record_bytes) {
    std::string out(magic);
    out.append(reinterpret_cast<const char*>(&version), 4);
    out.append(reinterpret_cast<const char*>(&byte_order), 4);
    out.append(reinterpret_cast<const char*>(&record_bytes), 8);
    const std::uint64_t check = xxh3(out);
    return out.append(reinterpret_cast<const char*>(&check), 8);
}

/// Number of bytes that were read: fewer than wanted only at the end of the file.
std::size_t read_at(int file, char* to, std::size_t size, std::size_t offset,
                    const std::filesystem::path& path) {
    std::size_t done = 0;
    while (done < size) {
        const ssize_t got = ::pread(file, to + done, size - done, static_cast<off_t>(offset + done));
        if (got < 0 && errno != EINTR)
            system_failure(path, "read");
        if (got == 0)
            break;
        done += got < 0 ? 0 : static_cast<std::size_t>(got);
    }
    return done;
}

/// Bytes of a record of the log in this open file. Throws InputError if it is none.
std::size_t record_bytes_of(int file, const std::filesystem::path& path) {
    std::string found(header_size, '\0');
    found.resize(read_at(file, found.data(), header_size, 0, path));
    if (!found.starts_with(magic))
        throw InputError(path.string() + ": not a record log of rodwake; move it away");
    std::uint64_t record_bytes = 0;
    if (found.size() == header_size)
        std::memcpy(&record_bytes, found.data() + 16, 8);
    if (found != header(record_bytes))
        throw InputError(path.string() + ": the header of this record log is damaged or of another version");
    return record_bytes;
}

/// A file in the way that is not such a log is not ours to replace.
void refuse_foreign(const std::filesystem::path& path) {
    const Descriptor file(path, O_RDONLY | O_CLOEXEC);
    if (file.get() >= 0)
        record_bytes_of(file.get(), path);
    else if (errno != ENOENT)
        system_failure(path, "open");
}

std::size_t file_size(int file, const std::filesystem::path& path) {
    struct stat info {};
    if (::fstat(file, &info) != 0)
        system_failure(path, "read the size of");
    return static_cast<std::size_t>(info.st_size);
}

} // namespace

AppendLog::AppendLog(std::filesystem::path path, std::size_t record_bytes, std::size_t keep_records)
    : path_(std::move(path)), record_bytes_(record_bytes) {
    if (record_bytes == 0)
        throw std::invalid_argument("a record log needs records of at least one byte");
    if (keep_records == 0) {
        refuse_foreign(path_);
        write_atomically(path_, header(record_bytes));
    }
    file_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
    if (file_ < 0 && errno == ENOENT)
        throw InputError(fmt::format(
            "{}: is missing; {} records of it are needed: put it back, or start anew with --force",
            path_.string(), keep_records));
    if (file_ < 0)
        system_failure(path_, "open");
    try {
        open_existing(keep_records);
    } catch (...) {
        ::close(file_);
        throw;
    }
}

void AppendLog::open_existing(std::size_t keep_records) {
    if (const std::size_t found = record_bytes_of(file_, path_); found != record_bytes_)
        throw InputError(
            fmt::format("{}: has records of {} bytes, expected {}", path_.string(), found, record_bytes_));
    const std::size_t found = (file_size(file_, path_) - header_size) / stride();
    if (found < keep_records)
        throw InputError(
            fmt::format("{}: holds {} records, {} are needed", path_.string(), found, keep_records));
    records_ = keep_records;
    if (::ftruncate(file_, static_cast<off_t>(place(records_))) != 0 ||
        ::lseek(file_, static_cast<off_t>(place(records_)), SEEK_SET) < 0)
        system_failure(path_, "shorten");
}

AppendLog::~AppendLog() {
    try {
        flush();
    } catch (const RunError&) { // a destructor cannot tell
    }
    ::close(file_);
}

std::size_t AppendLog::place(std::size_t record) const { return header_size + record * stride(); }

void AppendLog::append(std::span<const std::byte> record) {
    if (record.size() != record_bytes_)
        throw std::invalid_argument(fmt::format("{}: a record of {} bytes, expected {}", path_.string(),
                                                record.size(), record_bytes_));
    const std::uint64_t check = xxh3(as_text(record), records_);
    const auto* check_bytes = reinterpret_cast<const std::byte*>(&check);
    buffer_.insert(buffer_.end(), record.begin(), record.end());
    buffer_.insert(buffer_.end(), check_bytes, check_bytes + 8);
    ++records_;
    if (buffer_.size() >= buffer_size)
        flush();
}

void AppendLog::flush() {
    const std::vector<std::byte> out = std::exchange(buffer_, {}); // a failure is not tried again half-way
    write_all(file_, as_text(out), path_);
}

void AppendLog::sync() {
    flush();
    if (::fsync(file_) != 0)
        system_failure(path_, "sync");
}

std::vector<std::byte> AppendLog::read(std::size_t i) {
    if (i >= records_)
        throw std::invalid_argument(fmt::format("{}: no record {} of {}", path_.string(), i, records_));
    flush();
    std::vector<std::byte> record(stride());
    const std::size_t got = read_at(file_, reinterpret_cast<char*>(record.data()), stride(), place(i), path_);
    std::uint64_t check = 0;
    std::memcpy(&check, record.data() + record_bytes_, 8);
    record.resize(record_bytes_);
    if (got != stride() || check != xxh3(as_text(record), i))
        throw InputError(fmt::format("{}: record {} is damaged", path_.string(), i));
    return record;
}

} // namespace rodwake::store
