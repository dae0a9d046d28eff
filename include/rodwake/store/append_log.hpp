#pragma once
// Append-only file of records of one size: what a long run writes while it goes on. A checkpoint remembers
// how many records count; going on from it drops the rest.
//
//   8  magic "RWKRECS\n"    4  format version, 1    4  0x01020304    8  bytes of a record
//   8  XXH3-64 of the 24 bytes above
//   then for each record: its bytes, XXH3-64 of them with the record's number as seed

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace rodwake::store {

class AppendLog {
public:
    /// Opens the file and drops all but its first `keep_records` records. If 0 are to be kept it is made or
    /// made anew. Throws InputError if the file is not such a log, has records of another size or fewer than
    /// that; RunError if it cannot be written.
    AppendLog(std::filesystem::path path, std::size_t record_bytes, std::size_t keep_records);
    /// Writes what is still buffered, if it can; sync() tells whether that went well.
    ~AppendLog();
    AppendLog(const AppendLog&) = delete;
    AppendLog& operator=(const AppendLog&) = delete;
    AppendLog(AppendLog&&) = delete;
    AppendLog& operator=(AppendLog&&) = delete;

    std::size_t records() const { return records_; }

    /// Throws RunError with the system's reason if the buffer is full and cannot be written,
    /// std::invalid_argument if it is not of the record's size. After a RunError the log is of no more use:
    /// open it again.
    void append(std::span<const std::byte> record);
    /// Hands the buffer to the system. Throws RunError.
    void flush();
    /// flush(), then on to the disk: to be done before a checkpoint counts on the records. Throws RunError.
    void sync();

    /// Record i < records(). Throws InputError if it is damaged.
    std::vector<std::byte> read(std::size_t i);

private:
    std::size_t stride() const { return record_bytes_ + 8; }
    std::size_t place(std::size_t record) const;
    void open_existing(std::size_t keep_records);

    std::filesystem::path path_;
    std::size_t record_bytes_, records_ = 0;
    int file_ = -1;
    std::vector<std::byte> buffer_; ///< whole records, the last of the log
};

} // namespace rodwake::store
