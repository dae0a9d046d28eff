#include "wake_comparison.hpp"

#include <algorithm>
#include <cmath>

namespace measure_test {

Comparison compare(const rodwake::measure::DisplacementField& field, const Truth& truth, double core,
                   double coherence) {
    Comparison result;
    double squares = 0.0;
    for (std::size_t j = 0; j < field.grid.bins(); ++j) {
        const double x = field.grid.x_of(j), y = field.grid.y_of(j);
        if (field.count[j] == 0.0 || std::hypot(x, y) < core || field.coherence[j] < coherence)
            continue;
        const auto u = truth(x, y);
        const double dx = field.Ux[j] - u.x, dy = field.Uy[j] - u.y;
        result.bins += 1.0;
        result.largest_truth = std::max(result.largest_truth, std::hypot(u.x, u.y));
        result.bias_x = std::max(result.bias_x, std::abs(dx));
        result.bias_y = std::max(result.bias_y, std::abs(dy));
        result.chi2_x += dx * dx / (field.sigma_x[j] * field.sigma_x[j]);
        result.chi2_y += dy * dy / (field.sigma_y[j] * field.sigma_y[j]);
        result.mean_x += dx;
        result.mean_y += dy;
        squares += dx * dx + dy * dy;
    }
    result.chi2_x /= result.bins;
    result.chi2_y /= result.bins;
    for (double* value : {&result.bias_x, &result.bias_y})
        *value /= result.largest_truth;
    for (double* value : {&result.mean_x, &result.mean_y})
        *value /= result.largest_truth * result.bins;
    result.rms = std::sqrt(squares / (2.0 * result.bins)) / result.largest_truth;
    return result;
}

} // namespace measure_test
