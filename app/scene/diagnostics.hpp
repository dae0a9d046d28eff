#pragma once
// What is wrong with a scene, collected while it is read, and the words for it.

#include "node.hpp"
#include "rodwake/core/spelling.hpp"
#include "rodwake/scene/read.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rodwake::scene {

/// Collects problems while a scene is read; storage is capped so that a hopeless file costs little.
class Diagnostics {
public:
    static constexpr std::size_t stored_at_most = 1000;

    void add(const SourcePosition& position, std::string key, std::string message);
    void add(Diagnostic problem);
    bool empty() const { return list_.empty(); }
    const std::vector<Diagnostic>& list() const { return list_; }

    /// Throws SceneError with all problems if there are any.
    void throw_if_any() const;

private:
    std::vector<Diagnostic> list_;
    std::size_t unstored_ = 0;
};

using Names = std::span<const std::string_view>;

/// `must be one of x, y (did you mean "x"?)`
std::string one_of_text(Names legal, std::string_view found);

/// `[coupling] unknown key "gama1" (did you mean "gamma1"?). Known keys: kappa, gamma1`; for the top level
/// the title is empty.
std::string unknown_key_text(const std::string& title, const std::string& name, Names known);

template<class Strings>
bool contains(const Strings& names, std::string_view name) {
    return std::ranges::find(names, name) != std::ranges::end(names);
}

/// "a, b, c"
template<class Strings>
std::string comma_list(const Strings& names) {
    std::string text;
    for (const std::string_view name : names)
        text.append(text.empty() ? "" : ", ").append(name);
    return text;
}

// TOML as a tree of nodes that know their places.

/// The document as a tree with places in `name`; nothing, and one problem, if it is not TOML.
std::optional<Node> parse_toml(std::string_view text, const std::string& name, Diagnostics& diagnostics);

/// One TOML value ("-2.5", "[1, 2]", "{ a = 1 }"), every node of it at `place`. Nothing, and the reason in
/// `why`, if it is not one.
std::optional<Node> parse_toml_value(std::string_view text, const SourcePosition& position, std::string& why);

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
