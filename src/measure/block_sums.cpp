#include "block_sums.hpp"

#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double most_turn = 0.1; // rad

}

double BlockSums::heading() const { return std::atan2(sine, cosine); }

BlockSums& Blocks::at(double time, double heading) {
    const double number = std::floor(time / length_);
    const auto fits = [&](const BlockSums& block) {
        return std::abs(std::remainder(heading - block.first_heading, 2.0 * M_PI)) <= most_turn;
    };
    auto found = blocks_.rbegin();
    while (found != blocks_.rend() && found->number == number && !fits(*found))
        ++found;
    const bool begins = found == blocks_.rend() || found->number != number;
    if (begins)
        blocks_.push_back({number, heading, 0.0, 0.0, 0.0, std::vector<double>(bins_ * channels_, 0.0)});
    BlockSums& block = begins ? blocks_.back() : *found;
    block.cosine += std::cos(heading);
    block.sine += std::sin(heading);
    block.frames += 1.0;
    return block;
}

void Blocks::pack(Packer& out) const {
    out.put(blocks_.size());
    for (const BlockSums& block : blocks_) {
        for (const double value : {block.number, block.first_heading, block.cosine, block.sine, block.frames})
            out.put(value);
        out.put(std::span<const double>(block.sums));
    }
}

void Blocks::unpack(Unpacker& in) {
    blocks_.clear();
    for (std::size_t left = in.count(); left > 0; --left) {
        BlockSums block;
        for (double* value : {&block.number, &block.first_heading, &block.cosine, &block.sine, &block.frames})
            *value = in.get();
        block.sums = in.array(bins_ * channels_);
        blocks_.push_back(std::move(block));
    }
}

} // namespace rodwake::measure
