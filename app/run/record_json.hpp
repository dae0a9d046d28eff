#pragma once
// Described results (core/record.hpp) as JSON, both ways. NaN is null. Included by one source a result, for
// it brings JSON and a visit of each field.

#include "rodwake/core/record.hpp"
#include "run/record_members.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace rodwake::app {

/// JSON has no infinity and no NaN; null stands for them.
inline nlohmann::ordered_json finite_or_null(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

inline nlohmann::ordered_json finite_or_null(const std::optional<double>& value) {
    return value ? finite_or_null(*value) : nlohmann::ordered_json(nullptr);
}

template<Described Record>
nlohmann::ordered_json record_json(const Record& record);

/// Numbers, texts and lists of them.
template<class T>
nlohmann::ordered_json member_json(const T& value) {
    if constexpr (std::is_floating_point_v<T>)
        return finite_or_null(value);
    else
        return value;
}

inline nlohmann::ordered_json member_json(const Estimate& e) {
    return {{"value", e.count > 0 ? finite_or_null(e.value) : nlohmann::ordered_json(nullptr)},
            {"error", finite_or_null(e.error)},
            {"samples", e.count}};
}

template<Described T>
nlohmann::ordered_json member_json(const T& value) {
    return record_json(value);
}

template<Described T>
nlohmann::ordered_json member_json(const std::vector<T>& list) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const T& item : list)
        out.push_back(record_json(item));
    return out;
}

template<class T>
nlohmann::ordered_json member_json(const Named<T>& named) {
    nlohmann::ordered_json out = nlohmann::ordered_json::object();
    for (const auto& [name, value] : named)
        out[name] = member_json(value);
    return out;
}

/// One or another; nothing at all is null.
template<class... Ts>
nlohmann::ordered_json member_json(const std::variant<Ts...>& alternatives) {
    return std::visit(
        [](const auto& value) -> nlohmann::ordered_json {
            if constexpr (std::is_same_v<decltype(value), const std::monostate&>)
                return nullptr;
            else
                return member_json(value);
        },
        alternatives);
}

/// {"name": value, ...} in the order of the description; an optional member that is absent is left out.
template<Described Record>
nlohmann::ordered_json record_json(const Record& record) {
    nlohmann::ordered_json out = nlohmann::ordered_json::object();
    for_each_field<Record>([&](const auto& field) {
        const auto& value = field.of(record);
        if constexpr (requires { value.has_value(); }) {
            if (value)
                out[std::string(field.name)] = member_json(*value);
        } else {
            out[std::string(field.name)] = member_json(value);
        }
    });
    return out;
}

template<Described Record>
void read_record(const nlohmann::json& json, Record& record);

template<class T>
void read_member(const nlohmann::json& json, T& value) {
    if constexpr (Described<T>)
        read_record(json, value);
    else if constexpr (std::is_floating_point_v<T>)
        value = json.is_null() && !std::isfinite(value) ? value : json.get<T>();
    else
        json.get_to(value);
}

template<Described T>
void read_member(const nlohmann::json& json, std::vector<T>& list) {
    for (const nlohmann::json& item : json)
        read_record(item, list.emplace_back());
}

template<Described T>
void read_member(const nlohmann::json& json, std::optional<T>& value) {
    read_record(json, value.emplace());
}

/// From record_json. null is a number only where the member begins with NaN, unknown, or infinite. Members
/// that are records themselves, or optional, keep their value where the document has none: it is of an
/// earlier version. Throws nlohmann::json::exception where anything else is missing or no such value.
template<Described Record>
void read_record(const nlohmann::json& json, Record& record) {
    for_each_field<Record>([&](const auto& field) {
        auto& value = record.*field.get;
        constexpr bool may_be_missing = Described<std::remove_cvref_t<decltype(value)>> || requires {
            value.has_value();
        };
        if (!may_be_missing || json.contains(field.name))
            read_member(json.at(std::string(field.name)), value);
    });
}

} // namespace rodwake::app
