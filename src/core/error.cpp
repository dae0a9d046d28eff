#include "rodwake/core/error.hpp"

#include <new>

namespace rodwake {

std::string describe(const std::exception& error) {
    const bool memory = dynamic_cast<const std::bad_alloc*>(&error);
    const bool size = dynamic_cast<const std::length_error*>(&error);
    return memory || size
               ? "not enough memory; a coarser grid, fewer rows in the files that are read, or fewer "
                 "threads (-j) need less"
               : error.what();
}

} // namespace rodwake
