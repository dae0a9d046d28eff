// Every task once, in every round, however many threads there are.

#include "rodwake/core/parallel.hpp"

#include <catch2/catch.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using rodwake::parallel_for;
using rodwake::ThreadPool;

namespace {

using namespace std::chrono_literals;

/// How often each task of a round was done. Not atomic: no task runs twice, and all is seen when run returns.
std::vector<int> round_of(ThreadPool& team, std::size_t count) {
    std::vector<int> done(count, 0);
    team.run(count, [&](std::size_t i) { ++done[i]; });
    return done;
}

bool once_each(const std::vector<int>& done) {
    return std::ranges::all_of(done, [](int times) { return times == 1; });
}

} // namespace

TEST_CASE("a team does every task of every round once", "[threads]") {
    for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
        ThreadPool team(threads);
        for (std::size_t round = 0; round < 3000; ++round)
            REQUIRE(once_each(round_of(team, round % 17)));
    }
}

TEST_CASE("a team with more threads than tasks, or with none to do, ends", "[threads]") {
    ThreadPool team(6);
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
    ThreadPool team(3);
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
        ThreadPool team(4);
    SUCCEED();
}

TEST_CASE("the work is shared out among the threads", "[threads]") {
    ThreadPool team(2);
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

TEST_CASE("a team that fell asleep between rounds wakes up, and ends asleep", "[threads]") {
    for (int k = 0; k < 10; ++k) {
        ThreadPool team(3);
        for (int round = 0; round < 10; ++round) {
            REQUIRE(once_each(round_of(team, 7)));
            std::this_thread::sleep_for(200us); // they watch for 50
        }
    }
}

TEST_CASE("a round does not wait for a thread that never begins", "[threads]") {
    ThreadPool team(3);
    round_of(team, 50);
    const pid_t child = fork(); // which has the caller's thread alone
    REQUIRE(child >= 0);
    if (child == 0) {
        alarm(20); // the end of one that waits
        bool all = true;
        for (std::size_t round = 0; round < 100; ++round)
            all = once_each(round_of(team, 20)) && all;
        _exit(all ? 0 : 1);
    }
    int status = -1;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(status == 0);
}

TEST_CASE("a team that waits leaves the processor to others", "[threads]") {
    ThreadPool team(4);
    const auto idle = [&] {
        round_of(team, 100);
        const std::clock_t before = std::clock(); // processor time of all threads
        std::this_thread::sleep_for(50ms);
        return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
    };
    CHECK(idle() < 0.010); // three watch for 50 us each; spinning they would take 50 ms and more

    std::atomic<int> begun{0};
    const std::thread::id caller = std::this_thread::get_id();
    const std::clock_t before = std::clock();
    team.run(2, [&](std::size_t) { // so that the caller waits for the other
        for (++begun; begun < 2;)
            std::this_thread::sleep_for(100us);
        if (std::this_thread::get_id() != caller)
            std::this_thread::sleep_for(50ms);
    });
    CHECK(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC < 0.010);
}

TEST_CASE("a team in use by one caller lets others do their tasks alone", "[threads]") {
    ThreadPool team(3);
    std::atomic<int> wrong{0}, inner{0};
    const auto call = [&] {
        for (int round = 0; round < 200; ++round) {
            std::vector<int> done(9, 0);
            team.run(9, [&](std::size_t i) {
                ++done[i];
                team.run(2, [&](std::size_t) { ++inner; });
            });
            wrong += once_each(done) ? 0 : 1;
        }
    };
    std::thread other(call);
    call();
    other.join();
    CHECK(wrong == 0);
    CHECK(inner == 2 * 200 * 9 * 2);
}

TEST_CASE("a team's loops hand on the exception of the lowest index", "[threads]") {
    ThreadPool team(2);
    std::atomic<int> done{0};
    const auto task = [&](std::size_t i) {
        ++done;
        if (i % 10 == 3)
            throw std::runtime_error(std::to_string(i));
    };
    CHECK_THROWS_WITH(rodwake::parallel_for(100, team, task), "3");
    CHECK(done == 100);
    CHECK(once_each(round_of(team, 5))); // and goes on
}

TEST_CASE("threads by the work there is", "[threads]") {
    CHECK(rodwake::threads_for(0, 10, 8) == 1);
    CHECK(rodwake::threads_for(19, 10, 8) == 1);
    CHECK(rodwake::threads_for(20, 10, 8) == 2);
    CHECK(rodwake::threads_for(1000, 10, 8) == 8);
    CHECK(rodwake::threads_for(1000, 10, 1) == 1);
    CHECK(rodwake::threads_for(1000, 10, 0) == 1);
}

// --- Tasks over threads: each once, whatever the number of threads, and the first failure by index comes out

namespace {

/// How often each index was called.
std::vector<int> calls(std::size_t count, std::size_t threads) {
    std::vector<std::atomic<int>> called(count);
    parallel_for(count, threads, [&](std::size_t i) { ++called[i]; });
    return {called.begin(), called.end()};
}

} // namespace

TEST_CASE("Each index is called once", "[threads]") {
    const auto threads = GENERATE(as<std::size_t>{}, 0, 1, 2, 3, 8, 100);
    const auto count = GENERATE(as<std::size_t>{}, 0, 1, 2, 7, 1000);
    CAPTURE(threads, count);
    CHECK(calls(count, threads) == std::vector<int>(count, 1));
}

TEST_CASE("Tasks run at the same time", "[threads]") {
    // Each waits until the other has begun: with one thread this would time out.
    std::atomic<int> begun{0};
    std::atomic<bool> met{true};
    parallel_for(2, 2, [&](std::size_t) {
        ++begun;
        const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (begun < 2 && std::chrono::steady_clock::now() < give_up)
            std::this_thread::yield();
        if (begun < 2)
            met = false;
    });
    CHECK(met);
}

TEST_CASE("The exception of the lowest index is rethrown after all tasks have ended", "[threads]") {
    const auto threads = GENERATE(as<std::size_t>{}, 1, 2, 8);
    std::atomic<int> done{0};
    std::string caught;
    try {
        parallel_for(100, threads, [&](std::size_t i) {
            ++done;
            if (i % 10 == 3) {
                // The lowest failing index fails last.
                if (i == 3)
                    std::this_thread::sleep_for(std::chrono::milliseconds(20));
                throw std::runtime_error(std::to_string(i));
            }
        });
    } catch (const std::runtime_error& error) {
        caught = error.what();
    }
    CHECK(caught == "3");
    CHECK(done == 100);
}
