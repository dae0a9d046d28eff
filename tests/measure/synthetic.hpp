#pragma once
// Beds made of known motion, for tests of accumulators.

#include "rodwake/core/rng.hpp"
#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/state_io.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace rodwake::measure::synthetic {

/// Standard normal numbers (Box-Muller).
struct Normal {
    RandomStream random;
    explicit Normal(std::uint64_t seed) : random(seed) {}
    double operator()() {
        const double radius = std::sqrt(-2.0 * std::log(random.uniform()));
        return radius * std::cos(2.0 * std::numbers::pi * random.uniform());
    }
};

inline Layout layout(std::size_t beads, std::size_t rods = 0, double box_in_radii = 78.0) {
    return {box_in_radii * 4e-4, 4e-4, 7.2e-7, beads, rods};
}

/// A coordinate in the box, [0, L), of an unwrapped one.
inline double wrapped(double free, double box) {
    const double place = free - box * std::floor(free / box);
    return place < box ? place : 0.0;
}

/// The frame of beads at these unwrapped places, at rest.
inline Frame frame_of(const Layout& layout, double time, std::vector<double> x, std::vector<double> y,
                      std::vector<RodPlace> rods = {}) {
    Frame frame;
    frame.time = time;
    for (std::size_t i = 0; i < x.size(); ++i) {
        frame.x.push_back(wrapped(x[i], layout.box.x));
        frame.y.push_back(wrapped(y[i], layout.box.y));
    }
    frame.unwrapped_x = std::move(x);
    frame.unwrapped_y = std::move(y);
    frame.vx.assign(frame.x.size(), 0.0);
    frame.vy = frame.vx;
    frame.rods = std::move(rods);
    return frame;
}

template<class Accumulator>
std::vector<double> saved(const Accumulator& accumulator) {
    StateWriter out;
    accumulator.save(out);
    return out.take();
}

/// What `accumulator` packs, put into `empty`.
template<class Accumulator>
Accumulator through_packing(const Accumulator& accumulator, Accumulator empty) {
    const std::vector<double> row = saved(accumulator);
    StateReader in(row, "test");
    empty.load(in);
    in.finish();
    return empty;
}

} // namespace rodwake::measure::synthetic
