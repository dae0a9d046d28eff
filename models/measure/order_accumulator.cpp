// Sums over frames of pair correlation and bond order: what the order of a bed is reduced from.

#include "pair_counts.hpp"
#include "psi6.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

void want(bool legal, const std::string& what) {
    if (!legal)
        throw InputError("measure: " + what);
}

bool positive(double value) { return std::isfinite(value) && value > 0.0; }

/// Throws InputError for options outside their domain, a layout that is none, or fewer than 2 beads.
void validate(const Layout& layout, const OrderOptions& options) {
    validate(layout);
    want(layout.beads >= 2, fmt::format("{} bead: order needs at least 2", layout.beads));
    const double half = 0.5 * layout.box.shorter(), ratio = options.order_bin / options.bin;
    want(options.bin >= 1e-6 * layout.bead_radius && options.bin <= half,
         fmt::format("bin {:g} m of g(r): must be at least a millionth of a bead and at most half the box, "
                     "{:g} m",
                     options.bin, half));
    want(positive(options.order_bin) && options.order_bin <= half,
         fmt::format("bin {:g} m of g_B(r): must be above 0 and at most half the box, {:g} m",
                     options.order_bin, half));
    want(ratio > 0.5 && std::abs(ratio - std::round(ratio)) <= 1e-9 * ratio,
         fmt::format("bin {:g} m of g_B(r): must be a whole multiple of the bin of g(r), {:g} m",
                     options.order_bin, options.bin));
    want(positive(options.block), fmt::format("blocks of {:g} s: must be above 0", options.block));
    want(!layout.window || options.neighbours == Neighbours::cutoff,
         "Delaunay neighbours need a periodic box: with a window leave measure.order_neighbours out");
    want(options.cutoff_frames >= 1, "cut-off from 0 frames: must be at least 1");
    want(!options.cutoff || (positive(*options.cutoff) && *options.cutoff <= half),
         fmt::format("cut-off {:g} m for neighbours: must be above 0 and at most half the box, {:g} m",
                     options.cutoff.value_or(0.0), half));
}

/// Up to half the box, but not far into the emptiness around few beads: their dense crystal would be a tenth
/// as wide with bins of 0.05 a.
std::size_t bins_of_g(const Layout& layout, const OrderOptions& options) {
    const double most = 4096.0 + 256.0 * std::sqrt(static_cast<double>(layout.beads));
    return std::min(whole_bins(std::min(layout.box.shorter(), 4.0 * most * options.bin), options.bin),
                    static_cast<std::size_t>(most));
}

/// Bins of g(r) in one of g_B(r).
std::size_t bins_of_order_bin(const OrderOptions& options) {
    return static_cast<std::size_t>(std::round(options.order_bin / options.bin));
}

void add_to(std::vector<double>& sums, const std::vector<double>& values, std::size_t together) {
    for (std::size_t k = 0; k < sums.size() * together; ++k)
        sums[k / together] += values[k];
}

/// With itself and each other; 0 where all beads have one size.
std::size_t pairs_of_kinds(const Layout& layout) {
    return layout.kind_radii.size() * (layout.kind_radii.size() + 1) / 2;
}

/// Pairs of so many beads over those of a frame that has as many as the layout.
double share_of_all_pairs(const Layout& layout, std::size_t beads) {
    const double n = static_cast<double>(beads), all = static_cast<double>(layout.beads);
    return n * (n - 1.0) / (all * (all - 1.0));
}

template<class T>
std::vector<T> only(const std::vector<T>& values, const std::vector<std::size_t>& which) {
    std::vector<T> kept;
    kept.reserve(which.size());
    for (const std::size_t i : which)
        kept.push_back(values[i]);
    return kept;
}

} // namespace

OrderAccumulator::OrderAccumulator(const Layout& layout, const OrderOptions& options)
    : layout_(layout), options_(options) {
    validate(layout, options);
    if (options.neighbours == Neighbours::cutoff && options.cutoff)
        cutoff_.value = *options.cutoff;
}

bool OrderAccumulator::waits() const {
    return options_.neighbours == Neighbours::cutoff && cutoff_.value == 0.0;
}

void OrderAccumulator::add(const Frame& frame) {
    check_frame(layout_, frame);
    if (frame.x.size() < 2) // of tracks: nobody there
        return;
    if (!waits())
        return count({frame.time, frame.x, frame.y, frame.kind});
    waiting_.push_back({frame.time, frame.x, frame.y, frame.kind});
    if (waiting_.size() >= options_.cutoff_frames)
        count_waiting();
}

Cutoff OrderAccumulator::settled_cutoff() const {
    if (!waits() || waiting_.empty())
        return cutoff_;
    const std::size_t bins = bins_of_g(layout_, options_);
    std::vector<double> pairs(bins, 0.0);
    double frames = 0.0;
    for (const Waiting& frame : waiting_) {
        add_to(pairs, pairs_for_g(frame.x, frame.y), 1);
        frames += share_of_all_pairs(layout_, frame.x.size());
    }
    const std::vector<double> g =
        pair_correlation(pairs, frames, layout_.beads, seen_area(layout_), options_.bin);
    const auto minimum = first_minimum(middles(bins, options_.bin), g, layout_.bead_radius);
    if (minimum && *minimum <= 0.5 * layout_.box.shorter())
        return {*minimum, false};

    // 1.4 spacings of the perfect triangular lattice of this density lie between its first two shells, 1
    // and 1.73.
    const double area = seen_area(layout_) / static_cast<double>(layout_.beads);
    return {std::min(1.4 * std::sqrt(2.0 / std::sqrt(3.0) * area), 0.5 * layout_.box.shorter()), true};
}

void OrderAccumulator::count_waiting() {
    cutoff_ = settled_cutoff();
    for (const Waiting& frame : waiting_)
        count(frame);
    waiting_.clear();
}

void OrderAccumulator::count(const Waiting& frame) {
    const auto& [time, x, y, kind] = frame;
    const PeriodicBox box = image_box(layout_);
    LocalOrder order = options_.neighbours == Neighbours::delaunay
                           ? order_by_delaunay(x, y, box)
                           : order_by_cutoff(x, y, box, cutoff_.value);
    std::vector<std::size_t> inner; // beads farther than the cut-off from the border of a window
    for (std::size_t i = 0; i < x.size(); ++i)
        if (!layout_.window || layout_.window->inside_by(x[i], y[i]) > cutoff_.value)
            inner.push_back(i);
    if (inner.empty()) // nothing is known of this frame
        return;
    order = {only(order.psi, inner), only(order.neighbours, inner)};
    const std::size_t bins = bins_of_g(layout_, options_), together = bins_of_order_bin(options_);
    const PairSums sums = count_pairs(only(x, inner), only(y, inner), order.psi, box, options_.bin, bins);
    const double number = std::floor(time / options_.block);
    if (blocks_.empty() || block_number_.back() != number) {
        OrderBlock& fresh = blocks_.emplace_back(
            OrderBlock{std::vector<double>(bins, 0.0), std::vector<double>(bins / together, 0.0),
                       std::vector<double>(bins / together, 0.0), std::vector<double>(bins, 0.0)});
        if (layout_.window)
            fresh.weighted.assign(bins, 0.0);
        fresh.kind_pairs.assign(pairs_of_kinds(layout_) * bins, 0.0);
        fresh.kind_pairs_in_all.assign(pairs_of_kinds(layout_), 0.0);
        block_number_.push_back(number);
    }
    OrderBlock& block = blocks_.back();
    add_to(block.pairs, sums.pairs, 1);
    add_to(block.order_pairs, sums.pairs, together);
    add_to(block.order, sums.order, together);
    add_to(block.fine_order, sums.order, 1);
    const std::vector<double> weighted = layout_.window ? pairs_for_g(x, y) : std::vector<double>();
    if (layout_.window)
        add_to(block.weighted, weighted, 1);
    if (!kind.empty())
        count_kinds(frame, layout_.window ? weighted : sums.pairs, block);
    block.psi6 += order.global();
    block.local += order.mean_size();
    block.neighbours += order.mean_neighbours();
    block.frames += 1.0;
    block.full_frames += share_of_all_pairs(layout_, x.size());
    block.at_border += static_cast<double>(x.size() - inner.size()) / static_cast<double>(x.size());
}

/// Pairs within each kind are counted, and of two kinds they are those of both together less those within.
void OrderAccumulator::count_kinds(const Waiting& frame, const std::vector<double>& all,
                                   OrderBlock& block) const {
    const std::size_t kinds = layout_.kind_radii.size(), bins = all.size();
    std::vector<std::vector<double>> within(kinds);
    std::vector<double> beads(kinds);
    const auto pairs_among = [&](std::size_t p, std::size_t q) {
        std::vector<std::size_t> which;
        for (std::size_t i = 0; i < frame.kind.size(); ++i)
            if (frame.kind[i] == p || frame.kind[i] == q)
                which.push_back(i);
        beads[p] = p == q ? static_cast<double>(which.size()) : beads[p];
        return pairs_for_g(only(frame.x, which), only(frame.y, which));
    };
    for (std::size_t p = 0; p < kinds; ++p)
        within[p] = pairs_among(p, p);
    for (std::size_t p = 0, pair = 0; p < kinds; ++p)
        for (std::size_t q = p; q < kinds; ++q, ++pair) {
            const std::vector<double> together = p == q ? within[p] : kinds == 2 ? all : pairs_among(p, q);
            for (std::size_t k = 0; k < bins; ++k)
                block.kind_pairs[pair * bins + k] +=
                    together[k] - (p == q ? 0.0 : within[p][k] + within[q][k]);
            block.kind_pairs_in_all[pair] += p == q ? 0.5 * beads[p] * (beads[p] - 1.0) : beads[p] * beads[q];
        }
}

std::vector<double> OrderAccumulator::pairs_for_g(const std::vector<double>& x,
                                                  const std::vector<double>& y) const {
    const std::size_t bins = bins_of_g(layout_, options_);
    return layout_.window ? count_pairs_in(*layout_.window, x, y, layout_.box, options_.bin, bins)
                          : count_pairs(x, y, {}, layout_.box, options_.bin, bins).pairs;
}

std::vector<OrderAccumulator::OrderBlock> OrderAccumulator::blocks() const {
    if (waiting_.empty())
        return blocks_;
    OrderAccumulator all = *this;
    all.count_waiting();
    return all.blocks_;
}

void OrderAccumulator::save(StateWriter& out) const {
    out.put(cutoff_.value);
    out.put(std::size_t{cutoff_.by_spacing});
    out.put(waiting_.size());
    for (const Waiting& frame : waiting_) {
        out.put(frame.time);
        out.put(frame.x);
        out.put(frame.y);
        if (!frame.kind.empty())
            out.put(std::vector<double>(frame.kind.begin(), frame.kind.end()));
    }
    out.put(blocks_.size());
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const OrderBlock& block = blocks_[b];
        for (const auto* sums : {&block.pairs, &block.order_pairs, &block.order, &block.fine_order})
            out.put(*sums);
        if (layout_.window) {
            out.put(block.weighted);
            out.put(block.at_border);
        }
        if (!block.kind_pairs.empty()) {
            out.put(block.kind_pairs);
            out.put(block.kind_pairs_in_all);
        }
        for (const double value : {block.psi6, block.local, block.neighbours, block.frames, block_number_[b]})
            out.put(value);
    }
}

void OrderAccumulator::load(StateReader& in) {
    cutoff_.value = in.get();
    cutoff_.by_spacing = in.count() != 0;
    waiting_.clear();
    blocks_.clear();
    block_number_.clear();
    const std::size_t kind_pairs = pairs_of_kinds(layout_);
    for (std::size_t left = in.count(); left > 0; --left) {
        const double time = in.get();
        std::vector<double> x = in.array(layout_.beads);
        waiting_.push_back({time, std::move(x), in.array(layout_.beads), {}});
        if (kind_pairs > 0)
            for (const double kind : in.array(layout_.beads))
                waiting_.back().kind.push_back(static_cast<std::uint8_t>(kind));
    }
    const std::size_t bins = bins_of_g(layout_, options_), order_bins = bins / bins_of_order_bin(options_);
    for (std::size_t left = in.count(); left > 0; --left) {
        OrderBlock block{in.array(bins), in.array(order_bins), in.array(order_bins), in.array(bins)};
        if (layout_.window) {
            block.weighted = in.array(bins);
            block.at_border = in.get();
        }
        if (kind_pairs > 0) {
            block.kind_pairs = in.array(kind_pairs * bins);
            block.kind_pairs_in_all = in.array(kind_pairs);
        }
        for (double* value : {&block.psi6, &block.local, &block.neighbours, &block.frames})
            *value = in.get();
        block.full_frames = block.frames;
        blocks_.push_back(std::move(block));
        block_number_.push_back(in.get());
    }
}

} // namespace rodwake::measure
