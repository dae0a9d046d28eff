#include "node.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rodwake::scene {

namespace {

template<class Range, class Text>
std::string joined(const Range& range, Text text) {
    std::string out;
    for (const auto& item : range)
        out += (out.empty() ? "" : ", ") + text(item);
    return out;
}

struct InlineText {
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
    std::string operator()(double value) const { return number_text(value); }
    std::string operator()(const std::string& value) const { return in_quotes(value); }
    std::string operator()(Node::Date) const { return "1970-01-01"; }
    std::string operator()(const Node::List& list) const {
        return fmt::format("[{}]", joined(list, to_inline));
    }
    std::string operator()(const Node::Table& table) const {
        const auto entry_text = [](const Entry& e) { return key_text(e.key) + " = " + to_inline(e.value); };
        return table.empty() ? "{}" : fmt::format("{{ {} }}", joined(table, entry_text));
    }
};

} // namespace

const Entry* Node::find(std::string_view key) const { return const_cast<Node*>(this)->find(key); }

Entry* Node::find(std::string_view key) {
    auto* table = as<Table>();
    if (!table)
        return nullptr;
    const auto it = std::find_if(table->begin(), table->end(), [&](const Entry& e) { return e.key == key; });
    return it == table->end() ? nullptr : &*it;
}

std::string number_text(double value) {
    std::string text = fmt::format("{}", value);
    const bool integral = text.find_first_not_of("-0123456789") == std::string::npos;
    return integral ? text + ".0" : text;
}

std::string in_quotes(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            out += {'\\', c};
        else if (code < 0x20 || code == 0x7F)
            out += fmt::format("\\u{:04X}", code);
        else
            out += c;
    }
    return out + '"';
}

std::string key_text(const std::string& key) {
    const auto bare = [](unsigned char c) { return (c < 128 && std::isalnum(c)) || c == '_' || c == '-'; };
    return !key.empty() && std::all_of(key.begin(), key.end(), bare) ? key : in_quotes(key);
}

std::string to_inline(const Node& node) { return std::visit(InlineText{}, node.value); }

std::string describe_value(const Node& node) {
    if (node.as<Node::Table>())
        return "a table";
    if (const auto* list = node.as<Node::List>())
        return fmt::format("an array of {}", list->size());
    if (node.as<Node::Date>())
        return "a date or time";
    const std::string text = to_inline(node);
    if (text.size() <= 40)
        return text;
    std::size_t end = 36; // cut between UTF-8 characters
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80)
        --end;
    return text.substr(0, end) + "...";
}

std::string describe(const Node& node) {
    static constexpr const char* kinds[] = {" (boolean)", " (integer)", " (float)", " (string)", "", "", ""};
    return describe_value(node) + kinds[node.value.index()];
}

std::vector<std::string> split_path(const std::string& path) {
    std::vector<std::string> segments(1);
    for (const char c : path)
        if (c == '.')
            segments.emplace_back();
        else
            segments.back() += c;
    return segments;
}

long list_index(const std::string& segment) {
    const bool digits = !segment.empty() && segment.find_first_not_of("0123456789") == std::string::npos;
    return digits && segment.size() <= 9 ? std::stol(segment) : -1;
}

SourcePosition locate(const Node& root, const std::string& path) {
    const Node* node = &root;
    for (const auto& segment : split_path(path)) {
        const Node* next = nullptr;
        if (const auto* entry = node->find(segment))
            next = &entry->value;
        else if (const auto* list = node->as<Node::List>())
            if (const long i = list_index(segment); i >= 0 && static_cast<std::size_t>(i) < list->size())
                next = &(*list)[static_cast<std::size_t>(i)];
        if (!next)
            break;
        node = next;
    }
    return node->place;
}

} // namespace rodwake::scene
