#pragma once
// First places of the beads, before they are pushed apart.

#include "packing.hpp"

#include <cstddef>
#include <cstdint>

namespace rodwake::granular {

/// What the random numbers of a start are for; each purpose has streams of its own.
enum class Purpose : std::uint64_t { place = 1, vacancy, velocity, shake };

/// Stream of one bead or site: independent of all others and of how many there are.
RandomStream stream_for(Purpose purpose, std::uint64_t seed, std::uint32_t run, std::size_t index = 0);

/// `beads` sites of the lattice that fits best. Sites under rods are dropped, the most covered first, then
/// sites at random; where the beads are dense, some that rods cover a little stay and have to give way.
Places on_lattice(const GranularProblem& problem, const Room& room, std::uint32_t run);

/// Uniform in the room outside the rods.
Places at_random(const GranularProblem& problem, const Room& room, std::uint32_t run);

} // namespace rodwake::granular
