// Every task once, in every round, however many threads there are.

#include "rodwake/core/parallel.hpp"

#include <catch2/catch.hpp>

#include <numeric>
#include <vector>

using rodwake::Team;

TEST_CASE("a team does every task of every round once", "[threads]") {
    for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
        Team team(threads);
        for (std::size_t round = 0; round < 3000; ++round) {
            const std::size_t count = round % 17;
            std::vector<int> done(count,
                                  0); // not atomic: no task runs twice, and all is seen when run returns
            team.run(count, [&](std::size_t i) { ++done[i]; });
            for (const int times : done)
                REQUIRE(times == 1);
        }
    }
}

TEST_CASE("a team with more threads than tasks, or with none to do, ends", "[threads]") {
    Team team(6);
    int once = 0;
    team.run(0, [&](std::size_t) { ++once; });
    CHECK(once == 0);
    team.run(1, [&](std::size_t) { ++once; });
    CHECK(once == 1);
    std::vector<int> done(2, 0);
    team.run(2, [&](std::size_t i) { done[i] = static_cast<int>(i) + 1; });
    CHECK(done == std::vector<int>{1, 2});
}

TEST_CASE("what one round writes the next one reads, whoever does it", "[threads]") {
    Team team(3);
    std::vector<long> value(100, 1), next(100, 0);
    for (int round = 0; round < 500; ++round) {
        team.run(100, [&](std::size_t i) { next[i] = value[(i + 7) % 100] + static_cast<long>(i % 3); });
        std::swap(value, next);
    }
    std::vector<long> alone(100, 1);
    for (int round = 0; round < 500; ++round) {
        std::vector<long> after(100);
        for (std::size_t i = 0; i < 100; ++i)
            after[i] = alone[(i + 7) % 100] + static_cast<long>(i % 3);
        alone = after;
    }
    CHECK(value == alone);
}

TEST_CASE("a team that never worked goes away quietly", "[threads]") {
    for (int k = 0; k < 200; ++k)
        Team team(4);
    SUCCEED();
}

TEST_CASE("the work is shared out among the threads", "[threads]") {
    Team team(2);
    std::vector<std::thread::id> who(2);
    std::atomic<int> waiting{0};
    team.run(2, [&](std::size_t i) { // each waits for the other: one thread alone would never get past
        who[i] = std::this_thread::get_id();
        ++waiting;
        while (waiting < 2)
            std::this_thread::yield();
    });
    CHECK(who[0] != who[1]);
}
