#pragma once
// TOML as a tree of nodes that know their places.

#include "node.hpp"
#include "problems.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace rodwake::scene {

/// The document as a tree with places in `name`; nothing, and one problem, if it is not TOML.
std::optional<Node> parse_toml(std::string_view text, const std::string& name, Problems& problems);

/// One TOML value ("-2.5", "[1, 2]", "{ a = 1 }"), every node of it at `place`. Nothing, and the reason in
/// `why`, if it is not one.
std::optional<Node> parse_toml_value(std::string_view text, const Place& place, std::string& why);

/// Whether the text is a number beyond the range of a double, such as 1e400.
bool is_too_large(const std::string& text);

/// Longest dotted key, in dots. The parser limits nested brackets itself but recurses without limit over
/// a.b.c.d...
inline constexpr int max_key_dots = 16;

struct TextPosition {
    long line = 1, column = 1;
};

/// First place where a dotted key of valid TOML has more than max_key_dots dots.
std::optional<TextPosition> find_deep_key(std::string_view text);

} // namespace rodwake::scene
