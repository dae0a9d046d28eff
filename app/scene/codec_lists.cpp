// The codecs of lists and tables.

#include "apply_overrides.hpp"
#include "codec_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace rodwake::scene {

// Lists.

namespace {

/// Returns null and adds a diagnostic unless the node is a list of legal length.
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
        is_right &= codec_of<T>().parse(in.with(item).at((*list)[i], fmt::format("[{}]", i)), &found[i]);
    if (is_right)
        value = std::move(found);
    return is_right;
}

} // namespace

template<class T>
struct As<std::vector<T>> : Single<std::vector<T>> {
    static constexpr bool is_quantity = std::is_same_v<T, double>;
    static constexpr int depth = 1;
    static void clear(std::vector<T>& value) { value.clear(); }
    static bool is_present(const std::vector<T>& value) { return !value.empty(); }
    static bool read(const Input& in, std::vector<T>& value) { return read_list(in, in.key, value); }
    static std::string text(const Key& key, const std::vector<T>& values, const Units& units) {
        std::string inner;
        for (const T& item : values)
            inner.append(inner.empty() ? "" : ", ").append(codec_of<T>().print(key, &item, units));
        return values.empty() ? "" : "[" + inner + "]";
    }
    static Description about(const Key& key, const std::vector<T>&) {
        const T none{};
        const Description item = codec_of<T>().describe(key, &none);
        return {key.count_text(items_of<T>), std::string(key.absent_text), item.legal, item.has_range};
    }
    static std::string misses(const Key&, const std::vector<T>& value, std::span<const PathSegment> path) {
        const PathSegment& last = path.back();
        if (last.index >= 0 && static_cast<std::size_t>(last.index) < value.size())
            return "";
        const std::string list = path_text(path.first(path.size() - 1));
        return last.index < 0
                   ? fmt::format("{} is a list: give an index from 0 after it, not {}", list,
                                 in_quotes(last.name))
                   : fmt::format("no entry {}: {} has {} (numbered from 0)", last.index, list, value.size());
    }
    static bool set(const Input& in, std::vector<T>& value, std::span<const PathSegment> path) {
        return codec_of<T>().parse(in, &value[static_cast<std::size_t>(path.back().index)]);
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
        for (std::size_t i = 0; list && i < list->size(); ++i) {
            const Input at = in.at((*list)[i], fmt::format("[{}]", i));
            std::string name;
            if (!codec_of<std::string>().parse(at, &name))
                continue;
            if (contains(value, name))
                at.wrong("is in the list already");
            value.push_back(name);
        }
        return list && value.size() == list->size();
    }
    static std::string text(const Key&, const Words& value, const Units&) {
        std::string inner;
        for (const auto& item : value)
            inner += (inner.empty() ? "" : ", ") + in_quotes(item);
        return "[" + inner + "]";
    }
    static Description about(const Key& key, const Words& value) {
        if (key.choices.empty())
            return {key.count_text("names"), "", key.name == "keys" ? "keys of the scene" : "any"};
        return {key.count_text("names"), text(key, value, {}), comma_list(key.choices)};
    }
};

// Tables whose keys are among key.choices.

namespace {

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

constexpr std::string_view prior_kinds[] = {"uniform", "log_uniform", "normal"};
constexpr std::string_view prior_keys[] = {"kind", "low", "high", "mean", "sd"};

template<>
struct Item<fitting::Prior> {
    static constexpr std::string_view of = "table of priors";
    static bool read(const Input& in, fitting::Prior& value) {
        const auto* table = in.node.as<Node::Table>();
        if (!table)
            return in.wrong_type("expected a prior such as { kind = \"normal\", mean = 1.0, sd = 0.2 }");
        bool is_right = true;
        for (const Entry& item : *table) {
            const Input at = in.at(item.value, "." + item.key);
            if (item.key == "kind") {
                const auto* word = word_of(at, prior_kinds);
                if (word)
                    value.kind =
                        static_cast<fitting::PriorKind>(std::ranges::find(prior_kinds, *word) - prior_kinds);
                is_right &= word != nullptr;
            } else if (item.key == "low" || item.key == "high") {
                is_right &= quantity(at, (item.key == "low" ? value.low : value.high).emplace());
            } else if (item.key == "mean" || item.key == "sd") {
                is_right &= quantity(at, item.key == "sd" ? value.sd : value.mean);
            } else {
                in.faults.add(item.key_place, at.below,
                              fmt::format(": unknown key {}{}. Known keys: {}", in_quotes(item.key),
                                          did_you_mean(item.key, prior_keys), comma_list(prior_keys)));
                is_right = false;
            }
        }
        return is_right;
    }
    static std::string text(const fitting::Prior& prior) {
        std::string inner = "kind = " + in_quotes(prior_kinds[static_cast<std::size_t>(prior.kind)]);
        const auto add = [&](const char* name, double number) {
            inner += fmt::format(", {} = {}", name, number_text(number));
        };
        if (prior.low)
            add("low", *prior.low);
        if (prior.high)
            add("high", *prior.high);
        if (prior.kind == fitting::PriorKind::normal) {
            add("mean", prior.mean);
            add("sd", prior.sd);
        }
        return "{ " + inner + " }";
    }
};

std::string unknown_parameter(const Key& key, const std::string& name) {
    return fmt::format(": unknown parameter {}{}. Known parameters: {}", in_quotes(name),
                       did_you_mean(name, key.choices), comma_list(key.choices));
}

} // namespace

template<class T>
struct As<std::map<std::string, T>> : Single<std::map<std::string, T>> {
    using Table = std::map<std::string, T>;
    static constexpr bool is_quantity = !std::is_same_v<T, Tie> && !std::is_same_v<T, fitting::Prior>;
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
    static std::string misses(const Key& key, const Table& value, std::span<const PathSegment> path) {
        if constexpr (std::is_same_v<T, double>)
            return contains(key.choices, path.back().name)
                       ? ""
                       : path_text(path) + unknown_parameter(key, path.back().name);
        const bool is_end = path.back().index == 0 || path.back().index == 1;
        return is_end && value.contains(path.end()[-2].name) ? "" : "the scene has no " + path_text(path);
    }
    static bool set(const Input& in, Table& value, std::span<const PathSegment> path) {
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

// What a camera sees: a word, or a table of one list.

template<>
struct As<TracksWindow> : Whole<TracksWindow> {
    static constexpr std::string_view words[] = {window_names[0], window_names[1],
                                                 window_names[2]}; ///< the others have sizes
    static bool read(const Input& in, TracksWindow& value) {
        if (in.node.as<std::string>()) {
            const auto* word = word_of(in, words);
            if (word)
                value = {static_cast<WindowKind>(std::ranges::find(words, *word) - words), {}};
            return word;
        }
        const auto* table = in.node.as<Node::Table>();
        const std::string name = table && table->size() == 1 ? table->front().key : "";
        const bool circle = name == to_string(WindowKind::circle);
        if (!circle && name != to_string(WindowKind::rectangle))
            return in.wrong_type(
                "expected a string such as \"hull\", { circle = [x, y, radius] } or { rectangle = "
                "[x0, y0, x1, y1] }");
        TracksWindow found{circle ? WindowKind::circle : WindowKind::rectangle, {}};
        Key sizes = in.key;
        sizes.unit(Dimension::length);
        if (!read_list(
                in.at(table->front().value, "." + name).with(sizes.items(circle ? 3 : 4, circle ? 3 : 4)),
                sizes, found.sizes))
            return false;
        value = std::move(found);
        return true;
    }
    static std::string text(const Key& key, const TracksWindow& value, const Units& units) {
        if (value.sizes.empty())
            return in_quotes(to_string(value.kind));
        Key sizes = key;
        return fmt::format("{{ {} = {} }}", to_string(value.kind),
                           As<std::vector<double>>::text(sizes.unit(Dimension::length), value.sizes, units));
    }
    static Description about(const Key&, const TracksWindow&) {
        return {"string",
                in_quotes(words[0]),
                comma_list(words),
                false,
                {std::string(words[0]), std::string(words[1]), std::string(words[2])}};
    }
};

template const Codec& codec_of<TracksWindow>();
template const Codec& codec_of<Settings>();
template const Codec& codec_of<std::vector<double>>();
template const Codec& codec_of<std::vector<long>>();
template const Codec& codec_of<std::vector<Value>>();
template const Codec& codec_of<std::vector<std::string>>();
template const Codec& codec_of<std::vector<std::vector<double>>>();
template const Codec& codec_of<std::map<std::string, double>>();
template const Codec& codec_of<std::map<std::string, Interval>>();
template const Codec& codec_of<std::map<std::string, Tie>>();
template const Codec& codec_of<std::map<std::string, fitting::Prior>>();

} // namespace rodwake::scene
