#include "suggest.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

namespace rodwake::scene {

namespace {

std::string lower(std::string text) {
    for (char& c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

} // namespace

std::size_t edit_distance(const std::string& a, const std::string& b) {
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

std::string nearest(const std::string& name, std::span<const std::string> known) {
    std::string best;
    if (name.size() > 64) // no key is near, and the table would be large
        return best;
    std::size_t best_distance = std::clamp<std::size_t>(name.size() / 3, 1, 3) + 1;
    for (const auto& candidate : known) {
        const std::size_t distance = edit_distance(lower(name), lower(candidate));
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

std::string did_you_mean(const std::string& name, std::span<const std::string> known) {
    const std::string near = nearest(name, known);
    return near.empty() ? "" : " (did you mean \"" + near + "\"?)";
}

bool contains(std::span<const std::string> names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::string comma_list(std::span<const std::string> names) {
    std::string text;
    for (const auto& name : names)
        text += (text.empty() ? "" : ", ") + name;
    return text;
}

} // namespace rodwake::scene
