#include "rodwake/store/journal.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"

#include "descriptor.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rodwake::store {

namespace {

constexpr std::string_view magic = "RWKJRNL\n";
constexpr std::uint32_t version = 1, byte_order = 0x01020304;
constexpr std::size_t file_head = 16, record_head = 16, check_size = 8, buffer_size = std::size_t{1} << 20;

template<class T>
void put(std::string& out, T value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template<class T>
T peek(const char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

std::string head_of_file() {
    std::string head(magic);
    put(head, version);
    put(head, byte_order);
    return head;
}

/// The record as it is in the file at this offset.
std::string framed(std::uint32_t layout, std::string_view content, std::uint64_t offset) {
    std::string frame;
    frame.reserve(record_head + content.size() + check_size);
    put(frame, std::uint64_t{content.size()});
    put(frame, layout);
    put(frame, static_cast<std::uint32_t>(xxh3(frame, offset)));
    frame += content;
    put(frame, xxh3(content, offset));
    return frame;
}

/// Fewer bytes than wanted only at the end of the file.
std::string read_at(int descriptor, std::uint64_t offset, std::size_t size,
                    const std::filesystem::path& path) {
    std::string bytes(size, '\0');
    std::size_t done = 0;
    while (done < size) {
        const ssize_t got =
            ::pread(descriptor, bytes.data() + done, size - done, static_cast<off_t>(offset + done));
        if (got < 0 && errno != EINTR)
            system_failure(path, "read");
        if (got == 0)
            break;
        done += got < 0 ? 0 : static_cast<std::size_t>(got);
    }
    bytes.resize(done);
    return bytes;
}

std::string journal_of(std::string_view key) { return head_of_file() + framed(0, key, file_head); }

} // namespace

std::string journal_of(std::string_view key, std::uint32_t layout, std::span<const std::byte> content) {
    const std::string empty = journal_of(key);
    return empty + framed(layout, as_text(content), empty.size());
}

Journal::Journal(std::filesystem::path file, std::string_view key, OfAnother of_another)
    : file_(std::move(file)) {
    std::error_code error;
    const auto size = std::filesystem::file_size(file_, error);
    if (error == std::errc::no_such_file_or_directory || (!error && size == 0)) // never begun
        write_atomically(file_, journal_of(key));
    try {
        open(O_RDWR);
        index();
    } catch (const InputError&) {
        if (of_another == OfAnother::refuse)
            throw;
    }
    if (key_ != key && of_another == OfAnother::refuse)
        throw InputError(file_.string() + ": is the journal of other work; choose another folder with -o, "
                                          "or --force to replace it");
    if (key_ != key) {
        replaced_ = true;
        write_atomically(file_, journal_of(key));
        open(O_RDWR);
        index();
    }
    shorten(); // by what was being written when the process ended
}

Journal::Journal(std::filesystem::path file) : file_(std::move(file)) {
    try {
        open(O_RDONLY);
    } catch (const RunError& error) {
        throw InputError(error.what());
    }
    index();
}

Journal::~Journal() {
    try {
        flush();
    } catch (const RunError&) { // flush() before it would have thrown
    }
}

void Journal::open(int flags) {
    descriptor_ = std::make_unique<Descriptor>(file_, flags | O_CLOEXEC);
    if (descriptor_->get() < 0)
        system_failure(file_, "open");
}

/// Finds the whole records by their heads, through a window on the file.
void Journal::index() {
    const std::string head = read_at(descriptor_->get(), 0, file_head, file_);
    if (!head.starts_with(magic))
        throw InputError(file_.string() +
                         ": is not a journal of rodwake, or of an earlier version, or its first bytes "
                         "are damaged; move it away");
    if (head != head_of_file())
        throw InputError(file_.string() +
                         ": is a journal of another version of rodwake, or of a machine of the other byte "
                         "order; choose another folder with -o, or --force to start anew");
    struct stat info {};
    if (::fstat(descriptor_->get(), &info) != 0)
        system_failure(file_, "read the size of");
    const auto size = static_cast<std::uint64_t>(info.st_size);
    records_.clear();
    end_ = file_head;
    std::string window;
    std::uint64_t window_at = 0;
    while (end_ + record_head + check_size <= size) {
        if (end_ < window_at || end_ + record_head > window_at + window.size()) {
            window_at = end_;
            window = read_at(descriptor_->get(), window_at, std::size_t{1} << 16, file_);
            if (window.size() < record_head)
                break;
        }
        const char* at = window.data() + (end_ - window_at);
        const auto length = peek<std::uint64_t>(at);
        const bool whole = peek<std::uint32_t>(at + 12) == static_cast<std::uint32_t>(xxh3({at, 12}, end_)) &&
                           length <= size - end_ - record_head - check_size;
        if (!whole)
            break;
        records_.push_back({end_, length, peek<std::uint32_t>(at + 8)});
        end_ += record_head + length + check_size;
    }
    if (records_.empty())
        throw InputError(file_.string() +
                         ": the first record of this journal is damaged: choose another folder with -o, or "
                         "--force to start anew");
    const std::vector<std::byte> key = read(0);
    key_ = as_text(key);
    records_.erase(records_.begin());
}

const Journal::RecordSpan& Journal::span_of(std::size_t record) const {
    if (record >= size())
        throw InputError(fmt::format("{}: is damaged: it ends before record {}", file_.string(), record));
    return records_[record];
}

void Journal::require_layout(std::size_t record, std::uint32_t layout) const {
    if (span_of(record).layout != layout)
        throw InputError(file_.string() +
                         ": written by another version of rodwake with a different layout: resume with that "
                         "version, choose another folder with -o, or --force to start again");
}

std::vector<std::byte> Journal::read(std::size_t record) {
    flush();
    const RecordSpan& at = span_of(record);
    const std::string bytes =
        read_at(descriptor_->get(), at.offset + record_head, at.length + check_size, file_);
    const std::string_view content = std::string_view(bytes).substr(0, at.length);
    if (bytes.size() != at.length + check_size ||
        peek<std::uint64_t>(bytes.data() + at.length) != xxh3(content, at.offset))
        throw InputError(fmt::format("{}: record {} is damaged", file_.string(), record));
    const auto* first = reinterpret_cast<const std::byte*>(content.data());
    return {first, first + content.size()};
}

void Journal::keep(std::size_t records) {
    if (records > size())
        throw InputError(fmt::format("{}: holds {} records, {} are needed: put the whole file back, or start "
                                     "anew with --force",
                                     file_.string(), size(), records));
    flush();
    if (records < size())
        end_ = records_[records].offset;
    records_.resize(records);
    shorten();
}

void Journal::shorten() {
    struct stat info {};
    if (::fstat(descriptor_->get(), &info) != 0)
        system_failure(file_, "read the size of");
    if (static_cast<std::uint64_t>(info.st_size) > end_ &&
        ::ftruncate(descriptor_->get(), static_cast<off_t>(end_)) != 0)
        system_failure(file_, "shorten");
}

void Journal::append(std::uint32_t layout, std::span<const std::byte> content) {
    buffer_ += framed(layout, as_text(content), end_);
    records_.push_back({end_, content.size(), layout});
    end_ += record_head + content.size() + check_size;
    if (buffer_.size() >= buffer_size)
        flush();
}

void Journal::flush() {
    const std::string out = std::exchange(buffer_, {}); // a failure is not tried again half-way
    if (out.empty())
        return;
    if (::lseek(descriptor_->get(), static_cast<off_t>(end_ - out.size()), SEEK_SET) < 0)
        system_failure(file_, "write");
    try {
        write_all(descriptor_->get(), out, file_);
    } catch (const RunError& error) {
        throw RunError(std::string(error.what()) +
                       "; what was written before is kept, and the same command resumes from there");
    }
}

void Journal::sync() {
    flush();
    if (::fsync(descriptor_->get()) != 0)
        system_failure(file_, "sync");
}

} // namespace rodwake::store
