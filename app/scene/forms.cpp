#include "forms.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rodwake::scene {

std::vector<std::string_view> names_of(Forms forms) {
    std::vector<std::string_view> names;
    for (const Form& form : forms)
        for (const auto name : {form.first, form.second})
            if (!name.empty() && std::ranges::find(names, name) == names.end())
                names.push_back(name);
    return names;
}

std::vector<std::string_view> effective_names(std::span<const GivenKey> given, Forms forms) {
    const auto has_all_overriding = [&](const Form& form) {
        return std::ranges::all_of(given,
                                   [&](const GivenKey& k) { return !k.is_overriding || form.has(k.name); });
    };
    const bool any_overriding = std::ranges::any_of(given, &GivenKey::is_overriding);
    std::vector<std::string_view> names;
    for (const GivenKey& key : given)
        if (!any_overriding || key.is_overriding || std::ranges::any_of(forms, [&](const Form& form) {
                return form.has(key.name) && has_all_overriding(form);
            }))
            names.push_back(key.name);
    return names;
}

int matching_form(std::span<const std::string_view> names, Forms forms) {
    for (std::size_t i = 0; i < forms.size(); ++i)
        if (names.size() == forms[i].size() &&
            std::ranges::all_of(names, [&](std::string_view name) { return forms[i].has(name); }))
            return static_cast<int>(i);
    return -1;
}

std::string forms_text(Forms forms) {
    std::string text;
    for (const Form& form : forms)
        text += fmt::format("{}{}{}{}", text.empty() ? "" : " | ", form.first,
                            form.second.empty() ? "" : " + ", form.second);
    return text;
}

} // namespace rodwake::scene
