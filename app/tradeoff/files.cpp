// tradeoff.json and tradeoff.csv of rods, ways.json and ways.csv of the other parts.

#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"
#include "target.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace rodwake::app {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

} // namespace

ordered_json member_json(const Unbounded& number) {
    if (std::isnan(number))
        return nullptr;
    return std::isinf(number) ? ordered_json("inf") : ordered_json(number.value);
}

void read_member(const json& value, Unbounded& number) {
    number.value = value.is_null() ? NAN : value.is_string() ? HUGE_VAL : value.get<double>();
}

namespace {

// --- tables with words in them ----------------------------------------------------------------------------

/// A cell that is always in quotes, and a number with nine digits.
struct Words {
    std::string text;
};
struct Precise {
    double value = NAN;
};

std::string cell(double value) { return std::isnan(value) ? "" : fmt::format("{:.6g}", value); }
std::string cell(Precise number) {
    return std::isnan(number.value) ? "" : fmt::format("{:.9g}", number.value);
}
std::string cell(long value) { return fmt::format("{}", value); }
std::string cell(Words words) {
    std::ranges::replace(words.text, '\n', ' ');
    std::ranges::replace(words.text, '"', '\'');
    return words.text.empty() ? "" : '"' + words.text + '"';
}
std::string cell(const std::string& text) {
    const std::string quoted = cell(Words{text});
    return text.find(',') == std::string::npos ? quoted.substr(quoted.empty() ? 0 : 1, text.size()) : quoted;
}

template<Described Row>
std::string text_csv(const std::vector<Row>& rows) {
    std::string text = fmt::format("{}\n", fmt::join(field_names<Row>(), ","));
    for (const Row& row : rows) {
        std::string line;
        for_each_field<Row>([&](const auto& field) { line += ',' + cell(row.*field.member); });
        text += line.substr(1) + "\n";
    }
    return text;
}

// --- rods -------------------------------------------------------------------------------------------------

/// A way of rods in tradeoff.json.
struct Trial : Setting {
    RodErrors errors;
    Unbounded seconds;
    long repeats = 0, rhs_evaluations = 0;
    std::string status;

    static constexpr auto fields() {
        using R = Trial;
        return std::tuple_cat(
            Setting::fields(),
            std::tuple{
                rodwake::field("errors", &R::errors, {"", "against the reference"}),
                rodwake::field("seconds", &R::seconds,
                               {"s", "CPU time on one thread, the least of the repeats"}),
                rodwake::field("repeats", &R::repeats, {"1", "how often it was timed"}),
                rodwake::field("rhs_evaluations", &R::rhs_evaluations, {"1", "right-hand sides of all rods"}),
                rodwake::field("status", &R::status, {"1", "ok, or why there is no result"})});
    }
};

/// The same in tradeoff.csv, in another order.
struct TrialRow : Trial, RodErrors {
    double error;

    static constexpr auto fields() {
        const auto [method, form, field_, table, precision, tolerance, errors, seconds, repeats, rhs,
                    status] = Trial::fields();
        const auto error =
            rodwake::field("error", &TrialRow::error,
                           {"1", "the kind of error that was asked for; inf: no result, or another outcome"});
        return std::tuple_cat(
            std::tuple{method, form, field_, tolerance, error, seconds, rhs, table, precision},
            RodErrors::fields(), std::tuple{repeats, status});
    }
};

struct Document {
    std::string unit, work;
    double limit = 0.0;
    std::string error;
    RodReference reference;
    std::string cpu;
    std::vector<Trial> trials;

    static constexpr auto fields() {
        using R = Document;
        return std::tuple{field("unit", &R::unit, {"", "of work"}),
                          field("work", &R::work, {"", "the points of a scan"}),
                          field("limit", &R::limit, {"s", "settings that took longer were given up"}),
                          field("error", &R::error, {"", "the kind that was asked for"}),
                          field("reference", &R::reference, {"", "what errors are taken against"}),
                          field("cpu", &R::cpu, {"", "of the machine"}),
                          field("trials", &R::trials, {"", "the settings that were tried"})};
    }
};

RodErrors errors_of(const Way& way) {
    RodErrors errors;
    for_each_field<RodErrors>([&](const auto& field) {
        const auto at = std::ranges::find(way.found, field.name, &Found::name);
        if (at != way.found.end())
            (errors.*field.member).value = at->value;
    });
    return errors;
}

std::vector<Trial> trials_of(const Tradeoff& table) {
    std::vector<Trial> trials;
    for (const Way& way : table.ways)
        if (way.tried())
            trials.push_back(
                {way.setting, errors_of(way), {way.seconds}, way.runs, way.rhs_evaluations, way.status});
    return trials;
}

Way way_of(const Trial& trial) {
    return {.seconds = trial.seconds,
            .runs = trial.repeats,
            .found = found_of(trial.errors),
            .status = trial.status,
            .setting = trial,
            .rhs_evaluations = trial.rhs_evaluations};
}

// --- the other parts --------------------------------------------------------------------------------------

/// The column of another row.
template<class Row, class Member>
constexpr Field<Row, Member> like(const auto& other, Member Row::*member) {
    return {other.name, member, other.info};
}

struct WayRow {
    long way = 0;
    Words keys;
    double seconds = 0.0;
    long runs = 0;
    std::string quantity;
    Words unit;
    Precise value;
    double error = NAN, scatter = NAN, bias = NAN, bias_error = NAN;
    Precise scale;
    Words status;

    static constexpr auto fields() {
        using R = WayRow;
        const auto [k, s, r, found, st] = Way::fields();
        const auto [q, u, v, e, sc, b, be, size] = Found::fields();
        return std::tuple{
            field("way", &R::way,
                  {"1", "number of the way, from 0, which is the reference where there is one among them"}),
            like(k, &R::keys),
            like(s, &R::seconds),
            like(r, &R::runs),
            like(q, &R::quantity),
            like(u, &R::unit),
            like(v, &R::value),
            like(e, &R::error),
            like(sc, &R::scatter),
            like(b, &R::bias),
            like(be, &R::bias_error),
            like(size, &R::scale),
            like(st, &R::status)};
    }
};

Part part_named(const std::string& name) {
    for (const Part part : {Part::rods, Part::bed, Part::fit, Part::field})
        if (to_string(part) == name)
            return part;
    throw InputError("\"" + name + "\" is no part of a scene");
}

/// Throws InputError for a file that cannot be read, or of which `use` makes nothing.
template<class Use>
Tradeoff read_file(const std::filesystem::path& file, const Use& use) {
    try {
        std::ifstream in(file);
        return use(json::parse(in));
    } catch (const std::exception& error) {
        throw InputError(file.string() + ": cannot be read (" + error.what() + "); --force measures anew");
    }
}

} // namespace

std::span<const ColumnInfo> tradeoff_columns() { return columns_of<TrialRow>(); }

std::string tradeoff_json(const Tradeoff& t) {
    return json_text(
               record_json(Document{t.unit, t.work, t.limit, t.kind, t.rods, cpu_model(), trials_of(t)}), 1) +
           "\n";
}

std::string tradeoff_csv(const Tradeoff& table) {
    std::vector<TrialRow> rows;
    for (Trial& trial : trials_of(table)) {
        if (!(trial.table_tolerance > 0.0))
            trial.table_tolerance = NAN;
        rows.push_back({trial, trial.errors, error_of(trial.errors, table.kind)});
    }
    return text_csv(rows);
}

Tradeoff read_tradeoff(const std::filesystem::path& folder) {
    return read_file(folder / "tradeoff.json", [](const json& text) {
        Document read;
        read_record(text, read);
        Tradeoff table{.part = Part::rods,
                       .work = read.work,
                       .limit = read.limit,
                       .unit = read.unit,
                       .kind = read.error,
                       .rods = read.reference};
        std::ranges::transform(read.trials, std::back_inserter(table.ways), way_of);
        scene::Scene any;
        any.rods_run.emplace();
        any.medium.emplace();
        for (const Way& way : table.ways)
            with(any, way.setting); // throws for a value that no key has
        return table;
    });
}

std::span<const ColumnInfo> ways_columns() { return columns_of<WayRow>(); }

std::string ways_json(const Tradeoff& table, const std::string& command) {
    const ordered_json document = {{"of", to_string(table.part)},
                                   {"work", table.work},
                                   {"reference", table.reference},
                                   {"limit", table.limit},
                                   {"finished", table.finished},
                                   {"command", command},
                                   {"version", build_info().version},
                                   {"git", build_info().git},
                                   {"cpu", cpu_model()},
                                   {"ways", member_json(table.ways)}};
    return json_text(document, 1) + "\n";
}

std::string ways_csv(const Tradeoff& table) {
    std::vector<WayRow> rows;
    for (std::size_t k = 0; k < table.ways.size(); ++k) {
        const Way& way = table.ways[k];
        WayRow row;
        row.way = static_cast<long>(k);
        row.keys.text = fmt::format("{}", fmt::join(way.keys, " "));
        row.seconds = way.seconds;
        row.runs = way.runs;
        row.status.text = way.status;
        if (way.found.empty())
            rows.push_back(row);
        for (const Found& f : way.found) {
            row.quantity = f.name;
            row.unit.text = f.unit;
            row.value = {f.value};
            row.error = f.error;
            row.scatter = f.scatter;
            row.bias = f.bias;
            row.bias_error = f.bias_error;
            row.scale = {f.scale};
            rows.push_back(row);
        }
    }
    return text_csv(rows);
}

std::optional<Tradeoff> read_ways(const std::filesystem::path& folder) {
    const auto file = folder / "ways.json";
    if (!std::filesystem::exists(file))
        return std::nullopt;
    return read_file(file, [](const json& text) {
        Tradeoff table{.part = part_named(text.at("of")),
                       .work = text.at("work"),
                       .reference = text.at("reference"),
                       .limit = text.at("limit"),
                       .finished = text.at("finished")};
        read_member(text.at("ways"), table.ways);
        return table;
    });
}

} // namespace rodwake::app
