#include "rodwake/measure/displacement.hpp"
#include "displacement_impl.hpp"
#include "estimators.hpp"
#include "regrid.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr int reference_rounds = 3;

std::vector<bool> known(const DisplacementField& field) {
    std::vector<bool> result(field.count.size());
    for (std::size_t j = 0; j < result.size(); ++j)
        result[j] = field.count[j] > 0.0;
    return result;
}

void fill_gaps(DisplacementField& field) {
    const auto measured = known(field);
    if (std::ranges::find(measured, true) == measured.end())
        throw InputError("measure: displacement: no bead came into any bin of the grid");
    fill_in(field.Ux, measured, field.grid.columns);
    fill_in(field.Uy, measured, field.grid.columns);
}

/// Where a displaced sample was depends on what counts as no displacement, so the two are found together.
void place(const BinSamples& samples, double far_from, DisplacementField& field) {
    const bool displaced = field.method != DisplacementMethod::lagrangian;
    std::vector<Vector2> undisplaced = samples.place;
    for (int round = 0; round < reference_rounds; ++round) {
        if (displaced)
            for (std::size_t j = 0; j < undisplaced.size(); ++j)
                undisplaced[j] = {samples.place[j].x - samples.value[j].x + field.offset.x,
                                  samples.place[j].y - samples.value[j].y + field.offset.y};
        regrid(samples, undisplaced, field);
        fill_gaps(field);
        // The offset is the mean of the filled field over the reference.
        const RodGrid& grid = field.grid;
        const double inside = std::min(0.5 * grid.width * static_cast<double>(grid.columns),
                                       0.5 * grid.height * static_cast<double>(grid.rows)); // at any heading
        Vector2 sum;
        double total = 0.0;
        for (std::size_t j = 0; j < grid.bins(); ++j) {
            const double r = std::hypot(grid.x_of(j), grid.y_of(j));
            const bool counts = field.reference == Reference::far ? field.count[j] > 0.0 && r > far_from
                                                                  : field.count[j] > 0.0 || r < inside;
            if (!counts)
                continue;
            sum.x += field.Ux[j];
            sum.y += field.Uy[j];
            total += 1.0;
        }
        field.offset = total > 0.0 ? Vector2{sum.x / total, sum.y / total} : Vector2{};
    }
    for (double& u : field.Ux)
        u -= field.offset.x;
    for (double& u : field.Uy)
        u -= field.offset.y;
}

struct Pair {
    double value, sigma;
};

Pair mean_of(double u, double v, double su, double sv, double cu, double cv) {
    return {(cu * u + cv * v) / (cu + cv), std::hypot(cu * su, cv * sv) / (cu + cv)};
}

/// The mean of the field and its mirror image; on the axis U_y is 0 and sigma stays as it is.
DisplacementField with_mirror_image(const DisplacementField& field) {
    DisplacementField mean = field;
    for (std::size_t j = 0; j < field.grid.bins(); ++j) {
        const std::size_t k =
            (field.grid.rows - j / field.grid.columns) % field.grid.rows * field.grid.columns +
            j % field.grid.columns;
        if (field.count[j] + field.count[k] == 0.0)
            continue;
        const auto x = mean_of(field.Ux[j], field.Ux[k], field.sigma_x[j], field.sigma_x[k], field.count[j],
                               field.count[k]);
        const auto y = mean_of(field.Uy[j], -field.Uy[k], field.sigma_y[j], field.sigma_y[k], field.count[j],
                               field.count[k]);
        mean.Ux[j] = x.value;
        mean.Uy[j] = y.value;
        if (j == k)
            continue;
        mean.sigma_x[j] = x.sigma;
        mean.sigma_y[j] = y.sigma;
        mean.count[j] = field.count[j] + field.count[k];
        mean.coherence[j] =
            (field.count[j] * field.coherence[j] + field.count[k] * field.coherence[k]) / mean.count[j];
    }
    fill_gaps(mean);
    return mean;
}

double scatter(const std::vector<double>& values, const std::vector<bool>& measured) {
    double sum = 0.0, squares = 0.0, count = 0.0;
    for (std::size_t j = 0; j < values.size(); ++j)
        if (measured[j]) {
            sum += values[j];
            squares += values[j] * values[j];
            count += 1.0;
        }
    return std::sqrt(std::max(squares / count - sum * sum / (count * count), 0.0));
}

} // namespace

DisplacementField reduce(std::span<const DisplacementAccumulator> given) {
    const bool same = std::ranges::all_of(given, [&](const DisplacementAccumulator& run) {
        return run.layout() == given[0].layout() && run.options() == given[0].options();
    });
    if (!same)
        throw InputError(
            "measure: displacement: accumulators of different beds or options cannot be put together");
    if (std::ranges::none_of(
            given, [](const DisplacementAccumulator& run) { return DisplacementSums::of(run).frames > 0; }))
        throw InputError(
            "measure: displacement: there are no frames to measure, or none has a bead farther than "
            "far_from from every rod; lengthen the runs or lower `from` or `far_from`");
    std::vector<DisplacementAccumulator> complete;
    if (given[0].layout().window) {
        // Frames that wait for the end of a block of time are added.
        complete.assign(given.begin(), given.end());
        for (DisplacementAccumulator& run : complete)
            DisplacementSums::finish(run);
    }
    const auto runs = complete.empty() ? given : std::span<const DisplacementAccumulator>(complete);
    const DisplacementOptions& options = runs[0].options();
    DisplacementField field;
    field.grid = grid_of(runs[0]);
    field.method = options.method;
    field.reference = runs[0].layout().window ? Reference::far : options.reference; // a window has no mean
    double path = 0.0, duration = 0.0;
    for (const DisplacementAccumulator& run : runs) {
        const auto& impl = DisplacementSums::of(run);
        field.frames += impl.frames;
        path += impl.path;
        duration += impl.duration;
        std::visit(
            [&](const auto& sums) { // Parts of one block that differ in the rod's heading count once.
                const std::span<const BlockSums> parts = sums.blocks();
                std::size_t count = 0;
                for (std::size_t b = 0; b < parts.size(); ++b)
                    count += b == 0 || parts[b].number != parts[b - 1].number;
                field.blocks += count;
            },
            impl.sums);
        if (const auto* phase = std::get_if<PhaseAccumulator>(&impl.sums);
            phase && phase->peaks() && field.peaks.m[0] == 0 && field.peaks.n[0] == 0)
            field.peaks = *phase->peaks();
    }
    field.mean_speed = duration > 0.0 ? path / duration : 0.0;
    const BinSamples samples =
        options.method == DisplacementMethod::lagrangian ? lagrangian_samples(runs) : phase_samples(runs);
    field.block_correlation = samples.block_correlation;
    place(samples, DisplacementSums::of(runs[0]).far_from, field);
    if (options.mirror)
        field = with_mirror_image(field);
    // One block tells no error, nor do two frames of a film; a bin without data may be anything that the
    // field is elsewhere.
    const bool is_film = !runs[0].layout().velocities;
    const auto measured = known(field);
    const bool tells = field.blocks > 1 && !(is_film && field.frames < 3);
    const double sx = tells ? scatter(field.Ux, measured) : unknown_error,
                 sy = tells ? scatter(field.Uy, measured) : unknown_error;
    for (std::size_t j = 0; j < field.grid.bins(); ++j)
        if (!measured[j] || !tells) {
            field.sigma_x[j] = sx;
            field.sigma_y[j] = sy;
        }
    return field;
}

Profile profile(const DisplacementField& field, const std::string& component, const std::string& along,
                double at) {
    if (component != "Ux" && component != "Uy")
        throw InputError(fmt::format("measure: profile: component = \"{}\": must be Ux or Uy", component));
    if (along != "x" && along != "y")
        throw InputError(fmt::format("measure: profile: along = \"{}\": must be x or y", along));
    const RodGrid& grid = field.grid;
    const bool along_x = along == "x";
    const std::size_t lines = along_x ? grid.rows : grid.columns, points = along_x ? grid.columns : grid.rows;
    const auto across = [&](std::size_t k) { return along_x ? grid.y(k) : grid.x(k); };
    const std::size_t middle = lines / 2;
    const double line = std::round(at / (along_x ? grid.height : grid.width)) + static_cast<double>(middle);
    if (!(line >= 0.0 && line < static_cast<double>(lines)))
        throw InputError(fmt::format("measure: profile at {:g} m: the grid reaches from {:g} to {:g} m", at,
                                     across(0), across(lines - 1)));
    const auto& value = component == "Ux" ? field.Ux : field.Uy;
    const auto& sigma = component == "Ux" ? field.sigma_x : field.sigma_y;
    const std::size_t fixed = static_cast<std::size_t>(line);
    Profile result{component, along, across(fixed), {}, {}, {}, {}};
    for (std::size_t k = 0; k < points; ++k) {
        const std::size_t bin = along_x ? fixed * grid.columns + k : k * grid.columns + fixed;
        if (!(field.count[bin] > 0.0))
            continue;
        result.place.push_back(along_x ? grid.x(k) : grid.y(k));
        result.value.push_back(value[bin]);
        result.sigma.push_back(sigma[bin]);
        result.count.push_back(field.count[bin]);
    }
    return result;
}

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
    want(layout.force ? options.rod == 0 : options.rod < layout.rods,
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
    if (frame.time < options.from || !place_of(options.rod, layout, frame).known())
        return;
    if (auto* phase = std::get_if<PhaseAccumulator>(&sums)) {
        if (!phase->add(frame))
            return;
    } else {
        std::get<LagrangianAccumulator>(sums).add(frame);
    }

    // The path of the rod.
    const RodPosition now = place_of(options.rod, layout, frame);
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
