#include "cause_table.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::scan {

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

} // namespace rodwake::scan
