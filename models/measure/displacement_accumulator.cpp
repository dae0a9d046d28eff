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

const DisplacementOptions& checked(const Layout& layout, const DisplacementOptions& options) {
    validate(layout);
    want(layout.beads >= least_beads, fmt::format("{} beads: needs at least {}", layout.beads, least_beads));
    want(options.rod < layout.rods,
         fmt::format("rod = {}: there are {} rods, counted from 0", options.rod, layout.rods));
    want(options.far_from >= 0.0 && options.far_from <= largest_far * layout.box.shorter(),
         fmt::format("far_from = {:g} m: must be 0 (30 % of the box) or up to half of the box, {:g} m",
                     options.far_from, largest_far * layout.box.shorter()));
    want(std::isfinite(options.block) && options.block > 0.0,
         fmt::format("block = {:g} s: must be finite and above 0", options.block));
    want(std::isfinite(options.from), fmt::format("from = {:g} s: must be finite", options.from));
    return options;
}

EstimatorSums sums_for(const Layout& layout, DisplacementOptions options, double far_from) {
    options.far_from = far_from;
    if (options.method == DisplacementMethod::lagrangian)
        return LagrangianAccumulator(layout, options);
    return PhaseAccumulator(layout, options);
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

DisplacementAccumulator::Impl::Impl(const Layout& layout_in, const DisplacementOptions& options_in)
    : layout(layout_in), options(checked(layout_in, options_in)),
      far_from(options.far_from > 0.0 ? options.far_from : default_far * layout.box.shorter()),
      sums(sums_for(layout, options, far_from)) {}

void DisplacementAccumulator::Impl::add(const Frame& frame) {
    check_frame(layout, frame);
    if (frame.time < options.from)
        return;
    if (auto* phase = std::get_if<PhaseAccumulator>(&sums)) {
        if (!phase->add(frame))
            return;
    } else {
        std::get<LagrangianAccumulator>(sums).add(frame);
    }
    follow(frame);
}

void DisplacementAccumulator::Impl::follow(const Frame& frame) {
    const RodPlace& now = frame.rods[options.rod];
    if (frames > 0) {
        const double heading = last.heading + 0.5 * std::remainder(now.heading - last.heading, 2.0 * M_PI);
        path += std::cos(heading) * (now.x - last.x) + std::sin(heading) * (now.y - last.y);
        duration += frame.time - last_time;
    }
    last = now;
    last_time = frame.time;
    ++frames;
}

DisplacementAccumulator::DisplacementAccumulator(const Layout& layout, const DisplacementOptions& options)
    : impl_(std::make_unique<Impl>(layout, options)) {}
DisplacementAccumulator::~DisplacementAccumulator() = default;
DisplacementAccumulator::DisplacementAccumulator(const DisplacementAccumulator& other)
    : impl_(std::make_unique<Impl>(*other.impl_)) {}
DisplacementAccumulator& DisplacementAccumulator::operator=(const DisplacementAccumulator& other) {
    if (this != &other)
        impl_ = std::make_unique<Impl>(*other.impl_);
    return *this;
}
DisplacementAccumulator::DisplacementAccumulator(DisplacementAccumulator&&) noexcept = default;
DisplacementAccumulator& DisplacementAccumulator::operator=(DisplacementAccumulator&&) noexcept = default;

void DisplacementAccumulator::add(const Frame& frame) { impl_->add(frame); }
const Layout& DisplacementAccumulator::layout() const { return impl_->layout; }
const DisplacementOptions& DisplacementAccumulator::options() const { return impl_->options; }

void DisplacementAccumulator::save(StateWriter& out) const {
    out.put(impl_->frames);
    for (const double value :
         {impl_->path, impl_->duration, impl_->last_time, impl_->last.x, impl_->last.y, impl_->last.heading})
        out.put(value);
    std::visit([&](const auto& sums) { sums.save(out); }, impl_->sums);
}

void DisplacementAccumulator::load(StateReader& in) {
    impl_->frames = in.count();
    for (double* value : {&impl_->path, &impl_->duration, &impl_->last_time, &impl_->last.x, &impl_->last.y,
                          &impl_->last.heading})
        *value = in.get();
    std::visit([&](auto& sums) { sums.load(in); }, impl_->sums);
}

} // namespace rodwake::measure
