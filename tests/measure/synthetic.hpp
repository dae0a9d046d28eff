#pragma once
// Beds made of known motion, for tests of accumulators.

#include "rodwake/measure/frame.hpp"
#include "rodwake/measure/state_io.hpp"
#include "support/normal.hpp"

#include <cmath>
#include <cstdint>
#include <span>

namespace rodwake::measure::synthetic {

/// Standard normal numbers.
struct Normal {
    RandomStream random;
    explicit Normal(std::uint64_t seed) : random(seed) {}
    double operator()() { return normal(random); }
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
                      std::vector<RodPosition> rods = {}) {
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

/// Results of a single run.
template<class Accumulator>
auto reduced(const Accumulator& run) {
    return reduce(std::span(&run, 1));
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
