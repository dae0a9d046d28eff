#include "key_values.hpp"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <regex>
#include <sstream>

namespace scene_test {

namespace {

/// "1 to 16 pairs of numbers", "2 numbers", "table of 1 to 100 keys".
struct Count {
    std::size_t min = 0, max = 0;
    std::string text, of;
};

std::optional<Count> count_of(const std::string& type) {
    static const std::regex form("(?:table of )?((\\d+)(?: to (\\d+))? (.+))");
    std::smatch found;
    if (!std::regex_match(type, found, form))
        return std::nullopt;
    return Count{std::stoul(found[2]), std::stoul(found[3].matched ? found[3] : found[2]), found[1],
                 found[4]};
}

bool is_table(const KeyInfo& info) { return info.type.starts_with("table of "); }

bool is_integer(const KeyInfo& info) {
    return info.type.ends_with("integer") || info.type.ends_with("integers");
}

std::string list_of(std::size_t count, const std::string& item) {
    return fmt::format("[{}]", fmt::join(std::vector(count, item), ", "));
}

std::string joined(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

std::string number_text(const KeyInfo& info, double value) {
    return is_integer(info) ? fmt::format("{}", static_cast<long>(value)) : fmt::format("{}", value);
}

/// The nearest number beyond a bound; beside 0 a normal one.
double beyond(const KeyInfo& info, double bound, double side) {
    if (is_integer(info))
        return bound + side;
    return bound == 0.0 ? side * 1e-300 : std::nextafter(bound, side * HUGE_VAL);
}

/// A number as the key takes it: alone, or in as many places as its list needs at least.
Refused wrapped(const KeyInfo& info, const std::string& number, std::string said) {
    const auto count = count_of(info.type);
    if (!count)
        return {number, std::move(said)};
    const std::size_t least = std::max<std::size_t>(count->min, 1);
    if (count->of.starts_with("pairs"))
        return {list_of(least, list_of(2, number)), std::move(said), "[0][0]", 2};
    return {list_of(least, number), std::move(said), "[0]", 1};
}

void add_numbers(const KeyInfo& info, std::vector<Refused>& all) {
    const double low = *info.low, high = *info.high;
    const std::string legal = "must be " + info.legal;
    const std::string below = number_text(info, info.is_low_legal ? beyond(info, low, -1.0) : low);
    all.push_back(wrapped(info, below, legal));
    if (!is_integer(info) || high < 9e18) // beyond is no TOML integer
        all.push_back(wrapped(info, number_text(info, beyond(info, high, 1.0)), legal));
    for (const std::string number : {"nan", "inf", "-inf"})
        all.push_back(
            wrapped(info, number, is_integer(info) ? "expected an integer" : "must be a finite number"));
}

void add_choices(const KeyInfo& info, std::vector<Refused>& all) {
    const bool is_list = info.type.ends_with("names");
    const auto add = [&](const std::string& name, const std::string& said) {
        all.push_back(is_list ? Refused{list_of(1, quoted(name)), said, "[0]", 1}
                              : Refused{quoted(name), said});
    };
    const std::string any = "must be one of " + joined(info.choices), first = info.choices.front();
    add("nonsense", any);
    add("", any);
    if (first.size() > 2) // else nothing is near
        add(first + "q", any + " (did you mean " + quoted(first) + "?)");
    if (is_list)
        all.push_back({list_of(2, quoted(first)), "is in the list already", "[1]", first.size() + 5});
}

/// "{ k0 = 1, k1 = 1 }"
std::string keys(std::size_t number) {
    std::vector<std::string> entries;
    for (std::size_t i = 0; i < number; ++i)
        entries.push_back(fmt::format("k{} = 1", i));
    return fmt::format("{{ {} }}", fmt::join(entries, ", "));
}

void add_counts(const Count& count, std::vector<Refused>& all) {
    const auto add = [&](std::size_t number) {
        all.push_back({count.of == "keys" ? keys(number) : list_of(number, "0"),
                       fmt::format("expected {}, found {}", count.text, number)});
    };
    if (count.min > 0)
        add(count.min - 1);
    add(count.max + 1);
    if (count.of.starts_with("pairs"))
        all.push_back({"[[0]]", "expected 2 numbers, found 1", "[0]", 1});
}

/// Tables of values by name: the names.
void add_entry_names(const KeyInfo& info, std::vector<Refused>& all) {
    const std::string name = info.choices.front(), known = ". Known parameters: " + joined(info.choices);
    all.push_back({"{ nonsense = 1 }", "unknown parameter \"nonsense\"" + known, ".nonsense", 2});
    all.push_back({"{ " + name + "q = 1 }",
                   fmt::format("unknown parameter \"{0}q\" (did you mean \"{0}\"?){1}", name, known),
                   "." + name + "q", 2});
}

/// The values: numbers, [low, high] or [name, factor].
void add_entry_values(const KeyInfo& info, std::vector<Refused>& all) {
    const std::string name = info.choices.front(), finite = "must be a finite number";
    const auto add = [&](const std::string& value, const std::string& said, const std::string& item = "") {
        const std::size_t at = name.size() + 5 + (item.empty() ? 0 : 1);
        all.push_back({"{ " + name + " = " + value + " }", said, "." + name + item, at});
    };
    if (info.type.ends_with("[name, factor]")) {
        add("1", "expected [name, factor]");
        add("[\"" + name + "\"]", "expected [name, factor]");
        add("[\"nonsense\", 1]", "must be one of " + joined(info.choices), "[0]");
    } else if (info.type.ends_with("[low, high]")) {
        add("[1]", "expected 2 numbers, found 1");
        add("[nan, 1]", finite, "[0]");
    } else if (info.type.ends_with("priors"))
        add("1", "expected a prior");
    else
        add("nan", finite);
}

/// "expected a length", "expected 2 numbers".
std::string expected(const KeyInfo& info) {
    const auto count = count_of(info.type);
    if (is_table(info))
        return count ? "expected a table" : "expected a " + info.type;
    if (info.type == "boolean")
        return "expected true or false";
    const bool vowel = std::string("aeiou").find(info.type.front()) != std::string::npos;
    return count ? "expected " + info.type : fmt::format("expected a{} {}", vowel ? "n" : "", info.type);
}

} // namespace

std::vector<Refused> wrong_types(const KeyInfo& info) {
    std::vector<std::string> values{"1979-05-27"};
    const bool is_list = count_of(info.type) && !is_table(info);
    if (!is_table(info))
        values.push_back("{ a = 1 }");
    if (!is_list)
        values.push_back("[]");
    const bool any = info.type == "number, quantity or word"; // of another key
    if (!any) {
        values.push_back(info.type == "boolean" ? "1" : "true");
        values.push_back(info.type == "string" ? "1" : "\"abc\"");
    }
    if (info.type == "integer")
        values.push_back("1.5");
    std::vector<Refused> all;
    for (const auto& value : values)
        all.push_back({value, expected(info)});
    const bool takes_any = info.type.ends_with("quantities or words");
    if (is_list)
        all.push_back(takes_any ? wrapped(info, "[1]", "expected a number, quantity or word")
                                : wrapped(info, "true", "found true (boolean)"));
    return all;
}

std::vector<Refused> refused_values(const KeyInfo& info) {
    std::vector<Refused> all;
    if (info.low)
        add_numbers(info, all);
    if (const auto count = count_of(info.type))
        add_counts(*count, all);
    if (is_table(info) && !info.choices.empty()) {
        add_entry_names(info, all);
        add_entry_values(info, all);
    } else if (!info.choices.empty())
        add_choices(info, all);
    if (info.type == "boolean" || info.type == "number, quantity or word")
        return wrong_types(info);
    if (info.legal == "one line")
        for (const std::string& text :
             {std::string("two\\nlines"), std::string("a\\u0007"), std::string(301, 'a')})
            all.push_back({quoted(text), "must be one line of at most 300 bytes"});
    return all;
}

std::vector<std::string> accepted_values(const KeyInfo& info) {
    std::vector<std::string> values;
    const auto add = [&](const std::string& number) { values.push_back(wrapped(info, number, "").value); };
    if (info.low) {
        add(number_text(info, info.is_low_legal ? *info.low : beyond(info, *info.low, 1.0)));
        add(is_integer(info) && *info.high > 9e18 ? "9223372036854775807" : number_text(info, *info.high));
    }
    if (!is_table(info))
        for (const auto& name : info.choices)
            add(quoted(name));
    if (info.type == "boolean")
        values.insert(values.end(), {"true", "false"});
    return values;
}

Placed placed(const KeyInfo& info, const std::string& value) {
    const std::string header = rodwake::scene::table_header(info.table);
    std::vector<std::string> lines;
    std::istringstream stream(complete_for(info));
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    auto at = lines.begin();
    if (const auto list = info.table.find("[]."); list != std::string::npos) { // belongs to the first entry
        at = std::ranges::find(lines, rodwake::scene::table_header(info.table.substr(0, list + 2)));
        at = std::find_if(std::next(at), lines.end(), [](const auto& line) { return line.starts_with('['); });
        at = std::next(lines.insert(at, header));
    } else if (!info.table.empty()) {
        at = std::ranges::find(lines, header);
        at = std::next(at == lines.end() ? lines.insert(at, header) : at);
    }
    const auto end = std::find_if(at, lines.end(), [](const auto& line) { return line.starts_with('['); });
    const auto is_key = [&](const auto& line) { return line.starts_with(info.name + " = "); };
    lines.erase(std::remove_if(at, end, is_key), end);
    at = lines.insert(at, info.name + " = " + value);
    return {fmt::format("{}\n", fmt::join(lines, "\n")), static_cast<std::size_t>(at - lines.begin()) + 1,
            info.name.size() + 4};
}

bool has_whole(const std::string& message, const std::string& said) {
    const auto at = message.find(said);
    if (at == std::string::npos)
        return false;
    const std::string rest = message.substr(at + said.size());
    const auto follows = [&](const char* next) { return rest.starts_with(next); };
    return rest.empty() || follows(": ") || follows(" (") || follows(", found ") || follows(" such as ") ||
           follows(", such as ");
}

bool is_refused(const KeyInfo& info, const Refused& refused) {
    const Placed scene = placed(info, refused.value);
    const std::string place =
        fmt::format("x.toml:{}:{}: {}", scene.line, scene.column + refused.at, message_path(info));
    return std::ranges::any_of(problems_of(scene.text), [&](const Diagnostic& problem) {
        return problem.key == message_path(info) + refused.item && problem.text().starts_with(place) &&
               has_whole(problem.message, refused.said);
    });
}

bool is_reported(const KeyInfo& info, const Diagnostic& problem) {
    const auto tells = [&](const Refused& refused) { return has_whole(problem.message, refused.said); };
    return problem.key.starts_with(message_path(info)) && (std::ranges::any_of(refused_values(info), tells) ||
                                                           std::ranges::any_of(wrong_types(info), tells));
}

} // namespace scene_test
