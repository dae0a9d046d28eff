#include "tradeoff_files.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/integrate/ode.hpp"

#include <fmt/format.h>
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

} // namespace rodwake::app
