#include "answer.hpp"

#include <algorithm>
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

} // namespace rodwake::app
