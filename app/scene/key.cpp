#include "key.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace rodwake::scene {

namespace {

constexpr std::size_t max_text_bytes = 300;

/// 1e+12 rather than 1000000000000.
std::string bound(double value) {
    return std::abs(value) < 1e7 ? fmt::format("{}", value) : fmt::format("{:g}", value);
}

} // namespace

std::string Range::text() const {
    if (low == high)
        return bound(low);
    if (low == -high)
        return "within +-" + bound(high);
    return fmt::format("{} {} and <= {}", open_low ? ">" : ">=", bound(low), bound(high));
}

std::string Key::fault(double value) const {
    if (!std::isfinite(value))
        return "must be a finite number";
    return range.contains(value)
               ? ""
               : fmt::format("must be {}{}{}", range.text(), reason.empty() ? "" : ": ", reason);
}

std::string Key::fault(const std::string& text) const {
    // Letters, digits, '_', '-' and inner '.' are the same file on every system.
    const bool plain = std::ranges::all_of(text, [](unsigned char c) {
        return (c < 128 && std::isalnum(c)) || c == '_' || c == '-' || c == '.';
    });
    if (is_file_name &&
        (text.empty() || text.size() > 64 || text.front() == '.' || text.front() == '-' || !plain))
        return "must be usable as a file name: letters, digits, _ - . and at most 64 of them";
    return text.size() > max_text_bytes || std::any_of(text.begin(), text.end(),
                                                       [](unsigned char c) { return c < 0x20 || c == 0x7F; })
               ? fmt::format("must be one line of at most {} bytes", max_text_bytes)
               : "";
}

std::string Key::count_text(std::string_view of) const {
    return min_items == max_items ? fmt::format("{} {}", min_items, of)
                                  : fmt::format("{} to {} {}", min_items, max_items, of);
}

std::vector<std::string_view> Choice::names() const {
    std::vector<std::string_view> all(count);
    for (std::size_t i = 0; i < count; ++i)
        all[i] = name(i);
    return all;
}

std::vector<std::string_view> names_of(Forms forms) {
    std::vector<std::string_view> names;
    for (const KeyAlternative& form : forms)
        for (const auto name : {form.first, form.second})
            if (!name.empty() && std::ranges::find(names, name) == names.end())
                names.push_back(name);
    return names;
}

std::vector<std::string_view> effective_names(std::span<const GivenKey> given, Forms forms) {
    const auto has_all_overriding = [&](const KeyAlternative& form) {
        return std::ranges::all_of(given,
                                   [&](const GivenKey& k) { return !k.is_overriding || form.has(k.name); });
    };
    const bool any_overriding = std::ranges::any_of(given, &GivenKey::is_overriding);
    std::vector<std::string_view> names;
    for (const GivenKey& key : given)
        if (!any_overriding || key.is_overriding ||
            std::ranges::any_of(forms, [&](const KeyAlternative& form) {
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
    for (const KeyAlternative& form : forms)
        text += fmt::format("{}{}{}{}", text.empty() ? "" : " | ", form.first,
                            form.second.empty() ? "" : " + ", form.second);
    return text;
}

} // namespace rodwake::scene
