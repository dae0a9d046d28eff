#include "reader.hpp"

#include "fields.hpp"
#include "rodwake/scene/document.hpp"
#include "suggest.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rodwake::scene {

namespace {

/// The alternatives that count: all that are given, but what an override sets drops what only the file gives.
std::vector<std::string> effective_names(const Node& table, const Forms& forms) {
    std::vector<std::string> given, overriding;
    for (const auto& form : forms)
        for (const auto& name : form)
            if (const Entry* entry = table.find(name); entry && !contains(given, name)) {
                given.push_back(name);
                if (entry->value.place.overriding)
                    overriding.push_back(name);
            }
    if (overriding.empty())
        return given;
    const auto has_all_overriding = [&](const std::vector<std::string>& form) {
        return std::all_of(overriding.begin(), overriding.end(),
                           [&](const auto& n) { return contains(form, n); });
    };
    std::erase_if(given, [&](const std::string& name) {
        const auto keeps = [&](const auto& form) { return contains(form, name) && has_all_overriding(form); };
        return !contains(overriding, name) && std::none_of(forms.begin(), forms.end(), keeps);
    });
    return given;
}

std::string forms_text(const Forms& forms) {
    std::string text;
    for (const auto& form : forms) {
        text += text.empty() ? "" : " | ";
        for (std::size_t i = 0; i < form.size(); ++i)
            text += (i == 0 ? "" : " + ") + form[i];
    }
    return text;
}

/// " ([coupling] has it)" for a key that stands in the wrong table.
std::string where_it_belongs(const std::string& name) {
    for (const auto& known : scene_keys())
        if (known.name == name && !known.table.empty())
            return fmt::format(" ([{}] has it)", known.table);
    return "";
}

/// Whether the scene has more than granular tables, which are SI without [scales].
bool has_reduced_tables(const Node& root) {
    const std::vector<std::string> names{"medium", "coupling", "noise", "rods", "rods_run", "field"};
    return std::any_of(names.begin(), names.end(), [&](const auto& name) { return root.find(name); });
}

} // namespace

Reader::Reader(const Node& root, Problems& problems) : problems_(problems) {
    frames_.push_back({&root, "", "", {}});
}

const Entry* Reader::find(const Key& key) {
    Frame& frame = frames_.back();
    frame.known.push_back(key.name);
    const Entry* entry = frame.table->find(key.name);
    if (!entry && key.is_required) {
        const std::string owner = frame.path.empty() ? "the scene" : frame.path;
        problems_.add(frame.table->place, path_of(key.name),
                      fmt::format("{} needs the key {}, for example {} = {}", owner, key.name, key.name,
                                  key.example_value));
    }
    return entry;
}

std::string Reader::path_of(const std::string& name) const {
    const std::string& path = frames_.back().path;
    return path.empty() ? name : path + "." + name;
}

bool Reader::enter_table(const Key& key, bool) {
    const Entry* entry = find(key);
    if (!entry)
        return false;
    const std::string path = path_of(key.name);
    if (!entry->value.as<Node::Table>()) {
        wrong_type(entry->value, path, fmt::format("expected a table [{}]", path));
        return false;
    }
    frames_.push_back({&entry->value, path, "[" + path + "]", {}});
    return true;
}

std::size_t Reader::enter_list(const Key& key, std::size_t) {
    const Entry* entry = find(key);
    if (!entry)
        return 0;
    const std::string path = path_of(key.name);
    const auto* list = entry->value.as<Node::List>();
    if (!list) {
        wrong_type(entry->value, path, fmt::format("expected entries [[{}]]", path));
        return 0;
    }
    if (list->size() > key.max_items) {
        problems_.add(entry->value.place, path,
                      fmt::format("{}: {} entries; at most {}", path, list->size(), key.max_items));
        return 0;
    }
    return list->size();
}

bool Reader::enter_entry(const Key& key, std::size_t index) {
    const std::string path = path_of(key.name);
    const Node& node = (*frames_.back().table->find(key.name)->value.as<Node::List>())[index];
    const std::string entry_path = fmt::format("{}[{}]", path, index);
    if (!node.as<Node::Table>()) {
        wrong_type(node, entry_path, fmt::format("expected a table [[{}]]", path));
        return false;
    }
    frames_.push_back({&node, entry_path, "[[" + path + "]]", {}});
    return true;
}

void Reader::leave() {
    const Frame& frame = frames_.back();
    for (const auto& entry : *frame.table->as<Node::Table>())
        if (!contains(frame.known, entry.key))
            unknown_key(frame, entry);
    frames_.pop_back();
}

void Reader::unknown_key(const Frame& frame, const Entry& entry) {
    const std::string where = frame.title.empty() ? "unknown table or key" : frame.title + " unknown key";
    std::string hint = did_you_mean(entry.key, frame.known);
    if (hint.empty())
        hint = where_it_belongs(entry.key);
    problems_.add(entry.key_place, path_of(entry.key),
                  fmt::format("{} {}{}. Known keys: {}", where, describe_value(Node{{}, entry.key}), hint,
                              comma_list(frame.known)));
}

void Reader::planned(const std::string& name) {
    const Node& table = *frames_.back().table;
    const Entry* entry = table.find(name);
    if (!entry)
        return;
    const std::string path = path_of(name);
    problems_.add(entry->key_place, path, fmt::format("[{}] is not available in this version", path));
    frames_.back().known.push_back(name);
}

void Reader::use_units(const Units& units) {
    units_ = units;
    if (units_.scales && !(units_.scales->f_over_mu > 0.0 && units_.scales->v0 > 0.0))
        units_.scales =
            Scales{1.0, 1.0, units_.scales->bead_radius}; // wrong and reported: any stand-in will do
    const Node& table = *frames_.back().table;
    const Entry* system = table.find("units");
    if (units_.system == UnitSystem::si && !units_.scales && system && has_reduced_tables(table))
        missing_scales(system->value, "units", "units = \"si\"");
}

void Reader::one_form(const Forms& forms, const std::function<void(int)>& resolve) {
    const Node& table = *frames_.back().table;
    const auto given = effective_names(table, forms);
    if (given.empty())
        return problems_.add(table.place, frames_.back().path,
                             fmt::format("{} needs one of {}", frames_.back().path, forms_text(forms)));
    for (std::size_t i = 0; i < forms.size(); ++i)
        if (std::is_permutation(given.begin(), given.end(), forms[i].begin(), forms[i].end()))
            return resolve(static_cast<int>(i));
    report_forms(given, forms);
}

void Reader::report_forms(const std::vector<std::string>& given, const Forms& forms) {
    const Node& table = *frames_.back().table;
    std::string places;
    const Entry* last = table.find(given.front());
    for (const auto& name : given) {
        const Entry* entry = table.find(name);
        places +=
            fmt::format("{}{}{}", places.empty() ? "" : " and ", name,
                        entry->key_place.line > 0 ? fmt::format(" (line {})", entry->key_place.line) : "");
        if (entry->key_place.line > last->key_place.line)
            last = entry;
    }
    problems_.add(last->key_place, path_of(last->key),
                  fmt::format("{} gives {}: give one of {}", frames_.back().path, places, forms_text(forms)));
}

void Reader::complain(const std::string& name, const std::string& message) {
    const Node& table = *frames_.back().table;
    const Entry* entry = table.find(name);
    problems_.add(entry ? entry->value.place : table.place, path_of(name),
                  fmt::format("{} {}", path_of(name), message));
}

} // namespace rodwake::scene
