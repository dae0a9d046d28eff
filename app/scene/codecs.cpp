// The codecs of all types of values.

#include "apply_overrides.hpp"
#include "codec.hpp"
#include "problems.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>

namespace rodwake::scene {

std::string path_text(std::span<const Segment> path) {
    std::string text;
    for (const Segment& segment : path)
        text += segment.index >= 0 ? fmt::format("[{}]", segment.index)
                                   : fmt::format("{}{}", text.empty() ? "" : ".", segment.name);
    return text;
}

bool Input::wrong(const std::string& message) const {
    faults.add(node.place, below, fmt::format(" = {}: {}", describe_value(node), message));
    return false;
}

bool Input::wrong_type(const std::string& expected, const std::string& why) const {
    faults.add(
        node.place, below,
        fmt::format(": {}, found {}{}{}", expected, scene::describe(node), why.empty() ? "" : ": ", why));
    return false;
}

namespace {

constexpr std::string_view usual_box = "78 a"; // "fit" alone: the paper's

/// What a type T takes: how it is read, printed and described, and what differs from this base.
template<class T>
struct As;

template<class T>
struct Single {
    static constexpr bool is_quantity = false;
    static constexpr int depth = 0;
    static void clear(T&) {}
    static bool is_present(const T&) { return true; }
    static std::string misses(const Key&, const T&, std::span<const Segment>) { return ""; }
    static bool set(const Input& in, T& value, std::span<const Segment>) { return As<T>::read(in, value); }
};

template<class T>
struct Quantified : Single<T> {
    static constexpr bool is_quantity = true;
};

/// Nothing in it can be set without text.
template<class T>
struct Whole : Single<T> {
    static constexpr int depth = -1;
};

// Numbers.

std::string expected_number(Dimension dimension) {
    static constexpr const char* examples[] = {"",       "0.4 mm",      "5 s",        "2.8 mm/s",   "0.5 1/s",
                                               "30 deg", "2700 kg/m^3", "9.81 m/s^2", "0.01 mm^2/s"};
    if (dimension == Dimension::none)
        return "expected a number";
    return fmt::format("expected {} (a number, or a string such as \"{}\")", name_of(dimension),
                       examples[static_cast<std::size_t>(dimension)]);
}

/// A string with a unit; false, and told, if it is none.
bool worded(const Input& in, double& value) {
    const Dimension dimension = in.key.dimension;
    const auto* word = in.node.as<std::string>();
    if (!word || !in.units || dimension == Dimension::none)
        return in.wrong_type(expected_number(in.units ? dimension : Dimension::none));
    const Quantity found = parse_quantity(*word, dimension, *in.units);
    if (found.needs_scales)
        in.faults.add_missing_scales(in.node.place, in.below,
                                     fmt::format(" = {}: a physical unit", describe_value(in.node)));
    else if (!found.value)
        in.wrong_type(fmt::format("expected {}", name_of(dimension)), found.why);
    value = found.value.value_or(value);
    return found.value.has_value();
}

bool number(const Input& in, double& value) {
    if (const auto* whole = in.node.as<std::int64_t>())
        value = static_cast<double>(*whole);
    else if (const auto* real = in.node.as<double>())
        value = *real;
    else
        return worded(in, value);
    if (in.units)
        value = to_reduced(value, in.key.dimension, *in.units);
    return true;
}

bool quantity(const Input& in, double& value) {
    double found = 0.0;
    if (!number(in, found))
        return false;
    if (!in.key.range.contains(found)) // not so nan and inf
        return in.wrong(in.key.fault(found));
    value = found;
    return true;
}

std::string number_type(const Key& key) {
    const std::string name = name_of(key.dimension);
    return key.dimension == Dimension::none ? "number" : name.substr(name.find(' ') + 1);
}

template<>
struct As<double> : Quantified<double> {
    static bool read(const Input& in, double& value) { return quantity(in, value); }
    static std::string text(const Key& key, double value, const Units& units) {
        return quantity_text(value, key.dimension, units);
    }
    static Description about(const Key& key, double value) {
        return {number_type(key), number_text(value), "", true};
    }
};

template<>
struct As<long> : Single<long> {
    static bool read(const Input& in, long& value) {
        const auto* whole = in.node.as<std::int64_t>();
        if (!whole)
            return in.wrong_type("expected an integer");
        if (!in.key.range.contains(static_cast<double>(*whole)))
            return in.wrong("must be " + in.key.range.text());
        value = *whole;
        return true;
    }
    static std::string text(const Key&, long value, const Units&) { return std::to_string(value); }
    static Description about(const Key&, long value) { return {"integer", std::to_string(value), "", true}; }
};

template<>
struct As<bool> : Single<bool> {
    static bool read(const Input& in, bool& value) {
        const auto* flag = in.node.as<bool>();
        value = flag ? *flag : value;
        return flag || in.wrong_type("expected true or false");
    }
    static std::string text(const Key&, bool value, const Units&) { return value ? "true" : "false"; }
    static Description about(const Key&, bool value) {
        return {"boolean", value ? "true" : "false", "true, false"};
    }
};

// Words.

/// Null, and told, if it is none, or none of `names` where there are some.
const std::string* word_of(const Input& in, Names names) {
    const auto* found = in.node.as<std::string>();
    if (!found)
        in.wrong_type("expected a string");
    else if (const std::string fault = in.key.fault(*found); !fault.empty())
        in.wrong(fault);
    else if (!names.empty() && !contains(names, *found))
        in.wrong(one_of_text(names, *found));
    else
        return found;
    return nullptr;
}

template<>
struct As<std::string> : Single<std::string> {
    static bool is_present(const std::string& value) { return !value.empty(); }
    static bool read(const Input& in, std::string& value) {
        const auto* found = word_of(in, in.key.choices);
        if (found)
            value = *found;
        return found;
    }
    static std::string text(const Key&, const std::string& value, const Units&) {
        return value.empty() ? "" : in_quotes(value);
    }
    static Description about(const Key& key, const std::string& value) {
        const std::string legal = key.is_file_name ? "letters, digits, _ - ., at most 64" : "one line";
        return {"string", value.empty() ? std::string(key.absent_text) : in_quotes(value),
                key.choices.empty() ? legal : comma_list(key.choices)};
    }
};

template<>
struct As<Choice> : Single<Choice> {
    static bool read(const Input& in, Choice& value) {
        const auto names = value.names();
        const auto* found = word_of(in, names);
        if (found)
            value.set(static_cast<std::size_t>(std::ranges::find(names, *found) - names.begin()));
        return found;
    }
    static std::string text(const Key&, const Choice& value, const Units&) {
        return in_quotes(value.name(value.current));
    }
    static Description about(const Key&, const Choice& value) {
        const auto all = value.names();
        return {
            "string", in_quotes(value.name(value.current)), comma_list(all), false, {all.begin(), all.end()}};
    }
};

// What may be left out.

template<class T>
struct As<std::optional<T>> : Single<std::optional<T>> {
    static constexpr bool is_quantity = As<T>::is_quantity;
    static void clear(std::optional<T>& value) { value.reset(); }
    static bool is_present(const std::optional<T>& value) { return value.has_value(); }
    static bool read(const Input& in, std::optional<T>& value) {
        T found{};
        const bool is_right = As<T>::read(in, found);
        if (is_right)
            value = std::move(found);
        return is_right;
    }
    static std::string text(const Key& key, const std::optional<T>& value, const Units& units) {
        return value ? As<T>::text(key, *value, units) : "";
    }
    static Description about(const Key& key, const std::optional<T>&) {
        Description all = As<T>::about(key, T{});
        all.fallback = key.absent_text;
        return all;
    }
};

// A number, or something in its place.

/// The two sides that `in` lists.
bool two_sides(const Input& in, double& x, double& y);

std::string sides_text(const Key& key, double x, double y, const Units& units) {
    const std::string first = quantity_text(x, key.dimension, units);
    return x == y ? first : fmt::format("[{}, {}]", first, quantity_text(y, key.dimension, units));
}

/// One side or two.
template<>
struct As<PeriodicBox> : Quantified<PeriodicBox> {
    static bool read(const Input& in, PeriodicBox& value) {
        const auto* list = in.node.as<Node::List>();
        if (list && list->empty())
            return in.wrong_type("expected a length (\"78 a\") or two ([\"78 a\", \"77 a\"])");
        double x = 0.0, y = 0.0;
        const bool is_right = list ? two_sides(in, x, y) : quantity(in, x);
        if (is_right)
            value = list ? PeriodicBox{x, y} : PeriodicBox(x);
        return is_right;
    }
    static std::string text(const Key& key, const PeriodicBox& value, const Units& units) {
        return sides_text(key, value.x, value.y, units);
    }
    static Description about(const Key& key, const PeriodicBox&) { return {number_type(key), "", "", true}; }
};

/// A length, two of them, or "fit", alone or before a length.
template<>
struct As<BoxSize> : Quantified<BoxSize> {
    static bool read(const Input& in, BoxSize& value) {
        const auto* list = in.node.as<Node::List>();
        const auto* said = in.node.as<std::string>();
        const bool fit = said && (*said == "fit" || said->starts_with("fit "));
        const bool is_other =
            said && !said->empty() && std::isalpha(static_cast<unsigned char>(said->front()));
        if ((list && list->empty()) || (is_other && !fit))
            return in.wrong_type(
                "expected a length (\"78 a\"), two ([\"78 a\", \"77 a\"]), \"fit\" or \"fit 155 a\"");
        BoxSize found{0.0, 0.0, fit};
        const Node size{in.node.place, fit && said->size() > 3 ? said->substr(4) : std::string(usual_box)};
        if (!(list ? two_sides(in, found.x, found.y) : quantity(fit ? in.at(size, "") : in, found.x)))
            return false;
        value = {found.x, list ? found.y : found.x, fit};
        return true;
    }
    static std::string text(const Key& key, const BoxSize& value, const Units& units) {
        return value.fit ? fmt::format("\"fit {} {}\"", quantity_text(value.x, key.dimension, units),
                                       si_unit(key.dimension))
                         : sides_text(key, value.x, value.y, units);
    }
    static Description about(const Key& key, const BoxSize&) {
        return {number_type(key), "required", "", true};
    }
};

/// A time, or a length as a string with its unit.
template<>
struct As<TimeOrTravel> : Quantified<TimeOrTravel> {
    static bool read(const Input& in, TimeOrTravel& value) {
        const auto* said = in.node.as<std::string>();
        const auto is_a = [&](Dimension d) {
            return said && in.units && parse_quantity(*said, d, *in.units).value.has_value();
        };
        Key travel = in.key;
        travel.unit(Dimension::length).range = value.travel_range;
        if (in.node.as<std::int64_t>() || in.node.as<double>() || is_a(in.key.dimension))
            return quantity(in, value.time);
        if (!is_a(Dimension::length))
            return in.wrong_type("expected a time or length (a number of seconds, \"5 s\" or \"20 a\")");
        if (value.travel)
            return in.wrong("is a distance, and so is from_travel: leave one of them out");
        return As<std::optional<double>>::read(in.with(travel), value.travel);
    }
    static std::string text(const Key& key, const TimeOrTravel& value, const Units& units) {
        return quantity_text(value.time, key.dimension, units);
    }
    static Description about(const Key& key, const TimeOrTravel& value) {
        return {number_type(key) + " or length", number_text(value.time), "", true};
    }
};

/// A value of another key: what it must be is seen where that key is known.
template<>
struct As<Value> : Single<Value> {
    static bool read(const Input& in, Value& value) {
        const auto* real = in.node.as<double>();
        if (real && !std::isfinite(*real))
            return in.wrong("must be a finite number");
        if (const auto* flag = in.node.as<bool>())
            value = *flag;
        else if (const auto* whole = in.node.as<std::int64_t>())
            value = *whole;
        else if (const auto* said = in.node.as<std::string>())
            value = *said;
        else if (real)
            value = *real;
        else
            return in.wrong_type("expected a number, quantity or word");
        return true;
    }
    static std::string text(const Key&, const Value& value, const Units&) {
        return to_inline(std::visit([](const auto& v) { return Node{{}, v}; }, value));
    }
    static Description about(const Key&, const Value&) {
        return {"number, quantity or word", "", "those of the key that varies"};
    }
};

// Lists.

/// Null, and told, if it is none or has too few or too many entries.
const Node::List* list_of(const Input& in, std::string_view of) {
    const auto* list = in.node.as<Node::List>();
    const Key& key = in.key;
    if (!list)
        in.wrong_type("expected " + key.count_text(of));
    else if (list->size() < key.min_items || list->size() > key.max_items)
        in.faults.add(in.node.place, in.below,
                      fmt::format(": expected {}, found {}", key.count_text(of), list->size()));
    else
        return list;
    return nullptr;
}

template<class T>
constexpr std::string_view items_of = "numbers";
template<>
constexpr std::string_view items_of<long> = "integers";
template<>
constexpr std::string_view items_of<Value> = "numbers, quantities or words";
template<>
constexpr std::string_view items_of<std::vector<double>> = "pairs of numbers";

/// A list with a wrong entry is not taken at all.
template<class T>
bool read_list(const Input& in, const Key& item, std::vector<T>& value) {
    const auto* list = list_of(in, items_of<T>);
    std::vector<T> found(list ? list->size() : 0);
    bool is_right = list;
    for (std::size_t i = 0; i < found.size(); ++i)
        is_right &= As<T>::read(in.with(item).at((*list)[i], fmt::format("[{}]", i)), found[i]);
    if (is_right)
        value = std::move(found);
    return is_right;
}

template<class T>
struct As<std::vector<T>> : Single<std::vector<T>> {
    static constexpr bool is_quantity = As<T>::is_quantity;
    static constexpr int depth = 1;
    static void clear(std::vector<T>& value) { value.clear(); }
    static bool is_present(const std::vector<T>& value) { return !value.empty(); }
    static bool read(const Input& in, std::vector<T>& value) { return read_list(in, in.key, value); }
    static std::string text(const Key& key, const std::vector<T>& values, const Units& units) {
        std::string inner;
        for (const T& item : values)
            inner.append(inner.empty() ? "" : ", ").append(As<T>::text(key, item, units));
        return values.empty() ? "" : "[" + inner + "]";
    }
    static Description about(const Key& key, const std::vector<T>&) {
        const Description item = As<T>::about(key, T{});
        return {key.count_text(items_of<T>), std::string(key.absent_text), item.legal, item.has_range};
    }
    static std::string misses(const Key&, const std::vector<T>& value, std::span<const Segment> path) {
        const Segment& last = path.back();
        if (last.index >= 0 && static_cast<std::size_t>(last.index) < value.size())
            return "";
        const std::string list = path_text(path.first(path.size() - 1));
        return last.index < 0
                   ? fmt::format("{} is a list: give an index from 0 after it, not {}", list,
                                 in_quotes(last.name))
                   : fmt::format("no entry {}: {} has {} (numbered from 0)", last.index, list, value.size());
    }
    static bool set(const Input& in, std::vector<T>& value, std::span<const Segment> path) {
        return As<T>::read(in, value[static_cast<std::size_t>(path.back().index)]);
    }
};

bool two_sides(const Input& in, double& x, double& y) {
    Key sides = in.key;
    std::vector<double> found;
    if (!read_list(in.with(sides.items(2, 2)), sides, found))
        return false;
    x = found[0];
    y = found[1];
    return true;
}

using Pairs = std::vector<std::vector<double>>;

template<>
struct As<Pairs> : Whole<Pairs> {
    static void clear(Pairs& value) { value.clear(); }
    static bool read(const Input& in, Pairs& value) {
        Key pair = in.key;
        return read_list(in, pair.items(2, 2), value);
    }
    static std::string text(const Key& key, const Pairs& values, const Units& units) {
        std::string inner;
        for (const auto& item : values)
            inner.append(inner.empty() ? "" : ", ").append(As<std::vector<double>>::text(key, item, units));
        return values.empty() ? "" : "[" + inner + "]";
    }
    static Description about(const Key& key, const Pairs&) {
        return {key.count_text(items_of<std::vector<double>>), "", "", true};
    }
};

/// Some of key.choices, or any words where it has none, each at most once; kept when the key is absent.
using Words = std::vector<std::string>;

template<>
struct As<Words> : Whole<Words> {
    static bool read(const Input& in, Words& value) {
        const auto* list = list_of(in, "names");
        value.clear();
        for (std::size_t i = 0; list && i < list->size(); ++i)
            add(in.at((*list)[i], fmt::format("[{}]", i)), value);
        return list && value.size() == list->size();
    }
    static void add(const Input& in, Words& value) {
        std::string name;
        if (!As<std::string>::read(in, name))
            return;
        if (contains(value, name))
            in.wrong("stands in the list already");
        value.push_back(name);
    }
    static std::string text(const Key&, const Words& value, const Units&) {
        std::string inner;
        for (const auto& item : value)
            inner += (inner.empty() ? "" : ", ") + in_quotes(item);
        return "[" + inner + "]";
    }
    static Description about(const Key& key, const Words& value) {
        if (key.choices.empty())
            return {key.count_text("names"), "", "keys of the scene"};
        return {key.count_text("names"), text(key, value, {}), comma_list(key.choices)};
    }
};

// Tables whose keys are among key.choices.

template<class T>
struct Item; // of a table

template<>
struct Item<double> {
    static constexpr std::string_view of = "table of numbers";
    static bool read(const Input& in, double& value) { return quantity(in, value); }
    static std::string text(double value) { return number_text(value); }
};

template<>
struct Item<Interval> {
    static constexpr std::string_view of = "table of [low, high]";
    static bool read(const Input& in, Interval& value) { return two_sides(in, value.low, value.high); }
    static std::string text(const Interval& value) {
        return fmt::format("[{}, {}]", number_text(value.low), number_text(value.high));
    }
};

template<>
struct Item<Tie> {
    static constexpr std::string_view of = "table of [name, factor]";
    static bool read(const Input& in, Tie& value) {
        const auto* list = in.node.as<Node::List>();
        if (!list || list->size() != 2)
            return in.wrong_type("expected [name, factor], such as [\"f_over_mu\", 0.5]");
        const auto* name = word_of(in.at((*list)[0], "[0]"), in.key.choices);
        if (!quantity(in.at((*list)[1], "[1]"), value.factor) || !name)
            return false;
        value.to = *name;
        return true;
    }
    static std::string text(const Tie& tie) {
        return fmt::format("[{}, {}]", in_quotes(tie.to), number_text(tie.factor));
    }
};

std::string unknown_parameter(const Key& key, const std::string& name) {
    return fmt::format(": unknown parameter {}{}. Known parameters: {}", in_quotes(name),
                       did_you_mean(name, key.choices), comma_list(key.choices));
}

template<class T>
struct As<std::map<std::string, T>> : Single<std::map<std::string, T>> {
    using Table = std::map<std::string, T>;
    static constexpr bool is_quantity = !std::is_same_v<T, Tie>;
    static constexpr int depth = std::is_same_v<T, double> ? 1 : std::is_same_v<T, Interval> ? 2 : -1;
    static void clear(Table& value) { value.clear(); }
    static bool read(const Input& in, Table& value) {
        const auto* table = in.node.as<Node::Table>();
        if (!table)
            return in.wrong_type(fmt::format("expected a {} such as {}", Item<T>::of, in.key.example_value));
        for (const Entry& item : *table) {
            const Input at = in.at(item.value, "." + item.key);
            T found{};
            if (!contains(in.key.choices, item.key))
                in.faults.add(item.key_place, at.below, unknown_parameter(in.key, item.key));
            else if (Item<T>::read(at, found))
                value.emplace(item.key, found);
        }
        return value.size() == table->size();
    }
    static std::string text(const Key&, const Table& values, const Units&) {
        std::string inner;
        for (const auto& [name, value] : values)
            inner +=
                fmt::format("{}{} = {}", inner.empty() ? "" : ", ", key_text(name), Item<T>::text(value));
        return values.empty() ? "" : "{ " + inner + " }";
    }
    static Description about(const Key& key, const Table&) {
        return {std::string(Item<T>::of), std::string(key.absent_text), comma_list(key.choices)};
    }
    static std::string misses(const Key& key, const Table& value, std::span<const Segment> path) {
        if constexpr (std::is_same_v<T, double>)
            return contains(key.choices, path.back().name)
                       ? ""
                       : path_text(path) + unknown_parameter(key, path.back().name);
        const bool is_end = path.back().index == 0 || path.back().index == 1;
        return is_end && value.contains(path.end()[-2].name) ? "" : "the scene has no " + path_text(path);
    }
    static bool set(const Input& in, Table& value, std::span<const Segment> path) {
        double found = 0.0;
        if (!quantity(in, found))
            return false;
        if constexpr (std::is_same_v<T, double>)
            value[path.back().name] = found;
        else if constexpr (std::is_same_v<T, Interval>)
            (path.back().index == 0 ? value.at(path.end()[-2].name).low
                                    : value.at(path.end()[-2].name).high) = found;
        return true;
    }
};

template<>
struct As<Settings> : Whole<Settings> {
    static void clear(Settings& value) { value.list.clear(); }
    static bool read(const Input& in, Settings& value) {
        const Key& key = in.key;
        if (!in.node.as<Node::Table>())
            return in.wrong_type(fmt::format("expected a table such as {}", key.example_value));
        const auto overrides = variant_overrides(in.node);
        if (overrides.size() < key.min_items || overrides.size() > key.max_items)
            return in.wrong(fmt::format("expected {}, found {}", key.count_text("keys"), overrides.size()));
        std::set<std::string> seen;
        for (const Override& item : overrides) {
            value.list.push_back(item.text());
            if (!seen.insert(item.path).second) {
                in.faults.add(item.place, in.below, fmt::format(": {} is set twice", in_quotes(item.path)));
                return false;
            }
        }
        return true;
    }
    static std::string text(const Key&, const Settings& value, const Units&) {
        return settings_text(value.list);
    }
    static Description about(const Key& key, const Settings&) {
        return {"table of " + key.count_text("keys"), "required", "any keys of the scene"};
    }
};

/// The same, of a value whose type the visitor does not know.
template<class T>
class TypedCodec : public Codec {
public:
    void clear(void* value) const override { As<T>::clear(of(value)); }
    bool is_present(const void* value) const override { return As<T>::is_present(of(value)); }
    bool parse(const Input& in, void* value) const override { return As<T>::read(in, of(value)); }
    std::string print(const Key& key, const void* value, const Units& units) const override {
        return As<T>::text(key, of(value), units);
    }
    Description describe(const Key& key, const void* value) const override {
        Description all = As<T>::about(key, of(value));
        if (key.is_required)
            all.fallback = "required";
        if (all.has_range)
            all.legal = key.range.text();
        return all;
    }
    bool is_quantity() const override { return As<T>::is_quantity; }
    int depth() const override { return As<T>::depth; }
    std::string misses(const Key& key, const void* value, std::span<const Segment> path) const override {
        return As<T>::misses(key, of(value), path);
    }
    bool set(const Input& in, void* value, std::span<const Segment> path) const override {
        return As<T>::set(in, of(value), path);
    }

private:
    static T& of(void* value) { return *static_cast<T*>(value); }
    static const T& of(const void* value) { return *static_cast<const T*>(value); }
};

} // namespace

template<class T>
const Codec& codec_of() {
    static const TypedCodec<T> codec;
    return codec;
}

template const Codec& codec_of<double>();
template const Codec& codec_of<long>();
template const Codec& codec_of<bool>();
template const Codec& codec_of<std::string>();
template const Codec& codec_of<Choice>();
template const Codec& codec_of<TimeOrTravel>();
template const Codec& codec_of<BoxSize>();
template const Codec& codec_of<Settings>();
template const Codec& codec_of<std::optional<double>>();
template const Codec& codec_of<std::optional<long>>();
template const Codec& codec_of<std::optional<PeriodicBox>>();
template const Codec& codec_of<std::optional<Value>>();
template const Codec& codec_of<std::vector<double>>();
template const Codec& codec_of<std::vector<long>>();
template const Codec& codec_of<std::vector<Value>>();
template const Codec& codec_of<std::vector<std::string>>();
template const Codec& codec_of<std::vector<std::vector<double>>>();
template const Codec& codec_of<std::map<std::string, double>>();
template const Codec& codec_of<std::map<std::string, Interval>>();
template const Codec& codec_of<std::map<std::string, Tie>>();

} // namespace rodwake::scene
