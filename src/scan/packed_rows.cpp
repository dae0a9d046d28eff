#include "packed_rows.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>

namespace rodwake::scan {

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
