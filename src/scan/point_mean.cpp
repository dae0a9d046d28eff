
#include "rodwake/core/error.hpp"
#include "rodwake/scan/proportion.hpp"

#include <boost/math/distributions/binomial.hpp>

#include <algorithm>
#include <cmath>

namespace rodwake::scan {

PointMean mean_of_runs(std::span<const Result> runs, const Columns& columns) {
    if (runs.empty())
        throw InputError("the mean of no runs");
    PointMean mean;
    mean.point = runs.front().point;
    mean.point.id = place_of_run(mean.point.id);
    mean.runs = std::ranges::count_if(runs, &Result::ok);
    mean.failed = static_cast<std::int64_t>(runs.size()) - mean.runs;
    mean.status = mean.runs > 0 ? Status::ok : runs.front().status;
    for (std::size_t k = 0; k < columns.outcomes.size(); ++k)
        mean.outcomes.push_back({std::ranges::count_if(runs,
                                                       [&](const Result& run) {
                                                           return run.ok() &&
                                                                  run.outcome == static_cast<std::int32_t>(k);
                                                       }),
                                 mean.runs});
    if (mean.runs > 0) {
        const auto most = std::ranges::max_element(mean.outcomes, {}, &Proportion::count);
        mean.outcome = static_cast<std::int32_t>(most - mean.outcomes.begin());
    }
    for (std::size_t k = 0; k < columns.observables.size(); ++k) {
        std::vector<double> values;
        for (const Result& run : runs)
            if (run.ok() && std::isfinite(run.values[k]))
                values.push_back(run.values[k]);
        mean.values.push_back(values.empty() ? Estimate{std::nan(""), unknown_error, 0} : mean_of(values));
    }
    return mean;
}

std::vector<PointMean> means_of(const Ledger& ledger) {
    std::vector<PointMean> means;
    std::vector<Result> runs;
    const auto close = [&] {
        if (!runs.empty())
            means.push_back(mean_of_runs(runs, ledger.head().columns));
        runs.clear();
    };
    ledger.for_each([&](const Result& result) {
        if (!runs.empty() && place_of_run(runs.front().point.id) != place_of_run(result.point.id))
            close();
        runs.push_back(result);
    });
    close();
    return means;
}

namespace {

using Binomial = boost::math::binomial_distribution<>;

} // namespace

double Proportion::value() const {
    return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : std::nan("");
}

double Proportion::low(double tail) const {
    if (of == 0 || count == 0)
        return 0.0;
    return Binomial::find_lower_bound_on_p(static_cast<double>(of), static_cast<double>(count), tail);
}

double Proportion::high(double tail) const {
    if (of == 0 || count == of)
        return 1.0;
    return Binomial::find_upper_bound_on_p(static_cast<double>(of), static_cast<double>(count), tail);
}

std::pair<double, double> Proportion::wilson(double z) const {
    if (of == 0)
        return {0.0, 1.0};
    const double n = static_cast<double>(of), p = value(), share = z * z / n;
    const double middle = (p + 0.5 * share) / (1.0 + share);
    const double half = z * std::sqrt(p * (1.0 - p) / n + 0.25 * share / n) / (1.0 + share);
    return {count == 0 ? 0.0 : middle - half, count == of ? 1.0 : middle + half};
}

} // namespace rodwake::scan
