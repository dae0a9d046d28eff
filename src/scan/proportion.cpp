#include "rodwake/scan/proportion.hpp"

#include <boost/math/distributions/binomial.hpp>

#include <cmath>

namespace rodwake::scan {

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
