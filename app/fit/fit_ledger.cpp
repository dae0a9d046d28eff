#include "fit_files.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/store/bytes.hpp"

#include <functional>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using fitting::StartResult;

constexpr std::size_t longest_text = 1000;
/// Key, index, objective, evaluations, start and end with their sizes, text with its own.
std::size_t record_bytes(std::size_t free) { return 4 * 8 + 2 * (16 + 8 * free) + 16 + 8 + longest_text; }
constexpr std::size_t header_bytes = 32, check_bytes = 8; // of store::AppendLog

std::vector<std::byte> to_record(const StartResult& end, std::uint64_t key, std::size_t free) {
    store::ByteWriter out;
    out.put(key);
    out.put(std::uint64_t{end.index});
    out.put(end.objective);
    out.put(std::int64_t{end.evaluations});
    out.put_array(end.start);
    out.put_array(end.end);
    out.put_text(end.termination);
    std::vector<std::byte> bytes = out.take();
    bytes.resize(record_bytes(free));
    return bytes;
}

/// Nothing if it is of another key.
bool from_record(std::span<const std::byte> bytes, const std::string& where, std::uint64_t key,
                 StartResult& end) {
    store::ByteReader in(bytes, where);
    if (in.get<std::uint64_t>() != key)
        return false;
    end.index = in.get<std::uint64_t>();
    end.objective = in.get<double>();
    end.evaluations = in.get<std::int64_t>();
    end.start = in.get_array<double>();
    end.end = in.get_array<double>();
    end.termination = in.get_text();
    return true;
}

/// Whole records in the file; a last one that was being written does not count.
std::size_t whole_records(const fs::path& file, std::size_t bytes) {
    std::error_code error;
    const auto size = fs::file_size(file, error);
    return error || size < header_bytes ? 0 : (size - header_bytes) / (bytes + check_bytes);
}

/// A damaged or foreign ledger is of no use, and no harm.
std::vector<StartResult> read(const fs::path& file, std::uint64_t key, std::size_t free) {
    std::vector<StartResult> done;
    const std::size_t count = whole_records(file, record_bytes(free));
    try {
        if (count == 0)
            return done;
        store::AppendLog log(file, record_bytes(free), count);
        for (std::size_t i = 0; i < count; ++i)
            if (StartResult end; from_record(log.read(i), file.string(), key, end))
                done.push_back(std::move(end));
            else
                return {};
    } catch (const InputError&) { // what was read so far holds
    }
    return done;
}

} // namespace

FitLedger::FitLedger(fs::path file, const std::string& key, std::size_t free)
    : file_(std::move(file)), key_(std::hash<std::string>{}(key)), free_(free),
      done_(read(file_, key_, free)) {
    if (done_.empty())
        fs::remove(file_); // whatever is there is of another fit, or damaged
    log_ = std::make_unique<store::AppendLog>(file_, record_bytes(free_), done_.size());
}

void FitLedger::add(const StartResult& end) {
    if (end.termination.size() > longest_text)
        return; // would not come back the same: this start is done again
    log_->append(to_record(end, key_, free_));
    log_->flush();
}

} // namespace rodwake::app
