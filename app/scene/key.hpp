#pragma once
// The description of one key, from which it is read, written, checked, set and documented.

#include "diagnostics.hpp"
#include "units.hpp"

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace rodwake::scene {

/// Legal values of a number. Everything is bounded: larger magnitudes are slips of the keyboard and overflow
/// later.
struct Range {
    double low = -1e12, high = 1e12;
    bool open_low = false; ///< low itself is not legal

    bool contains(double value) const { return (open_low ? value > low : value >= low) && value <= high; }
    /// "> -1 and <= 1e12"
    std::string text() const;
};

/// Only refers to its texts, and is used within the expression that makes it: a visit of a table allocates
/// nothing, so that a scan can set a value in less than a microsecond. The name is a literal.
struct Key {
    std::string_view name, meaning, example_value;
    std::string_view symbol_tex; ///< TeX without dollars; empty: none
    Dimension dimension = Dimension::none;
    Range range;
    std::string_view reason;      ///< why the range is what it is, for the message
    std::string_view absent_text; ///< what the absence of an optional key means
    bool is_required = false, is_file_name = false;
    bool is_written =
        true;             ///< false: the key means nothing beside the other values, a written scene omits it
    bool is_unit = false; ///< says what the numbers of the scene mean
    std::size_t min_items = 0, max_items = 0; ///< for lists
    Names choices;                            ///< for strings; empty: any

    Key& required() { return is_required = true, *this; }
    Key& above(double low, double high = 1e12) { return range = {low, high, true}, *this; }
    Key& within(double low, double high) { return range = {low, high, false}, *this; }
    Key& unit(Dimension d) { return dimension = d, *this; }
    Key& symbol(std::string_view tex) { return symbol_tex = tex, *this; }
    Key& because(std::string_view text) { return reason = text, *this; }
    Key& absent(std::string_view text) { return absent_text = text, *this; }
    Key& items(std::size_t min, std::size_t max) { return min_items = min, max_items = max, *this; }
    Key& one_of(Names names) { return choices = names, *this; }
    Key& one_of(std::initializer_list<std::string_view> names) {
        return one_of(Names{names.begin(), names.size()});
    }
    Key& written_if(bool belongs) { return is_written = belongs, *this; }
    Key& says_units(bool is = true) { return is_unit = is, *this; }
    Key& file_name() { return is_file_name = true, *this; }
    Key& doc(std::string_view text) { return meaning = text, *this; }
    Key& example(std::string_view toml) { return example_value = toml, *this; }

    /// What is wrong with a value ("must be > -1 and <= 1e12: the longitudinal modulus 1 + eta must be
    /// positive"); empty: nothing.
    std::string fault(double value) const;
    std::string fault(const std::string& text) const;
    /// "2 numbers", "1 to 1000 numbers"
    std::string count_text(std::string_view of) const;
};

inline Key key(std::string_view name) {
    Key result;
    result.name = name;
    return result;
}

template<class Enum>
struct Named {
    std::string_view name;
    Enum value;
};

/// An enumeration seen as names. Like a Key it refers to what it was made from.
struct Choice {
    std::size_t count = 0, current = 0;
    void* value = nullptr;
    const void* options = nullptr; ///< array of Named<Enum>
    std::string_view (*name_of)(const void* options, std::size_t) = nullptr;
    void (*assign)(void* value, const void* options, std::size_t) = nullptr;

    std::string_view name(std::size_t i) const { return name_of(options, i); }
    void set(std::size_t i) const { assign(value, options, i); }
    std::vector<std::string_view> names() const;
};

template<class Enum>
Choice choice(Enum& value, std::initializer_list<Named<std::type_identity_t<Enum>>> options) {
    Choice result;
    result.count = options.size();
    for (std::size_t i = 0; i < options.size(); ++i)
        if (options.begin()[i].value == value)
            result.current = i;
    result.value = &value;
    result.options = options.begin();
    result.name_of = [](const void* all, std::size_t i) {
        return static_cast<const Named<Enum>*>(all)[i].name;
    };
    result.assign = [](void* target, const void* all, std::size_t i) {
        *static_cast<Enum*>(target) = static_cast<const Named<Enum>*>(all)[i].value;
    };
    return result;
}

// Alternatives: keys that give the same thing in different ways, of which a table has exactly one.

/// Keys that give a thing together: {"lame_lambda", "mu"}. Of a single key the second name is empty.
struct KeyAlternative {
    std::string_view first, second{};

    bool has(std::string_view name) const { return name == first || (!second.empty() && name == second); }
    std::size_t size() const { return second.empty() ? 1 : 2; }
};

/// {{"xi"}, {"alpha"}}
using Forms = std::span<const KeyAlternative>;

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
