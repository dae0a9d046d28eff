#pragma once

#include <optional>
#include <string_view>

namespace rodwake::scene {

/// Longest dotted key, in dots. The parser limits nested brackets itself but recurses without limit over
/// a.b.c.d...
inline constexpr int max_key_dots = 16;

struct TextPosition {
    long line = 1, column = 1;
};

/// First place where a dotted key of valid TOML has more than max_key_dots dots.
std::optional<TextPosition> find_deep_key(std::string_view text);

} // namespace rodwake::scene
