#include "apply_overrides.hpp"

#include "diagnostics.hpp"
#include "rodwake/core/spelling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <tuple>

namespace rodwake::scene {

namespace {

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

bool is_path(const std::string& path) {
    const auto segments = split_path(path);
    const auto empty = [](const std::string& s) { return s.empty(); };
    return segments.size() <= static_cast<std::size_t>(max_key_dots) &&
           std::none_of(segments.begin(), segments.end(), empty);
}

} // namespace

std::optional<Override> parse_override(const std::string& text, Diagnostics& diagnostics) {
    const SourcePosition place{std::make_shared<const std::string>("-s " + text), 0, 0, true};
    const auto equals = text.find('=');
    const std::string path = trimmed(text.substr(0, equals));
    if (equals == std::string::npos || !is_path(path)) {
        diagnostics.add(place, path, "expected table.key=value, for example coupling.kappa=0.5");
        return std::nullopt;
    }
    const std::string value = trimmed(text.substr(equals + 1));
    if (value.empty())
        return Override{path, {}, place, true};
    if (is_too_large(value)) {
        diagnostics.add(place, path,
                        fmt::format("{} is too large for a number, which ends at 1.8e308", value));
        return std::nullopt;
    }
    std::string why;
    if (auto node = parse_toml_value(value, place, why))
        return Override{path, *node, place};
    double number = 0.0; // one that TOML writes otherwise: .5, 5., 99999999999999999999
    const auto [rest, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (rest == value.data() + value.size() && error == std::errc{})
        return Override{path, Node{place, number}, place};
    // A word or phrase that is meant as a string; a broken array or quoted string is not.
    const bool starts_toml = value.empty() || std::string("\"'[{").find(value.front()) != std::string::npos;
    const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20; };
    if (!starts_toml && std::none_of(value.begin(), value.end(), control))
        return Override{path, Node{place, value}, place};
    diagnostics.add(place, path, "the value is not valid TOML: " + why);
    return std::nullopt;
}

void apply_override(Node& root, const Override& item, Diagnostics& diagnostics) {
    const auto fail = [&](const std::string& message) { diagnostics.add(item.place, item.path, message); };
    if (!is_path(item.path))
        return fail(
            fmt::format("{} is not a key such as \"coupling.kappa\"", describe_value(Node{{}, item.path})));

    // The document is walked one path segment at a time; tables on the way to a new value are made.
    Node *at = &root, *parent = at;
    std::string walked;
    const std::vector<std::string> segments = split_path(item.path);
    for (const std::string& segment : segments) {
        parent = at;
        const long index = list_index(segment);
        if (auto* list = at->as<Node::List>()) {
            if (index < 0)
                return fail(fmt::format("{} is a list: give an index from 0 after it, not {}", walked,
                                        in_quotes(segment)));
            if (static_cast<std::size_t>(index) >= list->size())
                return fail(
                    fmt::format("no entry {}: {} has {} (numbered from 0)", segment, walked, list->size()));
            at = &(*list)[static_cast<std::size_t>(index)];
        } else {
            auto* table = at->as<Node::Table>();
            if (!table)
                return fail(fmt::format("{} is not a table: {}", walked, describe(*at)));
            Entry* entry = at->find(segment);
            if (!entry && item.unsets) {
                std::vector<std::string_view> keys;
                for (const Entry& known : *table)
                    keys.push_back(known.key);
                return fail(fmt::format("nothing to unset: {} has no {}{}",
                                        walked.empty() ? "the scene" : walked, segment,
                                        did_you_mean(segment, keys)));
            }
            if (!entry && index >= 0)
                return fail(fmt::format("no entry {}: the scene has no such list", segment));
            if (!entry)
                entry = &table->emplace_back(Entry{segment, item.place, Node{item.place, Node::Table{}}});
            at = &entry->value;
        }
        walked += (walked.empty() ? "" : ".") + segment;
    }
    const std::string& last = segments.back();
    if (!item.unsets)
        *at = item.value;
    else if (auto* list = parent->as<Node::List>())
        list->erase(list->begin() + list_index(last));
    else
        std::erase_if(*parent->as<Node::Table>(), [&](const Entry& entry) { return entry.key == last; });
}

namespace {

void flatten(const std::string& prefix, const Node::Table& table, std::vector<Override>& out) {
    for (const auto& entry : table) {
        const std::string path = prefix + entry.key;
        const auto* inner = entry.value.as<Node::Table>();
        if (inner && !inner->empty()) {
            flatten(path + ".", *inner, out);
            continue;
        }
        SourcePosition position = entry.key_place;
        position.overriding = true;
        out.push_back({path, entry.value, position});
    }
}

/// The override's nodes stand where the setting stands, and win over alternatives.
void move_to(Node& node, const SourcePosition& position) {
    node.place = position;
    if (auto* list = node.as<Node::List>())
        for (auto& item : *list)
            move_to(item, position);
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
    Diagnostics ignored; // settings that are not valid are written as they are and refused on reading
    for (const auto& setting : settings) {
        const auto parsed = parse_override(setting, ignored);
        text += text.empty() ? "" : ", ";
        text += parsed && !parsed->unsets ? in_quotes(parsed->path) + " = " + to_inline(parsed->value)
                                          : in_quotes(setting) + " = {}";
    }
    return "{ " + text + " }";
}

} // namespace rodwake::scene
