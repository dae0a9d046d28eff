#pragma once
// A proportion that was counted, with its interval of confidence.

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

} // namespace rodwake::scan
