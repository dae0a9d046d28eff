#pragma once
// What an exception says to the user.

#include <exception>
#include <new>
#include <stdexcept>
#include <string>

namespace rodwake::cli {

/// Its text; words where the library has none.
inline std::string words_of(const std::exception& error) {
    const bool memory = dynamic_cast<const std::bad_alloc*>(&error);
    const bool size = dynamic_cast<const std::length_error*>(&error);
    return memory || size
               ? "not enough memory; a coarser grid, fewer rows in the files that are read, or fewer "
                 "threads (-j) need less"
               : error.what();
}

} // namespace rodwake::cli
