#pragma once
// Turning rates of a pair and their derivatives at many states at once: what the bounds of a run
// (pair_proof.hpp) are made of. Reduced units, the lab's frame.

#include "rodwake/elastic/medium.hpp"
#include "rodwake/rods/couplings.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace rodwake::rods {

/// Columns, a state a row: what goes in and what comes out.
struct PairJets {
    enum Column : std::size_t {
        x, ///< R_0 - R_1
        y,
        heading0,
        heading1,
        rate0, ///< theta_0'; behind it by x, y, heading0 and heading1
        rate1 = rate0 + 5,
        cosine0 = rate1 + 5, ///< of the headings
        sine0,
        cosine1,
        sine1,
        columns
    };
    std::array<std::vector<double>, columns> at; ///< of at least as many rows as states, a multiple of 8
    std::size_t states = 0;

    void resize(std::size_t count);
    double operator()(std::size_t column, std::size_t state) const { return at[column][state]; }
};

/// Fills the rates. False if a state is out of the range of the kernels (elastic/wake_kernel.hpp; eta < 0
/// is): then nothing of it holds. Derivatives lose (2 xi/r)^2 roundings of their parts near the rod.
bool fill_jets(const elastic::Medium& medium, const Couplings& couplings, PairJets& jets);

} // namespace rodwake::rods
