#pragma once
// Results described once. A struct of results says beside its members what each is called in files, its unit
// and what it means; JSON, CSV, means over runs, catalogue, manifest and columns of scans follow from that:
//
//     struct RodSummary {
//         double mean_speed = 0.0;
//         static constexpr auto fields() {
//             return std::tuple{field("mean_speed", &RodSummary::mean_speed, {"m/s", "along its heading"})};
//         }
//     };
//
// A member without unit or meaning does not compile. A member may itself be described, or a list of such. In
// place of a member may stand a function of the record, without captures and last:
//
//     field("turn", {"deg", "net turn"}, [](const RodSummary& r) { return r.turn * degrees; })

#include "rodwake/core/estimate.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

namespace rodwake {

/// The row of a value in the report.
struct ReportRow {
    std::string_view title = {}; ///< text with formulas as TeX between dollars; "": there is no row
    std::string_view unit = {};  ///< the file's with a prefix, "\u00b5N"; "": the file's
};

/// A column of a table, or a number of a JSON file ("rods.<k>.force"). "<k>" in a name stands for a number or
/// a word: x<k> is x0, x1, ...
struct ColumnInfo {
    std::string_view name;
    std::string_view unit; ///< one that is_unit knows; of values also "": a text
    std::string_view meaning;
    ReportRow row = {};
};

/// Units of results. "1": none; "{length}", "{time}", ...: those that the file or the run names;
/// "{unit}": in the column of that name.
// clang-format off
inline constexpr std::string_view units[] = {
    "1", "s", "m", "a", "rad", "deg", "rad^2", "rad^2/s", "rad^2/a", "1/s", "1/a", "1/a^2", "a^2",
    "a^2/s", "a/s", "m/s", "m^2/s^2", "m^2/s", "Hz", "J", "N", "N s", "N/m", "MB", "kB", "{length}",
    "{time}", "{data}", "{scan length}", "{scan time}", "rad/({scan time})", "rad/({time})", "{order length}", "{order time}", "1/({time})",
    "({length})/({time})", "({length})^2", "({length})^2/({time})", "rad/s", "kg/m^2", "a^-2", "runs",
    "f/(mu v0)", "{unit}", "{solved key}", "1/({scan time})", "\u00b5N", "\u00b5N/m", "mN/m"
};
// clang-format on

constexpr bool is_unit(std::string_view unit) { return std::ranges::find(units, unit) != std::end(units); }

/// What becomes of a number when there are several runs.
enum class OverRuns : char {
    mean,          ///< with its standard error
    mean_of_known, ///< the same over the runs that have it (not NaN)
    sum,
    largest,
    same, ///< of the first run, for it is the same in all
    left_out
};

struct FieldInfo {
    std::string_view unit; ///< of numbers; empty of all else
    std::string_view meaning;
    OverRuns over_runs = OverRuns::mean;
    std::string_view column = "=";     ///< in tables with a row a run; "=": its name; "": none
    std::string_view scan_column = ""; ///< in the tables of a scan; "=": its name; "": none
    std::string_view known_runs = "";  ///< of mean_of_known: key of the number of runs that have it; "": none
    ReportRow row = {};
};

template<class Get>
struct Field {
    std::string_view name;
    Get get; ///< pointer to a member, or function of the record
    FieldInfo info;

    template<class Record>
    constexpr decltype(auto) of(const Record& record) const {
        return std::invoke(get, record);
    }

    constexpr std::string_view column() const { return info.column == "=" ? name : info.column; }
    constexpr std::string_view scan_column() const {
        return info.scan_column == "=" ? name : info.scan_column;
    }
};

/// The type of a member, or of the result of a function of a record.
template<class Get>
struct ValueOf {
    using type = typename ValueOf<decltype(&Get::operator())>::type;
};
template<class Member, class Record>
struct ValueOf<Member Record::*> {
    using type = Member;
};
template<class Result, class Function, class Record>
struct ValueOf<Result (Function::*)(Record) const> {
    using type = std::remove_cvref_t<Result>;
};

template<class T>
inline constexpr bool needs_unit =
    std::is_floating_point_v<T> || std::is_same_v<T, Estimate> || std::is_same_v<T, std::vector<double>>;

// Clang 14 crashes at a function object that a class hands to a consteval function of its own body.
#if defined(__clang__) && __clang_major__ < 16
#define RODWAKE_CONSTEVAL constexpr
#else
#define RODWAKE_CONSTEVAL consteval
#endif

template<class Get>
RODWAKE_CONSTEVAL Field<Get> field(std::string_view name, FieldInfo info, Get get) {
    if (name.empty() || info.meaning.empty())
        throw "a described result has a name and a meaning";
    if (!is_unit(info.unit) && (needs_unit<typename ValueOf<Get>::type> || !info.unit.empty()))
        throw "a described number has a unit of the list `units`";
    if (!info.row.unit.empty() && (!is_unit(info.row.unit) || !info.row.unit.ends_with(info.unit)))
        throw "the unit of a row is that of the number with a prefix";
    return {name, get, info};
}

template<class Record, class Member>
RODWAKE_CONSTEVAL auto field(std::string_view name, Member Record::*member, FieldInfo info) {
    return field(name, info, member);
}

/// With a row in the report.
template<class Get>
RODWAKE_CONSTEVAL auto field(std::string_view name, ReportRow row, FieldInfo info, Get get) {
    info.row = row;
    return field(name, info, get);
}

#undef RODWAKE_CONSTEVAL

template<class T>
concept Described = requires {
    T::fields();
};

template<Described Record>
constexpr std::size_t field_count = std::tuple_size_v<decltype(Record::fields())>;

/// Calls f(field) for each, in the order of the description.
template<Described Record, class Call>
constexpr void for_each_field(const Call& f) {
    std::apply([&](const auto&... fields) { (f(fields), ...); }, Record::fields());
}

/// Stands for a member of any type.
struct AnyMember {
    template<class T>
    operator T() const;
};

/// Number of members of an aggregate, a base counted as one.
template<class Record, class... Members>
consteval std::size_t member_count() {
    if constexpr (requires { Record{Members{}..., AnyMember{}}; })
        return member_count<Record, Members..., AnyMember>();
    else
        return sizeof...(Members);
}

/// Members that fields() does not list. A record states this number in a static_assert, so that a new member
/// without its line does not compile.
template<Described Record>
consteval std::size_t undescribed_members() {
    return std::apply(
        [](const auto&... fields) {
            return member_count<Record>() -
                   (std::size_t{0} + ... + std::is_member_object_pointer_v<decltype(fields.get)>);
        },
        Record::fields());
}

template<Described Record>
constexpr auto field_names() {
    return std::apply([](const auto&... fields) { return std::array{fields.name...}; }, Record::fields());
}

/// Of a record of nothing but numbers: a row of a table.
template<Described Record>
constexpr auto field_values(const Record& record) {
    return std::apply(
        [&](const auto&... fields) { return std::array<double, sizeof...(fields)>{fields.of(record)...}; },
        Record::fields());
}

/// Calls use(field, suffix, number) for each number: of a list with the suffix 0, 1, ... up to `most`, else
/// with none (-1).
template<Described Record, class Use>
void for_each_number(const Record& record, int most, const Use& use) {
    for_each_field<Record>([&](const auto& field) {
        const auto& value = field.of(record);
        if constexpr (requires { value.size(); })
            for (int k = 0; k < std::min(static_cast<int>(value.size()), most); ++k)
                use(field, k, static_cast<double>(value[static_cast<std::size_t>(k)]));
        else
            use(field, -1, static_cast<double>(value));
    });
}

} // namespace rodwake
