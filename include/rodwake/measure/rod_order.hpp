#pragma once
// Order of many rods: do they share a heading or an axis, and in what groups are they?
//
//   polar order      P = |sum_a exp(i theta_a)|/N        1: all head one way
//   nematic order    S = |sum_a exp(2 i theta_a)|/N      1: all along one axis, either way
//   clusters         rods nearer than the distance `link` are linked, or by another rule; those joined by
//                    links are a cluster
//   mean size        N/number of clusters
//   weighted size    sum over clusters of s^2/N: the mean size of the cluster that a rod is in
//   fluctuation      sum_c (n_c - n)^2 / ((M - 1) n), n_c rods in cell c of M = m x m equal ones, n = mean of
//                    n_c: the sample variance over the mean, 1 in the mean for independent places
//
// (Vicsek et al., Phys. Rev. Lett. 75, 1226 (1995); Ginelli et al., Phys. Rev. Lett. 104, 184502 (2010);
// fluctuations: Narayan, Ramaswamy, Menon, Science 317, 105 (2007).) P and S of N random headings are not 0
// but sqrt(pi/(4 N)) in the mean, for N of some tens or more. All are dimensionless; link is in the unit of
// the places.
//
// Cells divide the periodic box. On the plane they divide the square round the mean place whose half side is
// the rods' root-mean-square distance from it, which a disc of even density just holds; the profile of a
// crowd that is denser in its middle adds to the fluctuation.

#include "rodwake/core/estimate.hpp"
#include "rodwake/measure/frame.hpp"

#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace rodwake::measure {

/// How the numbers of rods in equal cells vary at one instant.
struct NumberFluctuation {
    double cell = 0.0;        ///< root of a cell's area
    double rods = 0.0;        ///< mean of a cell
    double fluctuation = 0.0; ///< variance over mean
};

/// For m = 2, 4, 8, ... while there are as many rods as cells; empty for fewer than 4 rods.
std::vector<NumberFluctuation> number_fluctuations(std::span<const RodPosition> rods,
                                                   std::optional<PeriodicBox> box);

/// At one instant.
struct RodOrder {
    double polar = 0.0, nematic = 0.0;
    std::vector<std::size_t> clusters;                      ///< sizes, the largest first; they add up to N
    std::vector<std::pair<std::size_t, std::size_t>> links; ///< by a rule: first < second, in order
    std::vector<NumberFluctuation> fluctuations = {};

    double mean_size() const;
    double weighted_size() const;
};

/// `box`: the periodic one, distances are those of the nearest images; absent: infinite plane. At
/// least one rod, finite places, link > 0 and at most half the box's shorter side. Cost: N, and the pairs in
/// neighbouring cells of the size of link.
RodOrder rod_order(std::span<const RodPosition> rods, double link, std::optional<PeriodicBox> box = {});

/// Linked are pairs nearer than `reach` for which `linked(a, b)` holds. The links are kept.
RodOrder rod_order(std::span<const RodPosition> rods, double reach, std::optional<PeriodicBox> box,
                   const std::function<bool(std::size_t a, std::size_t b)>& linked);

/// Mean time that a link lasts: the time of all links over the number of them that are gone at the next time.
/// Times between which a link parts and forms anew count as one. Nothing if none ends.
std::optional<double> link_lifetime(std::span<const double> times, std::span<const RodOrder> orders);

/// Of one run: times grow, as many as orders, all of the same rods.
struct RodOrderSeries {
    std::vector<double> times;
    std::vector<RodOrder> orders;
};

/// Over the instants from a time on.
struct MeanRodOrder {
    Estimate polar, nematic, mean_size, weighted_size, largest;
    std::vector<double> clusters; ///< number of clusters of size s at an instant, at index s - 1
    std::vector<NumberFluctuation> fluctuations;
    std::vector<double> fluctuation_errors;
    std::size_t instants = 0, blocks = 0;
};

/// Instants of one block of time of one run count as one value in the errors, which grow by
/// correlation_factor where successive blocks correlate (statistics.hpp). `runs` have the same number of
/// rods; block > 0. Throws InputError if no instant of any run is at or after `from`.
MeanRodOrder mean_rod_order(std::span<const RodOrderSeries> runs, double from, double block);

} // namespace rodwake::measure
