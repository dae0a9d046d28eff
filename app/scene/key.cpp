#include "key.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>

namespace rodwake::scene {

namespace {

constexpr std::size_t max_text_bytes = 300;

/// Letters, digits, '_', '-' and inner '.', so that it is the same file on every system.
bool usable_as_file_name(const std::string& text) {
    const auto plain = [](unsigned char c) {
        return (c < 128 && std::isalnum(c)) || c == '_' || c == '-' || c == '.';
    };
    return !text.empty() && text.size() <= 64 && text.front() != '.' && text.front() != '-' &&
           std::all_of(text.begin(), text.end(), plain);
}

bool has_control_characters(const std::string& text) {
    return std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; });
}

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
    if (is_file_name && !usable_as_file_name(text))
        return "must be usable as a file name: letters, digits, _ - . and at most 64 of them";
    return text.size() > max_text_bytes || has_control_characters(text)
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

} // namespace rodwake::scene
