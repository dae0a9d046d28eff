#include "rodwake/scene/output_grid.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::scene {

std::vector<double> output_grid(double interval, double t_end) {
    const double steps = std::clamp(std::ceil(t_end / interval - 1e-9), 1.0, max_outputs);
    std::vector<double> times(static_cast<std::size_t>(steps));
    for (std::size_t i = 0; i < times.size(); ++i)
        times[i] = static_cast<double>(i + 1) * interval;
    times.back() = t_end;
    return times;
}

std::optional<double> grid_interval(const std::vector<double>& times, double t_end) {
    if (times.empty() || !(times.front() > 0.0) || t_end / times.front() > max_outputs)
        return std::nullopt;
    return output_grid(times.front(), t_end) == times ? std::optional(times.front()) : std::nullopt;
}

} // namespace rodwake::scene
