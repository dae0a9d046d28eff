#pragma once
// Counter-based random numbers: the value depends on (seed, stream, index) only, never on who asks or in what
// order, so threads and ranks cannot change a result.

#include <array>
#include <cstdint>

namespace rodwake {

/// Philox4x32-10 (Salmon et al., SC'11) keyed by a 64-bit seed; a stream is named by two 32-bit words.
class RandomStream {
public:
    explicit RandomStream(std::uint64_t seed, std::uint32_t stream = 0, std::uint32_t substream = 0)
        : seed_(seed), stream_(stream), substream_(substream) {}

    /// Uniform in the open interval (0, 1), 53 bits.
    double uniform();
    /// Uniform in (low, high).
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Log-uniform in (low, high), both > 0.
    double log_uniform(double low, double high);
    /// Standard normal, of two draws (Box and Muller).
    double normal();
    /// 64 random bits; advances the counter by one draw.
    std::uint64_t bits();

private:
    std::uint64_t seed_;
    std::uint32_t stream_, substream_;
    std::uint64_t index_ = 0;
};

/// One Philox4x32-10 block: for who names its counters itself. Those with counter[1] = 0 are RandomStream's.
std::array<std::uint32_t, 4> philox_block(std::array<std::uint32_t, 4> counter,
                                          std::array<std::uint32_t, 2> key);

} // namespace rodwake
