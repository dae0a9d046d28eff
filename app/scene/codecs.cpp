// The codecs of single values.

#include "codec_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace rodwake::scene {

std::string path_text(std::span<const PathSegment> path) {
    std::string text;
    for (const PathSegment& segment : path)
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

std::string number_type(const Key& key) {
    const std::string name = name_of(key.dimension);
    return key.dimension == Dimension::none ? "number" : name.substr(name.find(' ') + 1);
}

std::string sides_text(const Key& key, double x, double y, const Units& units) {
    const std::string first = quantity_text(x, key.dimension, units);
    return x == y ? first : fmt::format("[{}, {}]", first, quantity_text(y, key.dimension, units));
}

} // namespace

bool quantity(const Input& in, double& value) {
    const Dimension dimension = in.key.dimension;
    const auto* whole = in.node.as<std::int64_t>();
    const auto* real = in.node.as<double>();
    const auto* word = in.node.as<std::string>();
    double found = 0.0;
    if (whole || real) {
        found = whole ? static_cast<double>(*whole) : *real;
        if (in.units)
            found = to_reduced(found, dimension, *in.units);
    } else if (!in.units || dimension == Dimension::none) {
        return in.wrong_type("expected a number");
    } else if (!word) {
        static constexpr const char* examples[] = {
            "",       "0.4 mm",      "5 s",        "2.8 mm/s",    "0.5 1/s",
            "30 deg", "2700 kg/m^3", "9.81 m/s^2", "0.01 mm^2/s", "2 1/mm"};
        return in.wrong_type(fmt::format("expected {} (a number, or a string such as \"{}\")",
                                         name_of(dimension), examples[static_cast<std::size_t>(dimension)]));
    } else {
        const Quantity read = parse_quantity(*word, dimension, *in.units);
        if (read.needs_scales)
            in.faults.add_missing_scales(in.node.place, in.below,
                                         fmt::format(" = {}: a physical unit", describe_value(in.node)));
        else if (!read.value)
            in.wrong_type(fmt::format("expected {}", name_of(dimension)), read.why);
        if (!read.value)
            return false;
        found = *read.value;
    }
    if (!in.key.range.contains(found)) // not so nan and inf
        return in.wrong(in.key.fault(found));
    value = found;
    return true;
}

const std::string* word_of(const Input& in, Names names) {
    const auto* found = in.node.as<std::string>();
    if (!found)
        in.wrong_type("expected a string");
    else if (const std::string fault = in.key.fault(*found); !fault.empty())
        in.wrong(fault);
    else if (!names.empty() && !contains(names, *found))
        in.wrong(one_of_text(names, *found) +
                 (in.key.reason.empty() ? "" : fmt::format(": {}", in.key.reason)));
    else
        return found;
    return nullptr;
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
        return {number_type(key), std::string(key.absent_text), "", true};
    }
};

/// A length, or "auto".
template<>
struct As<Localisation> : Quantified<Localisation> {
    static bool read(const Input& in, Localisation& value) {
        const auto* said = in.node.as<std::string>();
        if (said && !said->empty() && std::isalpha(static_cast<unsigned char>(said->front()))) {
            if (*said != "auto")
                return in.wrong_type("expected a length (\"0.05 a\") or \"auto\"");
            value = {true, 0.0};
            return true;
        }
        value.find = false;
        return quantity(in, value.given);
    }
    static std::string text(const Key& key, const Localisation& value, const Units& units) {
        return value.find ? "\"auto\"" : quantity_text(value.given, key.dimension, units);
    }
    static Description about(const Key& key, const Localisation&) {
        return {number_type(key), std::string(key.absent_text), "", true};
    }
};

/// A length, "auto" or "unlimited".
template<>
struct As<StepLimit> : Quantified<StepLimit> {
    static bool read(const Input& in, StepLimit& value) {
        const auto* said = in.node.as<std::string>();
        if (said && !said->empty() && std::isalpha(static_cast<unsigned char>(said->front()))) {
            if (*said != "auto" && *said != "unlimited")
                return in.wrong_type("expected a length (\"2 a\"), \"auto\" or \"unlimited\"");
            value.length = *said == "auto" ? std::nullopt : std::optional(HUGE_VAL);
            return true;
        }
        return quantity(in, value.length.emplace());
    }
    static std::string text(const Key& key, const StepLimit& value, const Units& units) {
        return !value.length               ? "\"auto\""
               : std::isinf(*value.length) ? "\"unlimited\""
                                           : quantity_text(*value.length, key.dimension, units);
    }
    static Description about(const Key& key, const StepLimit&) {
        return {number_type(key), "\"auto\"", "", true};
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
        return {"number, quantity or word", "", "as the key that varies"};
    }
};

template const Codec& codec_of<double>();
template const Codec& codec_of<long>();
template const Codec& codec_of<bool>();
template const Codec& codec_of<std::string>();
template const Codec& codec_of<Choice>();
template const Codec& codec_of<TimeOrTravel>();
template const Codec& codec_of<BoxSize>();
template const Codec& codec_of<Localisation>();
template const Codec& codec_of<StepLimit>();
template const Codec& codec_of<Value>();
template const Codec& codec_of<std::optional<bool>>();
template const Codec& codec_of<std::optional<double>>();
template const Codec& codec_of<std::optional<long>>();
template const Codec& codec_of<std::optional<PeriodicBox>>();
template const Codec& codec_of<std::optional<Value>>();

} // namespace rodwake::scene
