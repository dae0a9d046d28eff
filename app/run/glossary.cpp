#include "rodwake/app/run.hpp"

#include "bed/measure_kind.hpp"
#include "catalogue.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scene/document.hpp"
#include "stage_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace rodwake::app {

namespace {

/// "rods[].position" of "[[rods]].0.position", "rods[1].position" and "rods.position": numbers and brackets
/// dropped.
std::string plain_name(const std::string& name) {
    std::string plain, word;
    for (const char c : name + ".") {
        if (c != '.' && c != '[' && c != ']') {
            word += c;
            continue;
        }
        if (word.find_first_not_of("0123456789") != std::string::npos)
            plain += (plain.empty() ? "" : ".") + word;
        word.clear();
    }
    return plain;
}

std::string full_name(const scene::KeyInfo& key) {
    return plain_name(key.table.empty() ? key.name : key.table + "." + key.name);
}

std::string line(const char* title, const std::string& text) {
    return text.empty() ? "" : fmt::format("  {:<9} {}\n", title, text);
}

std::string key_text(const scene::KeyInfo& key) {
    const std::string where = key.table.empty() ? "the top level" : scene::table_header(key.table);
    return fmt::format("{}: key of a scene, in {}\n", full_name(key), where) + line("meaning", key.meaning) +
           line("type", key.type) + line("unit", key.unit) + line("default", key.default_value) +
           line("legal", key.legal) + line("example", key.name + " = " + key.example) +
           line("see",
                fmt::format("docs/scene.md, \"{}\"",
                            key.table.empty() ? std::string("Top level") : scene::table_header(key.table)));
}

/// Units that depend on the scene, in words: of the theory first.
std::string unit_text(std::string_view unit) {
    struct Dependent {
        std::string_view name, theory, other, when;
    };
    constexpr Dependent all[] = {{"{length}", "f/mu", "m", "with units = \"si\""},
                                 {"{time}", "f/(mu v0)", "s", "with units = \"si\""},
                                 {"{order length}", "f/mu", "m", "with units = \"si\", for beds a"},
                                 {"{order time}", "f/(mu v0)", "s", "with units = \"si\", and of beds"},
                                 {"{scan length}", "f/mu", "m", "with units = \"si\", for beds a"},
                                 {"{scan time}", "f/(mu v0)", "s", "with units = \"si\", and of beds"},
                                 {"{data}", "as the data", "fit.length_unit", "names it"},
                                 {"{unit}", "as in the row", "column unit", "names it"}};
    std::string theory(unit == "1" ? "" : unit), other = theory;
    std::string_view when;
    for (const Dependent& dependent : all)
        for (auto at = theory.find(dependent.name); at != std::string::npos;
             at = theory.find(dependent.name)) {
            theory.replace(at, dependent.name.size(), dependent.theory);
            other.replace(other.find(dependent.name), dependent.name.size(), dependent.other);
            when = dependent.when;
        }
    return when.empty() ? theory : fmt::format("{} ({} {})", theory, other, when);
}

std::string maker(const FileKind& kind) {
    return kind.stage ? fmt::format(", made by the stage \"{}\"", to_string(*kind.stage)) : "";
}

/// Columns of a file as a table in Markdown. A standard error has no row of its own.
std::string columns_table(const FileKind& kind) {
    constexpr std::string_view error = "_error";
    for (const FileKind& earlier : file_kinds())
        if (&earlier < &kind && std::ranges::equal(earlier.columns, kind.columns,
                                                   [](const ColumnInfo& column, const ColumnInfo& other) {
                                                       return std::tie(column.name, column.unit,
                                                                       column.meaning) ==
                                                              std::tie(other.name, other.unit, other.meaning);
                                                   }))
            return fmt::format("\nThe columns of `{}`.\n", earlier.pattern);
    std::string text = fmt::format("\n| {} | unit | meaning |\n|---|---|---|\n",
                                   kind.pattern.ends_with(".json") ? "key" : "column");
    for (const ColumnInfo& column : kind.columns) {
        const bool is_error =
            column.name.ends_with(error) && column.meaning.find("standard error") != std::string_view::npos &&
            std::ranges::count(kind.columns, column.name.substr(0, column.name.size() - error.size()),
                               &ColumnInfo::name) > 0;
        if (!is_error)
            text += fmt::format("| `{}` | {} | {} |\n", column.name, unit_text(column.unit),
                                scene::markdown_cell(column.meaning));
    }
    return text;
}

constexpr const char* files_introduction = R"md(# Files of a run

Made by `rodwake info --file-reference > docs/files.md`. Do not edit.

For users who read result files. Each section lists the files that one stage writes, then the columns of its CSV files
and the keys of its JSON files. `<k>` stands for a number or a name. A column or key `<name>_error` is the standard
error of `<name>` and is empty, null or NaN if it is unknown. A dot in a key opens a table.
`manifest.json` in the run folder lists the files of that run with its units. `rodwake help NAME` prints the entry of a
file, a column or a key.
)md";

/// "mean_speed" for mean_speed<k> and rods.<k>.mean_speed, and each name of the first.
bool names_column(const std::string& name, std::string_view pattern) {
    if (const auto dot = pattern.rfind('.'); dot != std::string_view::npos && name == pattern.substr(dot + 1))
        return true;
    const auto gap = pattern.find("<k>");
    const bool starts = gap != 0 && gap != std::string_view::npos && name == pattern.substr(0, gap);
    return starts || name == pattern || (gap != 0 && fits(name, pattern));
}

/// How runs of rods end: the criteria of docs/theory.md for `outcome`, or one of its words.
std::string outcome_text(const std::string& name) {
    constexpr std::pair<const char*, const char*> criteria[] = {
        {"contact", "the separation fell to contact_distance, or was within it at the start"},
        {"pursuit",
         "the headings differ by at most 0.1 rad; one rod is behind the other, within 0.2 of their "
         "separation of its axis; over the last fifth of the run the separation changed by at most "
         "5 %; and the wake of the front rod can turn the rear one by 0.05 rad or more in the run"},
        {"escape",
         "the separation grows, and neither heading turns by more than the residual turn allowed, "
         "0.05 of the difference of the headings, while the separation doubles, at its largest rate "
         "of the last fifth of the run"},
        {"orbit",
         "none of these, and the two rods, in each other's steady wakes on the plane, are in the basin of a "
         "stable orbit: they circle each other at one distance and rate"},
        {"undecided", "none of these by t_end; a longer run may decide, and scan.decide does so for scans"},
        {"bound", "rods with bodies push each other: they touch for 0.9 of the last quarter of the run"},
        {"capture", "contact, bound, orbit or pursuit"}};
    std::string text;
    for (const auto& [word, meaning] : criteria)
        if (name == word || name == "outcome")
            text += fmt::format("{}: how a run of rods ends\n", word) + line("criterion", meaning);
    return text.empty()
               ? ""
               : text + line("see",
                             "docs/theory.md, \"Outcomes\"; for rods of beds docs/estimators.md, \"Pairs\"");
}

std::string scene_text(const std::string& name) {
    std::string text;
    const std::string plain = plain_name(name);
    const auto exact = scene::key_info(plain);
    for (const scene::TableInfo& table : scene::scene_tables()) {
        if (!plain.empty() && plain_name(table.path) == plain) {
            text += fmt::format("{}: table of a scene\n", scene::table_header(table.path));
            text += line("meaning", table.meaning);
            for (const std::string& note : table.notes)
                text += line("note", note);
            for (const scene::KeyInfo& key : table.keys)
                text += fmt::format("    {:<22} {}\n", key.name, key.meaning);
            text += line("see", fmt::format("docs/scene.md, \"{}\"; rodwake help {}",
                                            scene::table_header(table.path),
                                            table.keys.empty() ? "KEY" : full_name(table.keys.front())));
        }
        for (const scene::KeyInfo& key : table.keys)
            if (full_name(key) == plain || (key.name == name && !exact))
                text += key_text(key);
    }
    if (const auto dot = plain.rfind('.'); text.empty() && dot != std::string::npos)
        for (const scene::KeyInfo& key : scene::scene_keys()) // an entry of a table of numbers
            if (full_name(key) == plain.substr(0, dot) && key.type.starts_with("table"))
                text += key_text(key);
    return text;
}

/// Each name with what it means.
std::vector<std::pair<std::string, std::string>> all_names() {
    std::vector<std::pair<std::string, std::string>> names;
    for (const scene::TableInfo& table : scene::scene_tables()) {
        if (!table.path.empty())
            names.emplace_back(plain_name(table.path), table.meaning);
        for (const scene::KeyInfo& key : table.keys)
            names.emplace_back(full_name(key), key.meaning);
    }
    for (const FileKind& kind : file_kinds()) {
        names.emplace_back(kind.pattern, kind.what);
        for (const ColumnInfo& column : kind.columns)
            names.emplace_back(column.name, column.meaning);
    }
    for (const MeasureKind& kind : measure_kinds())
        for (const ColumnInfo& value : kind.values())
            names.emplace_back(value.name, value.meaning);
    return names;
}

} // namespace

std::optional<std::string> explain(const std::string& name) {
    std::string text = outcome_text(name) + scene_text(name);
    for (const FileKind& kind : file_kinds())
        if (name == kind.pattern || fits(name, kind.pattern)) {
            text += fmt::format("{}: file of a run{}\n", kind.pattern, maker(kind));
            text += line("holds", std::string(kind.what));
            for (const ColumnInfo& column : kind.columns)
                text +=
                    fmt::format("    {:<22} {:<8} {}\n", column.name, unit_text(column.unit), column.meaning);
            if (kind.pattern == "measure.json")
                for (const MeasureKind& measure : measure_kinds())
                    for (const ColumnInfo& value : measure.values())
                        text += fmt::format("    {:<22} {:<8} {}\n", value.name, unit_in_report(value),
                                            value.meaning);
        }
    for (const FileKind& kind : file_kinds())
        for (const ColumnInfo& column : kind.columns)
            if (names_column(name, column.name))
                text += fmt::format("{}: {} of {}{}\n", column.name,
                                    kind.pattern.ends_with(".json") ? "key" : "column", kind.pattern,
                                    maker(kind)) +
                        line("meaning", std::string(column.meaning)) + line("unit", unit_text(column.unit));
    for (const MeasureKind& kind : measure_kinds())
        for (const ColumnInfo& value : kind.values())
            if (name == value.name || value.name.ends_with("." + name))
                text += fmt::format("{}: value of measure.json, with [measure] {}\n", value.name, kind.name) +
                        line("meaning", fmt::format("{}{}{}", value.row.title,
                                                    value.row.title.empty() ? "" : ": ", value.meaning)) +
                        line("unit", std::string(unit_in_report(value))) +
                        line("in file", value.row.unit.empty() ? ""
                                                               : fmt::format("times {:g} it is in that unit",
                                                                             factor_in_report(value)));
    return text.empty() ? std::nullopt : std::optional(text);
}

std::string file_reference() {
    std::vector<std::optional<Stage>> makers = {std::nullopt};
    makers.insert(makers.end(), all_stages().begin(), all_stages().end());
    std::string text = files_introduction;
    for (const std::optional<Stage> stage : makers) {
        std::string tables;
        text += stage ? fmt::format("\n## Stage `{}`\n", to_string(*stage)) : "\n## Any run\n";
        text += "\n| file | content |\n|---|---|\n";
        for (const FileKind& kind : file_kinds())
            if (kind.stage == stage) {
                text += fmt::format("| `{}` | {} |\n", kind.pattern, scene::markdown_cell(kind.what));
                if (!kind.columns.empty())
                    tables += fmt::format("\n### `{}`\n{}", kind.pattern, columns_table(kind));
            }
        text += tables;
    }
    return text;
}

std::vector<std::string> similar_names(const std::string& name) {
    constexpr std::size_t most = 8;
    std::vector<std::pair<std::size_t, std::string>> near; // by distance; the word in a meaning comes last
    const std::size_t far = std::max<std::size_t>(1, std::min<std::size_t>(3, name.size() / 3));
    for (const auto& [known, meaning] : all_names()) {
        const bool whole = name.find('.') != std::string::npos;
        const std::size_t away =
            edit_distance(plain_name(name), whole ? known : known.substr(known.rfind('.') + 1));
        if (away <= far)
            near.emplace_back(away, known);
        else if (name.size() > 3 && fmt::format("{} {}", known, meaning).find(name) != std::string::npos)
            near.emplace_back(far + 1, known);
    }
    std::ranges::stable_sort(near, {}, &std::pair<std::size_t, std::string>::first);
    std::vector<std::string> names;
    for (const auto& [away, known] : near)
        if (names.size() < most && std::ranges::count(names, known) == 0)
            names.push_back(known);
    return names;
}

} // namespace rodwake::app
