#pragma once
// The description of one key, from which it is read, written, checked and documented.

#include "units.hpp"

#include <functional>
#include <string>
#include <utility>
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

struct Key {
    std::string name, meaning, example_value;
    Dimension dimension = Dimension::none;
    Range range;
    std::string reason;      ///< why the range is what it is, for the message
    std::string absent_text; ///< what the absence of an optional key means
    bool is_required = false, is_file_name = false;
    bool is_written =
        true; ///< false: the key means nothing beside the other values, a written scene omits it
    std::size_t min_items = 0, max_items = 0; ///< for lists
    std::vector<std::string> choices;         ///< for strings; empty: any
    std::vector<std::string> planned;         ///< choices that are not available in this version

    Key& required() { return is_required = true, *this; }
    Key& above(double low, double high = 1e12) { return range = {low, high, true}, *this; }
    Key& within(double low, double high) { return range = {low, high, false}, *this; }
    Key& unit(Dimension d) { return dimension = d, *this; }
    Key& because(std::string text) { return reason = std::move(text), *this; }
    Key& absent(std::string text) { return absent_text = std::move(text), *this; }
    Key& items(std::size_t min, std::size_t max) { return min_items = min, max_items = max, *this; }
    Key& one_of(std::vector<std::string> names) { return choices = std::move(names), *this; }
    Key& not_yet(std::vector<std::string> names) { return planned = std::move(names), *this; }
    Key& written_if(bool belongs) { return is_written = belongs, *this; }
    Key& file_name() { return is_file_name = true, *this; }
    Key& doc(std::string text) { return meaning = std::move(text), *this; }
    Key& example(std::string toml) { return example_value = std::move(toml), *this; }

    /// "2 numbers", "1 to 1000 numbers"
    std::string count_text(const std::string& of) const;
};

Key key(std::string name);

/// An enumeration seen as names.
struct Choice {
    std::vector<std::string> names;
    std::size_t current = 0;
    std::function<void(std::size_t)> set;
};

template<class Enum>
Choice choice(Enum& value, const std::vector<std::pair<std::string, Enum>>& options) {
    Choice result;
    std::vector<Enum> values;
    for (const auto& [name, option] : options) {
        if (option == value)
            result.current = values.size();
        result.names.push_back(name);
        values.push_back(option);
    }
    result.set = [&value, values](std::size_t i) { value = values[i]; };
    return result;
}

} // namespace rodwake::scene
