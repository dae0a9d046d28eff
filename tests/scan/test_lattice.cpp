// Places of an adaptive scan and their numbers.

#include "maps.hpp"
#include "rodwake/core/error.hpp"

#include <catch2/catch.hpp>

using namespace scan_test;

TEST_CASE("Places and their numbers are one to one, to the last corner") {
    for (const std::size_t axes : {1, 2, 3}) {
        const Lattice lattice(adaptive(axes, 4, 16));
        std::set<std::int64_t> seen;
        Lattice::LatticePoint place{};
        for (const std::int64_t x : {std::int64_t{0}, std::int64_t{1}, lattice.steps(0)})
            for (const std::int64_t y : {std::int64_t{0}, lattice.steps(axes > 1 ? 1 : 2)})
                for (const std::int64_t z : {std::int64_t{0}, lattice.steps(2)}) {
                    place = {x, y, z};
                    const std::int64_t id = lattice.id(place);
                    CHECK(id >= 0);
                    CHECK(lattice.place(id) == place);
                    seen.insert(id);
                }
        CHECK(seen.size() == (axes == 1 ? 3 : axes == 2 ? 6 : 12));
        CHECK(*seen.rbegin() < (std::int64_t{1} << 60)); // numbers of edges fit
    }
}

TEST_CASE("Corners of the lattice are ends of the axes to the bit") {
    Design design = adaptive(2, 48, 96);
    design.axes[0].spacing = Spacing::log;
    design.axes[0].from = 0.1;
    design.axes[0].to = 100.0;
    const Lattice lattice(design);
    CHECK(lattice.point({0, 0, 0}).at[0] == 0.1);
    CHECK(lattice.point({lattice.steps(0), lattice.steps(1), 0}).at[0] == 100.0);
    CHECK(lattice.point({lattice.steps(0), lattice.steps(1), 0}).at[1] == 1.0);
}

TEST_CASE("A finer resolution has the places of the coarser under the same numbers") {
    const Lattice coarse(adaptive(2, 16, 64)), fine(adaptive(2, 16, 1024));
    CHECK(coarse.levels() == 2);
    CHECK(fine.levels() == 6);
    CHECK(coarse.steps(0) == fine.steps(0));
    CHECK(coarse.stride(0) == fine.stride(0));
    const Lattice::LatticePoint place{3 * coarse.stride(2), 5 * coarse.stride(2), 0};
    CHECK(coarse.id(place) == fine.id(place));
    CHECK(coarse.point(place).at == fine.point(place).at);
}

TEST_CASE("Resolutions that no lattice has are refused") {
    CHECK_THROWS_AS(Lattice(adaptive(0, 16, 64)), rodwake::InputError);
    CHECK_THROWS_AS(Lattice(adaptive(4, 16, 64)), rodwake::InputError);
    CHECK_THROWS_AS(Lattice(adaptive(2, 16, 100)), rodwake::InputError); // no power of two times 16
    CHECK_THROWS_AS(Lattice(adaptive(2, 16, 8)), rodwake::InputError);
    Design uneven = adaptive(2, 16, 64);
    uneven.axes[1].count = 32; // two halvings of one axis, one of the other
    CHECK_THROWS_AS(Lattice(uneven), rodwake::InputError);
    CHECK_NOTHROW(Lattice(adaptive(3, 64, 1 << 19)));
    CHECK_THROWS_AS(Lattice(adaptive(3, 3, 3L << 22)), rodwake::InputError);
}
