#include "reader.hpp"

#include "fields.hpp"
#include "problems.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rodwake::scene {

namespace {

/// Keys of the forms that the document gives.
std::vector<GivenKey> given_keys(const Node& table, Forms forms) {
    std::vector<GivenKey> given;
    for (const auto name : names_of(forms))
        if (const Entry* entry = table.find(name))
            given.push_back({name, entry->value.place.overriding});
    return given;
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
    if (!contains(frame.known, key.name))
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
        problems_.add(entry->value.place, path,
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
    const Frame& frame = frames_.back();
    for (const auto& entry : *frame.table->as<Node::Table>())
        if (!contains(frame.known, entry.key))
            unknown_key(frame, entry);
    frames_.pop_back();
}

void Reader::unknown_key(const Frame& frame, const Entry& entry) {
    problems_.add(entry.key_place, path_of(entry.key), unknown_key_text(frame.title, entry.key, frame.known));
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

int Reader::form_given(Forms forms) {
    const Node& table = *frames_.back().table;
    const auto names = effective_names(given_keys(table, forms), forms);
    const int form = matching_form(names, forms);
    if (names.empty())
        problems_.add(table.place, frames_.back().path,
                      fmt::format("{} needs one of {}", frames_.back().path, forms_text(forms)));
    else if (form < 0)
        report_forms(names, forms);
    return form;
}

void Reader::report_forms(std::span<const std::string_view> given, Forms forms) {
    const Node& table = *frames_.back().table;
    std::string places;
    const Entry* last = table.find(given.front());
    for (const auto name : given) {
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

void Reader::complain(std::string_view name, const std::string& message) {
    const Node& table = *frames_.back().table;
    const Entry* entry = table.find(name);
    problems_.add(entry ? entry->value.place : table.place, path_of(name),
                  fmt::format("{} {}", path_of(name), message));
}

// Reader: tables of named values, and lists of integers.

void Reader::operator()(const Key& key, std::vector<long>& value) {
    value.clear();
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const auto* list = list_of(key, entry->value, path, "integers");
    for (std::size_t i = 0; list && i < list->size(); ++i) {
        const Node& node = (*list)[i];
        const std::string item_path = fmt::format("{}[{}]", path, i);
        const auto* integer = node.as<std::int64_t>();
        if (!integer)
            wrong_type(node, item_path, "expected an integer");
        else if (!key.range.contains(static_cast<double>(*integer)))
            wrong(node, item_path, "must be " + key.range.text());
        else
            value.push_back(*integer);
    }
}

template<class T, class Read>
void Reader::entries(const Key& key, std::map<std::string, T>& value, const std::string& of, Read read) {
    value.clear();
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const auto* table = entry->value.as<Node::Table>();
    if (!table)
        return wrong_type(entry->value, path, fmt::format("expected {} such as {}", of, key.example_value));
    for (const Entry& item : *table) {
        const std::string item_path = path + "." + item.key;
        if (!contains(key.choices, item.key))
            problems_.add(item.key_place, item_path,
                          fmt::format("{}: unknown parameter {}{}. Known parameters: {}", path,
                                      in_quotes(item.key), did_you_mean(item.key, key.choices),
                                      comma_list(key.choices)));
        else if (const std::optional<T> found = read(item.value, item_path))
            value.emplace(item.key, *found);
    }
}

void Reader::operator()(const Key& key, std::map<std::string, double>& value) {
    entries(key, value, "a table of numbers",
            [&](const Node& node, const std::string& path) { return quantity(key, node, path); });
}

void Reader::operator()(const Key& key, std::map<std::string, Interval>& value) {
    entries(key, value, "a table of [low, high]",
            [&](const Node& node, const std::string& path) -> std::optional<Interval> {
                Key pair = key;
                const auto found = numbers(pair.items(2, 2), node, path);
                return found ? std::optional(Interval{(*found)[0], (*found)[1]}) : std::nullopt;
            });
}

void Reader::operator()(const Key& key, std::map<std::string, Tie>& value) {
    entries(key, value, "a table of [name, factor]",
            [&](const Node& node, const std::string& path) -> std::optional<Tie> {
                const auto* list = node.as<Node::List>();
                if (!list || list->size() != 2) {
                    wrong_type(node, path, "expected [name, factor], such as [\"f_over_mu\", 0.5]");
                    return std::nullopt;
                }
                const auto* name = text(key, (*list)[0], path + "[0]");
                const auto factor = quantity(key, (*list)[1], path + "[1]");
                if (!name || !is_choice(key.choices, (*list)[0], path + "[0]") || !factor)
                    return std::nullopt;
                return Tie{*name, *factor};
            });
}

} // namespace rodwake::scene
