#include "rodwake/scene/set.hpp"

#include "check.hpp"
#include "fields.hpp"
#include "node.hpp"
#include "setter.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rodwake::scene {

ValueSetter compile_setter(const Scene& scene, std::span<const std::string> keys) {
    auto targets = std::make_shared<std::vector<SetterTarget>>();
    for (const std::string& key : keys) {
        SetterTarget& target = targets->emplace_back(SetterTarget{key, {}});
        for (const std::string& segment : split_path(key))
            target.path.push_back({segment, list_index(segment)});
    }
    Scene copy = scene; // a field list may change what it visits
    Setter setter(*targets);
    fields(setter, copy);
    auto error = setter.finish();
    for (std::size_t i = 0; i < keys.size() && !error; ++i)
        if (std::ranges::find(keys.first(i), keys[i]) != keys.first(i).end())
            error = keys[i] + " is set twice";
    if (error)
        throw InputError(*error);
    return ValueSetter(std::move(targets));
}

ValueSetter compile_setter(const Scene& scene, std::string_view key) {
    const std::string keys[] = {std::string(key)};
    return compile_setter(scene, keys);
}

std::optional<std::string> ValueSetter::set(Scene& scene, std::span<const Value> values) const {
    if (values.size() != targets_->size())
        return fmt::format("{} values for {} keys", values.size(), targets_->size());
    Setter setter(*targets_, values);
    fields(setter, scene);
    return setter.finish();
}

std::optional<std::string> ValueSetter::set(Scene& scene, const Value& value) const {
    return set(scene, std::span(&value, 1));
}

Value ValueSetter::held(const Value& written, std::size_t which) const {
    const SetterTarget& target = targets_->at(which);
    if (!target.is_quantity || std::holds_alternative<bool>(written))
        return written;
    if (const auto* whole = std::get_if<std::int64_t>(&written))
        return to_reduced(static_cast<double>(*whole), target.dimension, target.units);
    if (const auto* real = std::get_if<double>(&written))
        return to_reduced(*real, target.dimension, target.units);
    const std::string& text = std::get<std::string>(written);
    const Quantity found = parse_quantity(text, target.dimension, target.units);
    if (target.dimension == Dimension::none || !found.value)
        throw InputError(fmt::format("{} = {}: expected {}{}{}", target.path_text(), in_quotes(text),
                                     name_of(target.dimension), found.why.empty() ? "" : ": ",
                                     found.needs_scales ? "a physical unit needs [scales]" : found.why));
    return *found.value;
}

std::vector<Diagnostic> validate(const Scene& scene) {
    Diagnostics diagnostics;
    check(scene, nullptr, diagnostics);
    return diagnostics.list();
}

} // namespace rodwake::scene
