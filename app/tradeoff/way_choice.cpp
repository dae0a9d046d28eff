// Which of the ways that were tried is worth having.

#include "rodwake/app/ways.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::app {

namespace {

constexpr std::array<const char*, 4> part_names{"rods", "bed", "fit", "field"};
constexpr double most_runs = 1e9;

const Found* find(const Way& way, const std::string& quantity) {
    const auto at = std::ranges::find(way.found, quantity, &Found::name);
    return way.status == "ok" && at != way.found.end() ? &*at : nullptr;
}

double squared(double x) { return x * x; }

/// b of the header.
double bias_of(const Found& found) {
    return std::sqrt(std::max(0.0, squared(found.bias) - squared(found.bias_error)));
}

Choice with_runs(const Way& way, const Found& found, double runs) {
    const double n = found.scatter > 0.0 ? std::clamp(std::floor(runs), 1.0, most_runs) : 1.0;
    return {&way, &found, std::lround(n), bias_of(found), found.scatter / std::sqrt(n)};
}

/// The best by `better` of what `choose` makes of each way.
template<class Choose, class Better>
std::optional<Choice> best_of(const Ways& ways, const std::string& quantity, const Choose& choose,
                              const Better& better) {
    std::optional<Choice> best;
    for (const Way& way : ways.ways)
        if (const Found* found = find(way, quantity))
            if (const std::optional<Choice> choice = choose(way, *found))
                if (!best || better(*choice, *best))
                    best = choice;
    return best;
}

} // namespace

std::string to_string(Part part) { return part_names[static_cast<std::size_t>(part)]; }

double Choice::error() const { return std::hypot(bias, statistical); }

std::optional<Choice> cheapest(const Ways& ways, const std::string& quantity, double error) {
    const auto choose = [error](const Way& way, const Found& found) -> std::optional<Choice> {
        const double left = squared(error) - squared(bias_of(found));
        if (found.scatter > 0.0 ? !(left > 0.0) : !(left >= 0.0))
            return std::nullopt;
        const double runs = std::ceil(squared(found.scatter) / left);
        return found.scatter > 0.0 && runs > most_runs ? std::nullopt
                                                       : std::optional(with_runs(way, found, runs));
    };
    return best_of(ways, quantity, choose,
                   [](const Choice& a, const Choice& b) { return a.seconds() < b.seconds(); });
}

std::optional<Choice> most_accurate(const Ways& ways, const std::string& quantity, double seconds) {
    const auto choose = [seconds](const Way& way, const Found& found) -> std::optional<Choice> {
        if (way.seconds > seconds)
            return std::nullopt;
        return with_runs(way, found, seconds / way.seconds);
    };
    return best_of(ways, quantity, choose, [](const Choice& a, const Choice& b) {
        return a.error() != b.error() ? a.error() < b.error() : a.seconds() < b.seconds();
    });
}

std::vector<std::string> quantities_of(const Ways& ways) {
    std::vector<std::string> names;
    for (const Way& way : ways.ways)
        for (const Found& found : way.found)
            if (std::ranges::find(names, found.name) == names.end())
                names.push_back(found.name);
    return names;
}

Found reference_of(const Ways& ways, const std::string& quantity) {
    for (const Way& way : ways.ways)
        if (const Found* found = find(way, quantity))
            return *found;
    const std::vector<std::string> names = quantities_of(ways);
    if (names.empty())
        throw InputError(fmt::format("no way to compute the {} gave a result: {}", to_string(ways.part),
                                     ways.ways.empty() ? "none was tried" : ways.ways.front().status));
    throw InputError(fmt::format("\"{}\" is not measured of this {}; there is {}", quantity,
                                 to_string(ways.part), fmt::join(names, ", ")));
}

std::filesystem::path ways_folder(const std::filesystem::path& results, Part part) {
    return results / ("tradeoff_" + to_string(part));
}

} // namespace rodwake::app
