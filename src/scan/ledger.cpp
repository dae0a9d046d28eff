#include "rodwake/scan/ledger.hpp"

#include "id_set.hpp"
#include "ledger_tables.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/spelling.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <unordered_set>

namespace rodwake::scan {

namespace {

namespace fs = std::filesystem;

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

/// Results by increasing id; of those with one id the last.
std::vector<const Result*> in_order(std::span<const Result> results) {
    std::vector<const Result*> order(results.size());
    std::ranges::transform(results, order.begin(), [](const Result& one) { return &one; });
    const auto id = [](const Result* one) { return one->point.id; };
    if (!std::ranges::is_sorted(order, std::ranges::less_equal(), id)) {
        std::ranges::stable_sort(order, {}, id);
        std::ranges::reverse(order);
        const auto same = [&](const Result* a, const Result* b) { return id(a) == id(b); };
        order.erase(std::unique(order.begin(), order.end(), same), order.end());
        std::ranges::reverse(order);
    }
    return order;
}

std::vector<std::int64_t> ids_of(std::span<const Result* const> results) {
    std::vector<std::int64_t> ids(results.size());
    std::ranges::transform(results, ids.begin(), [](const Result* one) { return one->point.id; });
    return ids;
}

/// Row by row: SQLite would sort the whole table to group it.
Counts counts_in(const Connection& connection) {
    Counts counts;
    const Snapshot snapshot(connection);
    ChunkTable::count(connection, counts);
    std::map<std::string, std::string> by_pattern;
    Statement rows(connection, "SELECT outcome, status, cause, seconds, id FROM causes ORDER BY id");
    while (rows.step()) {
        ++counts.points;
        counts.seconds += rows.real(3);
        if (rows.text(1) == "ok") {
            ++counts.outcomes[std::string(rows.text(0))];
            continue;
        }
        ++counts.failed;
        const std::string_view cause = rows.text(2);
        const std::string text = fmt::format("{}{}{}", rows.text(1), cause.empty() ? "" : ": ", cause);
        const std::string& first = by_pattern.try_emplace(cause_pattern(text), text).first->second;
        ++counts.causes[first];
        counts.examples.try_emplace(first, rows.integer(4));
    }
    return counts;
}

std::string meta(const Connection& connection, std::string_view key) {
    Statement found(connection, "SELECT value FROM meta WHERE key = ?");
    found.bind(1, key);
    return found.step() ? std::string(found.text(0)) : "";
}

void require_format(const Connection& connection) {
    const std::string version = meta(connection, "format");
    if (version != std::to_string(Ledger::format))
        throw InputError(fmt::format("{}: is a ledger of format {}, and this version of rodwake knows {}; "
                                     "rodwake {} made it",
                                     connection.file().string(), version, Ledger::format,
                                     meta(connection, "rodwake")));
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
            connection.run("PRAGMA page_size = 32768"); // long rows need few pages
        connection.run("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA cache_size = -16000");
        if (!begun)
            create();
        chunks_ = std::make_unique<ChunkTable>(connection, head);
        causes_ = std::make_unique<CauseTable>(connection, head);
        version_ = std::make_unique<Statement>(connection, "PRAGMA data_version");
    }

    /// Within a transaction. Points that are there already are replaced.
    void insert(std::span<const Result> results) {
        const IdSet& there = known();
        const std::vector<const Result*> order = in_order(results);
        const std::vector<std::int64_t> ids = ids_of(order);
        std::vector<std::int64_t> replaced;
        std::ranges::copy_if(ids, std::back_inserter(replaced),
                             [&](std::int64_t id) { return there.contains(id); });
        known_at_.reset(); // unless all goes well
        if (!replaced.empty())
            remove(replaced);
        std::vector<const Result*> packed;
        for (const Result* one : order)
            if (PackedRows::fits(*one))
                packed.push_back(one);
            else
                causes_->insert(*one);
        chunks_->insert(packed);
        known_.insert(ids);
    }

    /// After a commit of what was inserted: nobody else wrote meanwhile.
    void keep_known() { known_at_ = version(); }
    /// Before something is taken out.
    void forget_known() { known_at_.reset(); }

    /// Ids of all points. Read again if another connection wrote.
    const IdSet& known() {
        const std::int64_t now = version();
        if (known_at_ == now)
            return known_;
        known_ = {};
        chunks_->for_each_row_of_ids([&](std::span<const std::int64_t> ids) { known_.insert(ids); });
        Statement rows(connection, "SELECT id FROM causes ORDER BY id");
        while (rows.step())
            known_.insert(std::array{rows.integer(0)});
        known_at_ = now;
        return known_;
    }

    void for_each(const std::function<void(const Result&)>& each) const {
        const Snapshot snapshot(connection);
        CauseTable::Rows rows(*causes_);
        for (ChunkTable::Points points(*chunks_); points.current() || rows.current();) {
            if (rows.current() &&
                (!points.current() || rows.current()->point.id < PackedRows::id(points.current()))) {
                each(*rows.current());
                rows.next();
            } else {
                each(unpacked(points.current()));
                points.next();
            }
        }
    }

    void remove(std::span<const std::int64_t> ids) {
        chunks_->remove(ids);
        for (const std::int64_t id : ids)
            causes_->remove(id);
    }

    Connection connection;

private:
    Result unpacked(const char* record) const {
        try {
            return chunks_->records().result(record);
        } catch (const InputError& error) {
            throw InputError(connection.file().string() + ": " + error.what());
        }
    }

    std::int64_t version() {
        version_->step();
        const std::int64_t now = version_->integer(0);
        version_->step();
        return now;
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
        put("columns", CauseTable::columns(head_));
        put("record", PackedRows(head_).layout());
        put("outcomes", fmt::format("{}", fmt::join(head_.columns.outcomes, ",")));
        put("scan", head_.description);
        connection.run(ChunkTable::create);
        connection.run(CauseTable::create(head_));
        connection.run(create_crossings);
        change.commit();
    }

    void require_same() const {
        require_format(connection);
        const std::string there = meta(connection, "scan") + meta(connection, "columns"),
                          here = head_.description + CauseTable::columns(head_);
        if (there != here)
            throw InputError(fmt::format("{}: is the ledger of another scan ({}); choose another folder with "
                                         "-o, or --force to replace it",
                                         connection.file().string(), first_difference(there, here)));
    }

    const LedgerHead& head_;
    std::unique_ptr<ChunkTable> chunks_;
    std::unique_ptr<CauseTable> causes_;
    std::unique_ptr<Statement> version_;
    IdSet known_;
    std::optional<std::int64_t> known_at_; ///< version of the file; none: not read
};

Ledger::Ledger(const fs::path& file, LedgerHead head) : head_(std::move(head)) {
    database_ = std::make_unique<Database>(file, head_);
}

Ledger::~Ledger() = default;

void Ledger::add(std::span<const Result> results) {
    Transaction change(database_->connection);
    database_->insert(results);
    change.commit();
    database_->keep_known();
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
    constexpr std::size_t at_once = 1 << 12;
    std::vector<Result> fresh;
    std::unordered_set<std::int64_t> failed;
    Statement rows(database_->connection, "SELECT id FROM causes WHERE status <> 'ok'");
    while (rows.step())
        failed.insert(rows.integer(0));
    const auto flush = [&] {
        add(fresh);
        fresh.clear();
    };
    theirs.for_each([&](const Result& one) {
        if (!failed.contains(one.point.id) && database_->known().contains(one.point.id))
            return;
        fresh.push_back(one);
        if (fresh.size() == at_once)
            flush();
    });
    flush();
}

std::int64_t Ledger::forget_failed() {
    Transaction change(database_->connection);
    database_->forget_known();
    database_->connection.run("DELETE FROM causes WHERE status <> 'ok'");
    const std::int64_t forgotten = sqlite3_changes(database_->connection.get());
    database_->connection.run("DELETE FROM crossings WHERE outcome_low < 0 OR outcome_high < 0");
    change.commit();
    return forgotten;
}

void Ledger::forget(std::span<const std::int64_t> ids) {
    if (ids.empty())
        return;
    Transaction change(database_->connection);
    database_->forget_known();
    database_->remove(ids);
    change.commit();
}

void Ledger::for_each(const std::function<void(const Result&)>& each) const { database_->for_each(each); }

void Ledger::for_each_id(const std::function<void(std::int64_t)>& each) const {
    database_->known().for_each(each);
}

std::vector<Result> Ledger::find(std::span<const Point> points) const {
    std::unordered_set<std::int64_t> wanted;
    const IdSet& there = database_->known();
    for (const Point& point : points)
        if (there.contains(point.id))
            wanted.insert(point.id);
    std::vector<Result> found;
    if (!wanted.empty())
        database_->for_each([&](const Result& one) {
            if (wanted.contains(one.point.id))
                found.push_back(one);
        });
    return found;
}

std::optional<Result> Ledger::find(std::int64_t id) const {
    const std::vector<Result> found = find(std::array{Point{id, {}}});
    return found.empty() ? std::nullopt : std::optional(found.front());
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

std::int64_t Ledger::points() const { return database_->known().size(); }

Counts Ledger::counts() const { return counts_in(database_->connection); }

void Ledger::settle() { database_->connection.run("PRAGMA wal_checkpoint(TRUNCATE)"); }

Counts counts_of(const fs::path& file) {
    if (!fs::exists(file))
        throw InputError(file.string() + ": no such ledger");
    const Connection connection(file, SQLITE_OPEN_READWRITE); // a log left by a killed scan is folded in
    if (!is_begun(connection))
        return {};
    require_format(connection);
    return counts_in(connection);
}

} // namespace rodwake::scan
