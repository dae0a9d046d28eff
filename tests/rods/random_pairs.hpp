#pragma once
// Pairs as scans meet them, for the tests of the batch.

#include "rodwake/core/rng.hpp"
#include "rodwake/rods/pair_batch.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace rodwake::rods {

/// kappa of both signs from 0.3 to 300, within 6 of each other, any headings; `polar`: gammas too.
inline PairProblem random_pair(RandomStream& random, bool polar) {
    const auto angle = [&] { return random.uniform(-std::numbers::pi, std::numbers::pi); };
    PairProblem pair;
    pair.medium = {random.log_uniform(0.1, 10.0), random.log_uniform(0.3, 3.0)};
    pair.couplings.kappa = random.log_uniform(0.3, 300.0) * (random.uniform() < 0.5 ? -1.0 : 1.0);
    if (polar) {
        pair.couplings.gamma1 = random.uniform(-10.0, 10.0);
        pair.couplings.gamma2 = random.uniform(-10.0, 10.0);
    }
    const double r = random.uniform(0.5, 6.0), where = angle();
    pair.rods = {Pose{1.0, -2.0, angle()},
                 Pose{1.0 + r * std::cos(where), -2.0 + r * std::sin(where), angle()}};
    pair.t_end = 40.0;
    pair.contact_distance = 0.1;
    return pair;
}

inline std::vector<PairProblem> random_pairs(std::size_t count, std::uint64_t seed, bool polar) {
    RandomStream random(seed);
    std::vector<PairProblem> pairs;
    while (pairs.size() < count)
        pairs.push_back(random_pair(random, polar));
    return pairs;
}

inline std::vector<PairResult> results_of(const std::vector<PairProblem>& pairs, const PairOptions& options) {
    std::vector<PairResult> results(pairs.size());
    simulate_pairs(pairs, options, results);
    return results;
}

} // namespace rodwake::rods
