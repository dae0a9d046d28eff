#include "rodwake/scene/document.hpp"

#include "fields.hpp"
#include "node.hpp"
#include "suggest.hpp"

#include <fmt/format.h>

namespace rodwake::scene {

namespace {

struct TableInfo {
    std::string path; ///< as in KeyInfo::table
    std::string meaning;
    std::vector<KeyInfo> keys;
    std::vector<std::string> notes;
};

/// Visits an empty scene with one entry in each list and describes what it is shown.
class Documenter : public Visitor {
public:
    Documenter() { tables_.push_back({"", "", {}, {}}); }

    const std::vector<TableInfo>& tables() const { return tables_; }
    const std::vector<std::string>& planned_names() const { return planned_; }

    void operator()(const Key& key, double& value) override {
        add(key, number_type(key), key.is_required ? "required" : number_text(value), key.range.text());
    }
    void operator()(const Key& key, std::optional<double>&) override {
        add(key, number_type(key), key.absent_text, key.range.text());
    }
    void operator()(const Key& key, long& value) override {
        add(key, "integer", key.is_required ? "required" : std::to_string(value), key.range.text());
    }
    void operator()(const Key& key, std::optional<long>&) override {
        add(key, "integer", key.absent_text, key.range.text());
    }
    void operator()(const Key& key, bool& value) override {
        add(key, "boolean", value ? "true" : "false", "true, false");
    }
    void operator()(const Key& key, std::string& value) override {
        const std::string fallback = value.empty() ? key.absent_text : quoted(value);
        const std::string legal = key.is_file_name ? "letters, digits, _ - ., at most 64" : "one line";
        add(key, "string", key.is_required ? "required" : fallback,
            key.choices.empty() ? legal : names(key, key.choices));
    }
    void operator()(const Key& key, const Choice& value) override {
        add(key, "string", quoted(value.names[value.current]), names(key, value.names));
    }
    void operator()(const Key& key, std::vector<double>&) override {
        add(key, key.count_text("numbers"), key.is_required ? "required" : key.absent_text, key.range.text());
    }
    void operator()(const Key& key, std::vector<std::vector<double>>&) override {
        add(key, key.count_text("pairs of numbers"), "", key.range.text());
    }
    void operator()(const Key& key, std::vector<std::string>& value) override {
        std::string fallback;
        for (const auto& item : value)
            fallback += (fallback.empty() ? "" : ", ") + quoted(item);
        add(key, key.count_text("names"), key.is_required ? "required" : "[" + fallback + "]",
            names(key, key.choices));
    }
    void operator()(const Key& key, std::vector<long>&) override {
        add(key, key.count_text("integers"), key.absent_text, key.range.text());
    }
    void operator()(const Key& key, std::map<std::string, double>&) override {
        add_entries(key, "table of numbers");
    }
    void operator()(const Key& key, std::map<std::string, Interval>&) override {
        add_entries(key, "table of [low, high]");
    }
    void operator()(const Key& key, std::map<std::string, Tie>&) override {
        add_entries(key, "table of [name, factor]");
    }
    void settings(const Key& key, std::vector<std::string>&) override {
        add(key, "table of " + key.count_text("keys"), "required", "any keys of the scene");
    }

    void planned(const std::string& name) override {
        planned_.push_back(path_.empty() ? name : path_.back() + "." + name);
    }
    void use_units(const Units& units) override { units_ = units; }
    void one_form(const Forms& forms, const std::function<void(int)>&) override {
        std::string text;
        for (const auto& form : forms) {
            std::string keys;
            for (const auto& name : form)
                keys += (keys.empty() ? "`" : " with `") + name + "`";
            text += (text.empty() ? "" : "; ") + keys;
        }
        current().notes.push_back(fmt::format("Exactly one of: {}.", text));
    }
    void derive(const std::function<void()>&) override {}
    void complain(const std::string&, const std::string&) override {}

protected:
    bool enter_table(const Key& key, bool) override { return open(key, key.name); }
    std::size_t enter_list(const Key&, std::size_t) override { return 1; }
    bool enter_entry(const Key& key, std::size_t) override { return open(key, key.name + "[]"); }
    void leave() override { path_.pop_back(); }

private:
    bool open(const Key& key, const std::string& name) {
        path_.push_back(path_.empty() ? name : path_.back() + "." + name);
        tables_.push_back({path_.back(), key.meaning, {}, {}});
        return true;
    }

    TableInfo& current() {
        const std::string path = path_.empty() ? "" : path_.back();
        for (auto& table : tables_)
            if (table.path == path)
                return table;
        return tables_.front();
    }

    static std::string number_type(const Key& key) {
        return key.dimension == Dimension::none
                   ? "number"
                   : name_of(key.dimension).substr(name_of(key.dimension).find(' ') + 1);
    }

    static std::string names(const Key& key, const std::vector<std::string>& choices) {
        const std::string later = key.planned.empty() ? "" : "; not yet: " + comma_list(key.planned);
        return comma_list(choices) + later;
    }

    void add(const Key& key, std::string type, std::string fallback, std::string legal) {
        const std::string reduced = reduced_unit(key.dimension), si = si_unit(key.dimension);
        std::string unit = key.dimension == Dimension::length && units_.is_own() ? units_.own
                           : !units_.reduced_words || reduced == si              ? si
                                                                                 : reduced + "; si: " + si;
        current().keys.push_back({path_.empty() ? "" : path_.back(), key.name, std::move(type),
                                  std::move(unit), std::move(fallback), std::move(legal), key.meaning,
                                  key.example_value});
    }

    void add_entries(const Key& key, const std::string& type) {
        add(key, type, key.is_required ? "required" : key.absent_text, names(key, key.choices));
    }

    std::vector<TableInfo> tables_;
    std::vector<std::string> path_, planned_;
    Units units_;
};

Documenter documented() {
    Scene scene;
    Documenter documenter;
    fields(documenter, scene);
    return documenter;
}

/// "field.cuts[]" as its header, "[[field.cuts]]".
std::string header(const std::string& path) {
    const bool list = path.ends_with("[]");
    return list ? "[[" + path.substr(0, path.size() - 2) + "]]" : "[" + path + "]";
}

std::string cell(const std::string& text) {
    std::string out;
    for (const char c : text)
        out += c == '|' ? "\\|" : std::string(1, c);
    return out;
}

std::string table_text(const TableInfo& table) {
    std::string text =
        table.path.empty() ? "\n## Top level\n" : fmt::format("\n## `{}`\n", header(table.path));
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
* density: `"2.7 g/cm^3"` (kg/m^3, g/cm^3); acceleration: `"9.81 m/s^2"` (m/s^2, mm/s^2)

On the command line `-s table.key=value` replaces a value: `-s coupling.kappa=2`, `-s rods.1.position.0=2.0` (entries
of lists are numbered from 0), `-s rods_run.method=adams`. Where keys are alternatives, the one set wins over those in
the file.
)md";

} // namespace

std::vector<KeyInfo> scene_keys() {
    const Documenter documenter = documented();
    std::vector<KeyInfo> keys;
    for (const auto& table : documenter.tables())
        keys.insert(keys.end(), table.keys.begin(), table.keys.end());
    return keys;
}

std::string scene_reference() {
    const Documenter documenter = documented();
    std::string text = introduction;
    for (const auto& table : documenter.tables())
        text += table_text(table);
    return text +
           "\n## Not available in this version\n\nThese tables have meaning in later versions and are errors "
           "in "
           "this one: " +
           comma_list(documenter.planned_names()) + ".\n";
}

} // namespace rodwake::scene
