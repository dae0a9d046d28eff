#include "reader.hpp"

#include "diagnostics.hpp"
#include "fields.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::scene {

Reader::Reader(const Node& root, Diagnostics& diagnostics) : diagnostics_(diagnostics) {
    frames_.push_back({&root, "", "", {}});
}

const Entry* Reader::find(const Key& key) {
    OpenTable& frame = frames_.back();
    if (!contains(frame.known, key.name))
        frame.known.push_back(key.name);
    const Entry* entry = frame.table->find(key.name);
    if (!entry && key.is_required) {
        const std::string owner = frame.path.empty() ? "the scene" : frame.path;
        diagnostics_.add(frame.table->place, path_of(key.name),
                         fmt::format("{} needs the key {}, for example {} = {}", owner, key.name, key.name,
                                     key.example_value));
    }
    return entry;
}

std::string Reader::path_of(std::string_view name) const {
    const std::string& path = frames_.back().path;
    return fmt::format("{}{}{}", path, path.empty() ? "" : ".", name);
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

Entries Reader::enter_list(const Key& key, std::size_t) {
    const Entry* entry = find(key);
    if (!entry)
        return {};
    const std::string path = path_of(key.name);
    const auto* list = entry->value.as<Node::List>();
    if (!list) {
        wrong_type(entry->value, path, fmt::format("expected entries [[{}]]", path));
        return {};
    }
    if (list->size() > key.max_items) {
        diagnostics_.add(entry->value.place, path,
                         fmt::format("{}: {} entries; at most {}", path, list->size(), key.max_items));
        return {};
    }
    return {list->size(), 0, list->size()};
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
    const OpenTable& frame = frames_.back();
    for (const auto& entry : *frame.table->as<Node::Table>())
        if (!contains(frame.known, entry.key))
            diagnostics_.add(entry.key_place, path_of(entry.key),
                             unknown_key_text(frame.title, entry.key, frame.known));
    frames_.pop_back();
}

void Reader::use_units(const Units& units) {
    units_ = units;
    if (units_.scales && !(units_.scales->f_over_mu > 0.0 && units_.scales->v0 > 0.0))
        units_.scales =
            Scales{1.0, 1.0, units_.scales->bead_radius}; // wrong and reported: any stand-in will do
    const Node& table = *frames_.back().table;
    const Entry* system = table.find("units");
    // Granular tables are SI without [scales]; the other tables need them.
    const std::vector<std::string> names{"medium", "coupling", "noise", "rods", "rods_run", "field"};
    if (units_.system == UnitSystem::si && !units_.scales && system &&
        std::any_of(names.begin(), names.end(), [&](const auto& name) { return table.find(name); }))
        missing_scales(system->value.place, "units", "units = \"si\"");
}

int Reader::form_given(Forms forms) {
    const Node& table = *frames_.back().table;
    // The document gives these keys of the forms.
    std::vector<GivenKey> given;
    for (const auto name : names_of(forms))
        if (const Entry* entry = table.find(name))
            given.push_back({name, entry->value.place.overriding});
    const auto names = effective_names(given, forms);
    const int form = matching_form(names, forms);
    if (names.empty())
        diagnostics_.add(table.place, frames_.back().path,
                         fmt::format("{} needs one of {}", frames_.back().path, forms_text(forms)));
    else if (form < 0) {
        std::string locations;
        const Entry* last = table.find(names.front());
        for (const auto name : names) {
            const Entry* entry = table.find(name);
            const long line = entry->key_place.line;
            locations += fmt::format("{}{}{}", locations.empty() ? "" : " and ", name,
                                     line > 0 ? fmt::format(" (line {})", line) : "");
            if (line > last->key_place.line)
                last = entry;
        }
        diagnostics_.add(
            last->key_place, path_of(last->key),
            fmt::format("{} gives {}: give one of {}", frames_.back().path, locations, forms_text(forms)));
    }
    return form;
}

void Reader::complain(std::string_view name, const std::string& message) {
    const Node& table = *frames_.back().table;
    const Entry* entry = table.find(name);
    diagnostics_.add(entry ? entry->value.place : table.place, path_of(name),
                     fmt::format("{} {}", path_of(name), message));
}

void Reader::visit(const Key& key, void* value, const Codec& codec) {
    codec.clear(value);
    current_ = key.name;
    if (const Entry* entry = find(key))
        codec.parse({key, entry->value, &units_, *this}, value);
}

void Reader::add(const SourcePosition& position, const std::string& below, const std::string& message) {
    const std::string path = path_of(current_) + below;
    diagnostics_.add(position, path, path + message);
}

void Reader::add_missing_scales(const SourcePosition& position, const std::string& below,
                                const std::string& message) {
    const std::string path = path_of(current_) + below;
    missing_scales(position, path, path + message);
}

void Reader::missing_scales(const SourcePosition& position, const std::string& path,
                            const std::string& what) {
    if (scales_reported_)
        return;
    scales_reported_ = true;
    diagnostics_.add(
        position, path,
        what + " needs [scales] with f_over_mu and v0, what one reduced unit of length and speed is worth");
}

void Reader::wrong_type(const Node& node, const std::string& path, const std::string& expected) {
    diagnostics_.add(node.place, path, fmt::format("{}: {}, found {}", path, expected, describe(node)));
}

} // namespace rodwake::scene
