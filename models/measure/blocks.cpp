#include "blocks.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

double BlockSums::heading() const { return std::atan2(sine, cosine); }

BlockSums& Blocks::at(double time, double heading) {
    const double number = std::floor(time / length_);
    constexpr double most_turn = 0.1; // rad
    auto found = blocks_.rbegin();
    while (found != blocks_.rend() && found->number == number &&
           !(std::abs(std::remainder(heading - found->first_heading, 2.0 * M_PI)) <= most_turn))
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

void Blocks::save(StateWriter& out) const {
    out.put(blocks_.size());
    for (const BlockSums& block : blocks_) {
        for (const double value : {block.number, block.first_heading, block.cosine, block.sine, block.frames})
            out.put(value);
        out.put(std::span<const double>(block.sums));
    }
}

void Blocks::load(StateReader& in) {
    blocks_.clear();
    for (std::size_t left = in.count(); left > 0; --left) {
        BlockSums block;
        for (double* value : {&block.number, &block.first_heading, &block.cosine, &block.sine, &block.frames})
            *value = in.get();
        block.sums = in.array(bins_ * channels_);
        blocks_.push_back(std::move(block));
    }
}

namespace {

constexpr double borrowed_blocks = 4.0;

double variance(double squares, double blocks) {
    return blocks > 1.0 ? squares * blocks / (blocks - 1.0) : 0.0;
}

double mixed(double squares, double blocks, double typical) {
    const double free = std::max(blocks - 1.0, 0.0);
    return std::sqrt((free * variance(squares, blocks) + borrowed_blocks * typical) /
                     (free + borrowed_blocks));
}

} // namespace

Follows follows_of(const BlockSums* before, const BlockSums& now) {
    if (!before)
        return Follows::nothing;
    return before->number == now.number ? Follows::same_block : Follows::block;
}

void BlockScatter::add(std::size_t bin, std::span<const Vector2> pulls, const std::vector<bool>& present,
                       std::span<const Follows> follows) {
    Vector2 last;
    bool had = false; // data in the block before
    for (std::size_t first = 0, end = 0; first < pulls.size(); first = end) {
        Vector2 pull;
        bool has = false;
        for (end = first; end < pulls.size() && (end == first || follows[end] == Follows::same_block);
             ++end) {
            pull.x += pulls[end].x;
            pull.y += pulls[end].y;
            has = has || present[end];
        }
        const double xx = pull.x * pull.x, yy = pull.y * pull.y;
        if (has) {
            squares_[bin].x += xx;
            squares_[bin].y += yy;
            blocks_[bin] += 1.0;
        }
        if (has && had && follows[first] == Follows::block) {
            products_ += pull.x * last.x + pull.y * last.y;
            product_squares_ += 0.5 * (xx + yy + last.x * last.x + last.y * last.y);
        }
        last = pull;
        had = has;
    }
}

void BlockScatter::finish(BinSamples& samples) const {
    samples.block_correlation = product_squares_ > 0.0 ? products_ / product_squares_ : 0.0;
    const double factor = correlation_factor(samples.block_correlation);

    // s^2 is the mean of error^2 times count over the bins.
    Vector2 sum, s2;
    double weight = 0.0;
    for (std::size_t j = 0; j < squares_.size(); ++j) {
        const double free = std::max(blocks_[j] - 1.0, 0.0);
        sum.x += free * variance(squares_[j].x, blocks_[j]) * samples.count[j];
        sum.y += free * variance(squares_[j].y, blocks_[j]) * samples.count[j];
        weight += free;
    }
    if (weight > 0.0)
        s2 = {sum.x / weight, sum.y / weight};
    for (std::size_t j = 0; j < squares_.size(); ++j) {
        samples.blocks[j] = blocks_[j];
        if (samples.count[j] > 0.0)
            samples.sigma[j] = {factor * mixed(squares_[j].x, blocks_[j], s2.x / samples.count[j]),
                                factor * mixed(squares_[j].y, blocks_[j], s2.y / samples.count[j])};
    }
}

namespace {

using Row = std::vector<double>;
constexpr auto groups = MicrorheologyAccumulator::groups;
constexpr std::size_t fewest_runs = 4;

} // namespace

std::vector<long> common_lags(MicrorheologyRuns runs) {
    std::vector<long> lags;
    for (const auto& item : runs[0].lags())
        if (const long key = item.first; std::ranges::all_of(runs, [key](const auto& run) {
                const auto found = run.lags().find(key);
                return found != run.lags().end() && found->second.origins > 0.0;
            }))
            lags.push_back(key);
    return lags;
}

Row well_known(MicrorheologyRuns runs, const std::vector<long>& lags) {
    Row seconds;
    for (const long key : lags) {
        if (!std::ranges::all_of(runs, [&](const auto& run) { return run.is_well_known(key); }))
            break;
        seconds.push_back(runs[0].lag(key));
    }
    if (seconds.size() < 2)
        throw InputError(
            fmt::format("measure: microrheology: only {} lags are known well enough: needs 2; choose a "
                        "longest lag of at least 16 frames",
                        seconds.size()));
    return seconds;
}

std::vector<LagBlock> all_blocks(MicrorheologyRuns runs, const std::vector<long>& lags) {
    std::vector<LagBlock> blocks;
    const std::size_t step = runs.size() >= fewest_runs ? groups : 1;
    blocks.reserve(runs.size() * groups / step);
    for (const MicrorheologyAccumulator& run : runs)
        for (std::size_t first = 0; first < groups; first += step) {
            LagBlock& block = blocks.emplace_back(LagBlock{Row(lags.size(), 0.0), Row(lags.size(), 0.0)});
            for (std::size_t i = 0; i < lags.size(); ++i)
                for (std::size_t g = first; g < first + step; ++g) {
                    block.sum[i] += run.lags().at(lags[i]).sum[g];
                    block.weight[i] += run.weight(lags[i], g);
                }
        }
    return blocks;
}

Row pooled(const std::vector<LagBlock>& blocks, std::size_t without) {
    Row sum(blocks[0].sum.size(), 0.0), weight = sum;
    for (std::size_t b = 0; b < blocks.size(); ++b)
        for (std::size_t i = 0; b != without && i < sum.size(); ++i) {
            sum[i] += blocks[b].sum[i];
            weight[i] += blocks[b].weight[i];
        }
    for (std::size_t i = 0; i < sum.size(); ++i)
        sum[i] /= weight[i];
    return sum;
}

double Jackknife::error(std::size_t i) const {
    const double n = static_cast<double>(without.size());
    double mean = 0.0, scatter = 0.0;
    for (const Row& curve : without)
        mean += curve[i] / n;
    for (const Row& curve : without)
        scatter += (curve[i] - mean) * (curve[i] - mean);
    return std::sqrt(scatter * (n - 1.0) / n);
}

Row Jackknife::errors() const {
    Row row;
    for (std::size_t i = 0; i < all.size(); ++i)
        row.push_back(error(i));
    return row;
}

Row log_range(double low, double high, std::size_t points) {
    Row range;
    for (std::size_t i = 0; i < points; ++i)
        range.push_back(low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(points - 1)));
    return range;
}

} // namespace rodwake::measure
