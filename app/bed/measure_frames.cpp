#include "measure_frames.hpp"

#include "rodwake/core/error.hpp"
#include "rodwake/granular/bead_kinds.hpp"
#include "rodwake/granular/problem.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/frames.hpp"
#include "rodwake/store/h5md_reader.hpp"
#include "rodwake/store/journal.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rodwake::app {

namespace {

double unwrapped(double position, std::int32_t image, double box) {
    return std::fma(static_cast<double>(image), box, position); // undoes store::wrap
}

double unwrapped(double x, double box) {
    const store::PeriodicCoordinate w = store::wrap(x, box);
    return unwrapped(w.place, w.image, box);
}

void resize(measure::Frame& frame, std::size_t beads, std::size_t rods) {
    for (auto* column : {&frame.x, &frame.y, &frame.unwrapped_x, &frame.unwrapped_y, &frame.vx, &frame.vy})
        column->resize(beads);
    frame.rods.resize(rods);
}

void want_equal(const std::filesystem::path& file, const char* what, double found, double wanted) {
    if (!(std::abs(found - wanted) <= 1e-9 * std::abs(wanted)))
        throw InputError(
            fmt::format("{}: {} is {:g} there and {:g} in the scene: a trajectory of another bed",
                        file.string(), what, found, wanted));
}

void check_bed(const std::filesystem::path& file, const store::TrajectoryInfo& info,
               const measure::Layout& layout) {
    want_equal(file, "the side of the box along x in m", info.box[0], layout.box.x);
    want_equal(file, "the side of the box along y in m", info.box[1], layout.box.y);
    want_equal(file, "the bead radius in m", info.bead_radius, layout.bead_radius);
    if (info.periodic == layout.window.has_value())
        throw InputError(fmt::format("{}: {} there and {} in the scene: a trajectory of another bed",
                                     file.string(), info.periodic ? "a periodic box" : "a wall",
                                     layout.window ? "a wall" : "a periodic box"));
    if (info.rods != layout.rods)
        throw InputError(fmt::format("{}: {} rods there and {} in the scene: a trajectory of another bed",
                                     file.string(), info.rods, layout.rods));
}

/// The same bed, all its beads among the frames, of the same sizes.
void check_all(const std::filesystem::path& file, const store::TrajectoryInfo& info,
               const MeasurePlan& plan) {
    const measure::Layout& layout = plan.sums.layout();
    check_bed(file, info, layout);
    if (info.beads < layout.beads)
        throw InputError(
            fmt::format("{}: frames hold {} beads, the scene has {}; they are of another bed, or of one with "
                        "granular.output.every_bead above 1: then measure while it runs (rodwake run, or dem "
                        "with [measure])",
                        file.string(), info.beads, layout.beads));
    want_equal(file, "the number of beads", static_cast<double>(info.beads),
               static_cast<double>(layout.beads));
    if (!plan.mix)
        return;
    granular::BeadSizes sizes{info.radius, {}};
    std::vector<std::size_t> counts(plan.kind_counts.size());
    for (const double radius : info.radius) {
        const std::size_t kind = plan.mix->nearest(radius);
        sizes.kind.push_back(static_cast<std::uint8_t>(kind));
        if (!counts.empty())
            ++counts[kind];
    }
    granular::require_sizes(*plan.mix, sizes, (file.string() + ":").c_str());
    if (counts != plan.kind_counts)
        throw InputError(fmt::format(
            "{}: beads of the kinds of [[granular.bead_kinds]] number {} there and {} in the scene: "
            "a trajectory of another bed",
            file.string(), fmt::join(counts, ", "), fmt::join(plan.kind_counts, ", ")));
}

/// Every how many stored frames are measured.
std::size_t stride_of(const std::filesystem::path& file, const store::TrajectoryInfo& info,
                      const MeasurePlan& plan) {
    if (info.frames() < 2)
        return 1;
    const double stored = (info.time.back() - info.time.front()) / static_cast<double>(info.frames() - 1);
    const double ratio = plan.interval / stored;
    if (ratio < 0.999 || std::abs(ratio - std::round(ratio)) > 1e-4 * ratio)
        throw InputError(fmt::format(
            "{}: frames are {:g} s apart; measure.{} = {:g} s is no whole multiple of that", file.string(),
            stored, plan.stride > 1 ? "phonon_interval" : "interval", plan.interval));
    return static_cast<std::size_t>(std::round(ratio));
}

void fill_frame(measure::Frame& frame, const store::StoredFrame& stored, const PeriodicBox& box) {
    const std::size_t beads = stored.x.size();
    resize(frame, beads, stored.rods.size());
    frame.time = stored.time;
    frame.x = stored.x;
    frame.y = stored.y;
    frame.vx = stored.vx;
    frame.vy = stored.vy;
    for (std::size_t i = 0; i < beads; ++i) {
        frame.unwrapped_x[i] = unwrapped(stored.x[i], stored.image_x[i], box.x);
        frame.unwrapped_y[i] = unwrapped(stored.y[i], stored.image_y[i], box.y);
    }
    for (std::size_t r = 0; r < stored.rods.size(); ++r) {
        const store::StoredRod& rod = stored.rods[r];
        const auto& q = rod.orientation;
        granular::RodBody body;
        body.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
        frame.rods[r] = {unwrapped(rod.x, rod.image_x, box.x), unwrapped(rod.y, rod.image_y, box.y),
                         body.heading()};
    }
}

} // namespace

void fill_frame(measure::Frame& frame, const granular::State& state, double time, const PeriodicBox& box,
                const measure::Layout& layout) {
    const granular::Beads& beads = state.beads;
    resize(frame, beads.size(), state.rods.size());
    frame.time = time;
    for (std::size_t i = 0; i < beads.size(); ++i) {
        const store::PeriodicCoordinate x = store::wrap(beads.x[i], box.x),
                                        y = store::wrap(beads.y[i], box.y);
        frame.x[i] = x.place;
        frame.y[i] = y.place;
        frame.unwrapped_x[i] = unwrapped(x.place, x.image, box.x);
        frame.unwrapped_y[i] = unwrapped(y.place, y.image, box.y);
        frame.vx[i] = beads.vx[i];
        frame.vy[i] = beads.vy[i];
    }
    frame.kind = measure::kinds_of(beads.radius, layout);
    for (std::size_t r = 0; r < state.rods.size(); ++r) {
        const granular::RodBody& rod = state.rods[r];
        frame.rods[r] = {unwrapped(rod.position.x(), box.x), unwrapped(rod.position.y(), box.y),
                         rod.heading()};
    }
}

void for_each_frame(const std::filesystem::path& file, const measure::Layout& layout, std::size_t stride,
                    const std::function<bool(const measure::Frame&, double)>& use) {
    store::H5mdReader reader(file);
    check_bed(file, reader.info(), layout);
    store::StoredFrame stored;
    measure::Frame frame;
    frame.kind = measure::kinds_of(reader.info().radius, layout);
    const std::size_t frames = reader.info().frames();
    for (std::size_t i = 0; i < frames; i += stride) {
        reader.read(i, stored);
        fill_frame(frame, stored, layout.box);
        if (!use(frame, static_cast<double>(i + 1) / static_cast<double>(frames)))
            return;
    }
}

void check_trajectory(const std::filesystem::path& file, const MeasurePlan& plan) {
    const store::H5mdReader reader(file);
    check_all(file, reader.info(), plan);
    stride_of(file, reader.info(), plan);
}

std::string why_no_frames(const measure::Measures& measures) {
    if (measures.from_travel() > 0.0)
        return fmt::format("no frame to measure: the rod travels less than measure.from = {:g} a; run longer "
                           "(granular.duration), or make measure.from shorter",
                           measures.from_travel() / measures.layout().bead_radius);
    return fmt::format(
        "no frame {}to measure from measure.from = {:g} s on; {}, or make measure.from shorter",
        measures.layout().velocities ? "" : "with beads ", measures.from(),
        measures.layout().velocities ? "run longer (granular.duration)" : "film longer");
}

std::optional<measure::Measures> measure_trajectory(const std::filesystem::path& file,
                                                    const MeasurePlan& plan,
                                                    const std::function<bool(double)>& on_progress) {
    const store::TrajectoryInfo info = store::H5mdReader(file).info();
    check_all(file, info, plan);
    measure::Measures measures = plan.sums;
    bool stopped = false;
    for_each_frame(file, plan.sums.layout(), stride_of(file, info, plan),
                   [&](const measure::Frame& frame, double part) {
                       measures.add(frame);
                       stopped = !on_progress(part);
                       return !stopped;
                   });
    if (stopped)
        return std::nullopt;
    if (measures.frames() == 0)
        throw InputError(fmt::format("{}: {}; the last frame is at {:g} s", file.string(),
                                     why_no_frames(measures), info.time.back()));
    return measures;
}

/// The number is counted up when what an accumulator saves changes.
static std::string record_key(const MeasurePlan& plan) { return "measures 4\n" + plan.key_text; }

void write_records(const std::filesystem::path& file, const MeasurePlan& plan,
                   const measure::Measures& measures) {
    store::write_atomically(file, store::journal_of(record_key(plan), measures.save()));
}

std::optional<measure::Measures> read_records(const std::filesystem::path& file, const MeasurePlan& plan) {
    if (!std::filesystem::exists(file))
        return std::nullopt;
    store::Journal records(file);
    if (records.key() != record_key(plan))
        return std::nullopt;
    measure::Measures measures = plan.sums;
    measures.load(records.value<std::vector<double>>(), file.string());
    return measures;
}

} // namespace rodwake::app
