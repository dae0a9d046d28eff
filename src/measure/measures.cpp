#include "rodwake/measure/measures.hpp"

namespace rodwake::measure {

Measures::Measures(const Layout& layout, const MeasureKeys& keys) : layout_(layout), keys_(keys) {
    validate(layout);
    if (keys.structure)
        structure_.emplace(layout, *keys.structure);
    if (keys.microrheology)
        microrheology_.emplace(layout, *keys.microrheology);
    if (keys.flow)
        flow_.emplace(layout, *keys.flow);
    if (keys.displacement)
        displacement_.emplace(layout, *keys.displacement);
}

void Measures::add(const Frame& frame) {
    check_frame(layout_, frame);
    if (frame.time < keys_.from)
        return;
    if (structure_ && frames_ % keys_.structure_every == 0)
        structure_->add(frame);
    if (microrheology_)
        microrheology_->add(frame);
    if (flow_)
        flow_->add(frame);
    if (displacement_)
        displacement_->add(frame);
    ++frames_;
}

std::vector<double> Measures::pack() const {
    Packer out;
    out.put(frames_);
    if (structure_)
        structure_->pack(out);
    if (microrheology_)
        microrheology_->pack(out);
    if (flow_)
        flow_->pack(out);
    if (displacement_)
        displacement_->pack(out);
    return out.take();
}

void Measures::unpack(std::span<const double> values, const std::string& what) {
    Unpacker in(values, what);
    frames_ = in.count();
    if (structure_)
        structure_->unpack(in);
    if (microrheology_)
        microrheology_->unpack(in);
    if (flow_)
        flow_->unpack(in);
    if (displacement_)
        displacement_->unpack(in);
    in.finish();
}

} // namespace rodwake::measure
