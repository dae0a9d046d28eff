// Which of the settings that were tried is worth having.

#include "rodwake/app/tradeoff.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::app {

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

} // namespace rodwake::app
