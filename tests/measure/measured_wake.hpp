#pragma once
// A synthetic wake taken through a record.

#include "rodwake/measure/displacement.hpp"

#include "synthetic_wake.hpp"
#include "wake_comparison.hpp"

namespace measure_test {

/// Twelve blocks, spacing 1, unless the keys say otherwise (0: not said).
inline rodwake::measure::DisplacementRecord record_of(const SyntheticWake& wake,
                                                      rodwake::measure::DisplacementKeys keys,
                                                      std::size_t frames, double interval = 0.1) {
    if (keys.spacing == 0.0)
        keys.spacing = 1.0;
    if (keys.block == 5.0)
        keys.block = static_cast<double>(frames) * interval / 12.0;
    rodwake::measure::DisplacementRecord record(wake.layout(), keys);
    for (std::size_t k = 0; k < frames; ++k)
        record.add(wake.frame(k));
    return record;
}

inline rodwake::measure::DisplacementField measured(const SyntheticWake& wake,
                                                    const rodwake::measure::DisplacementKeys& keys,
                                                    std::size_t frames, double interval = 0.1) {
    const rodwake::measure::DisplacementRecord runs[] = {record_of(wake, keys, frames, interval)};
    return rodwake::measure::reduce(runs);
}

inline Truth truth_of(const SyntheticWake& wake, double strength = 1.0, double sign_y = 1.0) {
    return [&wake, strength, sign_y](double x, double y) {
        const auto u = wake.truth(x, y);
        return rodwake::elastic::Vector{strength * u.x, strength * sign_y * u.y};
    };
}

} // namespace measure_test
