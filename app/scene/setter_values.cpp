// Setter: the value of one key.

#include "node.hpp"
#include "setter.hpp"

#include <cmath>
#include <fmt/format.h>

namespace rodwake::scene {

const Value* Setter::take(const Key& key, Progress& p, bool is_quantity, std::size_t rest) {
    p.is_done = true;
    const std::size_t below = frames_.back().depth + 1, size = p.target->path.size();
    if (size > below + rest)
        fail(fmt::format("{} is not a table", p.target->path_text(below + rest)));
    else if (size < below + rest)
        fail(fmt::format("{} has several values: give one of them by an index from 0 or a name",
                         p.target->path_text()));
    else if (is_compiling())
        learn(key, p, is_quantity);
    else
        return &values_[static_cast<std::size_t>(&p - progress_.data())];
    return nullptr;
}

void Setter::learn(const Key& key, const Progress& p, bool is_quantity) {
    SetterTarget& target = found_[static_cast<std::size_t>(&p - progress_.data())];
    if (key.is_unit)
        fail(
            fmt::format("{} says what the numbers of the scene mean: it can be set only before they are read",
                        target.key));
    target.is_quantity = is_quantity;
    target.dimension = key.dimension;
    target.units = units_;
}

std::optional<double> Setter::number(const Key& key, const Progress& p, const Value& value) {
    double number = 0.0;
    if (const auto* real = std::get_if<double>(&value))
        number = *real;
    else if (const auto* whole = std::get_if<std::int64_t>(&value))
        number = static_cast<double>(*whole);
    else
        return wrong(p, value, "expected a number"), std::nullopt;
    if (key.range.contains(number)) // not so nan and inf
        return number;
    return wrong(p, value, key.fault(number)), std::nullopt;
}

std::optional<long> Setter::integer(const Key& key, const Progress& p, const Value& value) {
    const auto* whole = std::get_if<std::int64_t>(&value);
    if (!whole)
        wrong(p, value, "expected an integer");
    else if (!key.range.contains(static_cast<double>(*whole)))
        wrong(p, value, "must be " + key.range.text());
    else
        return *whole;
    return std::nullopt;
}

const std::string* Setter::text(const Key& key, const Progress& p, const Value& value) {
    const auto* found = std::get_if<std::string>(&value);
    if (!found)
        wrong(p, value, "expected a string");
    else if (const std::string fault = key.fault(*found); !fault.empty())
        wrong(p, value, fault);
    else
        return found;
    return nullptr;
}

bool Setter::is_choice(Names names, const Progress& p, const std::string& found) {
    if (contains(names, found))
        return true;
    wrong(p, found, one_of_text(names, found));
    return false;
}

/// The entry that the last segment of the target's path names; null, and reported, if there is none.
template<class T>
T* Setter::entry(const Progress& p, std::vector<T>& list) {
    const auto& path = p.target->path;
    const long index = path.back().index;
    if (index >= 0 && static_cast<std::size_t>(index) < list.size())
        return &list[static_cast<std::size_t>(index)];
    fail(index < 0 ? fmt::format("{} is a list: give an index from 0 after it, not {}",
                                 p.target->path_text(path.size() - 1), in_quotes(path.back().name))
                   : fmt::format("no entry {}: {} has {} (numbered from 0)", index,
                                 p.target->path_text(path.size() - 1), list.size()));
    return nullptr;
}

void Setter::operator()(const Key& key, double& value) {
    here(key, [&](Progress& p) {
        if (const Value* given = take(key, p, true))
            value = number(key, p, *given).value_or(value);
    });
}

/// A side: lists and "fit" can be set only before the scene is read.
void Setter::operator()(const Key& key, BoxSize& value) {
    here(key, [&](Progress& p) {
        if (const Value* given = take(key, p, true))
            if (const auto side = number(key, p, *given))
                value = {*side, *side};
    });
}

/// The time: a length can be set only before the scene is read.
void Setter::operator()(const Key& key, const TimeOrTravel& value) { (*this)(key, value.time); }

/// A side, as above.
void Setter::operator()(const Key& key, std::optional<PeriodicBox>& value) {
    const bool is_target = here(key, [&](Progress& p) {
        if (const Value* given = take(key, p, true))
            if (const auto side = number(key, p, *given))
                value = PeriodicBox(*side);
    });
    if (!is_target && !key.is_written) // as if the scene had been written and read
        value.reset();
    note_given(key, value.has_value(), is_target);
}

void Setter::operator()(const Key& key, std::optional<double>& value) {
    const bool is_target = here(key, [&](Progress& p) {
        if (const Value* given = take(key, p, true))
            if (const auto found = number(key, p, *given))
                value = found;
    });
    if (!is_target && !key.is_written) // as if the scene had been written and read
        value.reset();
    note_given(key, value.has_value(), is_target);
}

void Setter::operator()(const Key& key, long& value) {
    here(key, [&](Progress& p) {
        if (const Value* given = take(key, p, false))
            value = integer(key, p, *given).value_or(value);
    });
}

void Setter::operator()(const Key& key, std::optional<long>& value) {
    const bool is_target = here(key, [&](Progress& p) {
        if (const Value* given = take(key, p, false))
            if (const auto found = integer(key, p, *given))
                value = found;
    });
    note_given(key, value.has_value(), is_target);
}

void Setter::operator()(const Key& key, bool& value) {
    here(key, [&](Progress& p) {
        const Value* given = take(key, p, false);
        if (!given)
            return;
        if (const bool* flag = std::get_if<bool>(given))
            value = *flag;
        else
            wrong(p, *given, "expected true or false");
    });
}

void Setter::operator()(const Key& key, std::string& value) {
    here(key, [&](Progress& p) {
        const Value* given = take(key, p, false);
        const std::string* found = given ? text(key, p, *given) : nullptr;
        if (found && (key.choices.empty() || is_choice(key.choices, p, *found)))
            value = *found;
    });
}

void Setter::operator()(const Key& key, const Choice& value) {
    here(key, [&](Progress& p) {
        const Value* given = take(key, p, false);
        const std::string* found = given ? text(key, p, *given) : nullptr;
        if (!found)
            return;
        const auto names = value.names();
        if (is_choice(names, p, *found))
            value.set(static_cast<std::size_t>(std::ranges::find(names, *found) - names.begin()));
    });
}

void Setter::operator()(const Key& key, std::vector<double>& value) {
    const bool is_target = here(key, [&](Progress& p) {
        const Value* given = take(key, p, true, 1);
        double* at = error_ ? nullptr : entry(p, value);
        if (given && at)
            *at = number(key, p, *given).value_or(*at);
    });
    note_given(key, !value.empty(), is_target);
}

void Setter::operator()(const Key& key, std::vector<long>& value) {
    here(key, [&](Progress& p) {
        const Value* given = take(key, p, false, 1);
        long* at = error_ ? nullptr : entry(p, value);
        if (given && at)
            *at = integer(key, p, *given).value_or(*at);
    });
}

bool Setter::is_parameter(const Key& key, const Progress& p, const std::string& name) {
    if (contains(key.choices, name))
        return true;
    fail(fmt::format("{}: unknown parameter {}{}. Known parameters: {}", p.target->key, in_quotes(name),
                     did_you_mean(name, key.choices), comma_list(key.choices)));
    return false;
}

void Setter::operator()(const Key& key, std::map<std::string, double>& value) {
    here(key, [&](Progress& p) {
        const Value* given = take(key, p, true, 1);
        const std::string& name = p.target->path.back().name;
        if (error_ || !is_parameter(key, p, name) || !given)
            return;
        if (const auto found = number(key, p, *given))
            value[name] = *found;
    });
}

void Setter::operator()(const Key& key, std::map<std::string, Interval>& value) {
    here(key, [&](Progress& p) {
        const Value* given = take(key, p, true, 2);
        const auto at = error_ ? value.end() : value.find(p.target->path.end()[-2].name);
        const long index = p.target->path.back().index;
        if (!error_ && (at == value.end() || index < 0 || index > 1))
            fail(fmt::format("the scene has no {}", p.target->key));
        if (!given || error_)
            return;
        double& end = index == 0 ? at->second.low : at->second.high;
        end = number(key, p, *given).value_or(end);
    });
}

void Setter::refuse(const Key& key) {
    here(key, [&](Progress& p) {
        p.is_done = true;
        fail(fmt::format("{} holds no single values: it can be set only before the scene is read",
                         p.target->path_text(frames_.back().depth + 1)));
    });
}

void Setter::operator()(const Key& key, std::vector<std::vector<double>>&) { refuse(key); }
void Setter::operator()(const Key& key, std::vector<std::string>&) { refuse(key); }

bool Setter::is_finite(const Progress& p, const Value& value) {
    const auto* real = std::get_if<double>(&value);
    if (!real || std::isfinite(*real))
        return true;
    wrong(p, value, "must be a finite number");
    return false;
}

void Setter::operator()(const Key& key, std::optional<Value>& value) {
    here(key, [&](Progress& p) {
        if (const Value* given = take(key, p, false); given && is_finite(p, *given))
            value = *given;
    });
}

void Setter::operator()(const Key& key, std::vector<Value>& value) {
    here(key, [&](Progress& p) {
        const Value* given = take(key, p, false, 1);
        Value* at = error_ ? nullptr : entry(p, value);
        if (given && at && is_finite(p, *given))
            *at = *given;
    });
}

void Setter::operator()(const Key& key, std::map<std::string, Tie>&) { refuse(key); }
void Setter::settings(const Key& key, std::vector<std::string>&) { refuse(key); }

} // namespace rodwake::scene
