#include "displacement_impl.hpp"

namespace rodwake::measure {

namespace {

Phases referenced(const Phases& waves, const Phases& reference) {
    return {times(waves[0], reference[0]), times(waves[1], reference[1]), times(waves[2], reference[2])};
}

} // namespace

PhaseAccumulator::PhaseAccumulator(const Layout& layout, const DisplacementOptions& options)
    : layout_(layout), options_(options), grid_(box_seen_by(options.rod, layout), options.spacing),
      blocks_(grid_.bins(), channels, options.block), waves_(layout.beads) {}

bool PhaseAccumulator::add(const Frame& frame) {
    if (!peaks_)
        peaks_ = find_peaks(frame.x, frame.y, layout_.box);
    for (std::size_t i = 0; i < layout_.beads; ++i)
        waves_[i] = plane_waves(peaks_->G, frame.x[i], frame.y[i]);
    const auto reference = far_phases(frame);
    if (!reference)
        return false;
    const RodPlace& place = frame.rods[options_.rod];
    const RodView rod(place, layout_.box);
    BlockSums& block = blocks_.at(frame.time, place.heading);
    const auto turned = seen_along(peaks_->G, block.first_heading);
    for (std::size_t i = 0; i < layout_.beads; ++i) {
        const Seen now = rod.at(frame.x[i], frame.y[i]);
        if (options_.method == DisplacementMethod::density)
            count(now, plane_waves(turned, now.x, now.y), block);
        else
            count(now, referenced(waves_[i], *reference), block);
    }
    return true;
}

/// Unit numbers to multiply by, so that the far field's mean phases become 0.
std::optional<Phases> PhaseAccumulator::far_phases(const Frame& frame) const {
    const FarField far(frame, layout_.box, options_.far_from);
    Phases sum{};
    for (std::size_t i = 0; i < layout_.beads; ++i)
        if (far.has(frame.x[i], frame.y[i]))
            for (std::size_t k = 0; k < 3; ++k)
                sum[k] += waves_[i][k];
    for (auto& phase : sum) {
        if (phase == 0.0)
            return std::nullopt;
        phase = std::conj(phase) / std::abs(phase);
    }
    return sum;
}

void PhaseAccumulator::count(const Seen& now, const Phases& waves, BlockSums& block) const {
    const auto bin = grid_.bin(now.x, now.y);
    if (!bin)
        return;
    double* sums = block.sums.data() + *bin * channels;
    for (std::size_t k = 0; k < 3; ++k) {
        sums[2 * k] += waves[k].real();
        sums[2 * k + 1] += waves[k].imag();
    }
    sums[beads] += 1.0;
    sums[place_x] += nearest_image_once(now.x - grid_.x_of(*bin), grid_.box.x);
    sums[place_y] += nearest_image_once(now.y - grid_.y_of(*bin), grid_.box.y);
}

void PhaseAccumulator::save(StateWriter& out) const {
    measure::save(out, peaks_);
    blocks_.save(out);
}

void PhaseAccumulator::load(StateReader& in) {
    peaks_ = load_peaks(in);
    blocks_.load(in);
}

void save(StateWriter& out, const std::optional<BraggPeaks>& peaks) {
    out.put(std::size_t{peaks ? 1U : 0U});
    if (!peaks)
        return;
    for (std::size_t k = 0; k < 3; ++k)
        for (const double value : {static_cast<double>(peaks->m[k]), static_cast<double>(peaks->n[k]),
                                   peaks->G[k].x, peaks->G[k].y, peaks->strength[k]})
            out.put(value);
    out.put(peaks->liquid_strength);
}

std::optional<BraggPeaks> load_peaks(StateReader& in) {
    if (in.count() == 0)
        return std::nullopt;
    BraggPeaks peaks;
    for (std::size_t k = 0; k < 3; ++k) {
        peaks.m[k] = static_cast<int>(in.get());
        peaks.n[k] = static_cast<int>(in.get());
        peaks.G[k] = {in.get(), in.get()};
        peaks.strength[k] = in.get();
    }
    peaks.liquid_strength = in.get();
    return peaks;
}

} // namespace rodwake::measure
