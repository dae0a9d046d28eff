// Bits that must come out in every build: any compiler, optimisation, instruction set, x86-64 or arm64. Who
// changes what a state goes through on purpose writes the new hashes here and in studies/reports/granular.md.

#include "fixed_bits.hpp"

#include <catch2/catch.hpp>

using namespace rodwake::granular;

TEST_CASE("functions, impacts and beds have these bits in every build") {
    CHECK(fixed::functions() == 0x6f028b14b106703au);
    CHECK(fixed::impacts() == 0x1e3aec9d88a24548u);
    CHECK(fixed::bed("periodic", fixed::periodic_bed()).back().second == 0x083efa80caff6e81u);
    CHECK(fixed::bed("dish", fixed::dish()).back().second == 0xa6224d071c9c70c9u);
}
