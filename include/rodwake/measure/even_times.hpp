#pragma once
// Times of frames that must be evenly spaced.

#include "rodwake/measure/packing.hpp"

#include <cstddef>

namespace rodwake::measure {

struct EvenTimes {
    std::size_t frames = 0;
    double last = 0.0, interval = 0.0; ///< s; interval 0 before the second frame

    /// Counts the next frame in. Throws RunError ("measure: <what>: ...", with the times) if times do not
    /// grow or their steps differ by more than a millionth, which is far above the round-off of times.
    void next(double time, const char* what);
    void pack(Packer& out) const;
    void unpack(Unpacker& in);
};

} // namespace rodwake::measure
