#pragma once
// Batches for the tests of the kernels, and what is compared.

#include "rodwake/core/rng.hpp"
#include "rodwake/elastic/wake_kernel.hpp"

#include <bit>
#include <cstdint>
#include <numbers>
#include <vector>

namespace rodwake::elastic {

/// Sums at targets, in the order xx, xy, yy, lap U, grad div U.
struct Sums {
    std::vector<double> part[7];

    explicit Sums(std::size_t targets) {
        for (auto& one : part)
            one.resize(targets);
    }
    StrainSums strain() { return {part[0], part[1], part[2]}; }
    PolarSums polar() { return {part[3], part[4], part[5], part[6]}; }

    std::vector<std::uint64_t> bits(std::size_t target) const {
        std::vector<std::uint64_t> all;
        for (const auto& one : part)
            all.push_back(std::bit_cast<std::uint64_t>(one[target]));
        return all;
    }
};

struct Batch {
    std::vector<Source> sources;
    std::vector<double> x, y;

    FieldPoints places() const { return {x, y}; }
    Sums sums(const Medium& medium, Accuracy accuracy = Accuracy::full) const {
        Sums sums(x.size());
        WakeKernel(medium, accuracy).strain_and_polar(sources, places(), sums.strain(), sums.polar());
        return sums;
    }
};

/// Sources and targets in a square of this half width.
inline Batch random_batch(RandomStream& random, std::size_t sources, std::size_t targets, double half_width) {
    Batch batch;
    const auto place = [&] { return random.uniform(-half_width, half_width); };
    for (std::size_t k = 0; k < sources; ++k)
        batch.sources.push_back({place(), place(), random.uniform(-10.0, 10.0)});
    for (std::size_t k = 0; k < targets; ++k) {
        batch.x.push_back(place());
        batch.y.push_back(place());
    }
    return batch;
}

} // namespace rodwake::elastic
