#pragma once
// XXH3-64, the checksum of every binary file written here.

#include <cstdint>
#include <string_view>

namespace rodwake::store {

std::uint64_t xxh3(std::string_view bytes, std::uint64_t seed = 0);

} // namespace rodwake::store
