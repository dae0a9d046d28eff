#include "diagnostics.hpp"

#include <toml++/toml.h>

#include <charconv>
#include <cmath>
#include <cstdlib>

namespace rodwake::scene {

namespace {

using Source = std::shared_ptr<const std::string>;

/// Turns toml++ nodes into ours. With `fixed`, every node stands at that place.
struct Converter {
    Source source;
    const SourcePosition* fixed = nullptr;

    SourcePosition place(const toml::source_region& region) const {
        return fixed ? *fixed : SourcePosition{source, region.begin.line, region.begin.column, false};
    }

    Node convert(const toml::node& from) const {
        Node node{place(from.source()), Node::Date{}};
        if (const auto* table = from.as_table()) {
            auto& entries = node.value.emplace<Node::Table>();
            entries.reserve(table->size());
            for (const auto& [key, value] : *table)
                entries.push_back({std::string(key.str()), place(key.source()), convert(value)});
        } else if (const auto* array = from.as_array()) {
            auto& list = node.value.emplace<Node::List>();
            list.reserve(array->size());
            for (const auto& item : *array)
                list.push_back(convert(item));
        } else if (const auto* text = from.as_string())
            node.value = text->get();
        else if (const auto* integer = from.as_integer())
            node.value = integer->get();
        else if (const auto* real = from.as_floating_point())
            node.value = real->get();
        else if (const auto* flag = from.as_boolean())
            node.value = flag->get();
        return node;
    }
};

} // namespace

bool is_too_large(const std::string& text) {
    double number = 0.0;
    const auto [at, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return at == text.data() + text.size() && error == std::errc::result_out_of_range &&
           std::isinf(std::strtod(text.c_str(), nullptr)); // not what is too small
}

std::optional<Node> parse_toml(std::string_view text, const std::string& name, Diagnostics& diagnostics) {
    const auto source = std::make_shared<const std::string>(name);
    if (const auto deep = find_deep_key(text)) {
        diagnostics.add({source, deep->line, deep->column}, "", "key nested too deeply");
        return std::nullopt;
    }
    try {
        return Converter{source}.convert(toml::parse(text));
    } catch (const toml::parse_error& error) {
        const auto at = error.source().begin;
        const std::string why(error.description()); // quotes the file
        const auto begin = why.find('\''), end = why.find('\'', begin + 1);
        const std::string number = end == std::string::npos ? "" : why.substr(begin + 1, end - begin - 1);
        diagnostics.add({source, at.line, at.column}, "",
                        is_too_large(number) ? number + " is too large for a number, which ends at 1.8e308"
                                             : "not valid TOML: " + why);
        return std::nullopt;
    }
}

std::optional<Node> parse_toml_value(std::string_view text, const SourcePosition& position,
                                     std::string& why) {
    if (text.find_first_of("\r\n") != std::string_view::npos) {
        why = "a value is one line";
        return std::nullopt;
    }
    const std::string document = "value = " + std::string(text);
    if (find_deep_key(document)) {
        why = "nested too deeply";
        return std::nullopt;
    }
    try {
        const toml::table parsed = toml::parse(document);
        return Converter{nullptr, &position}.convert(*parsed.get("value"));
    } catch (const toml::parse_error& error) {
        why = error.description();
        return std::nullopt;
    }
}

std::optional<TextPosition> find_deep_key(std::string_view text) {
    TextPosition position;
    std::size_t at = 0;
    const auto advance = [&](std::size_t count) {
        for (; count > 0 && at < text.size(); --count, ++at)
            if (text[at] == '\n')
                position = {position.line + 1, 1};
            else
                ++position.column;
    };
    int dots = 0;
    while (at < text.size()) {
        const char c = text[at];
        if (c == '#') { // a comment
            while (at < text.size() && text[at] != '\n')
                advance(1);
        } else if (c == '"' || c == '\'') { // a string of one line or several
            const std::string fence(3, c);
            const bool multi_line = text.substr(at, 3) == fence;
            const std::string end = multi_line ? fence : fence.substr(0, 1);
            advance(end.size());
            bool closed = true;
            while (closed && at < text.size() && text.substr(at, end.size()) != end) {
                closed = multi_line || text[at] != '\n'; // unterminated: the parser stops here, too
                if (closed)
                    advance(c == '"' && text[at] == '\\' ? 2 : 1);
            }
            if (closed)
                advance(end.size());
        } else {
            if (c == '.' && ++dots > max_key_dots)
                return position;
            if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos)
                dots = 0;
            advance(1);
        }
    }
    return std::nullopt;
}

} // namespace rodwake::scene
