// Random numbers: the generator is Philox4x32-10 to the bit, and the numbers drawn from it have the right
// moments.

#include "rodwake/core/rng.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>
#include <vector>

using rodwake::philox_block;
using rodwake::RandomStream;

namespace {

using Block = std::array<std::uint32_t, 4>;

std::vector<std::uint64_t> draw_bits(RandomStream stream, int count) {
    std::vector<std::uint64_t> bits;
    for (int i = 0; i < count; ++i)
        bits.push_back(stream.bits());
    return bits;
}

/// Mean and variance of `count` uniform numbers.
struct Moments {
    double mean = 0.0, variance = 0.0;
};
Moments moments(RandomStream stream, int count) {
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < count; ++i) {
        const double u = stream.uniform() - 0.5;
        sum += u;
        squares += u * u;
    }
    const double mean = sum / count;
    return {0.5 + mean, squares / count - mean * mean};
}

} // namespace

// Vectors "philox4x32 10" of kat_vectors in the Random123 distribution.
TEST_CASE("Philox4x32-10 gives the known answers") {
    constexpr std::uint32_t ones = 0xffffffffU;
    CHECK(philox_block({0, 0, 0, 0}, {0, 0}) == Block{0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U});
    CHECK(philox_block({ones, ones, ones, ones}, {ones, ones}) ==
          Block{0x408f276dU, 0x41c83b0eU, 0xa20bc7c6U, 0x6d5451fdU});
    CHECK(philox_block({0x243f6a88U, 0x85a308d3U, 0x13198a2eU, 0x03707344U}, {0xa4093822U, 0x299f31d0U}) ==
          Block{0xd16cfe09U, 0x94fdccebU, 0x5001e420U, 0x24126ea1U});
}

TEST_CASE("A stream is the block function of seed, stream and draw") {
    const std::uint64_t seed = 0x299f31d0a4093822ULL;
    RandomStream stream(seed, 7, 9);
    for (std::uint32_t draw = 0; draw < 3; ++draw) {
        const Block block = philox_block({draw, 0, 7, 9}, {0xa4093822U, 0x299f31d0U});
        CHECK(stream.bits() == ((static_cast<std::uint64_t>(block[1]) << 32) | block[0]));
    }
}

TEST_CASE("Uniform numbers lie inside (0, 1) and have its moments") {
    constexpr int count = 1'000'000;
    RandomStream stream(1);
    double smallest = 1.0, largest = 0.0;
    for (int i = 0; i < count; ++i) {
        const double u = stream.uniform();
        smallest = std::min(smallest, u);
        largest = std::max(largest, u);
    }
    CHECK(smallest > 0.0);
    CHECK(largest < 1.0);
    // The extremes of n numbers lie 1/n from the ends on average; 20/n is passed with probability e^-20.
    CHECK(smallest < 20.0 / count);
    CHECK(largest > 1.0 - 20.0 / count);
    const Moments m = moments(RandomStream(1), count);
    // Standard errors: sqrt(1/12/n) of the mean, sqrt((1/80 - 1/144)/n) of the variance; four of them.
    CHECK(std::abs(m.mean - 0.5) < 4.0 * std::sqrt(1.0 / 12.0 / count));
    CHECK(std::abs(m.variance - 1.0 / 12.0) < 4.0 * std::sqrt((1.0 / 80.0 - 1.0 / 144.0) / count));
}

TEST_CASE("Streams differ in every word that names them") {
    constexpr int count = 1000;
    std::set<std::uint64_t> all;
    for (const RandomStream& stream : {RandomStream(1), RandomStream(2), RandomStream(1ULL << 32),
                                       RandomStream(1, 1), RandomStream(1, 0, 1), RandomStream(1, 1, 1)}) {
        const auto bits = draw_bits(stream, count);
        all.insert(bits.begin(), bits.end());
    }
    // 6000 words of 64 bits: two alike by chance with probability 6000^2 / 2^65 = 1e-12.
    CHECK(all.size() == 6 * count);
    CHECK(draw_bits(RandomStream(1, 2, 3), 10) == draw_bits(RandomStream(1, 2, 3), 10));
}

TEST_CASE("Streams are not correlated") {
    constexpr int count = 100'000;
    RandomStream a(5, 1), b(5, 2);
    double sum = 0.0;
    for (int i = 0; i < count; ++i)
        sum += (a.uniform() - 0.5) * (b.uniform() - 0.5);
    // The product of two independent uniform deviates has standard deviation 1/12.
    CHECK(std::abs(sum / count) < 4.0 / 12.0 / std::sqrt(count));
}

TEST_CASE("Ranges") {
    RandomStream stream(3);
    double log_mean = 0.0;
    constexpr int count = 10'000;
    for (int i = 0; i < count; ++i) {
        const double u = stream.uniform(-3.0, -1.0), l = stream.log_uniform(1e-3, 1e3);
        REQUIRE((u > -3.0 && u < -1.0));
        REQUIRE((l > 1e-3 && l < 1e3));
        log_mean += std::log(l) / count;
    }
    // log l is uniform with width 6 ln 10 about 0.
    CHECK(std::abs(log_mean) < 4.0 * 6.0 * std::log(10.0) * std::sqrt(1.0 / 12.0 / count));
}
