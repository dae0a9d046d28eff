#include "rodwake/scan/ledger.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/first_difference.hpp"
#include "sqlite.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::scan {

namespace {

namespace fs = std::filesystem;

std::string identifier(std::string_view name) {
    std::string text = "\"";
    for (const char c : name)
        text += c == '"' ? "\"\"" : std::string(1, c);
    return text + "\"";
}

/// Columns of the table of points, in order: id, axes, outcome, status, observables, retries, cause, seconds.
std::vector<std::string> column_names(const LedgerHead& head) {
    std::vector<std::string> names = {"id"};
    for (const Axis& axis : head.axes)
        names.push_back(axis.name);
    names.insert(names.end(), {"outcome", "status"});
    names.insert(names.end(), head.columns.observables.begin(), head.columns.observables.end());
    names.insert(names.end(), {"retries", "cause", "seconds"});
    return names;
}

std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ", ") + identifier(name);
    return text;
}

std::string create_points(const LedgerHead& head) {
    std::string columns = "id INTEGER PRIMARY KEY";
    if (head.repeated)
        columns += fmt::format(", point INTEGER AS ((id >> {}) + 1), run INTEGER AS ((id & {}) + 1)",
                               run_bits, max_runs - 1);
    for (const Axis& axis : head.axes)
        columns += fmt::format(", {} {}", identifier(axis.name), axis.words.empty() ? "REAL" : "TEXT");
    columns += ", outcome TEXT, status TEXT NOT NULL";
    for (const std::string& name : head.columns.observables)
        columns += fmt::format(", {} REAL", identifier(name));
    return fmt::format(
        "CREATE TABLE points ({}, retries INTEGER NOT NULL, cause TEXT, seconds REAL NOT NULL)", columns);
}

std::string insert_points(const LedgerHead& head) {
    const std::vector<std::string> names = column_names(head);
    std::string marks = "?";
    for (std::size_t i = 1; i < names.size(); ++i)
        marks += ",?";
    return fmt::format("INSERT OR REPLACE INTO points ({}) VALUES ({})", listed(names), marks);
}

constexpr const char* create_crossings =
    "CREATE TABLE crossings (id INTEGER PRIMARY KEY, outcome_low INTEGER NOT NULL, outcome_high INTEGER NOT "
    "NULL, u_low REAL NOT NULL, u_high REAL NOT NULL)";

bool has_table(const Connection& connection, std::string_view name) {
    Statement found(connection, "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?");
    found.bind(1, name);
    return found.step();
}

/// False: a ledger that was never begun. Throws InputError for a file of something else.
bool is_begun(const Connection& connection) {
    if (has_table(connection, "meta"))
        return true;
    if (Statement(connection, "SELECT 1 FROM sqlite_master").step())
        throw InputError(connection.file().string() + ": is an SQLite file, but not a ledger of rodwake");
    return false;
}

template<class Names>
std::int32_t index_of(const Names& names, std::string_view name) {
    const auto found = std::ranges::find(names, name);
    return found == std::end(names) ? -1 : static_cast<std::int32_t>(found - std::begin(names));
}

} // namespace

class Ledger::Database {
public:
    Database(const fs::path& file, const LedgerHead& head)
        : connection(file, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX), head_(head) {
        const bool begun = is_begun(connection); // before anything of a file that is not ours is changed
        if (begun)
            require_same();
        if (!begun)
            connection.run("PRAGMA page_size = 32768"); // a quarter of an insertion's time against 4096
        connection.run("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA cache_size = -16000");
        if (!begun)
            create();
        insert_ = std::make_unique<Statement>(connection, insert_points(head));
        select_ = fmt::format("SELECT {} FROM points", listed(column_names(head)));
    }

    void insert(const Result& r) {
        int column = 0;
        insert_->bind(++column, r.point.id);
        for (std::size_t k = 0; k < head_.axes.size(); ++k)
            bind_axis(++column, head_.axes[k], r.point.at[k]);
        const bool named = r.ok() && r.outcome >= 0;
        insert_->bind(++column,
                      named ? std::string_view(head_.columns.outcomes[static_cast<std::size_t>(r.outcome)])
                            : std::string_view());
        insert_->bind(++column, std::string_view(status_names[static_cast<std::size_t>(r.status)]));
        for (std::size_t k = 0; k < head_.columns.observables.size(); ++k)
            insert_->bind(++column, r.ok() ? r.values[k] : std::nan(""));
        insert_->bind(++column, std::int64_t{r.retries});
        insert_->bind(++column, r.cause_text());
        insert_->bind(++column, r.seconds);
        insert_->step();
    }

    Result row(const Statement& from) const {
        Result r;
        int column = 0;
        r.point.id = from.integer(column++);
        for (std::size_t k = 0; k < head_.axes.size(); ++k, ++column)
            r.point.at[k] = head_.axes[k].words.empty()
                                ? from.real(column)
                                : known(head_.axes[k].words, from.text(column), r.point.id);
        if (const std::string_view outcome = from.text(column++); !outcome.empty())
            r.outcome = known(head_.columns.outcomes, outcome, r.point.id);
        r.status = static_cast<Status>(known(status_names, from.text(column++), r.point.id));
        for (std::size_t k = 0; k < head_.columns.observables.size(); ++k)
            r.values[k] = from.real(column++);
        r.retries = static_cast<std::int32_t>(from.integer(column++));
        r.set_cause(from.text(column++));
        r.seconds = from.real(column);
        return r;
    }

    const std::string& select() const { return select_; }

    Connection connection;

private:
    template<class Names>
    std::int32_t known(const Names& names, std::string_view name, std::int64_t point) const {
        const std::int32_t index = index_of(names, name);
        if (index < 0)
            throw InputError(
                fmt::format("{}: point {}: \"{}\" is not what rodwake writes there; put it right, "
                            "or delete the row",
                            connection.file().string(), point, name));
        return index;
    }

    void bind_axis(int column, const Axis& axis, double value) {
        if (axis.words.empty())
            insert_->bind(column, value);
        else
            insert_->bind(column, std::string_view(axis.words[static_cast<std::size_t>(value)]));
    }

    void create() {
        Transaction change(connection);
        connection.run("CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT NOT NULL)");
        Statement meta(connection, "INSERT INTO meta VALUES (?, ?)");
        const auto put = [&](std::string_view key, const std::string& value) {
            meta.bind(1, key);
            meta.bind(2, std::string_view(value));
            meta.step();
        };
        put("format", std::to_string(format));
        put("rodwake", build_info().version);
        put("columns", listed(column_names(head_)));
        put("scan", head_.description);
        connection.run(create_points(head_));
        connection.run(create_crossings);
        change.commit();
    }

    std::string meta(const char* key) const {
        Statement found(connection, "SELECT value FROM meta WHERE key = ?");
        found.bind(1, std::string_view(key));
        return found.step() ? std::string(found.text(0)) : "";
    }

    void require_same() const {
        const std::string file = connection.file().string(), version = meta("format");
        if (version != std::to_string(format))
            throw InputError(
                fmt::format("{}: is a ledger of format {}, and this version of rodwake knows {}; "
                            "rodwake {} made it",
                            file, version, format, meta("rodwake")));
        const std::string there = meta("scan") + meta("columns"),
                          here = head_.description + listed(column_names(head_));
        if (there != here)
            throw InputError(fmt::format("{}: is the ledger of another scan ({}); choose another folder with "
                                         "-o, or --force to replace it",
                                         file, first_difference(there, here)));
    }

    const LedgerHead& head_;
    std::unique_ptr<Statement> insert_;
    std::string select_;
};

Ledger::Ledger(const fs::path& file, LedgerHead head) : head_(std::move(head)) {
    database_ = std::make_unique<Database>(file, head_);
}

Ledger::~Ledger() = default;

void Ledger::add(std::span<const Result> results) {
    Transaction change(database_->connection);
    for (const Result& one : results)
        database_->insert(one);
    change.commit();
}

void Ledger::add(std::span<const Crossing> crossings) {
    Transaction change(database_->connection);
    Statement insert(database_->connection, "INSERT OR REPLACE INTO crossings VALUES (?,?,?,?,?)");
    for (const Crossing& one : crossings) {
        insert.bind(1, one.id);
        insert.bind(2, std::int64_t{one.outcome_low});
        insert.bind(3, std::int64_t{one.outcome_high});
        insert.bind(4, one.u_low);
        insert.bind(5, one.u_high);
        insert.step();
    }
    change.commit();
}

void Ledger::merge(const fs::path& other) {
    if (!fs::exists(other))
        throw InputError(other.string() + ": no such ledger");
    const Ledger theirs(other, head_); // refuses one of another scan
    Transaction change(database_->connection);
    Statement known(database_->connection, "SELECT 1 FROM points WHERE id = ? AND status = 'ok'");
    theirs.for_each([&](const Result& one) {
        known.bind(1, one.point.id);
        const bool is_known = known.step();
        if (is_known)
            known.step(); // to its end, ready to run again
        else
            database_->insert(one);
    });
    change.commit();
}

std::int64_t Ledger::forget_failed() {
    Transaction change(database_->connection);
    database_->connection.run("DELETE FROM points WHERE status <> 'ok'");
    const std::int64_t forgotten = sqlite3_changes(database_->connection.get());
    database_->connection.run("DELETE FROM crossings WHERE outcome_low < 0 OR outcome_high < 0");
    change.commit();
    return forgotten;
}

void Ledger::for_each(const std::function<void(const Result&)>& each) const {
    Statement rows(database_->connection, database_->select() + " ORDER BY id");
    while (rows.step())
        each(database_->row(rows));
}

void Ledger::for_each_id(const std::function<void(std::int64_t)>& each) const {
    Statement rows(database_->connection, "SELECT id FROM points ORDER BY id");
    while (rows.step())
        each(rows.integer(0));
}

std::optional<Result> Ledger::find(std::int64_t id) const {
    Statement row(database_->connection, database_->select() + " WHERE id = ?");
    row.bind(1, id);
    return row.step() ? std::optional(database_->row(row)) : std::nullopt;
}

std::vector<Crossing> Ledger::crossings() const {
    std::vector<Crossing> all;
    Statement rows(database_->connection,
                   "SELECT id, outcome_low, outcome_high, u_low, u_high FROM crossings ORDER BY id");
    while (rows.step())
        all.push_back({rows.integer(0), static_cast<std::int32_t>(rows.integer(1)),
                       static_cast<std::int32_t>(rows.integer(2)), rows.real(3), rows.real(4)});
    return all;
}

namespace {

/// Row by row: SQLite would sort the whole table to group it.
Counts counts_in(const Connection& connection) {
    Counts counts;
    Statement rows(connection, "SELECT outcome, status, cause, seconds FROM points");
    while (rows.step()) {
        ++counts.points;
        counts.seconds += rows.real(3);
        if (rows.text(1) == "ok") {
            ++counts.outcomes[std::string(rows.text(0))];
            continue;
        }
        ++counts.failed;
        const std::string_view cause = rows.text(2);
        ++counts.causes[fmt::format("{}{}{}", rows.text(1), cause.empty() ? "" : ": ", cause)];
    }
    return counts;
}

} // namespace

std::int64_t Ledger::points() const {
    Statement count(database_->connection, "SELECT count(*) FROM points");
    return count.step() ? count.integer(0) : 0;
}

Counts Ledger::counts() const { return counts_in(database_->connection); }

void Ledger::settle() { database_->connection.run("PRAGMA wal_checkpoint(TRUNCATE)"); }

Counts counts_of(const fs::path& file) {
    if (!fs::exists(file))
        throw InputError(file.string() + ": no such ledger");
    const Connection connection(file, SQLITE_OPEN_READWRITE); // a log left by a killed scan is folded in
    return is_begun(connection) ? counts_in(connection) : Counts{};
}

} // namespace rodwake::scan
