// Tasks over threads: each once, whatever the number of threads, and the first failure by index comes out.

#include "rodwake/core/parallel.hpp"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using rodwake::parallel_for;

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
