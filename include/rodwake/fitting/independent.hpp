#pragma once
// How many independent values there are in data of which neighbours share noise.

#include <span>
#include <vector>

namespace rodwake::fitting {

/// What each row is worth, in (0, 1], if rows of a run closer than `spacing` (> 0) share data: the mean step
/// between the rows within that distance over it, at least one value for all of them together. n rows with
/// the step h are worth n h/spacing, a row that is farther than `spacing` from all others 1, rows in the same
/// place 1 together. A run ends where the places turn back, so that runs written one after the other count
/// each; rows in no order are one run.
std::vector<double> independent_worth(std::span<const double> places, double spacing);

/// Independent values a row is worth on average.
double mean_worth(std::span<const double> worth);

} // namespace rodwake::fitting
