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
        if (const auto* table = from.as_table())
            node.value = convert_table(*table);
        else if (const auto* array = from.as_array())
            node.value = convert_array(*array);
        else if (const auto* text = from.as_string())
            node.value = text->get();
        else if (const auto* integer = from.as_integer())
            node.value = integer->get();
        else if (const auto* real = from.as_floating_point())
            node.value = real->get();
        else if (const auto* flag = from.as_boolean())
            node.value = flag->get();
        return node;
    }

    Node::Table convert_table(const toml::table& from) const {
        Node::Table table;
        table.reserve(from.size());
        for (const auto& [key, value] : from)
            table.push_back({std::string(key.str()), place(key.source()), convert(value)});
        return table;
    }

    Node::List convert_array(const toml::array& from) const {
        Node::List list;
        list.reserve(from.size());
        for (const auto& item : from)
            list.push_back(convert(item));
        return list;
    }
};

/// What toml++ quotes from the file.
std::string what_is_quoted(const std::string& why) {
    const auto begin = why.find('\''), end = why.find('\'', begin + 1);
    return end == std::string::npos ? "" : why.substr(begin + 1, end - begin - 1);
}

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
        const std::string why(error.description()), number = what_is_quoted(why);
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

namespace {

/// Walks over TOML text, skipping comments and the insides of strings.
class Scanner {
public:
    explicit Scanner(std::string_view text) : text_(text) {}

    std::optional<TextPosition> find_deep_key() {
        int dots = 0;
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '#')
                skip_comment();
            else if (c == '"' || c == '\'')
                skip_string(c);
            else {
                if (c == '.' && ++dots > max_key_dots)
                    return position_;
                if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos)
                    dots = 0;
                advance();
            }
        }
        return std::nullopt;
    }

private:
    void advance(std::size_t count = 1) {
        for (; count > 0 && at_ < text_.size(); --count, ++at_)
            if (text_[at_] == '\n')
                position_ = {position_.line + 1, 1};
            else
                ++position_.column;
    }

    void skip_comment() {
        while (at_ < text_.size() && text_[at_] != '\n')
            advance();
    }

    void skip_string(char quote) {
        const char triple[] = {quote, quote, quote};
        const std::string_view fence(triple, 3);
        const bool multi_line = text_.substr(at_, 3) == fence;
        const std::string_view end = multi_line ? fence : fence.substr(0, 1);
        advance(end.size());
        while (at_ < text_.size() && text_.substr(at_, end.size()) != end) {
            if (!multi_line && text_[at_] == '\n')
                return; // unterminated: the parser stops here, too
            advance(quote == '"' && text_[at_] == '\\' ? 2 : 1);
        }
        advance(end.size());
    }

    std::string_view text_;
    std::size_t at_ = 0;
    TextPosition position_;
};

} // namespace

std::optional<TextPosition> find_deep_key(std::string_view text) { return Scanner(text).find_deep_key(); }

} // namespace rodwake::scene
