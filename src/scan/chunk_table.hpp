#pragma once
// The points of a ledger that simply succeeded, packed: a row holds what was added at once. A point takes a
// tenth of the time that a row of its own would, and a million points are some thousand rows.

#include "packed_rows.hpp"
#include "sqlite.hpp"

namespace rodwake::scan {

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

} // namespace rodwake::scan
