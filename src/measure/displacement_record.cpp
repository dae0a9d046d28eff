#include "displacement_impl.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::measure {

namespace {

constexpr std::size_t least_beads = 50;
constexpr double default_far = 0.3, largest_far = 0.5; // of the box

void want(bool good, const std::string& what) {
    if (!good)
        throw InputError("measure: displacement: " + what);
}

const DisplacementKeys& checked(const Layout& layout, const DisplacementKeys& keys) {
    validate(layout);
    want(layout.beads >= least_beads, fmt::format("{} beads: needs at least {}", layout.beads, least_beads));
    want(keys.rod < layout.rods,
         fmt::format("rod = {}: there are {} rods, counted from 0", keys.rod, layout.rods));
    want(keys.far_from >= 0.0 && keys.far_from <= largest_far * layout.box,
         fmt::format("far_from = {:g} m: must be 0 (30 % of the box) or up to half of the box, {:g} m",
                     keys.far_from, largest_far * layout.box));
    want(std::isfinite(keys.block) && keys.block > 0.0,
         fmt::format("block = {:g} s: must be finite and above 0", keys.block));
    want(std::isfinite(keys.from), fmt::format("from = {:g} s: must be finite", keys.from));
    return keys;
}

DisplacementRecord::Impl::Sums sums_for(const Layout& layout, DisplacementKeys keys, double far_from) {
    keys.far_from = far_from;
    if (keys.method == DisplacementMethod::lagrangian)
        return LagrangianRecord(layout, keys);
    return PhaseRecord(layout, keys);
}

} // namespace

const char* to_string(DisplacementMethod method) {
    switch (method) {
    case DisplacementMethod::lagrangian:
        return "lagrangian";
    case DisplacementMethod::density:
        return "density";
    default:
        return "phase";
    }
}

DisplacementRecord::Impl::Impl(const Layout& layout_in, const DisplacementKeys& keys_in)
    : layout(layout_in), keys(checked(layout_in, keys_in)),
      far_from(keys.far_from > 0.0 ? keys.far_from : default_far * layout.box),
      sums(sums_for(layout, keys, far_from)) {}

void DisplacementRecord::Impl::add(const Frame& frame) {
    check_frame(layout, frame);
    if (frame.time < keys.from)
        return;
    if (auto* phase = std::get_if<PhaseRecord>(&sums)) {
        if (!phase->add(frame))
            return;
    } else {
        std::get<LagrangianRecord>(sums).add(frame);
    }
    follow(frame);
}

void DisplacementRecord::Impl::follow(const Frame& frame) {
    const RodPlace& now = frame.rods[keys.rod];
    if (frames > 0) {
        const double heading = last.heading + 0.5 * std::remainder(now.heading - last.heading, 2.0 * M_PI);
        path += std::cos(heading) * (now.x - last.x) + std::sin(heading) * (now.y - last.y);
        duration += frame.time - last_time;
    }
    last = now;
    last_time = frame.time;
    ++frames;
}

DisplacementRecord::DisplacementRecord(const Layout& layout, const DisplacementKeys& keys)
    : impl_(std::make_unique<Impl>(layout, keys)) {}
DisplacementRecord::~DisplacementRecord() = default;
DisplacementRecord::DisplacementRecord(const DisplacementRecord& other)
    : impl_(std::make_unique<Impl>(*other.impl_)) {}
DisplacementRecord& DisplacementRecord::operator=(const DisplacementRecord& other) {
    if (this != &other)
        impl_ = std::make_unique<Impl>(*other.impl_);
    return *this;
}
DisplacementRecord::DisplacementRecord(DisplacementRecord&&) noexcept = default;
DisplacementRecord& DisplacementRecord::operator=(DisplacementRecord&&) noexcept = default;

void DisplacementRecord::add(const Frame& frame) { impl_->add(frame); }
const Layout& DisplacementRecord::layout() const { return impl_->layout; }
const DisplacementKeys& DisplacementRecord::keys() const { return impl_->keys; }

void DisplacementRecord::pack(Packer& out) const {
    out.put(impl_->frames);
    for (const double value :
         {impl_->path, impl_->duration, impl_->last_time, impl_->last.x, impl_->last.y, impl_->last.heading})
        out.put(value);
    std::visit([&](const auto& sums) { sums.pack(out); }, impl_->sums);
}

void DisplacementRecord::unpack(Unpacker& in) {
    impl_->frames = in.count();
    for (double* value : {&impl_->path, &impl_->duration, &impl_->last_time, &impl_->last.x, &impl_->last.y,
                          &impl_->last.heading})
        *value = in.get();
    std::visit([&](auto& sums) { sums.unpack(in); }, impl_->sums);
}

} // namespace rodwake::measure
