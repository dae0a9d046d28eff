#include "rodwake/core/rng.hpp"

#include "rodwake/core/repeatable_math.hpp"

#include <Random123/philox.h>
#include <cmath>
#include <numbers>

namespace rodwake {

std::array<std::uint32_t, 4> philox_block(std::array<std::uint32_t, 4> counter,
                                          std::array<std::uint32_t, 2> key) {
    const r123::Philox4x32::ctr_type in{{counter[0], counter[1], counter[2], counter[3]}};
    const auto out = r123::Philox4x32{}(in, {{key[0], key[1]}});
    return {out[0], out[1], out[2], out[3]};
}

std::uint64_t RandomStream::bits() {
    const auto low = static_cast<std::uint32_t>(index_), high = static_cast<std::uint32_t>(index_ >> 32);
    ++index_;
    const auto word =
        philox_block({low, high, stream_, substream_},
                     {static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)});
    return (static_cast<std::uint64_t>(word[1]) << 32) | word[0];
}

double RandomStream::uniform() { return (static_cast<double>(bits() >> 12) + 0.5) * 0x1p-52; }

double RandomStream::normal() {
    const double length = std::sqrt(-2.0 * repeatable::log(uniform()));
    return length * repeatable::cos(2.0 * std::numbers::pi * uniform());
}

double RandomStream::log_uniform(double low, double high) {
    return repeatable::exp(uniform(repeatable::log(low), repeatable::log(high)));
}

} // namespace rodwake
