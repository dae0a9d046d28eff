#include "rodwake/core/estimate.hpp"

namespace rodwake {

Estimate mean_of(std::span<const double> values) {
    Estimate mean;
    mean.count = values.size();
    if (values.empty())
        return mean;
    const double count = static_cast<double>(values.size());
    double sum = 0.0, squares = 0.0;
    for (const double value : values)
        sum += value;
    mean.value = sum / count;
    for (const double value : values)
        squares += (value - mean.value) * (value - mean.value);
    if (values.size() > 1)
        mean.error = std::sqrt(squares / (count - 1.0) / count);
    return mean;
}

} // namespace rodwake
