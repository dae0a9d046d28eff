#include "ledger_tables.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>

namespace rodwake::scan {

namespace {

/// "contact 12;pursuit 3;": what `count` adds up.
std::string tally(std::span<const Result* const> results, const std::vector<std::string>& names) {
    std::vector<std::int64_t> counts(names.size() + 1, 0); // the first: no outcome
    for (const Result* result : results)
        ++counts[result->outcome < 0 ? 0 : 1 + static_cast<std::size_t>(result->outcome)];
    std::string text;
    for (std::size_t k = 0; k < counts.size(); ++k)
        if (counts[k] > 0)
            text += fmt::format("{} {};", k == 0 ? "" : names[k - 1], counts[k]);
    return text;
}

void add_tally(std::string_view text, std::map<std::string, std::int64_t>& outcomes) {
    while (!text.empty()) {
        const std::string_view one = text.substr(0, text.find(';'));
        const std::size_t space = std::min(one.rfind(' '), one.size());
        std::int64_t points = 0;
        std::from_chars(one.data() + std::min(space + 1, one.size()), one.data() + one.size(), points);
        outcomes[std::string(one.substr(0, space))] += points;
        text.remove_prefix(std::min(one.size() + 1, text.size()));
    }
}

double seconds_of(std::span<const Result* const> results) {
    double seconds = 0.0;
    for (const Result* result : results)
        seconds += result->seconds;
    return seconds;
}

} // namespace

ChunkTable::ChunkTable(const Connection& connection, const LedgerHead& head)
    : connection_(connection), head_(head), records_(head),
      insert_(connection,
              "INSERT INTO chunks (first, last, points, seconds, outcomes, data) VALUES (?,?,?,?,?,?)") {}

void ChunkTable::insert(std::span<const Result* const> results) {
    if (results.empty())
        return;
    std::string bytes;
    bytes.reserve(results.size() * records_.length());
    for (const Result* result : results)
        records_.append(bytes, *result);
    const std::string outcomes = tally(results, head_.columns.outcomes);
    insert_.bind(1, results.front()->point.id);
    insert_.bind(2, results.back()->point.id);
    insert_.bind(3, static_cast<std::int64_t>(results.size()));
    insert_.bind(4, seconds_of(results));
    insert_.bind(5, std::string_view(outcomes));
    insert_.bind_bytes(6, bytes);
    insert_.step();
}

void ChunkTable::remove(std::span<const std::int64_t> ids) {
    std::vector<std::int64_t> numbers;
    Statement rows(connection_, "SELECT number FROM chunks WHERE last >= ? AND first <= ?");
    rows.bind(1, ids.front());
    rows.bind(2, ids.back());
    while (rows.step())
        numbers.push_back(rows.integer(0));
    Statement read = bytes_of_row(), drop(connection_, "DELETE FROM chunks WHERE number = ?");
    for (const std::int64_t number : numbers) {
        read.bind(1, number);
        read.step();
        const std::string bytes = checked(read.bytes(0), number);
        read.step(); // to its end, ready to run again
        std::vector<Result> kept;
        for (std::size_t at = 0; at < bytes.size(); at += records_.length())
            if (!std::ranges::binary_search(ids, PackedRows::id(bytes.data() + at)))
                kept.push_back(records_.result(bytes.data() + at));
        if (kept.size() * records_.length() == bytes.size())
            continue;
        drop.bind(1, number);
        drop.step();
        std::vector<const Result*> rest(kept.size());
        std::ranges::transform(kept, rest.begin(), [](const Result& one) { return &one; });
        insert(rest);
    }
}

void ChunkTable::for_each_row_of_ids(const std::function<void(std::span<const std::int64_t>)>& each) const {
    Statement rows(connection_, "SELECT number, data FROM chunks ORDER BY first");
    std::vector<std::int64_t> ids;
    while (rows.step()) {
        const std::string bytes = checked(rows.bytes(1), rows.integer(0));
        ids.clear();
        for (std::size_t at = 0; at < bytes.size(); at += records_.length())
            ids.push_back(PackedRows::id(bytes.data() + at));
        each(ids);
    }
}

void ChunkTable::count(const Connection& connection, Counts& counts) {
    Statement rows(connection, "SELECT points, seconds, outcomes FROM chunks");
    while (rows.step()) {
        counts.points += rows.integer(0);
        counts.seconds += rows.real(1);
        add_tally(rows.text(2), counts.outcomes);
    }
}

std::string ChunkTable::checked(std::string_view bytes, std::int64_t number) const {
    if (bytes.empty() || bytes.size() % records_.length() != 0)
        throw InputError(fmt::format("{}: row {} of its chunks has {} bytes, no multiple of {}: is damaged",
                                     connection_.file().string(), number, bytes.size(), records_.length()));
    return std::string(bytes);
}

ChunkTable::Points::Points(const ChunkTable& table) : table_(table), read_(table.bytes_of_row()) {
    Statement rows(table.connection_, "SELECT number, first FROM chunks ORDER BY first");
    while (rows.step())
        rows_.push_back({rows.integer(0), rows.integer(1)});
    settle();
}

void ChunkTable::Points::next() {
    std::ranges::pop_heap(open_, std::ranges::greater());
    Cursor& cursor = cursors_[open_.back().second];
    cursor.at += table_.records_.length();
    if (cursor.at < cursor.data.size()) {
        open_.back().first = PackedRows::id(cursor.data.data() + cursor.at);
        std::ranges::push_heap(open_, std::ranges::greater());
    } else {
        cursor.data = {};
        free_.push_back(open_.back().second);
        open_.pop_back();
    }
    settle();
}

/// Opens the rows that begin before the point at hand.
void ChunkTable::Points::settle() {
    while (next_row_ < rows_.size() && (open_.empty() || rows_[next_row_].first <= open_.front().first))
        open(rows_[next_row_++].number);
    current_ = nullptr;
    if (!open_.empty()) {
        const Cursor& cursor = cursors_[open_.front().second];
        current_ = cursor.data.data() + cursor.at;
    }
}

void ChunkTable::Points::open(std::int64_t number) {
    if (free_.empty()) {
        free_.push_back(cursors_.size());
        cursors_.emplace_back();
    }
    const std::size_t which = free_.back();
    free_.pop_back();
    read_.bind(1, number);
    read_.step();
    cursors_[which] = {table_.checked(read_.bytes(0), number), 0};
    read_.step();
    open_.emplace_back(PackedRows::id(cursors_[which].data.data()), which);
    std::ranges::push_heap(open_, std::ranges::greater());
}

namespace {

std::string identifier(std::string_view name) {
    std::string text = "\"";
    for (const char c : name)
        text += c == '"' ? "\"\"" : std::string(1, c);
    return text + "\"";
}

/// In order: id, axes, outcome, status, observables, retries, cause, seconds.
std::vector<std::string> column_names(const LedgerHead& head) {
    std::vector<std::string> names = {"id"};
    for (const Axis& axis : head.axes)
        names.push_back(axis.name);
    names.insert(names.end(), {"outcome", "status"});
    names.insert(names.end(), head.columns.observables.begin(), head.columns.observables.end());
    names.insert(names.end(), {"retries", "cause", "seconds"});
    return names;
}

std::string insert_row(const LedgerHead& head) {
    std::string marks = "?";
    for (std::size_t i = 1; i < column_names(head).size(); ++i)
        marks += ",?";
    return fmt::format("INSERT OR REPLACE INTO causes ({}) VALUES ({})", CauseTable::columns(head), marks);
}

template<class Names>
std::int32_t index_of(const Names& names, std::string_view name) {
    const auto found = std::ranges::find(names, name);
    return found == std::end(names) ? -1 : static_cast<std::int32_t>(found - std::begin(names));
}

} // namespace

std::string CauseTable::columns(const LedgerHead& head) {
    std::string text;
    for (const std::string& name : column_names(head))
        text += (text.empty() ? "" : ", ") + identifier(name);
    return text;
}

std::string CauseTable::create(const LedgerHead& head) {
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
        "CREATE TABLE causes ({}, retries INTEGER NOT NULL, cause TEXT, seconds REAL NOT NULL)", columns);
}

CauseTable::CauseTable(const Connection& connection, const LedgerHead& head)
    : connection_(connection), head_(head), insert_(connection, insert_row(head)),
      remove_(connection, "DELETE FROM causes WHERE id = ?") {}

void CauseTable::insert(const Result& r) {
    int column = 0;
    insert_.bind(++column, r.point.id);
    for (std::size_t k = 0; k < head_.axes.size(); ++k)
        bind_axis(++column, head_.axes[k], r.point.at[k]);
    const bool named = r.ok() && r.outcome >= 0;
    insert_.bind(++column, named
                               ? std::string_view(head_.columns.outcomes[static_cast<std::size_t>(r.outcome)])
                               : std::string_view());
    insert_.bind(++column, std::string_view(status_names[static_cast<std::size_t>(r.status)]));
    for (std::size_t k = 0; k < head_.columns.observables.size(); ++k)
        insert_.bind(++column, r.ok() ? r.values[k] : std::nan(""));
    insert_.bind(++column, std::int64_t{r.retries});
    insert_.bind(++column, r.cause_text());
    insert_.bind(++column, r.seconds);
    insert_.step();
}

void CauseTable::remove(std::int64_t id) {
    remove_.bind(1, id);
    remove_.step();
}

CauseTable::Rows::Rows(const CauseTable& table)
    : table_(table),
      rows_(table.connection_, fmt::format("SELECT {} FROM causes ORDER BY id", columns(table.head_))) {
    next();
}

void CauseTable::Rows::next() { current_ = rows_.step() ? std::optional(table_.row(rows_)) : std::nullopt; }

Result CauseTable::row(const Statement& from) const {
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

template<class Names>
std::int32_t CauseTable::known(const Names& names, std::string_view name, std::int64_t point) const {
    const std::int32_t index = index_of(names, name);
    if (index < 0)
        throw InputError(fmt::format("{}: point {}: \"{}\" is not what rodwake writes there; put it right, "
                                     "or delete the row",
                                     connection_.file().string(), point, name));
    return index;
}

void CauseTable::bind_axis(int column, const Axis& axis, double value) {
    if (axis.words.empty())
        insert_.bind(column, value);
    else
        insert_.bind(column, std::string_view(axis.words[static_cast<std::size_t>(value)]));
}

static_assert(std::endian::native == std::endian::little, "records are copied as they are");

namespace {

template<class T>
void put(char*& to, T value) {
    std::memcpy(to, &value, sizeof value);
    to += sizeof value;
}

template<class T>
T take(const char*& from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    from += sizeof value;
    return value;
}

std::string in_quotes(std::string_view name) {
    std::string text = "\"";
    for (const char c : name)
        text += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    return text + "\"";
}

} // namespace

PackedRows::PackedRows(const LedgerHead& head)
    : head_(head), length_(8 * (head.axes.size() + head.columns.observables.size()) + 24) {}

void PackedRows::append(std::string& bytes, const Result& result) const {
    bytes.resize(bytes.size() + length_);
    char* to = bytes.data() + bytes.size() - length_;
    put(to, result.point.id);
    for (std::size_t k = 0; k < head_.axes.size(); ++k)
        put(to, result.point.at[k] + 0.0); // zero has no sign, as in SQLite's own columns
    for (std::size_t k = 0; k < head_.columns.observables.size(); ++k)
        put(to, result.values[k] + 0.0);
    put(to, result.seconds);
    put(to, result.outcome);
    put(to, result.retries);
}

std::int64_t PackedRows::id(const char* record) { return take<std::int64_t>(record); }

Result PackedRows::result(const char* record) const {
    Result r;
    r.point.id = take<std::int64_t>(record);
    for (std::size_t k = 0; k < head_.axes.size(); ++k)
        r.point.at[k] = take<double>(record);
    for (std::size_t k = 0; k < head_.columns.observables.size(); ++k)
        r.values[k] = take<double>(record);
    r.seconds = take<double>(record);
    r.outcome = take<std::int32_t>(record);
    r.retries = take<std::int32_t>(record);
    bool known = r.outcome >= -1 && r.outcome < static_cast<std::int32_t>(head_.columns.outcomes.size());
    for (std::size_t k = 0; k < head_.axes.size(); ++k)
        known = known &&
                (head_.axes[k].words.empty() ||
                 (r.point.at[k] >= 0.0 && r.point.at[k] < static_cast<double>(head_.axes[k].words.size())));
    if (!known)
        throw InputError(
            fmt::format("point {}: its outcome or a word of its axes is none of this scan's: the "
                        "ledger is damaged",
                        r.point.id));
    return r;
}

std::string PackedRows::layout() const {
    std::string text = R"([["id", "<i8"])";
    for (const Axis& axis : head_.axes)
        text += fmt::format(R"(, [{}, "<f8"])", in_quotes(axis.name));
    for (const std::string& name : head_.columns.observables)
        text += fmt::format(R"(, [{}, "<f8"])", in_quotes(name));
    return text + R"(, ["seconds", "<f8"], ["outcome", "<i4"], ["retries", "<i4"]])";
}

} // namespace rodwake::scan
