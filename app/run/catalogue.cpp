#include "catalogue.hpp"

#include "rodwake/app/explore.hpp"
#include "stage_kind.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace rodwake::app {

namespace {
using enum Lifetime;

// Columns of what `rodwake tradeoff` writes (commands/rodwake_commands/tradeoff.py).
constexpr ColumnInfo tradeoff_columns[] = {
    {"method", "1", "rods_run.method"},
    {"form", "1", "rods_run.form"},
    {"field", "1", "medium.field"},
    {"tolerance", "1", "rods_run.rtol; rods_run.atol is a hundredth of it"},
    {"error", "1", "the requested kind of error (inf: no result, or another outcome)"},
    {"seconds", "s", "CPU time of one run on one thread, the least of the repeats"},
    {"rhs_evaluations", "1", "right-hand sides of all rods"},
    {"table_tolerance", "1", "medium.table.tolerance (empty: no table)"},
    {"precision", "1", "rods_run.precision"},
    {"final_state", "1", "largest difference at the end, f/mu and rad"},
    {"contact_time", "f/(mu v0)", "difference of the times of contact (empty: there is none)"},
    {"outcome", "1", "share of runs whose outcome differs"},
    {"path", "1", "largest difference at the output times, f/mu and rad (empty: a scan)"},
    {"repeats", "1", "how often it was timed"},
    {"status", "1", "ok, or why there is no result"}};
constexpr ColumnInfo candidate_columns[] = {
    {"way", "1", "number of the candidate, from 0, which is the reference where there is one among them"},
    {"keys", "1", "its keys"},
    {"seconds", "s", "CPU time of one run"},
    {"runs", "1", "runs it was measured with"},
    {"quantity", "1", "what was computed (empty: the candidate gave nothing)"},
    {"unit", "1", "of this and the numbers that follow"},
    {"value", "{unit}", "what was found"},
    {"error", "{unit}", "standard error of the value"},
    {"scatter", "{unit}", "standard deviation of one run (0: all runs give the same)"},
    {"bias", "{unit}", "difference from the reference"},
    {"bias_error", "{unit}", "standard error of the bias"},
    {"scale", "{unit}", "what 100 % is"},
    {"status", "1", "ok, or why there is no result"}};

std::vector<FileKind> all_kinds() {
    std::vector<FileKind> all = {
        {"scene.toml", record, "the scene as resolved: every key with its value"},
        {"provenance.json", record,
         "who made the run, how each stage ended, the command that makes it again, elapsed seconds of the "
         "last command"},
        {"log.txt", record, "messages of every command that worked on the run"},
        {"manifest.json", record, "every file of the run, its stage, columns and units"},
        {"rodwake.lock", record, "host and process that works on the run, or did last"},
        {"film_<k>.h5md", record, "the film of [tracks], made once of a file in another format"},
        {"result.h5", result, "field and trajectories as datasets with units"},
        {"report.html", result, "figures and numbers of the run on one page"},
        {explorer_file, result, "the two rods of the run, to be dragged in a browser"},
        {"tradeoff.json", kept, "the reference, and the settings that rodwake tradeoff tried"},
        {"tradeoff.csv", kept, "one row per setting: its error and its cost", tradeoff_columns},
        {"ways.json", kept, "the candidates to compute a part of a scene that rodwake tradeoff tried"},
        {"ways.csv", kept, "one row per candidate and quantity: value, bias, scatter, cost",
         candidate_columns}};
    for (const Stage stage : all_stages())
        for (FileKind file : kind_of(stage).files()) {
            file.stage = stage;
            all.push_back(file);
        }
    return all;
}

} // namespace

ColumnInfo column_info(std::string name, std::string_view unit, std::string_view meaning, ReportRow row) {
    static std::set<std::string> names;
    return {*names.insert(std::move(name)).first, unit, meaning, row};
}

std::string_view unit_in_report(const ColumnInfo& value) {
    return !value.row.unit.empty() ? value.row.unit : value.unit == "1" ? "" : value.unit;
}

double factor_in_report(const ColumnInfo& value) {
    return value.row.unit.empty() ? 1.0 : value.row.unit.starts_with('m') ? 1e3 : 1e6; // milli, micro
}

bool fits(std::string_view name, std::string_view pattern) {
    const auto gap = pattern.find("<k>");
    if (gap == std::string_view::npos)
        return name == pattern;
    if (!name.starts_with(pattern.substr(0, gap)))
        return false;
    const std::string_view rest = pattern.substr(gap + 3);
    for (std::size_t end = gap + 1; end <= name.size(); ++end) {
        if (!std::isalnum(static_cast<unsigned char>(name[end - 1])))
            return false;
        if (fits(name.substr(end), rest))
            return true;
    }
    return false;
}

std::span<const FileKind> file_kinds() {
    static const std::vector<FileKind> kinds = all_kinds();
    return kinds;
}

const FileKind* kind_of(std::string_view name) {
    const auto at =
        std::ranges::find_if(file_kinds(), [&](const FileKind& k) { return fits(name, k.pattern); });
    return at == file_kinds().end() ? nullptr : &*at;
}

std::optional<Stage> stage_of(const FileKind& kind, std::string_view name) {
    return kind.stage == Stage::granular && name.starts_with("points/") ? Stage::scan : kind.stage;
}

const ColumnInfo* column_of(const FileKind& kind, std::string_view name) {
    const auto at =
        std::ranges::find_if(kind.columns, [&](const ColumnInfo& c) { return fits(name, c.name); });
    return at == kind.columns.end() ? nullptr : &*at;
}

} // namespace rodwake::app
