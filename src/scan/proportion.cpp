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

} // namespace rodwake::scan
