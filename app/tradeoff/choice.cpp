// Which of the ways that were tried is worth having.

#include "rodwake/app/tradeoff.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

constexpr double countable_runs = 1e9;

double squared(double x) { return x * x; }

/// b of the header.
double bias_of(const Found& found) {
    return std::sqrt(std::max(0.0, squared(found.bias) - squared(found.bias_error)));
}

Choice with_runs(const Way& way, const Found& found, double runs) {
    const double n = found.scatter > 0.0 ? std::clamp(std::floor(runs), 1.0, countable_runs) : 1.0;
    return {&way, &found, std::lround(n), bias_of(found), found.scatter / std::sqrt(n)};
}

/// The best by `better` of what `choose` makes of each way that has the quantity.
template<class Choose, class Better>
std::optional<Choice> best_of(const Tradeoff& table, const std::string& quantity, const Choose& choose,
                              const Better& better) {
    std::optional<Choice> best;
    for (const Way& way : table.ways)
        if (const Found* found = way.find(quantity); found && std::isfinite(found->bias))
            if (const std::optional<Choice> choice = choose(way, *found))
                if (!best || better(*choice, *best))
                    best = choice;
    return best;
}

bool more_accurate(const Choice& a, const Choice& b) {
    return a.error() != b.error() ? a.error() < b.error() : a.seconds() < b.seconds();
}

} // namespace

const Found* Way::find(const std::string& quantity) const {
    const auto at = std::ranges::find(found, quantity, &Found::name);
    return status == "ok" && at != found.end() ? &*at : nullptr;
}

double Choice::error() const { return std::hypot(bias, statistical); }

std::optional<Choice> cheapest(const Tradeoff& table, const std::string& quantity, double error) {
    const auto choose = [error](const Way& way, const Found& found) -> std::optional<Choice> {
        if (!(found.scatter > 0.0)) // no squares: errors as small as 1e-200 may be asked for
            return bias_of(found) <= error ? std::optional(with_runs(way, found, 1.0)) : std::nullopt;
        const double runs = std::ceil(squared(found.scatter) / (squared(error) - squared(bias_of(found))));
        return runs > 0.0 && runs <= countable_runs ? std::optional(with_runs(way, found, runs))
                                                    : std::nullopt;
    };
    return best_of(table, quantity, choose,
                   [](const Choice& a, const Choice& b) { return a.seconds() < b.seconds(); });
}

std::optional<Choice> most_accurate(const Tradeoff& table, const std::string& quantity, double seconds) {
    const auto choose = [seconds](const Way& way, const Found& found) -> std::optional<Choice> {
        if (way.seconds > seconds)
            return std::nullopt;
        return with_runs(way, found, seconds / way.seconds);
    };
    return best_of(table, quantity, choose, more_accurate);
}

std::vector<const Way*> pareto_front(const Tradeoff& table, const std::string& quantity) {
    std::vector<const Way*> front;
    for (double seconds = HUGE_VAL;;) { // from the slowest, which is the most accurate, down
        std::optional<Choice> best;
        for (const Way& way : table.ways)
            if (const Found* found = way.find(quantity);
                found && std::isfinite(found->bias) && way.seconds < seconds)
                if (const Choice choice = with_runs(way, *found, 1.0); !best || more_accurate(choice, *best))
                    best = choice;
        if (!best)
            break;
        front.insert(front.begin(), best->way);
        seconds = best->way->seconds;
    }
    return front;
}

std::vector<std::string> quantities_of(const Tradeoff& table) {
    std::vector<std::string> names;
    for (const Way& way : table.ways)
        for (const Found& found : way.found)
            if (std::ranges::find(names, found.name) == names.end())
                names.push_back(found.name);
    return names;
}

Found reference_of(const Tradeoff& table, const std::string& quantity) {
    for (const Way& way : table.ways)
        if (const Found* found = way.find(quantity))
            return *found;
    const std::vector<std::string> names = quantities_of(table);
    if (names.empty())
        throw InputError(fmt::format("no way to compute the {} gave a result: {}", to_string(table.part),
                                     table.ways.empty() ? "none was tried" : table.ways.front().status));
    throw InputError(fmt::format("\"{}\" is not measured of this {}; there is {}", quantity,
                                 to_string(table.part), fmt::join(names, ", ")));
}

} // namespace rodwake::app
