#pragma once
// Beds to start from, and whether anything in them overlaps: every pair is looked at.

#include "beds.hpp"
#include "rodwake/granular/start.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace starts {

using namespace rodwake;
using granular::GranularProblem;
using granular::make_start;
using granular::Start;
using granular::State;

constexpr double a = 0.4e-3;

inline GranularProblem bed(double phi, Start start, double box_in_a = 78.0) {
    GranularProblem problem;
    problem.box = box_in_a * a;
    problem.beads = static_cast<std::size_t>(std::lround(phi * box_in_a * box_in_a / M_PI));
    problem.start = start;
    return problem;
}

inline void add_rod(GranularProblem& problem, double x, double y, double heading) {
    problem.rods.push_back(granular::beds::long_rod(x * a, y * a, heading));
}

inline double floor_height(const GranularProblem& problem) {
    const double omega = 2.0 * M_PI * problem.plates.frequency,
                 amplitude = problem.plates.gamma * 9.81 / (omega * omega);
    return amplitude * std::cos(omega * static_cast<double>(problem.equilibration_steps) * problem.time_step);
}

/// Between two coordinates in [0, box).
inline double nearest(double u, double v, double box) {
    return std::min(std::abs(u - v), box - std::abs(u - v));
}

inline double folded(double u, double box) {
    const double rest = std::fmod(u, box);
    return rest < 0.0 ? rest + box : rest;
}

struct Ball {
    double x, y, z, radius;
    std::size_t body;
};

inline std::vector<Ball> balls_of(const State& state, const GranularProblem& problem) {
    std::vector<Ball> balls;
    const auto& b = state.beads;
    for (std::size_t i = 0; i < b.size(); ++i)
        balls.push_back({b.x[i], b.y[i], b.z[i], b.radius.empty() ? problem.bead_radius : b.radius[i], i});
    for (std::size_t k = 0; k < state.rods.size(); ++k) {
        const auto clump = granular::make_clump(problem.rods[k].shape);
        for (std::size_t s = 0; s < clump.offset.size(); ++s) {
            const Eigen::Vector3d centre = state.rods[k].position + clump.offset[s] * state.rods[k].axis();
            balls.push_back({centre.x(), centre.y(), centre.z(), clump.radius[s], b.size() + k});
        }
    }
    return balls;
}

/// Smallest free distance of any two bodies that are less than 2 mm apart in x, or of a body and a plate, m;
/// negative: an overlap. Every pair is looked at.
inline double clearance(const State& state, const GranularProblem& problem) {
    auto balls = balls_of(state, problem);
    const double floor = floor_height(problem), lid = floor + problem.plates.gap;
    const PeriodicBox& box = problem.box;
    for (Ball& ball : balls) {
        ball.x = folded(ball.x, box.x);
        ball.y = folded(ball.y, box.y);
    }
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < balls.size(); ++i) {
        const Ball& p = balls[i];
        least = std::min({least, p.z - p.radius - floor, lid - p.z - p.radius});
        for (std::size_t j = i + 1; j < balls.size(); ++j) {
            const Ball& q = balls[j];
            const double x = nearest(p.x, q.x, box.x);
            if (x < 2e-3 && p.body != q.body) // more than any two radii together
                least =
                    std::min(least, std::hypot(x, nearest(p.y, q.y, box.y), p.z - q.z) - p.radius - q.radius);
        }
    }
    return least;
}

inline void check_start(const GranularProblem& problem, std::uint32_t run = 0) {
    INFO(problem.beads << " beads, " << problem.rods.size() << " rods, orientation " << problem.orientation);
    const State state = make_start(problem, run);
    REQUIRE(state.beads.size() == problem.beads);
    REQUIRE(state.rods.size() == problem.rods.size());
    CHECK(clearance(state, problem) > 0.0);
    for (std::size_t i = 0; i < problem.beads; ++i)
        REQUIRE((state.beads.x[i] >= 0.0 && state.beads.x[i] < problem.box.x && state.beads.y[i] >= 0.0 &&
                 state.beads.y[i] < problem.box.y));
}

inline double mean(const std::vector<double>& numbers, int power) {
    double sum = 0.0;
    for (const double number : numbers)
        sum += std::pow(number, power);
    return sum / static_cast<double>(numbers.size());
}

} // namespace starts
