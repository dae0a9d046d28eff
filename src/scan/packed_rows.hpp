#pragma once
// Points of a ledger as records of one length, many a row: id, axes, observables, seconds (8 bytes each,
// little endian), outcome and retries (4 bytes each). Only points that succeeded and have no cause are
// packed.

#include "rodwake/scan/ledger.hpp"

#include <string>

namespace rodwake::scan {

class PackedRows {
public:
    explicit PackedRows(const LedgerHead& head);

    /// Whether a record holds all of a result.
    static bool fits(const Result& result) { return result.ok() && result.cause.front() == '\0'; }

    std::size_t length() const { return length_; } ///< of a record, bytes
    void append(std::string& bytes, const Result& result) const;
    static std::int64_t id(const char* record);
    /// Throws InputError, without a file, for an outcome or a word that the head does not have.
    Result result(const char* record) const;

    /// The layout as numpy.dtype takes it, in JSON: [["id", "<i8"], ...].
    std::string layout() const;

private:
    const LedgerHead& head_;
    std::size_t length_;
};

} // namespace rodwake::scan
