#pragma once
// Sums in the bins of a RodGrid, one set a block of time. A new block begins when time/length passes a whole
// number or the rod is turned by more than 0.1 rad from where it was at the beginning of each block of that
// time: one that rattles about a heading does not make a block each time.

#include "rodwake/measure/packing.hpp"

#include <span>
#include <vector>

namespace rodwake::measure {

struct BlockSums {
    double number = 0.0;             ///< floor(time/length)
    double first_heading = 0.0;      ///< rad
    double cosine = 0.0, sine = 0.0; ///< sums of those of the heading
    double frames = 0.0;
    std::vector<double> sums; ///< [bin][channel]

    /// Mean heading, rad.
    double heading() const;
};

class Blocks {
public:
    Blocks(std::size_t bins, std::size_t channels, double length)
        : bins_(bins), channels_(channels), length_(length) {}

    /// The block this frame belongs to, with the frame counted in.
    BlockSums& at(double time, double heading);

    std::span<const BlockSums> all() const { return blocks_; }
    std::size_t channels() const { return channels_; }
    void pack(Packer& out) const;
    void unpack(Unpacker& in);

private:
    std::size_t bins_, channels_;
    double length_;
    std::vector<BlockSums> blocks_;
};

} // namespace rodwake::measure
