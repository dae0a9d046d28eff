#include "rodwake/scan/ledger.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/store/journal.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_map>
#include <unordered_set>

namespace rodwake::scan {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Bytes = std::vector<std::byte>;

/// Kinds of records, as the journal's layouts. Later records replace earlier ones.
enum LedgerRecord : std::uint32_t {
    points_record = 1,    ///< packed points that simply succeeded
    cause_record,         ///< one packed point that failed or was retried, its status, its cause
    crossings_record,     ///< brackets as they are
    forgotten_record,     ///< ids to be evaluated again
    forgotten_all_record, ///< all that failed so far is to be evaluated again
};

// A packed point: id, axes, observables, seconds (8 bytes each), outcome and retries (4 bytes each).

std::size_t packed_size(const LedgerHead& head) {
    return 8 * (head.axes.size() + head.columns.observables.size()) + 24;
}

void pack(store::ByteWriter& out, const LedgerHead& head, const Result& r) {
    out.put(r.point.id);
    for (std::size_t k = 0; k < head.axes.size(); ++k)
        out.put(r.point.at[k]);
    for (std::size_t k = 0; k < head.columns.observables.size(); ++k)
        out.put(r.ok() ? r.values[k] : std::nan(""));
    out.put(r.seconds);
    out.put(r.ok() ? r.outcome : -1);
    out.put(r.retries);
}

/// The next point of a record of this kind.
Result unpack(store::ByteReader& in, const LedgerHead& head, std::uint32_t kind) {
    Result r;
    r.point.id = in.get<std::int64_t>();
    for (std::size_t k = 0; k < head.axes.size(); ++k)
        r.point.at[k] = in.get<double>();
    for (std::size_t k = 0; k < head.columns.observables.size(); ++k)
        r.values[k] = in.get<double>();
    r.seconds = in.get<double>();
    r.outcome = in.get<std::int32_t>();
    r.retries = in.get<std::int32_t>();
    if (kind == cause_record) {
        r.status = in.get<Status>();
        r.set_cause(in.get_text());
    }
    return r;
}

/// The description, and in the last line the names that the records need, so that `rodwake info` reads a
/// ledger without its scene.
std::string key_of(const LedgerHead& head) {
    json axes = json::array();
    for (const Axis& axis : head.axes)
        axes.push_back({axis.name, axis.words});
    return head.description + "\n" +
           json_text(json{{"axes", axes},
                          {"outcomes", head.columns.outcomes},
                          {"observables", head.columns.observables}});
}

LedgerHead head_of(const std::string& key, const fs::path& file) try {
    const std::size_t line = key.rfind('\n');
    const json names = json::parse(key.begin() + static_cast<std::ptrdiff_t>(line + 1), key.end());
    LedgerHead head;
    head.description = key.substr(0, line);
    for (const json& axis : names.at("axes"))
        axis.at(0).get_to(head.axes.emplace_back().name), axis.at(1).get_to(head.axes.back().words);
    names.at("outcomes").get_to(head.columns.outcomes);
    names.at("observables").get_to(head.columns.observables);
    return head;
} catch (const json::exception&) {
    throw InputError(file.string() + ": is a journal, but not the ledger of a scan");
}

} // namespace

void require_ledger(const fs::path& file, const LedgerHead& head) {
    if (!fs::exists(file) || fs::is_empty(file)) // never begun
        return;
    const std::string there = store::Journal(file).key(), here = key_of(head);
    head_of(there, file);
    if (there != here)
        throw InputError(fmt::format("{}: is the ledger of another scan ({}); choose another folder with -o, "
                                     "or --force to replace it",
                                     file.string(), first_difference(there, here)));
}

/// The journal, and where in it each point stands.
class Ledger::Book {
public:
    Book(const fs::path& file, LedgerHead of) : head(std::move(of)) {
        require_ledger(file, head);
        journal.emplace(file, key_of(head), store::Journal::OfAnother::refuse);
        replay();
    }

    /// Reads what another process may go on writing.
    explicit Book(const fs::path& file) {
        journal.emplace(file);
        head = head_of(journal->key(), file);
        replay();
    }

    void add(std::span<const Result> results) {
        // Points that simply succeeded make one record, in their order with the others: the last one counts.
        store::ByteWriter packed;
        std::vector<std::int64_t> ids;
        const auto append_packed = [&] {
            if (!ids.empty())
                append(points_record, packed.take());
            ids.clear();
        };
        for (const Result& result : results) {
            if (result.ok() && result.cause.front() == '\0') {
                pack(packed, head, result);
                ids.push_back(result.point.id);
                continue;
            }
            append_packed();
            store::ByteWriter out;
            pack(out, head, result);
            out.put(result.status);
            out.put_text(result.cause_text());
            append(cause_record, out.take());
        }
        append_packed();
        journal->flush();
    }

    void write(LedgerRecord kind, const Bytes& content) {
        append(kind, content);
        journal->flush();
    }
    void append(LedgerRecord kind, const Bytes& content) {
        journal->append(kind, content);
        take(journal->size() - 1, kind, content);
    }

    /// Applies a record: points are found by record and number within it.
    void take(std::size_t record, std::uint32_t kind, const Bytes& content) {
        store::ByteReader in(content, "ledger");
        const std::size_t size = packed_size(head);
        if (kind == points_record) {
            for (std::size_t at = 0; at + size <= content.size(); at += size) {
                std::int64_t id = 0;
                std::memcpy(&id, content.data() + at, sizeof id);
                places[id] = {static_cast<std::uint32_t>(record), static_cast<std::uint32_t>(at / size)};
                failed.erase(id);
            }
        } else if (kind == cause_record) {
            const Result r = unpack(in, head, kind);
            places[r.point.id] = {static_cast<std::uint32_t>(record), 0};
            if (r.ok())
                failed.erase(r.point.id);
            else
                failed.insert(r.point.id);
        } else if (kind == crossings_record) {
            for (const OutcomeChange& item : in.get_array<OutcomeChange>())
                brackets[item.id] = item;
        } else if (kind == forgotten_record) {
            for (const std::int64_t id : in.get_array<std::int64_t>())
                places.erase(id), failed.erase(id);
        } else if (kind == forgotten_all_record) {
            for (const std::int64_t id : failed)
                places.erase(id);
            failed.clear();
            std::erase_if(brackets, [](const auto& one) {
                return one.second.outcome_low < 0 || one.second.outcome_high < 0;
            });
        }
    }

    std::vector<std::int64_t> ids() const {
        std::vector<std::int64_t> all;
        all.reserve(places.size());
        for (const auto& [id, place] : places)
            all.push_back(id);
        std::ranges::sort(all);
        return all;
    }

    /// Results of these points, in this order. Records stay in memory as long as they are not too many: those
    /// of an adaptive scan overlap.
    void read(std::span<const std::int64_t> ids, const std::function<void(const Result&)>& each) {
        constexpr std::size_t most_bytes = std::size_t{1} << 28;
        std::unordered_map<std::uint32_t, Bytes> records;
        std::size_t bytes = 0;
        for (const std::int64_t id : ids) {
            const RecordNumber position = places.at(id);
            auto found = records.find(position.record);
            if (found == records.end()) {
                if (bytes > most_bytes)
                    records.clear(), bytes = 0;
                found = records.emplace(position.record, journal->read(position.record)).first;
                bytes += found->second.size();
            }
            const std::size_t size = packed_size(head);
            store::ByteReader in(std::span(found->second).subspan(position.number * size), "ledger");
            each(unpack(in, head, journal->layout(position.record)));
        }
    }

    /// All results that count, in the order in which they were written: record by record, which is faster
    /// than by id.
    void read_as_written(const std::function<void(const Result&)>& each) {
        const std::size_t size = packed_size(head);
        for (std::uint32_t record = 0; record < journal->size(); ++record) {
            const std::uint32_t kind = journal->layout(record);
            if (kind != points_record && kind != cause_record)
                continue;
            Bytes content;
            try {
                content = journal->read(record);
            } catch (const InputError&) { // none of its points is in places
                continue;
            }
            store::ByteReader in(content, "ledger");
            const std::size_t points = kind == cause_record ? 1 : content.size() / size;
            for (std::uint32_t number = 0; number < points; ++number) {
                const Result r = unpack(in, head, kind);
                const auto place = places.find(r.point.id);
                if (place != places.end() && place->second.record == record && place->second.number == number)
                    each(r);
            }
        }
    }

    struct RecordNumber {
        std::uint32_t record = 0, number = 0;
    };
    std::unordered_map<std::int64_t, RecordNumber> places;
    std::unordered_set<std::int64_t> failed;
    std::map<std::int64_t, OutcomeChange> brackets;
    std::int64_t damaged = 0;

    LedgerHead head;
    std::optional<store::Journal> journal;

private:
    /// Points of a damaged record are evaluated again.
    void replay() {
        for (std::size_t i = 0; i < journal->size(); ++i)
            try {
                take(i, journal->layout(i), journal->read(i));
            } catch (const InputError&) {
                ++damaged;
            }
    }
};

static_assert(sizeof(OutcomeChange) == 32, "brackets are copied as they are, and have no padding");

Ledger::Ledger(const fs::path& file, LedgerHead head)
    : head_(std::move(head)), book_(std::make_unique<Book>(file, head_)) {}

Ledger::~Ledger() = default;

void Ledger::add(std::span<const Result> results) { book_->add(results); }

void Ledger::add(std::span<const OutcomeChange> crossings) {
    store::ByteWriter out;
    out.put_array(crossings);
    book_->write(crossings_record, out.take());
}

void Ledger::merge(const fs::path& other) {
    if (!fs::exists(other))
        throw InputError(other.string() + ": no such ledger");
    require_ledger(other, head_);
    const Ledger theirs(other);
    constexpr std::size_t at_once = 1 << 12;
    std::vector<Result> fresh;
    const auto flush = [&] {
        add(fresh);
        fresh.clear();
    };
    theirs.for_each([&](const Result& result) {
        if (book_->places.contains(result.point.id) && !book_->failed.contains(result.point.id))
            return;
        fresh.push_back(result);
        if (fresh.size() == at_once)
            flush();
    });
    flush();
}

std::int64_t Ledger::forget_failed() {
    const auto count = static_cast<std::int64_t>(book_->failed.size());
    book_->write(forgotten_all_record, {});
    return count;
}

void Ledger::forget(std::span<const std::int64_t> ids) {
    if (ids.empty())
        return;
    store::ByteWriter out;
    out.put_array(ids);
    book_->write(forgotten_record, out.take());
}

void Ledger::for_each(const std::function<void(const Result&)>& each) const {
    book_->read(book_->ids(), each);
}

void Ledger::for_each_id(const std::function<void(std::int64_t)>& each) const {
    std::ranges::for_each(book_->ids(), each);
}

std::vector<Result> Ledger::find(std::span<const Point> points) const {
    std::vector<std::int64_t> there;
    for (const Point& point : points)
        if (book_->places.contains(point.id))
            there.push_back(point.id);
    std::ranges::sort(there);
    std::vector<Result> found;
    book_->read(there, [&](const Result& result) { found.push_back(result); });
    return found;
}

std::optional<Result> Ledger::find(std::int64_t id) const {
    const std::vector<Result> found = find(std::array{Point{id, {}}});
    return found.empty() ? std::nullopt : std::optional(found.front());
}

std::vector<OutcomeChange> Ledger::crossings() const {
    std::vector<OutcomeChange> all;
    for (const auto& [id, one] : book_->brackets)
        all.push_back(one);
    return all;
}

std::int64_t Ledger::points() const { return static_cast<std::int64_t>(book_->places.size()); }

std::int64_t Ledger::damaged() const { return book_->damaged; }

Counts Ledger::counts() const {
    struct Cause {
        std::int64_t points = 0, first = std::numeric_limits<std::int64_t>::max();
        std::string text; ///< of the first point
    };
    Counts counts;
    std::map<std::string, Cause> by_pattern;
    book_->read_as_written([&](const Result& result) {
        ++counts.points;
        counts.seconds += result.seconds;
        if (result.ok()) {
            ++counts
                  .outcomes[result.outcome < 0 ? "" : head_.columns.outcomes.at(std::size_t(result.outcome))];
            return;
        }
        ++counts.failed;
        std::string text = status_names[static_cast<std::size_t>(result.status)];
        if (!result.cause_text().empty())
            text += fmt::format(": {}", result.cause_text());
        Cause& cause = by_pattern[cause_pattern(text)];
        ++cause.points;
        if (result.point.id < cause.first)
            cause.first = result.point.id, cause.text = text;
    });
    for (const auto& [pattern, cause] : by_pattern) {
        counts.causes[cause.text] = cause.points;
        counts.examples[cause.text] = cause.first;
    }
    return counts;
}

void Ledger::sync() { book_->journal->sync(); }

Counts counts_of(const fs::path& file) {
    if (!fs::exists(file))
        throw InputError(file.string() + ": no such ledger");
    return fs::is_empty(file) ? Counts{} : Ledger(file).counts();
}

Ledger::Ledger(const fs::path& file) : book_(std::make_unique<Book>(file)) { head_ = book_->head; }

} // namespace rodwake::scan
