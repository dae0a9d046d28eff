#include "rodwake/scene/document.hpp"

#include "documented.hpp"
#include "figure_kinds.hpp"
#include "fit_parameters.hpp"
#include "suggest.hpp"

#include <fmt/format.h>

#include <sstream>

namespace rodwake::scene {

std::string table_header(const std::string& path) {
    const bool list = path.ends_with("[]");
    return list ? "[[" + path.substr(0, path.size() - 2) + "]]" : "[" + path + "]";
}

namespace {

std::string cell(const std::string& text) {
    std::string out;
    for (const char c : text)
        out += c == '|' ? "\\|" : std::string(1, c);
    return out;
}

std::string table_text(const TableInfo& table) {
    std::string text =
        table.path.empty() ? "\n## Top level\n" : fmt::format("\n## `{}`\n", table_header(table.path));
    if (!table.meaning.empty())
        text += "\n" + table.meaning + "\n";
    for (const auto& note : table.notes)
        text += "\n" + note + "\n";
    if (table.keys.empty()) // tables only
        return text;
    text += "\n| key | type | unit | default | legal | meaning | example |\n|---|---|---|---|---|---|---|\n";
    for (const auto& k : table.keys)
        text += fmt::format("| `{}` | {} | {} | {} | {} | {} | `{}` |\n", k.name, k.type, cell(k.unit),
                            cell(k.default_value), cell(k.legal), cell(k.meaning), cell(k.example));
    return text;
}

std::string kinds_text() {
    std::string text =
        "\n## Figure kinds\n\n| kind | shows | needs | drawn from | keys besides name, kind, title "
        "|\n|---|---|---|---|---|\n";
    for (const FigureKind& kind : figure_kinds()) {
        std::string needs, quantities;
        for (const FigureNeed& need : kind.needs)
            needs += fmt::format("{}{}", needs.empty() ? "" : "; ", need.text);
        for (const auto& [name, need] : kind.quantities)
            quantities +=
                fmt::format("{}{}: {}", quantities.empty() ? "; by quantity " : ", ", name, need.text);
        text += fmt::format("| `{}` | {} | {}{} | {} | {} |\n", kind.name, kind.meaning, needs, quantities,
                            comma_list(kind.files), comma_list(kind.keys));
    }
    return text;
}

std::string parameters_text() {
    std::string text = "\n## Parameters of `[fit]`\n\n| name | meaning |\n|---|---|\n";
    for (const FitParameter& parameter : fit_parameter_list())
        text += fmt::format("| `{}` | {} |\n", parameter.name, parameter.meaning);
    return text;
}

constexpr const char* introduction = R"md(# Scene reference

Made by `rodwake info --scene-reference > docs/scene.md`; do not edit.

A scene is a TOML file. A table that is absent is not modelled; where it says so, its defaults hold. Unknown keys, values outside their legal range, nan
and inf are errors; all errors of a file are listed at once with file, line and column.

Plain numbers are in the unit given below: reduced units, or SI with `units = "si"`. Any key with a unit also takes a
string with one. Legal ranges hold for the reduced value, in `[scales]` and `[granular]` for the SI value.

The granular bed has its own scale: plain numbers in `[granular]` and its tables, and in the windows of figures of it,
are SI whatever `units` says, and `a` is `granular.bead_radius`. A scene with granular tables only needs no `[scales]`.

Plain lengths in `[fit]` and in the windows of figures of it are in the unit of the measured profiles, whatever that
is; strings with a unit become bead radii, which is what `rodwake measure` writes.

* length: `"0.4 mm"` (m, cm, mm, um), `"78 a"` (bead radii, `scales.bead_radius`), `"2.2 f/mu"`
* time: `"5 s"` (s, ms, us, min), `"30 f/(mu v0)"`
* speed: `"2.8 mm/s"` (m/s, cm/s, mm/s, um/s, a/s), `"1 v0"`
* rate: `"0.5 1/s"` (1/s, 1/ms, 1/min, Hz, kHz), `"0.5 mu v0/f"`
* angle: `"30 deg"`, `"0.5 rad"`
* diffusion: `"0.01 mm^2/s"` (m^2/s, mm^2/s, um^2/s, f v0/mu)
* density: `"2.7 g/cm^3"` (kg/m^3, g/cm^3); acceleration: `"9.81 m/s^2"` (m/s^2, mm/s^2)

On the command line `-s table.key=value` replaces a value: `-s coupling.kappa=2`, `-s rods.1.position.0=2.0` (entries
of lists are numbered from 0), `-s rods_run.method=adams`. Where keys are alternatives, the one set wins over those in
the file. `-s noise=` takes a key, a table or an entry of a list out.
)md";

} // namespace

std::vector<TableInfo> scene_tables() { return documented(); }

std::vector<KeyInfo> scene_keys() {
    std::vector<KeyInfo> keys;
    for (const auto& table : documented())
        keys.insert(keys.end(), table.keys.begin(), table.keys.end());
    return keys;
}

std::optional<KeyInfo> key_info(const std::string& key) {
    std::vector<std::string> names;
    std::istringstream segments(key);
    for (std::string segment; std::getline(segments, segment, '.');)
        if (segment.find_first_not_of("0123456789") != std::string::npos)
            names.push_back(segment);
        else if (!names.empty() && !segments.eof()) // a number at the end counts within a value
            names.back() += "[]";
    const std::string name = names.empty() ? "" : names.back();
    const std::string table = fmt::format("{}", fmt::join(names.begin(), names.end() - !names.empty(), "."));
    for (KeyInfo& info : scene_keys())
        if (info.name == name && info.table == table)
            return std::move(info);
    return std::nullopt;
}

std::string scene_reference() {
    std::string text = introduction;
    for (const auto& table : documented())
        text += table_text(table);
    return text + kinds_text() + parameters_text();
}

} // namespace rodwake::scene
