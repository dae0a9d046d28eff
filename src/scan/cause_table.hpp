#pragma once
// The points of a ledger that have something to tell: they failed, or succeeded after retries. A row each
// with named columns, so that sqlite3 and pandas can ask for them.

#include "rodwake/scan/ledger.hpp"
#include "sqlite.hpp"

namespace rodwake::scan {

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
