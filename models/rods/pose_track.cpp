#include "pose_track.hpp"

#include <utility>

namespace rodwake::rods {

PoseTrack::PoseTrack(Formulation form, std::vector<double> headings, std::span<const double> output_times)
    : form_(form), output_times_(output_times), headings_(std::move(headings)) {}

integrate::Step PoseTrack::step(const integrate::Step& raw) {
    if (form_ == Formulation::angle)
        return raw;
    before_ = poses(raw.state_before);
    after_ = poses(raw.state);
    for (std::size_t a = 0; a < headings_.size(); ++a)
        headings_[a] = after_[3 * a + 2];
    while (at_outputs_.size() < output_times_.size() && output_times_[at_outputs_.size()] <= raw.time)
        at_outputs_.push_back(headings_);
    return {raw.time_before, raw.time, before_, after_};
}

std::vector<std::vector<double>> PoseTrack::outputs(std::span<const std::vector<double>> raw) const {
    std::vector<std::vector<double>> outputs;
    outputs.reserve(raw.size());
    for (std::size_t k = 0; k < raw.size(); ++k)
        outputs.push_back(to_poses(form_, raw[k], k < at_outputs_.size() ? at_outputs_[k] : headings_));
    return outputs;
}

} // namespace rodwake::rods
