#pragma once
// The points of a ledger that simply succeeded, packed: a row holds what was added at once. A point takes a
// tenth of the time that a row of its own would, and a million points are some thousand rows.

#include "rodwake/scan/ledger.hpp"
#include "sqlite.hpp"

#include <string>

namespace rodwake::scan {

// Points of a ledger as records of one length, many a row: id, axes, observables, seconds (8 bytes each,
// little endian), outcome and retries (4 bytes each). Only points that succeeded and have no cause are
// packed.

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

class ChunkTable {
public:
    static constexpr const char* create =
        "CREATE TABLE chunks (number INTEGER PRIMARY KEY, first INTEGER NOT NULL, last INTEGER NOT NULL, "
        "points INTEGER NOT NULL, seconds REAL NOT NULL, outcomes TEXT NOT NULL, data BLOB NOT NULL)";

    /// The head must outlive it.
    ChunkTable(const Connection& connection, const LedgerHead& head);

    /// Results that fit a record, by increasing id, none of them in the table.
    void insert(std::span<const Result* const> results);
    /// Takes these points, by increasing id, out of the rows that hold them.
    void remove(std::span<const std::int64_t> ids);
    /// Ids of each row, increasing within a row.
    void for_each_row_of_ids(const std::function<void(std::span<const std::int64_t>)>& each) const;
    /// Adds what the rows count.
    static void count(const Connection& connection, Counts& counts);

    const PackedRows& records() const { return records_; }

    /// All points in their order. Rows may overlap: those that do are held at once.
    class Points {
    public:
        explicit Points(const ChunkTable& table);
        /// The record at hand; null behind the last.
        const char* current() const { return current_; }
        void next();

    private:
        struct Row {
            std::int64_t number, first;
        };
        struct Cursor {
            std::string data;
            std::size_t at = 0;
        };
        using Open = std::pair<std::int64_t, std::size_t>; ///< id at hand, cursor

        void settle();
        void open(std::int64_t number);

        const ChunkTable& table_;
        Statement read_;
        std::vector<Row> rows_; ///< by first id
        std::size_t next_row_ = 0;
        std::vector<Cursor> cursors_;
        std::vector<std::size_t> free_; ///< of them
        std::vector<Open> open_;        ///< a heap, the smallest id in front
        const char* current_ = nullptr;
    };

private:
    Statement bytes_of_row() const { return {connection_, "SELECT data FROM chunks WHERE number = ?"}; }
    std::string checked(std::string_view bytes, std::int64_t number) const;

    const Connection& connection_;
    const LedgerHead& head_;
    PackedRows records_;
    Statement insert_;
};

// The points of a ledger that have something to tell: they failed, or succeeded after retries. A row each
// with named columns, so that sqlite3 and pandas can ask for them.

class CauseTable {
public:
    /// The head must outlive it.
    CauseTable(const Connection& connection, const LedgerHead& head);

    static std::string create(const LedgerHead& head);
    /// What tells the columns of one ledger from those of another.
    static std::string columns(const LedgerHead& head);

    void insert(const Result& result);
    void remove(std::int64_t id);

    /// Rows in the order of the points, one by one.
    class Rows {
    public:
        explicit Rows(const CauseTable& table);
        /// The row at hand; nothing behind the last.
        const std::optional<Result>& current() const { return current_; }
        void next();

    private:
        const CauseTable& table_;
        Statement rows_;
        std::optional<Result> current_;
    };

private:
    Result row(const Statement& from) const;
    template<class Names>
    std::int32_t known(const Names& names, std::string_view name, std::int64_t point) const;
    void bind_axis(int column, const Axis& axis, double value);

    const Connection& connection_;
    const LedgerHead& head_;
    Statement insert_, remove_;
};

} // namespace rodwake::scan
