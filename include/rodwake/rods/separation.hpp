#pragma once
// Distances between rods along a trajectory. Rods move at speed 1, so the rate of change of a separation is
// known exactly from the headings: within a step it is followed by cubic Hermite interpolation of its square.
//
// In a periodic box (axes of the lab) a separation is that of the nearest images; positions stay
// unwrapped. Of many rods only the pairs that can matter are looked at: N log N instead of N^2, same bits.
//
// Degenerate input: coincident rods have distance and encounter_step 0; rods so far apart (1e200) that the
// square overflows an infinite distance; if rod 0 or 1 is not finite, closest_pair's distance is NaN. One rod
// has an infinite encounter_step.

#include "rodwake/core/periodic.hpp"
#include "rodwake/elastic/medium.hpp"
#include "rodwake/integrate/ode.hpp"

#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace rodwake::rods {

/// The periodic box; none: infinite plane.
using Box = std::optional<PeriodicBox>;

/// A pair (first < second) and how far apart it is. Unit of the positions.
struct Separation {
    std::size_t first = 0, second = 0;
    double distance = 0.0;
};

/// The closest pair, the first of equals; needs two rods or more.
Separation closest_pair(integrate::State y, Box box = {});

/// R_a - R_b, of the nearest images.
struct Offset {
    double x, y;
};
Offset offset(integrate::State y, std::size_t a, std::size_t b, Box box = {});

/// Longest step in which no pair can meet and part unseen: the smallest of r/(3 max(|n_a - n_b|, 1/2)). At
/// most a third of the separation is closed in it, two thirds if the limit is one step old; rods that walk
/// abreast close in only by turning, which error control sees.
double encounter_step(integrate::State y, Box box = {});

/// Longest step in which no rod crosses a narrow wake of another unseen: the smallest of
/// (|d| + w)/(3 v) over the pairs, d being the distance from the other's track behind it, v the speed across,
/// and w = sqrt(4 b xi/nu) the width of the longitudinal wake at b behind (docs/theory.md, Eq. 16). For
/// nu >> 1, where w << b; for nu of order 1 it says no more than encounter_step. Looks at all pairs.
double wake_step(integrate::State y, const elastic::Medium& medium, Box box = {});
/// Whether wakes are wide enough for encounter_step alone: nu <= 10.
bool has_wide_wakes(const elastic::Medium& medium);

/// Closest approach at or below which two rods pass through each other as far as a solve can tell: the side
/// on which they pass, and with it their turning in fields that are singular there, is within `tolerance` of
/// their places, or within rounding of the state `y`. At most a thousandth of the separation `first` they
/// start at.
double passing_resolution(integrate::State y, double first, double tolerance);

/// The closest approach of a pair inside a step, if it comes closer there than at both ends and than `below`,
/// which saves looking at the others; the first of equals.
struct Approach {
    double time;
    Separation pair;
};
std::optional<Approach> closest_approach(const integrate::Step& step, Box box = {},
                                         double below = std::numeric_limits<double>::infinity());

/// Of all closest approaches inside a step of less than `below` the time of the first.
std::optional<double> first_approach_time(const integrate::Step& step, Box box, double below);

/// For a pair that is farther apart than `distance` before the step and not after it: when it comes that
/// close.
double fall_time(const integrate::Step& step, std::size_t a, std::size_t b, double distance);

} // namespace rodwake::rods
