#pragma once
// Alternatives: keys that give the same thing in different ways, of which a table has exactly one.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rodwake::scene {

/// Keys that give a thing together: {"lame_lambda", "mu"}. Of a single key the second name is empty.
struct Form {
    std::string_view first, second{};

    bool has(std::string_view name) const { return name == first || (!second.empty() && name == second); }
    std::size_t size() const { return second.empty() ? 1 : 2; }
};

/// {{"xi"}, {"alpha"}}
using Forms = std::span<const Form>;

/// A key of some form that a table has. One that overrides (-s, a variant, a scan) wins over alternatives.
struct GivenKey {
    std::string_view name;
    bool is_overriding = false;
};

/// The names of all forms, each once.
std::vector<std::string_view> names_of(Forms forms);

/// What counts of `given`: all, but what overrides drops what cannot stand beside it.
std::vector<std::string_view> effective_names(std::span<const GivenKey> given, Forms forms);

/// The form that consists of these keys, or -1.
int matching_form(std::span<const std::string_view> names, Forms forms);

/// "t_end | t_end + output_times"
std::string forms_text(Forms forms);

} // namespace rodwake::scene
