#include "rodwake/store/png.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>
#include <png.h>

namespace rodwake::store {

std::string png_of_grey(std::size_t width, std::size_t height, std::span<const std::uint8_t> values) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = PNG_FORMAT_GRAY;
    std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
    png_alloc_size_t size = bytes.size();
    if (width * height != values.size() ||
        !png_image_write_to_memory(&image, bytes.data(), &size, 0, values.data(), 0, nullptr))
        throw RunError(fmt::format("a picture of {} x {} pixels cannot be written as PNG: {}", width, height,
                                   image.message));
    bytes.resize(size);
    return bytes;
}

} // namespace rodwake::store
