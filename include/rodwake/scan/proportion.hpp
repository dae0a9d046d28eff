#pragma once
// A proportion that was counted, with its interval of confidence.

#include "rodwake/core/estimate.hpp"
#include "rodwake/scan/ledger.hpp"

#include <cstdint>
#include <utility>

namespace rodwake::scan {

/// Of the standard normal: 95 % lie within so many standard deviations.
inline constexpr double quantile_95 = 1.959963984540054;

struct Proportion {
    std::int64_t count = 0, of = 0;

    /// NaN if nothing was tried.
    double value() const;
    /// Ends of Clopper and Pearson's interval (1934): the true proportion is below `low`, or above `high`,
    /// with a probability of at most `tail` each. 0 and 1 if nothing was tried.
    double low(double tail) const;
    double high(double tail) const;
    /// Ends of Wilson's score interval (1927), for a quantile z of the standard normal: where the true
    /// proportion is p, the one counted is about z sqrt(p (1 - p)/of) away. 0 and 1 if nothing was tried.
    std::pair<double, double> wilson(double z) const;
};

// What the runs of a point yield together: means with errors, shares of outcomes, failures counted.

struct PointMean {
    Point point;                       ///< its id is its place
    std::int64_t runs = 0, failed = 0; ///< that finished, and that failed
    Status status = Status::ok;        ///< ok if a run finished, else that of the first
    std::int32_t outcome = -1;         ///< the most frequent one, of equals the first; -1: no run finished
    std::vector<Proportion> outcomes;  ///< of the runs that finished, as Columns::outcomes
    std::vector<Estimate> values;      ///< over the runs that have the number, as Columns::observables
};

/// Of the results of one place, in the order of their runs. Throws InputError for none.
PointMean mean_of_runs(std::span<const Result> runs, const Columns& columns);

/// Of every place that the ledger of a repeated design holds, in their order.
std::vector<PointMean> means_of(const Ledger& ledger);

} // namespace rodwake::scan
