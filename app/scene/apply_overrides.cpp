#include "apply_overrides.hpp"

#include "diagnostics.hpp"
#include "rodwake/core/spelling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <tuple>

namespace rodwake::scene {

namespace {

/// A number that TOML writes otherwise: .5, 5., 99999999999999999999.
std::optional<double> plain_number(const std::string& text) {
    double number = 0.0;
    const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_whole = at == text.data() + text.size() && error == std::errc{};
    return is_whole ? std::optional(number) : std::nullopt;
}

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

/// Goes through the document one path segment at a time.
class Walker {
public:
    Walker(Node& root, const Override& item, Diagnostics& diagnostics)
        : at_(&root), item_(item), diagnostics_(diagnostics) {}

    void apply() {
        if (!is_path(item_.path))
            fail(fmt::format("{} is not a key such as \"coupling.kappa\"",
                             describe_value(Node{{}, item_.path})));
        else if (item_.unsets)
            unset();
        else
            put();
    }

private:
    void put() {
        for (const auto& segment : split_path(item_.path))
            if (!step(segment))
                return;
        *at_ = item_.value;
    }

    void unset() {
        Node* parent = at_;
        std::string last;
        for (const auto& segment : split_path(item_.path)) {
            parent = at_;
            last = segment;
            if (!is_there(segment) || !step(segment))
                return;
        }
        if (auto* list = parent->as<Node::List>())
            list->erase(list->begin() + list_index(last));
        else
            std::erase_if(*parent->as<Node::Table>(), [&](const Entry& entry) { return entry.key == last; });
    }

    /// Whether a table has this key; of a list and of a value `step` tells.
    bool is_there(const std::string& segment) {
        const auto* table = at_->as<Node::Table>();
        if (!table || at_->find(segment))
            return true;
        std::vector<std::string_view> keys;
        for (const Entry& entry : *table)
            keys.push_back(entry.key);
        return fail(fmt::format("nothing to unset: {} has no {}{}", walked_.empty() ? "the scene" : walked_,
                                segment, did_you_mean(segment, keys)));
    }

    bool step(const std::string& segment) {
        const bool moved = at_->as<Node::List>() ? into_list(segment) : into_table(segment);
        walked_ += (walked_.empty() ? "" : ".") + segment;
        return moved;
    }

    bool into_list(const std::string& segment) {
        auto& list = *at_->as<Node::List>();
        const long index = list_index(segment);
        if (index < 0)
            return fail(fmt::format("{} is a list: give an index from 0 after it, not {}", walked_,
                                    in_quotes(segment)));
        if (static_cast<std::size_t>(index) >= list.size())
            return fail(
                fmt::format("no entry {}: {} has {} (numbered from 0)", segment, walked_, list.size()));
        at_ = &list[static_cast<std::size_t>(index)];
        return true;
    }

    bool into_table(const std::string& segment) {
        auto* table = at_->as<Node::Table>();
        if (!table)
            return fail(fmt::format("{} is not a table: {}", walked_, describe(*at_)));
        Entry* entry = at_->find(segment);
        if (!entry && list_index(segment) >= 0)
            return fail(fmt::format("no entry {}: the scene has no such list", segment));
        if (!entry)
            entry = &table->emplace_back(Entry{segment, item_.place, Node{item_.place, Node::Table{}}});
        at_ = &entry->value;
        return true;
    }

    bool fail(const std::string& message) {
        diagnostics_.add(item_.place, item_.path, message);
        return false;
    }

    Node* at_;
    std::string walked_;
    const Override& item_;
    Diagnostics& diagnostics_;
};

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
    if (const auto number = plain_number(value))
        return Override{path, Node{place, *number}, place};
    // A word or phrase that is meant as a string; a broken array or quoted string is not.
    const bool starts_toml = value.empty() || std::string("\"'[{").find(value.front()) != std::string::npos;
    const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20; };
    if (!starts_toml && std::none_of(value.begin(), value.end(), control))
        return Override{path, Node{place, value}, place};
    diagnostics.add(place, path, "the value is not valid TOML: " + why);
    return std::nullopt;
}

void apply_override(Node& root, const Override& item, Diagnostics& diagnostics) {
    Walker(root, item, diagnostics).apply();
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
