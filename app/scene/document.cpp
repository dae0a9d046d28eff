#include "rodwake/scene/document.hpp"

#include "diagnostics.hpp"
#include "fields.hpp"
#include "figure_kinds.hpp"
#include "fit_parameters.hpp"
#include "node.hpp"

#include <fmt/format.h>

#include <sstream>

namespace rodwake::scene {

std::string table_header(const std::string& path) {
    std::string name; // without the brackets of lists
    for (std::size_t at = 0; at < path.size(); ++at)
        if (path.compare(at, 2, "[]") == 0)
            ++at;
        else
            name += path[at];
    return path.ends_with("[]") ? "[[" + name + "]]" : "[" + name + "]";
}

std::string markdown_cell(std::string_view text) {
    std::string out;
    for (const char c : text)
        out += c == '|' ? "\\|" : std::string(1, c);
    return out;
}

namespace {

constexpr const char* introduction = R"md(# Scene reference

Made by `rodwake info --scene-reference > docs/scene.md`. Do not edit.

For users who look up a key. A scene is a TOML file. A table that is absent is not modelled, unless it says that its
defaults hold. Unknown keys, values outside their legal range, nan and inf are errors. All errors of a file are listed at
once with file, line and column.

Plain numbers are in the unit given below: reduced units, or SI with `units = "si"`. Any key with a unit also takes a
string with one. Legal ranges hold for the reduced value, in `[scales]` and `[granular]` for the SI value.

The granular bed has its own scale: plain numbers in `[granular]` and its tables, and in the windows of figures of it,
are always SI, and `a` is `granular.bead_radius`. A scene with granular tables only needs no `[scales]`.

Plain lengths in `[fit]` and in the windows of figures of it are in the unit of the measured profiles. Strings
with a unit become bead radii, as `rodwake measure` writes them.

* length: `"0.4 mm"` (m, cm, mm, um), `"78 a"` (bead radii, `scales.bead_radius`), `"2.2 f/mu"`
* time: `"5 s"` (s, ms, us, min), `"30 f/(mu v0)"`
* speed: `"2.8 mm/s"` (m/s, cm/s, mm/s, um/s, a/s), `"1 v0"`
* rate: `"0.5 1/s"` (1/s, 1/ms, 1/min, Hz, kHz), `"0.5 mu v0/f"`
* angle: `"30 deg"`, `"0.5 rad"`
* diffusion: `"0.01 mm^2/s"` (m^2/s, mm^2/s, um^2/s, f v0/mu)
* wavenumber: `"2 1/mm"` (1/m, 1/mm, mu/f)
* density: `"2.7 g/cm^3"` (kg/m^3, g/cm^3); acceleration: `"9.81 m/s^2"` (m/s^2, mm/s^2)

On the command line `-s table.key=value` replaces a value: `-s coupling.kappa=2`, `-s rods.1.position.0=2.0` (entries
of lists are numbered from 0), `-s rods_run.method=adams`. Where keys are alternatives, the one set wins over those in
the file. `-s noise=` takes a key, a table or an entry of a list out.
)md";

constexpr const char* figures_introduction = R"md(# Figures

Made by `rodwake info --figure-reference > docs/figures.md`. Do not edit.

For users who choose the figures of a run. `rodwake run` and `rodwake plot` draw what `[[figures]]` in the scene lists,
or else one figure for each result that the run holds. A figure needs the keys in the column "needs" and is drawn from
the [files](files.md) in the next column. The [scene reference](scene.md#figures) explains its keys. All kinds take
`name`, `kind` and `title`.
)md";

} // namespace

std::vector<KeyInfo> scene_keys() {
    std::vector<KeyInfo> keys;
    for (const auto& table : scene_tables())
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
    for (const TableInfo& table : scene_tables()) {
        text +=
            table.path.empty() ? "\n## Top level\n" : fmt::format("\n## `{}`\n", table_header(table.path));
        if (!table.meaning.empty())
            text += "\n" + table.meaning + "\n";
        for (const auto& note : table.notes)
            text += "\n" + note + "\n";
        if (table.keys.empty()) // tables only
            continue;
        text +=
            "\n| key | type | unit | default | legal | meaning | example |\n|---|---|---|---|---|---|---|\n";
        for (const auto& k : table.keys)
            text += fmt::format("| `{}` | {} | {} | {} | {} | {} | `{}` |\n", k.name, k.type,
                                markdown_cell(k.unit), markdown_cell(k.default_value), markdown_cell(k.legal),
                                markdown_cell(k.meaning), markdown_cell(k.example));
    }
    std::string rows = "\n## Parameters of `[fit]`\n\n| name | meaning |\n|---|---|\n";
    for (const FitParameter& parameter : fit_parameter_list())
        rows += fmt::format("| `{}` | {} |\n", parameter.name, parameter.meaning);
    return text + rows;
}

std::string figure_reference() {
    constexpr std::pair<FigureSubject, const char*> sections[] = {
        {FigureSubject::bed, "Beds and films"},
        {FigureSubject::measure, "Measures"},
        {FigureSubject::theory, "Rods and fields"},
        {FigureSubject::rod_order, "Order of many rods"},
        {FigureSubject::fit, "Fits"},
        {FigureSubject::scan, "Scans"}};
    std::string text = figures_introduction;
    for (const auto& [subject, title] : sections) {
        text += fmt::format(
            "\n## {}\n\n| kind | shows | needs | drawn from | keys |\n|---|---|---|---|---|\n", title);
        for (const FigureKind& kind : figure_kinds()) {
            std::string needs, quantities;
            for (const FigureNeed& need : kind.needs)
                needs += fmt::format("{}{}", needs.empty() ? "" : ", ", need.text);
            for (const auto& [name, need] : kind.quantities)
                quantities +=
                    fmt::format("{}{}: {}", quantities.empty() ? ", by quantity " : ", ", name, need.text);
            text += kind.subject == subject ? fmt::format("| `{}` | {} | {}{} | {} | {} |\n", kind.name,
                                                          markdown_cell(kind.meaning), needs, quantities,
                                                          comma_list(kind.files), comma_list(kind.keys))
                                            : "";
        }
    }
    return text;
}

namespace {

/// Visits an empty scene with one entry in each list and describes what it is shown.
class Documenter : public Visitor {
public:
    Documenter() { tables_.push_back({"", "", {}, {}}); }

    const std::vector<TableInfo>& tables() const { return tables_; }

    void use_units(const Units& units) override { units_ = units; }
    void complain(std::string_view, const std::string&) override {}

protected:
    void visit(const Key& key, void* value, const Codec& codec) override {
        const Description said = codec.describe(key, value);

        // A plain number has one unit in reduced scenes and one in SI scenes.
        std::string reduced = reduced_unit(key.dimension), si = si_unit(key.dimension);
        if (key.dimension == Dimension::length && units_.is_own())
            reduced = si = units_.own;
        else if (!units_.reduced_words)
            reduced = si;

        // The meaning of a figure's key begins with the kinds that have it.
        std::string meaning(key.meaning);
        if (!path_.empty() && path_.back() == "figures[]")
            if (const auto kinds = kinds_with(key.name); !kinds.empty())
                meaning =
                    fmt::format("{} {}: {}", kinds.size() > 1 ? "kinds" : "kind", comma_list(kinds), meaning);

        KeyInfo info{path_.empty() ? "" : path_.back(),
                     std::string(key.name),
                     said.type,
                     reduced == si ? si : reduced + "; si: " + si,
                     said.fallback,
                     said.legal,
                     meaning,
                     std::string(key.example_value)};
        info.symbol = key.symbol_tex;
        info.unit_reduced = reduced;
        info.unit_si = si;
        info.is_required = key.is_required;
        info.choices.assign(key.choices.begin(), key.choices.end());
        info.choices.insert(info.choices.end(), said.choices.begin(), said.choices.end());
        if (said.has_range) {
            info.low = key.range.low;
            info.high = key.range.high;
            info.is_low_legal = !key.range.open_low;
        }
        current().keys.push_back(std::move(info));
    }
    int form_given(Forms forms) override {
        std::string text;
        for (const KeyAlternative& form : forms)
            text += fmt::format("{}`{}`{}", text.empty() ? "" : "; ", form.first,
                                form.second.empty() ? "" : fmt::format(" with `{}`", form.second));
        current().notes.push_back(fmt::format("Exactly one of: {}.", text));
        return -1;
    }
    bool derives() const override { return false; }
    bool enter_table(const Key& key, bool) override { return open(key, ""); }
    Entries enter_list(const Key&, std::size_t) override { return {1, 0, 1}; }
    bool enter_entry(const Key& key, std::size_t) override { return open(key, "[]"); }
    void leave() override { path_.pop_back(); }

private:
    bool open(const Key& key, std::string_view ending) {
        path_.push_back(fmt::format("{}{}{}{}", path_.empty() ? "" : path_.back(), path_.empty() ? "" : ".",
                                    key.name, ending));
        tables_.push_back({path_.back(), std::string(key.meaning), {}, {}});
        return true;
    }

    TableInfo& current() {
        const std::string path = path_.empty() ? "" : path_.back();
        for (auto& table : tables_)
            if (table.path == path)
                return table;
        return tables_.front();
    }

    std::vector<TableInfo> tables_;
    std::vector<std::string> path_;
    Units units_;
};

} // namespace

std::vector<TableInfo> scene_tables() {
    Scene scene;
    Documenter documenter;
    fields(documenter, scene);
    return documenter.tables();
}

} // namespace rodwake::scene
