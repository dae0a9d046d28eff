#include "rodwake/core/spelling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <vector>

namespace rodwake {

namespace {

std::string lower(std::string_view word) {
    std::string text(word);
    for (char& c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

} // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // Three rows of the usual table: the swap looks two rows back.
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j)
        last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before.swap(last);
        last.swap(row);
    }
    return last[b.size()];
}

std::string_view nearest_word(std::string_view name, std::span<const std::string_view> known) {
    std::string_view best;
    if (name.size() > 64) // no key is near, and the table would be large
        return best;
    std::size_t best_distance = std::clamp<std::size_t>(name.size() / 3, 1, 3) + 1;
    for (const std::string_view candidate : known) {
        const std::size_t distance = edit_distance(lower(name), lower(candidate));
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view name, std::span<const std::string_view> known) {
    const std::string_view near = nearest_word(name, known);
    return near.empty() ? "" : " (did you mean \"" + std::string(near) + "\"?)";
}

namespace {

/// Bytes of the character of UTF-8 that a text begins with; 0 if it begins with none.
std::size_t character(std::string_view text) {
    const auto byte = [&](std::size_t at) {
        return static_cast<unsigned char>(at < text.size() ? text[at] : 0);
    };
    const unsigned first = byte(0), second = byte(1);
    const std::size_t size = first < 0x80   ? 1
                             : first < 0xC2 ? 0
                             : first < 0xE0 ? 2
                             : first < 0xF0 ? 3
                             : first < 0xF5 ? 4
                                            : 0;
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) || // too long, halves of pairs
        (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
        return 0;
    for (std::size_t at = 1; at < size; ++at)
        if ((byte(at) & 0xC0) != 0x80)
            return 0;
    return size;
}

std::string escaped(std::string_view text, std::string_view kept) {
    std::string out;
    while (!text.empty()) {
        const std::size_t size = character(text);
        const auto code = static_cast<unsigned char>(text[size == 2 ? 1 : 0]);
        const bool control =
            size < 2 ? code < 0x20 || code == 0x7F : text[0] == '\xC2' && code < 0xA0; // those beyond ASCII
        if (size == 0 || (control && kept.find(text[0]) == std::string_view::npos))
            out += fmt::format("\\x{:02x}", code);
        else
            out += text.substr(0, size);
        text.remove_prefix(std::max<std::size_t>(size, 1));
    }
    return out;
}

} // namespace

std::size_t first_not_utf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t size = character(text.substr(at));
        if (size == 0)
            return at;
        at += size;
    }
    return std::string_view::npos;
}

std::string printable(std::string_view text) { return escaped(text, "\t\n"); }

std::string shown(std::string_view word) {
    constexpr std::size_t most = 60;
    std::size_t end = std::min(word.size(), most);
    while (end > 0 && end < word.size() && (word[end] & 0xC0) == 0x80) // not within a character of UTF-8
        --end;
    return escaped(word.substr(0, end), "") + (end < word.size() ? "..." : "");
}

std::string first_difference(const std::string& there, const std::string& here) {
    std::istringstream a(there), b(here);
    const auto next = [](std::istringstream& text, std::string& line) {
        const bool is_there = static_cast<bool>(std::getline(text, line));
        if (!is_there)
            line.clear();
        return is_there;
    };
    const auto shown = [](const std::string& line) { return line.empty() ? "nothing" : line; };
    std::string line_a, line_b;
    for (bool more = true; more;) {
        const bool in_a = next(a, line_a), in_b = next(b, line_b);
        if (line_a != line_b)
            return shown(line_a) + " there, " + shown(line_b) + " here";
        more = in_a || in_b;
    }
    return "no line";
}

} // namespace rodwake
