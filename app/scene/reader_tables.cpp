// Reader: tables of named values, and lists of integers.

#include "reader.hpp"
#include "suggest.hpp"

#include <fmt/format.h>

namespace rodwake::scene {

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
