#pragma once
// Grey pictures as PNG: the one place that knows libpng.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace rodwake::store {

/// The file's bytes, of values from 0 (black) to 255, row by row from the top. Throws RunError.
std::string png_of_grey(std::size_t width, std::size_t height, std::span<const std::uint8_t> values);

} // namespace rodwake::store
