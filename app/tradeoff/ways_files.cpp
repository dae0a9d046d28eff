#include "ways_files.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
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
