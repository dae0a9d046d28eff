#pragma once
// A synthetic wake taken through a accumulator.

#include "rodwake/measure/displacement.hpp"

#include "synthetic_wake.hpp"
#include "wake_comparison.hpp"

namespace measure_test {

/// Twelve blocks, spacing 1, unless the options say otherwise (0: not said).
inline rodwake::measure::DisplacementAccumulator accumulator_of(const SyntheticWake& wake,
                                                                rodwake::measure::DisplacementOptions options,
                                                                std::size_t frames, double interval = 0.1) {
    if (options.spacing == 0.0)
        options.spacing = 1.0;
    if (options.block == 5.0)
        options.block = static_cast<double>(frames) * interval / 12.0;
    rodwake::measure::DisplacementAccumulator accumulator(wake.layout(), options);
    for (std::size_t k = 0; k < frames; ++k)
        accumulator.add(wake.frame(k));
    return accumulator;
}

inline rodwake::measure::DisplacementField measured(const SyntheticWake& wake,
                                                    const rodwake::measure::DisplacementOptions& options,
                                                    std::size_t frames, double interval = 0.1) {
    const rodwake::measure::DisplacementAccumulator runs[] = {
        accumulator_of(wake, options, frames, interval)};
    return rodwake::measure::reduce(runs);
}

inline Truth truth_of(const SyntheticWake& wake, double strength = 1.0, double sign_y = 1.0) {
    return [&wake, strength, sign_y](double x, double y) {
        const auto u = wake.truth(x, y);
        return rodwake::elastic::Vector{strength * u.x, strength * sign_y * u.y};
    };
}

} // namespace measure_test
