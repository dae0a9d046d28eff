#include "lagrangian_record.hpp"

#include <numeric>

namespace rodwake::measure {

namespace {

constexpr double zone_begin = 0.3, zone_end = 0.45, first_zone_begin = 0.15; // of the box, ahead of the rod

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

} // namespace

LagrangianRecord::LagrangianRecord(const Layout& layout, const DisplacementKeys& keys)
    : layout_(layout), keys_(keys), grid_(layout.box, keys.spacing),
      blocks_(grid_.bins(), channels, keys.block) {}

void LagrangianRecord::add(const Frame& frame) {
    const RodPlace& place = frame.rods[keys_.rod];
    const RodView rod(place, layout_.box);
    if (samples_.empty())
        start(frame, rod);
    drift_x_ = mean(frame.free_x) - first_x_;
    drift_y_ = mean(frame.free_y) - first_y_;
    double* sums = blocks_.at(frame.time, place.heading).sums.data();
    for (std::size_t i = 0; i < layout_.beads; ++i) {
        note_zone(i, frame, rod.at(frame.x[i], frame.y[i]));
        if (samples_[i] > 0.0)
            count(i, frame, rod, sums);
    }
}

void LagrangianRecord::start(const Frame& frame, const RodView& rod) {
    first_x_ = mean(frame.free_x);
    first_y_ = mean(frame.free_y);
    samples_.assign(layout_.beads, 0.0);
    in_zone_.assign(layout_.beads, 0.0);
    place_x_ = frame.free_x;
    place_y_ = frame.free_y;
    for (std::size_t i = 0; i < layout_.beads; ++i) {
        const double ahead = rod.at(frame.x[i], frame.y[i]).x / layout_.box;
        samples_[i] = ahead > first_zone_begin && ahead < zone_end ? 1.0 : 0.0;
    }
}

void LagrangianRecord::note_zone(std::size_t bead, const Frame& frame, const Seen& now) {
    const double ahead = now.x / layout_.box;
    if (!(ahead > zone_begin && ahead < zone_end)) {
        in_zone_[bead] = 0.0;
        return;
    }
    if (in_zone_[bead] == 0.0)
        place_x_[bead] = place_y_[bead] = samples_[bead] = 0.0;
    in_zone_[bead] = 1.0;
    place_x_[bead] += frame.free_x[bead] - drift_x_;
    place_y_[bead] += frame.free_y[bead] - drift_y_;
    samples_[bead] += 1.0;
}

void LagrangianRecord::count(std::size_t bead, const Frame& frame, const RodView& rod, double* sums) {
    const double dx = frame.free_x[bead] - drift_x_ - place_x_[bead] / samples_[bead];
    const double dy = frame.free_y[bead] - drift_y_ - place_y_[bead] / samples_[bead];
    const auto inside = [&](double place) { return place - layout_.box * std::floor(place / layout_.box); };
    const Seen before = rod.at(inside(frame.x[bead] - dx), inside(frame.y[bead] - dy));
    const auto bin = grid_.bin(before.x, before.y);
    if (!bin)
        return;
    const Seen moved = rod.turned(dx, dy);
    double* sum = sums + *bin * channels;
    sum[along] += moved.x;
    sum[across] += moved.y;
    sum[beads] += 1.0;
    sum[place_x] += nearest_step(before.x - grid_.middle(*bin % grid_.n), layout_.box);
    sum[place_y] += nearest_step(before.y - grid_.middle(*bin / grid_.n), layout_.box);
}

void LagrangianRecord::pack(Packer& out) const {
    for (const auto* values : {&place_x_, &place_y_, &samples_, &in_zone_})
        out.put(std::span<const double>(*values));
    for (const double value : {first_x_, first_y_, drift_x_, drift_y_})
        out.put(value);
    blocks_.pack(out);
}

void LagrangianRecord::unpack(Unpacker& in) {
    place_x_ = in.array();
    const std::size_t beads_known = place_x_.size(); // none before the first frame
    for (auto* values : {&place_y_, &samples_, &in_zone_})
        *values = in.array(beads_known);
    for (double* value : {&first_x_, &first_y_, &drift_x_, &drift_y_})
        *value = in.get();
    blocks_.unpack(in);
}

} // namespace rodwake::measure
