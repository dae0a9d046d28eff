#pragma once
// A number with its standard error, and means that are such numbers.
//
// An error may be
//   finite     known;
//   NaN        unknown: nothing tells it (one value, one block of time, a value that was given);
//   infinite   known to have no bound: the data do not fix the value.
// The same holds for columns of errors. Files write unknown as null (JSON), an empty field (CSV) or NaN
// (HDF5). JSON has no infinity either: there it is null too, and words beside it name what is not fixed.

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace rodwake {

inline constexpr double unknown_error = std::numeric_limits<double>::quiet_NaN();

struct Estimate {
    double value = 0.0, error = unknown_error;
    std::size_t count = 0; ///< independent values behind it; 0: none, and the value means nothing

    bool known() const { return !std::isnan(error); }
    bool not_fixed() const { return std::isinf(error); }
    /// In another unit, of positive size; keeps unknown unknown.
    Estimate scaled(double factor) const { return {factor * value, factor * error, count}; }
};

/// Mean of independent values of equal weight, error s/sqrt(n); of one value it is unknown. Weighted means:
/// measure/statistics.hpp.
Estimate mean_of(std::span<const double> values);

} // namespace rodwake
