#pragma once
// A synthetic wake taken through an accumulator.

#include "rodwake/measure/displacement.hpp"

#include "synthetic.hpp"
#include "synthetic_wake.hpp"
#include "wake_comparison.hpp"

namespace measure_test {

using Frames = std::vector<rodwake::measure::Frame>;

inline Frames frames_of(const SyntheticWake& wake, std::size_t count) {
    Frames frames;
    for (std::size_t k = 0; k < count; ++k)
        frames.push_back(wake.frame(k));
    return frames;
}

/// Twelve blocks, spacing 1, unless the options say otherwise (0: not said).
inline rodwake::measure::DisplacementAccumulator accumulator_of(const SyntheticWake& wake,
                                                                rodwake::measure::DisplacementOptions options,
                                                                const Frames& frames) {
    if (options.spacing == 0.0)
        options.spacing = 1.0;
    if (options.block == 5.0)
        options.block = static_cast<double>(frames.size()) * 0.1 / 12.0;
    rodwake::measure::DisplacementAccumulator accumulator(wake.layout(), options);
    for (const auto& frame : frames)
        accumulator.add(frame);
    return accumulator;
}

inline rodwake::measure::DisplacementField measured(const SyntheticWake& wake,
                                                    const rodwake::measure::DisplacementOptions& options,
                                                    const Frames& frames) {
    return rodwake::measure::synthetic::reduced(accumulator_of(wake, options, frames));
}

inline rodwake::measure::DisplacementField measured(const SyntheticWake& wake,
                                                    const rodwake::measure::DisplacementOptions& options,
                                                    std::size_t frames) {
    return measured(wake, options, frames_of(wake, frames));
}

inline Truth truth_of(const SyntheticWake& wake, double strength = 1.0, double sign_y = 1.0) {
    return [&wake, strength, sign_y](double x, double y) {
        const auto u = wake.truth(x, y);
        return rodwake::elastic::Vector{strength * u.x, strength * sign_y * u.y};
    };
}

} // namespace measure_test
