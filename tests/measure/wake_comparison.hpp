#pragma once
// A measured displacement field against the true one, in the bins with data outside a core and where the
// measured coherence is at least `coherence`.

#include "rodwake/measure/displacement.hpp"

#include "synthetic_wake.hpp"

#include <functional>

namespace measure_test {

struct Comparison {
    double bins = 0.0;
    double largest_truth = 0.0;        ///< max |U| of the bins compared
    double bias_x = 0.0, bias_y = 0.0; ///< largest |measured - true| over largest_truth
    double rms = 0.0;                  ///< of both components, over largest_truth
    double chi2_x = 0.0, chi2_y = 0.0; ///< mean of ((measured - true)/sigma)^2
    double mean_x = 0.0, mean_y = 0.0; ///< of measured - true, over largest_truth
};

using Truth = std::function<rodwake::elastic::Vector(double x, double y)>;

Comparison compare(const rodwake::measure::DisplacementField& field, const Truth& truth, double core = 3.0,
                   double coherence = 0.0);

} // namespace measure_test
