#include "tradeoff_files.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/integrate/ode.hpp"
#include "run/values_json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;

constexpr ColumnInfo columns[] = {
    {"method", "1", "rods_run.method"},
    {"form", "1", "rods_run.form"},
    {"field", "1", "medium.field"},
    {"tolerance", "1", "rods_run.rtol; rods_run.atol is a hundredth of it"},
    {"error", "1", "the kind of error that was asked for; inf: no result, or another outcome"},
    {"seconds", "s", "CPU time on one thread, the least of the repeats"},
    {"rhs_evaluations", "1", "right-hand sides of all rods"},
    {"table_tolerance", "1", "medium.table.tolerance; empty: no table"},
    {"precision", "1", "rods_run.precision"},
    {"final_state", "1", "largest difference at the end, f/mu and rad"},
    {"contact_time", "f/(mu v0)", "difference of the times of contact; empty: there is none"},
    {"outcome", "1", "share of runs whose outcome differs"},
    {"path", "1", "largest difference at the output times, f/mu and rad; empty: a scan"},
    {"repeats", "1", "how often it was timed"},
    {"status", "1", "ok, or why there is no result"}};

/// A cell of words, which may have commas.
std::string quoted(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    std::ranges::replace(text, '"', '\'');
    return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

std::string cell(double value) { return std::isnan(value) ? "" : fmt::format("{:.6g}", value); }

/// JSON has neither: null is NaN, "inf" infinity.
ordered_json number(double value) {
    if (std::isnan(value))
        return nullptr;
    return std::isinf(value) ? ordered_json("inf") : ordered_json(value);
}

double number(const ordered_json& value) {
    if (value.is_null())
        return NAN;
    return value.is_string() ? HUGE_VAL : value.get<double>();
}

ordered_json errors_json(const Errors& errors) {
    ordered_json json;
    for (std::size_t kind = 0; kind < error_kinds; ++kind)
        json[to_string(static_cast<ErrorKind>(kind))] = number(errors[kind]);
    return json;
}

Errors errors_of(const ordered_json& json) {
    Errors errors{};
    for (std::size_t kind = 0; kind < error_kinds; ++kind)
        errors[kind] = number(json.at(to_string(static_cast<ErrorKind>(kind))));
    return errors;
}

ordered_json trial_json(const Trial& trial) {
    const Setting& s = trial.setting;
    return {{"method", method_name(s)},
            {"form", rods::to_string(s.form)},
            {"field", name_of(s.field)},
            {"table_tolerance", s.table_tolerance},
            {"precision", name_of(s.precision)},
            {"tolerance", s.tolerance},
            {"errors", errors_json(trial.error)},
            {"seconds", number(trial.seconds)},
            {"repeats", trial.repeats},
            {"rhs_evaluations", trial.rhs_evaluations},
            {"status", trial.status}};
}

/// The value of an enumeration whose name this is.
template<class Value, class Name>
Value named(const std::string& name, std::initializer_list<Value> values, const Name& name_of) {
    for (const Value value : values)
        if (name_of(value) == name)
            return value;
    throw InputError("\"" + name + "\" is unknown");
}

Setting setting_of(const ordered_json& json) {
    using integrate::Method;
    using scene::FieldBackend;
    Setting s;
    const std::string method = json.at("method");
    if (method != "auto")
        s.method = named(method, {Method::bdf, Method::adams, Method::erk},
                         [](Method m) { return integrate::to_string(m); });
    s.form = named(json.at("form"), {rods::Form::angle, rods::Form::director, rods::Form::dae},
                   [](rods::Form form) { return rods::to_string(form); });
    s.field = named(json.at("field"), {FieldBackend::exact, FieldBackend::table, FieldBackend::measured},
                    [](FieldBackend field) { return name_of(field); });
    s.precision = named(json.at("precision"),
                        {elastic::Accuracy::full, elastic::Accuracy::fine, elastic::Accuracy::single},
                        [](elastic::Accuracy accuracy) { return name_of(accuracy); });
    s.table_tolerance = json.at("table_tolerance");
    s.tolerance = json.at("tolerance");
    return s;
}

Trial trial_of(const ordered_json& json) {
    return {setting_of(json),   errors_of(json.at("errors")), number(json.at("seconds")),
            json.at("repeats"), json.at("rhs_evaluations"),   json.at("status")};
}

ErrorKind kind_named(const std::string& name) {
    using enum ErrorKind;
    return named(name, {final_state, contact_time, outcome, path},
                 [](ErrorKind kind) { return to_string(kind); });
}

} // namespace

std::span<const ColumnInfo> tradeoff_columns() { return columns; }

std::string tradeoff_json(const Tradeoff& table) {
    ordered_json json;
    json["unit"] = table.unit;
    json["work"] = table.work;
    json["limit"] = table.limit;
    json["error"] = to_string(table.kind);
    json["reference"] = {{"methods", table.methods},
                         {"tolerance", table.tolerance},
                         {"agreement", errors_json(table.agreement)},
                         {"least_error_quoted", errors_json(table.least)}};
    json["cpu"] = cpu_model();
    json["trials"] = ordered_json::array();
    for (const Trial& trial : table.trials)
        json["trials"].push_back(trial_json(trial));
    return json.dump(1) + "\n";
}

std::string tradeoff_csv(const Tradeoff& table) {
    std::string text;
    for (const ColumnInfo& column : columns)
        text += (text.empty() ? "" : ",") + std::string(column.name);
    for (const Trial& trial : table.trials) {
        const Setting& s = trial.setting;
        text += fmt::format(
            "\n{},{},{},{:g},{},{:.6g},{},{},{}", method_name(s), rods::to_string(s.form), name_of(s.field),
            s.tolerance, cell(trial.error[static_cast<std::size_t>(table.kind)]), trial.seconds,
            trial.rhs_evaluations, s.table_tolerance > 0.0 ? fmt::format("{:g}", s.table_tolerance) : "",
            name_of(s.precision));
        for (const double error : trial.error)
            text += "," + cell(error);
        text += fmt::format(",{},{}", trial.repeats, quoted(trial.status));
    }
    return text + "\n";
}

Tradeoff read_tradeoff(const std::filesystem::path& folder) {
    const auto file = folder / "tradeoff.json";
    try {
        std::ifstream in(file);
        const ordered_json json = ordered_json::parse(in);
        Tradeoff table;
        table.unit = json.at("unit");
        table.work = json.at("work");
        table.limit = json.at("limit");
        table.kind = kind_named(json.at("error"));
        const ordered_json& reference = json.at("reference");
        table.methods = reference.at("methods");
        table.tolerance = reference.at("tolerance");
        table.agreement = errors_of(reference.at("agreement"));
        table.least = errors_of(reference.at("least_error_quoted"));
        for (const ordered_json& trial : json.at("trials"))
            table.trials.push_back(trial_of(trial));
        return table;
    } catch (const std::exception& error) {
        throw InputError(file.string() + ": cannot be read (" + error.what() + "); --force measures anew");
    }
}

namespace {

constexpr ColumnInfo columns_of_ways[] = {
    {"way", "1", "number of the way, from 0, which is the reference where there is one among them"},
    {"keys", "1", "its keys"},
    {"seconds", "s", "CPU time of one run"},
    {"runs", "1", "runs it was measured with"},
    {"quantity", "1", "what was computed; empty: the way gave nothing"},
    {"unit", "1", "of this and the numbers that follow"},
    {"value", "{unit}", "what was found"},
    {"error", "{unit}", "standard error of the value"},
    {"scatter", "{unit}", "standard deviation of one run; 0: all runs give the same"},
    {"bias", "{unit}", "difference from the reference"},
    {"bias_error", "{unit}", "standard error of the bias"},
    {"scale", "{unit}", "what 100 % is"},
    {"status", "1", "ok, or why there is no result"}};

/// JSON has no infinity and no NaN: null is infinite here.
double number_of(const ordered_json& value) { return value.is_null() ? HUGE_VAL : value.get<double>(); }

ordered_json found_json(const Found& f) {
    return {{"quantity", f.name},
            {"unit", f.unit},
            {"value", finite_or_null(f.value)},
            {"error", finite_or_null(f.error)},
            {"scatter", finite_or_null(f.scatter)},
            {"bias", finite_or_null(f.bias)},
            {"bias_error", finite_or_null(f.bias_error)},
            {"scale", f.scale}};
}

Found found_of(const ordered_json& json) {
    return {json.at("quantity"),
            json.at("unit"),
            number_of(json.at("value")),
            number_of(json.at("error")),
            number_of(json.at("scatter")),
            number_of(json.at("bias")),
            number_of(json.at("bias_error")),
            json.at("scale")};
}

ordered_json way_json(const Way& way) {
    ordered_json found = ordered_json::array();
    for (const Found& one : way.found)
        found.push_back(found_json(one));
    return {{"keys", way.keys},
            {"seconds", finite_or_null(way.seconds)},
            {"runs", way.runs},
            {"found", found},
            {"status", way.status}};
}

Way way_of(const ordered_json& json) {
    Way way{json.at("keys"), number_of(json.at("seconds")), json.at("runs"), {}, json.at("status")};
    for (const ordered_json& found : json.at("found"))
        way.found.push_back(found_of(found));
    return way;
}

Part part_named(const std::string& name) {
    for (const Part part : {Part::rods, Part::bed, Part::fit, Part::field})
        if (to_string(part) == name)
            return part;
    throw InputError("\"" + name + "\" is no part of a scene");
}

/// Words of a cell, which may have commas and line breaks.
std::string in_quotes(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    std::ranges::replace(text, '"', '\'');
    return '"' + text + '"';
}

} // namespace

std::span<const ColumnInfo> ways_columns() { return columns_of_ways; }

std::string ways_json(const Ways& ways, const std::string& command) {
    ordered_json json;
    json["of"] = to_string(ways.part);
    json["work"] = ways.work;
    json["reference"] = ways.reference;
    json["limit"] = ways.limit;
    json["finished"] = ways.finished;
    json["command"] = command;
    json["version"] = build_info().version;
    json["git"] = build_info().git;
    json["cpu"] = cpu_model();
    json["ways"] = ordered_json::array();
    for (const Way& way : ways.ways)
        json["ways"].push_back(way_json(way));
    return json.dump(1) + "\n";
}

std::string ways_csv(const Ways& ways) {
    std::string text;
    for (const ColumnInfo& column : columns_of_ways)
        text += (text.empty() ? "" : ",") + std::string(column.name);
    for (std::size_t k = 0; k < ways.ways.size(); ++k) {
        const Way& way = ways.ways[k];
        const std::string head =
            fmt::format("\n{},{},{:.6g},{}", k, in_quotes(fmt::format("{}", fmt::join(way.keys, " "))),
                        way.seconds, way.runs);
        for (const Found& f : way.found)
            text += fmt::format("{},{},{},{:.9g},{:.6g},{:.6g},{:.6g},{:.6g},{:.9g},{}", head, f.name,
                                in_quotes(f.unit), f.value, f.error, f.scatter, f.bias, f.bias_error, f.scale,
                                in_quotes(way.status));
        if (way.found.empty())
            text += fmt::format("{},,,,,,,,,{}", head, in_quotes(way.status));
    }
    return text + "\n";
}

std::optional<Ways> read_ways(const std::filesystem::path& folder) {
    const auto file = folder / "ways.json";
    if (!std::filesystem::exists(file))
        return std::nullopt;
    try {
        std::ifstream in(file);
        const ordered_json json = ordered_json::parse(in);
        Ways ways{part_named(json.at("of")), json.at("work"),     json.at("reference"),
                  json.at("limit"),          json.at("finished"), {}};
        for (const ordered_json& way : json.at("ways"))
            ways.ways.push_back(way_of(way));
        return ways;
    } catch (const std::exception& error) {
        throw InputError(file.string() + ": cannot be read (" + error.what() + "); --force measures anew");
    }
}

} // namespace rodwake::app
