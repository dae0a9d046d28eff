// Runs of ids against std::set.

#include "scan/id_set.hpp"

#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>

#include <set>
#include <vector>

using rodwake::RandomStream;
using rodwake::scan::IdSet;

namespace {

std::vector<std::int64_t> members(const IdSet& set) {
    std::vector<std::int64_t> found;
    set.for_each([&](std::int64_t id) { found.push_back(id); });
    return found;
}

} // namespace

TEST_CASE("A set of ids holds what was put in, in whatever order") {
    RandomStream random(1, 2);
    IdSet set;
    std::set<std::int64_t> expected;
    for (int round = 0; round < 300; ++round) {
        std::set<std::int64_t> batch;
        auto id = static_cast<std::int64_t>(random.uniform() * 400.0) - 100;
        for (int k = 0; k < 5; ++k, id += 1 + static_cast<std::int64_t>(random.uniform() * 1.5))
            batch.insert(id);
        set.insert(std::vector<std::int64_t>(batch.begin(), batch.end()));
        expected.insert(batch.begin(), batch.end());
        REQUIRE(members(set) == std::vector<std::int64_t>(expected.begin(), expected.end()));
        CHECK(set.size() == static_cast<std::int64_t>(expected.size()));
    }
    for (std::int64_t id = -110; id < 320; ++id)
        CHECK(set.contains(id) == expected.contains(id));
}

TEST_CASE("An empty set of ids holds nothing") {
    const IdSet set;
    CHECK(set.size() == 0);
    CHECK_FALSE(set.contains(0));
    CHECK(members(set).empty());
}
