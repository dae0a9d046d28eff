// Reader: the value of one key, its type and its range.

#include "apply_overrides.hpp"
#include "problems.hpp"
#include "reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>

namespace rodwake::scene {

namespace {

constexpr std::string_view usual_box = "78 a"; // "fit" alone: the paper's

std::string expected_number(Dimension dimension) {
    static constexpr const char* examples[] = {"",       "0.4 mm",      "5 s",        "2.8 mm/s",   "0.5 1/s",
                                               "30 deg", "2700 kg/m^3", "9.81 m/s^2", "0.01 mm^2/s"};
    if (dimension == Dimension::none)
        return "expected a number";
    return fmt::format("expected {} (a number, or a string such as \"{}\")", name_of(dimension),
                       examples[static_cast<std::size_t>(dimension)]);
}

const Override* repeated(const std::vector<Override>& overrides) {
    std::set<std::string> seen;
    for (const auto& item : overrides)
        if (!seen.insert(item.path).second)
            return &item;
    return nullptr;
}

} // namespace

void Reader::operator()(const Key& key, double& value) {
    if (const Entry* entry = find(key))
        value = quantity(key, entry->value, path_of(key.name)).value_or(value);
}

void Reader::operator()(const Key& key, std::optional<double>& value) {
    const Entry* entry = find(key);
    value = entry ? quantity(key, entry->value, path_of(key.name)) : std::nullopt;
}

void Reader::operator()(const Key& key, long& value) {
    const Entry* entry = find(key);
    if (!entry)
        return;
    const auto* integer = entry->value.as<std::int64_t>();
    const std::string path = path_of(key.name);
    if (!integer)
        wrong_type(entry->value, path, "expected an integer");
    else if (!key.range.contains(static_cast<double>(*integer)))
        wrong(entry->value, path, "must be " + key.range.text());
    else
        value = *integer;
}

void Reader::operator()(const Key& key, std::optional<long>& value) {
    long found = 0;
    const bool is_given = frames_.back().table->find(key.name);
    (*this)(key, found);
    value = is_given ? std::optional(found) : std::nullopt;
}

void Reader::operator()(const Key& key, bool& value) {
    const Entry* entry = find(key);
    if (!entry)
        return;
    if (const auto* flag = entry->value.as<bool>())
        value = *flag;
    else
        wrong_type(entry->value, path_of(key.name), "expected true or false");
}

void Reader::operator()(const Key& key, std::string& value) {
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const auto* found = text(key, entry->value, path);
    if (found && (key.choices.empty() || is_choice(key.choices, entry->value, path)))
        value = *found;
}

void Reader::operator()(const Key& key, const Choice& value) {
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const auto* found = text(key, entry->value, path);
    const auto names = value.names();
    if (found && is_choice(names, entry->value, path))
        value.set(static_cast<std::size_t>(std::ranges::find(names, *found) - names.begin()));
}

void Reader::operator()(const Key& key, std::vector<double>& value) {
    value.clear();
    if (const Entry* entry = find(key))
        if (auto found = numbers(key, entry->value, path_of(key.name)))
            value = std::move(*found);
}

void Reader::operator()(const Key& key, std::optional<PeriodicBox>& value) {
    value.reset();
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const auto* list = entry->value.as<Node::List>();
    if (list && list->empty()) {
        wrong_type(entry->value, path, "expected a length (\"78 a\") or two ([\"78 a\", \"77 a\"])");
    } else if (list) {
        Key sides = key;
        sides.items(2, 2);
        if (const auto found = numbers(sides, entry->value, path))
            value = PeriodicBox{(*found)[0], (*found)[1]};
    } else if (const auto side = quantity(key, entry->value, path)) {
        value = PeriodicBox(*side);
    }
}

void Reader::operator()(const Key& key, BoxSize& value) {
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const Node& node = entry->value;
    const auto* word = node.as<std::string>();
    if (const auto* list = node.as<Node::List>(); list && !list->empty()) {
        Key sides = key;
        sides.items(2, 2);
        if (const auto found = numbers(sides, node, path))
            value = {(*found)[0], (*found)[1]};
    } else if (word && (*word == "fit" || word->starts_with("fit "))) {
        const Node size{node.place, word->size() > 3 ? word->substr(4) : std::string(usual_box)};
        if (const auto side = quantity(key, size, path))
            value = {*side, *side, true};
    } else if (list || (word && !word->empty() && std::isalpha(static_cast<unsigned char>(word->front())))) {
        wrong_type(node, path,
                   "expected a length (\"78 a\"), two ([\"78 a\", \"77 a\"]), \"fit\" or \"fit 155 a\"");
    } else if (const auto side = quantity(key, node, path)) {
        value = {*side, *side};
    }
}

void Reader::operator()(const Key& key, const TimeOrTravel& value) {
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const Node& node = entry->value;
    const auto* word = node.as<std::string>();
    const auto is_a = [&](Dimension d) { return word && parse_quantity(*word, d, units_).value.has_value(); };
    Key travel = key;
    travel.unit(Dimension::length).range = value.travel_range;
    if (node.as<std::int64_t>() || node.as<double>() || is_a(key.dimension))
        value.time = quantity(key, node, path).value_or(value.time);
    else if (!is_a(Dimension::length))
        wrong_type(node, path, "expected a time or length (a number of seconds, \"5 s\" or \"20 a\")");
    else if (value.travel)
        wrong(node, path, "is a distance, and so is from_travel: leave one of them out");
    else
        value.travel = quantity(travel, node, path);
}

void Reader::operator()(const Key& key, std::vector<std::vector<double>>& value) {
    value.clear();
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const auto* list = list_of(key, entry->value, path, "pairs of numbers");
    Key pair = key;
    pair.items(2, 2);
    for (std::size_t i = 0; list && i < list->size(); ++i)
        if (auto found = numbers(pair, (*list)[i], fmt::format("{}[{}]", path, i)))
            value.push_back(std::move(*found));
}

void Reader::operator()(const Key& key, std::optional<Value>& value) {
    const Entry* entry = find(key);
    value = entry ? written(entry->value, path_of(key.name)) : std::nullopt;
}

void Reader::operator()(const Key& key, std::vector<Value>& value) {
    value.clear();
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const auto* list = list_of(key, entry->value, path, "numbers, quantities or words");
    for (std::size_t i = 0; list && i < list->size(); ++i)
        if (auto found = written((*list)[i], fmt::format("{}[{}]", path, i)))
            value.push_back(std::move(*found));
}

/// A value of another key: what it must be is seen where that key is known.
std::optional<Value> Reader::written(const Node& node, const std::string& path) {
    if (const auto* flag = node.as<bool>())
        return *flag;
    if (const auto* whole = node.as<std::int64_t>())
        return *whole;
    if (const auto* text = node.as<std::string>())
        return *text;
    const auto* real = node.as<double>();
    if (!real)
        wrong_type(node, path, "expected a number, quantity or word");
    else if (!std::isfinite(*real))
        wrong(node, path, "must be a finite number");
    else
        return *real;
    return std::nullopt;
}

void Reader::operator()(const Key& key, std::vector<std::string>& value) {
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    const auto* list = list_of(key, entry->value, path, "names");
    value.clear();
    for (std::size_t i = 0; list && i < list->size(); ++i) {
        const Node& node = (*list)[i];
        const std::string item_path = fmt::format("{}[{}]", path, i);
        const auto* name = text(key, node, item_path);
        if (!name || (!key.choices.empty() && !is_choice(key.choices, node, item_path)))
            continue;
        if (contains(value, *name))
            wrong(node, item_path, "stands in the list already");
        value.push_back(*name);
    }
}

void Reader::settings(const Key& key, std::vector<std::string>& value) {
    value.clear();
    const Entry* entry = find(key);
    if (!entry)
        return;
    const std::string path = path_of(key.name);
    if (!entry->value.as<Node::Table>()) {
        wrong_type(entry->value, path, fmt::format("expected a table such as {}", key.example_value));
        return;
    }
    const auto overrides = variant_overrides(entry->value);
    if (overrides.size() < key.min_items || overrides.size() > key.max_items)
        wrong(entry->value, path,
              fmt::format("expected {}, found {}", key.count_text("keys"), overrides.size()));
    else if (const auto* twice = repeated(overrides))
        problems_.add(twice->place, path, fmt::format("{}: {} is set twice", path, in_quotes(twice->path)));
    else
        std::transform(overrides.begin(), overrides.end(), std::back_inserter(value),
                       [](const Override& item) { return item.text(); });
}

std::optional<double> Reader::number(const Key& key, const Node& node, const std::string& path) {
    if (const auto* integer = node.as<std::int64_t>())
        return to_reduced(static_cast<double>(*integer), key.dimension, units_);
    if (const auto* real = node.as<double>())
        return to_reduced(*real, key.dimension, units_);
    const auto* word = node.as<std::string>();
    if (!word || key.dimension == Dimension::none) {
        wrong_type(node, path, expected_number(key.dimension));
        return std::nullopt;
    }
    const Quantity found = parse_quantity(*word, key.dimension, units_);
    if (found.needs_scales)
        missing_scales(node, path, fmt::format("{} = {}: a physical unit", path, describe_value(node)));
    else if (!found.value)
        wrong_type(node, path, fmt::format("expected {}", name_of(key.dimension)), found.why);
    return found.value;
}

std::optional<double> Reader::quantity(const Key& key, const Node& node, const std::string& path) {
    const auto value = number(key, node, path);
    if (!value)
        return std::nullopt;
    if (const std::string fault = key.fault(*value); !fault.empty()) {
        wrong(node, path, fault);
        return std::nullopt;
    }
    return value;
}

const Node::List* Reader::list_of(const Key& key, const Node& node, const std::string& path,
                                  std::string_view of) {
    const auto* list = node.as<Node::List>();
    if (!list)
        wrong_type(node, path, "expected " + key.count_text(of));
    else if (list->size() < key.min_items || list->size() > key.max_items)
        problems_.add(node.place, path,
                      fmt::format("{}: expected {}, found {}", path, key.count_text(of), list->size()));
    else
        return list;
    return nullptr;
}

std::optional<std::vector<double>> Reader::numbers(const Key& key, const Node& node,
                                                   const std::string& path) {
    const auto* list = list_of(key, node, path, "numbers");
    if (!list)
        return std::nullopt;
    std::vector<double> values;
    values.reserve(list->size());
    for (std::size_t i = 0; i < list->size(); ++i)
        if (const auto value = quantity(key, (*list)[i], fmt::format("{}[{}]", path, i)))
            values.push_back(*value);
    return values.size() == list->size() ? std::optional(std::move(values)) : std::nullopt;
}

const std::string* Reader::text(const Key& key, const Node& node, const std::string& path) {
    const auto* found = node.as<std::string>();
    if (!found)
        wrong_type(node, path, "expected a string");
    else if (const std::string fault = key.fault(*found); !fault.empty())
        wrong(node, path, fault);
    else
        return found;
    return nullptr;
}

bool Reader::is_choice(Names names, const Node& node, const std::string& path) {
    const std::string& found = *node.as<std::string>();
    if (contains(names, found))
        return true;
    wrong(node, path, one_of_text(names, found));
    return false;
}

void Reader::missing_scales(const Node& node, const std::string& path, const std::string& what) {
    if (scales_reported_)
        return;
    scales_reported_ = true;
    problems_.add(
        node.place, path,
        what + " needs [scales] with f_over_mu and v0, what one reduced unit of length and speed is worth");
}

void Reader::wrong(const Node& node, const std::string& path, const std::string& message) {
    problems_.add(node.place, path, fmt::format("{} = {}: {}", path, describe_value(node), message));
}

void Reader::wrong_type(const Node& node, const std::string& path, const std::string& expected,
                        const std::string& why) {
    problems_.add(
        node.place, path,
        fmt::format("{}: {}, found {}{}{}", path, expected, describe(node), why.empty() ? "" : ": ", why));
}

} // namespace rodwake::scene
