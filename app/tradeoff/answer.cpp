#include "answer.hpp"

#include "rodwake/app/tradeoff.hpp"
#include "rodwake/app/ways.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::app {

namespace {

constexpr double kept_by = 0.95; ///< of the points of a scan

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = a.size() == b.size() ? 0.0 : HUGE_VAL;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

/// Up to the earlier end: one of two runs into contact may have an output time more.
double path_difference(const Encounter& a, const Encounter& b) {
    double largest = largest_difference(a.final_state, b.final_state);
    for (std::size_t i = 0; i < std::min(a.path.size(), b.path.size()); ++i)
        largest = std::max(largest, largest_difference(a.path[i], b.path[i]));
    return largest;
}

bool differ(const Encounter& a, const Encounter& b) { return !a.solved || !b.solved || a.ending != b.ending; }

Errors errors_of(const Encounter& a, const Encounter& b) {
    if (differ(a, b))
        return {HUGE_VAL, b.ending == Ending::contact ? HUGE_VAL : NAN, 1.0, b.path.empty() ? NAN : HUGE_VAL};
    return {largest_difference(a.final_state, b.final_state),
            a.ending == Ending::contact ? std::abs(a.time - b.time) : NAN, 0.0,
            b.path.empty() ? NAN : path_difference(a, b)};
}

/// What this share of the numbers keeps to; NaN if there are none.
double quantile(std::vector<double> values, double share) {
    std::erase_if(values, [](double v) { return std::isnan(v); });
    if (values.empty())
        return NAN;
    const auto last = static_cast<double>(values.size() - 1);
    const auto at = values.begin() + std::lround(std::ceil(share * last));
    std::ranges::nth_element(values, at);
    return *at;
}

} // namespace

Errors errors_between(const Answer& one, const Answer& other) {
    std::array<std::vector<double>, error_kinds> all;
    for (std::size_t i = 0; i < other.encounters.size(); ++i) {
        const Errors each = errors_of(one.encounters.at(i), other.encounters[i]);
        for (std::size_t kind = 0; kind < error_kinds; ++kind)
            all[kind].push_back(each[kind]);
    }
    Errors errors{};
    for (std::size_t kind = 0; kind < error_kinds; ++kind)
        errors[kind] = quantile(all[kind], kept_by);
    auto& shares = all[static_cast<std::size_t>(ErrorKind::outcome)];
    double sum = 0.0;
    for (const double share : shares)
        sum += share;
    errors[static_cast<std::size_t>(ErrorKind::outcome)] = sum / static_cast<double>(shares.size());
    return errors;
}

// Which of the settings that were tried is worth having.

namespace {

/// NaN if there is none, or no result at all.
double error_of(const Trial& trial, ErrorKind kind) {
    return trial.status == "ok" ? trial.error[static_cast<std::size_t>(kind)] : NAN;
}

} // namespace

const Trial* cheapest(const Tradeoff& table, ErrorKind kind, double error) {
    const Trial* best = nullptr;
    for (const Trial& trial : table.trials)
        if (error_of(trial, kind) <= error && (!best || trial.seconds < best->seconds)) // NaN: is not
            best = &trial;
    return best;
}

const Trial* most_accurate(const Tradeoff& table, ErrorKind kind, double seconds) {
    const Trial* best = nullptr;
    for (const Trial* trial : pareto_front(table, kind)) // ever slower and better
        if (trial->seconds <= seconds)
            best = trial;
    return best;
}

std::vector<const Trial*> pareto_front(const Tradeoff& table, ErrorKind kind) {
    std::vector<const Trial*> all;
    for (const Trial& trial : table.trials)
        if (std::isfinite(error_of(trial, kind)))
            all.push_back(&trial);
    std::ranges::stable_sort(all, [&](const Trial* a, const Trial* b) {
        return a->seconds != b->seconds ? a->seconds < b->seconds : error_of(*a, kind) < error_of(*b, kind);
    });
    std::vector<const Trial*> front;
    for (const Trial* trial : all)
        if (front.empty() || error_of(*trial, kind) < error_of(*front.back(), kind))
            front.push_back(trial);
    return front;
}

// Which of the ways that were tried is worth having.

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
