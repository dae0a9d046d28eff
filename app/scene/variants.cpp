#include "variants.hpp"

#include <algorithm>
#include <tuple>

namespace rodwake::scene {

namespace {

void flatten(const std::string& prefix, const Node::Table& table, std::vector<Override>& out) {
    for (const auto& entry : table) {
        const std::string path = prefix + entry.key;
        const auto* inner = entry.value.as<Node::Table>();
        if (inner && !inner->empty()) {
            flatten(path + ".", *inner, out);
            continue;
        }
        Place place = entry.key_place;
        place.overriding = true;
        out.push_back({path, entry.value, place});
    }
}

/// The override's nodes stand where the setting stands, and win over alternatives.
void move_to(Node& node, const Place& place) {
    node.place = place;
    if (auto* list = node.as<Node::List>())
        for (auto& item : *list)
            move_to(item, place);
}

} // namespace

std::vector<Override> variant_overrides(const Node& set) {
    std::vector<Override> out;
    if (const auto* table = set.as<Node::Table>())
        flatten("", *table, out);
    const auto before = [](const Override& a, const Override& b) {
        return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
    };
    std::stable_sort(out.begin(), out.end(), before);
    for (auto& item : out)
        move_to(item.value, item.place);
    return out;
}

std::string settings_text(const std::vector<std::string>& settings) {
    std::string text;
    Problems ignored; // settings that are not valid are written as they are and refused on reading
    for (const auto& setting : settings) {
        const auto parsed = parse_override(setting, ignored);
        text += text.empty() ? "" : ", ";
        text += parsed && !parsed->unsets ? in_quotes(parsed->path) + " = " + to_inline(parsed->value)
                                          : in_quotes(setting) + " = {}";
    }
    return "{ " + text + " }";
}

} // namespace rodwake::scene
