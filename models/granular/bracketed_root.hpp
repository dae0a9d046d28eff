#pragma once
// Root of a function in a bracket: Newton, bisection where Newton leaves the bracket.

#include <cmath>
#include <limits>

namespace rodwake::granular {

struct ValueAndSlope {
    double value, slope;
};

/// f(low) and f(high) have opposite signs, f(high) > 0 if `rising`; accurate to the rounding of f. The
/// bracket shrinks with every evaluation, and 200 of them halve it below the last bit.
template<class Function>
double bracketed_root(Function f, double low, double high, double guess, bool rising) {
    double x = guess > low && guess < high ? guess : 0.5 * (low + high);
    for (int k = 0; k < 200; ++k) {
        const ValueAndSlope at = f(x);
        ((at.value < 0.0) == rising ? low : high) = x;
        double next = x - at.value / at.slope;
        if (!(next >= low && next <= high))
            next = 0.5 * (low + high);
        if (std::abs(next - x) <= 2.0 * std::numeric_limits<double>::epsilon() * std::abs(next))
            return next;
        x = next;
    }
    return x;
}

} // namespace rodwake::granular
