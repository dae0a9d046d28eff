#pragma once
// The journal of a run: records appended while the work goes on, and read back by the run that resumes it.
// Starts of a fit, blocks of a posterior, runs with noise, points of a scan, rows and frames of a bed are
// kept in this one way. A value that is replaced as a whole (a checkpoint, an archive, a table of a wake) is
// a journal of one record, written in one step.
//
//   8  magic "RWKJRNL\n"    4  format version, 1    4  0x01020304, then records, the first of them the key
//   for each record:
//   8  length of the content    4  layout    4  lower half of XXH3-64 of the 12 bytes before, seeded by
//   offset
//      content                  8  XXH3-64 of the content, seeded by the offset of the record
//
// Integers are in the byte order of the machine. The checksums depend on the offset, so that records cannot
// change places. A record that was being written when the process was killed or the disk was full is
// dropped; one whose content was damaged later is recognised when it is read, and those behind it stay
// readable.

#include "rodwake/core/error.hpp"
#include "rodwake/store/archive.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::store {

class Descriptor;

class Journal {
public:
    /// Treatment of a journal of another key, or of a file that is no whole journal.
    enum class OfAnother { refuse, replace };

    /// Opens the file to append to it, or makes it. `key` holds all that the records depend on. Throws
    /// InputError, and leaves the file as it is, where it is refused; RunError if it cannot be written.
    Journal(std::filesystem::path file, std::string_view key, OfAnother of_another);
    /// Opens it to read what it holds so far, also while another process appends. Throws InputError.
    explicit Journal(std::filesystem::path file);
    /// Writes what is still buffered, if it can; flush() throws where it cannot.
    ~Journal();
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;
    Journal(Journal&&) = delete;
    Journal& operator=(Journal&&) = delete;

    const std::string& key() const { return key_; }
    /// Whether the constructor replaced what was there.
    bool replaced() const { return replaced_; }
    /// Records besides the key.
    std::size_t size() const { return records_.size(); }
    std::uint32_t layout(std::size_t record) const { return span_of(record).layout; }
    /// Throws InputError if the record is damaged, or the journal ends before it.
    std::vector<std::byte> read(std::size_t record);
    /// Drops all but the first records: the rest came after a checkpoint. Throws InputError if there are
    /// fewer.
    void keep(std::size_t records);

    /// Throws RunError with the system's reason if the buffer is full and cannot be written. After that the
    /// journal is of no more use: open it again.
    void append(std::uint32_t layout, std::span<const std::byte> content);
    /// Hands the buffer to the system: the records outlive the process. Throws RunError.
    void flush();
    /// flush(), then on to the disk: to be done before a checkpoint counts on the records. Throws RunError.
    void sync();

    /// A value whose parts are described (archive.hpp), in the file when the call returns.
    template<class T>
    void add(const T& value) {
        append(layout_hash(Kept<T>::layout()), to_bytes(value));
        flush();
    }
    /// Throws InputError as read, and for a record of another layout.
    template<class T>
    T value(std::size_t record = 0) {
        require_layout(record, layout_hash(Kept<T>::layout()));
        return from_bytes<T>(read(record), file_.string());
    }
    /// Nothing if the record is damaged, or of another layout.
    template<class T>
    std::optional<T> get(std::size_t record) try {
        return value<T>(record);
    } catch (const InputError&) {
        return std::nullopt;
    }
    /// All values of this layout, in their order, without those that are damaged.
    template<class T>
    std::vector<T> all() {
        std::vector<T> values;
        for (std::size_t i = 0; i < size(); ++i)
            if (std::optional<T> value = get<T>(i))
                values.push_back(std::move(*value));
        return values;
    }

private:
    struct RecordSpan {
        std::uint64_t offset, length;
        std::uint32_t layout;
    };

    void open(int flags);
    void index();
    const RecordSpan& span_of(std::size_t record) const;
    void require_layout(std::size_t record, std::uint32_t layout) const;
    /// Takes away what is behind the last whole record. A file without such is not touched.
    void shorten();

    std::filesystem::path file_;
    std::unique_ptr<Descriptor> descriptor_;
    std::string key_;
    bool replaced_ = false;
    std::vector<RecordSpan> records_;
    std::uint64_t end_ = 0; ///< offset of the next record
    std::string buffer_;    ///< the last whole records, not yet in the file
};

/// A journal of one record as the bytes of a file: for write_atomically and write_generation.
std::string journal_of(std::string_view key, std::uint32_t layout, std::span<const std::byte> content);
template<class T>
std::string journal_of(std::string_view key, const T& value) {
    return journal_of(key, layout_hash(Kept<T>::layout()), to_bytes(value));
}

} // namespace rodwake::store
