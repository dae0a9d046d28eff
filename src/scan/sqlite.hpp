#pragma once
// The part of SQLite that a ledger needs: a connection and prepared statements that clean up after
// themselves. Errors are exceptions.

#include <sqlite3.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace rodwake::scan {

class Connection {
public:
    /// Throws RunError if it cannot be opened, InputError for one that was cut short.
    Connection(const std::filesystem::path& file, int flags);

    sqlite3* get() const { return handle_.get(); }
    const std::filesystem::path& file() const { return file_; }
    void run(const std::string& sql) const;
    /// Throws RunError, or InputError for a file that is no database, unless `code` is one of success.
    void require(int code) const;

private:
    struct Close {
        void operator()(sqlite3* handle) const { sqlite3_close_v2(handle); }
    };
    std::filesystem::path file_;
    std::unique_ptr<sqlite3, Close> handle_;
};

class Statement {
public:
    Statement(const Connection& connection, const std::string& sql);

    void bind(int column, std::int64_t value) { check(sqlite3_bind_int64(handle_.get(), column, value)); }
    /// NaN becomes NULL.
    void bind(int column, double value) {
        check(std::isnan(value) ? sqlite3_bind_null(handle_.get(), column)
                                : sqlite3_bind_double(handle_.get(), column, value));
    }
    /// The text must live until the next reset; empty becomes NULL.
    void bind(int column, std::string_view text) {
        check(text.empty() ? sqlite3_bind_null(handle_.get(), column)
                           : sqlite3_bind_text(handle_.get(), column, text.data(),
                                               static_cast<int>(text.size()), SQLITE_STATIC));
    }

    /// The bytes must live until the next reset.
    void bind_bytes(int column, std::string_view bytes) {
        check(sqlite3_bind_blob64(handle_.get(), column, bytes.data(), bytes.size(), SQLITE_STATIC));
    }

    /// True: there is a row. False: done, and ready to run again.
    bool step();

    std::int64_t integer(int column) const { return sqlite3_column_int64(handle_.get(), column); }
    double real(int column) const {
        return sqlite3_column_type(handle_.get(), column) == SQLITE_NULL
                   ? std::nan("")
                   : sqlite3_column_double(handle_.get(), column);
    }
    std::string_view text(int column) const {
        const auto* found = reinterpret_cast<const char*>(sqlite3_column_text(handle_.get(), column));
        return found ? std::string_view(found) : std::string_view();
    }

    /// Until the next step.
    std::string_view bytes(int column) const {
        const auto* found = static_cast<const char*>(sqlite3_column_blob(handle_.get(), column));
        return {found, static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column))};
    }

private:
    void check(int code) const {
        if (code != SQLITE_OK)
            connection_.require(code);
    }

    struct Finalize {
        void operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }
    };
    const Connection& connection_;
    std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

/// What is read while it lives is of one state of the file, whoever writes meanwhile.
class Snapshot {
public:
    explicit Snapshot(const Connection& connection) : connection_(connection) { connection.run("BEGIN"); }
    ~Snapshot() { sqlite3_exec(connection_.get(), "COMMIT", nullptr, nullptr, nullptr); }
    Snapshot(const Snapshot&) = delete;
    Snapshot& operator=(const Snapshot&) = delete;

private:
    const Connection& connection_;
};

/// Rolled back unless committed.
class Transaction {
public:
    explicit Transaction(const Connection& connection) : connection_(connection) {
        connection.run("BEGIN IMMEDIATE");
    }
    ~Transaction() {
        if (!committed_)
            sqlite3_exec(connection_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
    }
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;

    void commit() {
        connection_.run("COMMIT");
        committed_ = true;
    }

private:
    const Connection& connection_;
    bool committed_ = false;
};

} // namespace rodwake::scan
