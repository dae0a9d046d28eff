#include "check_measure.hpp"

#include <cmath>
#include <fmt/format.h>

namespace rodwake::scene {

namespace {

using Report = std::function<void(const std::string&, const std::string&)>;

void rods(const Measure& m, const Granular& bed, const Report& report) {
    const auto count = static_cast<long>(bed.rods.size());
    const auto want_rod = [&](bool wanted, const char* key) {
        if (wanted && count == 0)
            report(std::string("measure.") + key,
                   fmt::format("{} needs [[granular.rods]]: it is seen from a rod", key));
    };
    want_rod(m.flow, "flow");
    want_rod(m.force, "force");
    want_rod(m.displacement.has_value(), "displacement");
    want_rod(m.heading_diffusion, "heading_diffusion");
    if (m.mechanics && bed.body_force && bed.body_force->kind != granular::BodyForceKind::uniform)
        report("measure.mechanics",
               "mechanics has to know all of the force on the bed: make [granular.body_force] kind = "
               "\"uniform\", or leave out it or mechanics");
    if (m.inertia_error && !m.inertia_factor)
        report("measure.inertia_error",
               "inertia_error is that of inertia_factor: give inertia_factor (1 or a little more), or leave "
               "both out");
    want_rod(m.from_travel.has_value(), "from_travel (or a distance in from)");
    if (m.pairs && count != 2)
        report("measure.pairs", fmt::format("pairs needs two [[granular.rods]]; there are {}", count));
    if (count > 0 && m.rod >= count)
        report("measure.rod",
               fmt::format("there is no rod {}: granular.rods has {} (numbered from 0)", m.rod, count));
}

/// What takes more than a few frames. Of a trajectory from elsewhere the number is not known here.
void frames(const Measure& m, double intervals, const Report& report) {
    constexpr double least = 32.0; // of microrheology
    const double count = std::floor(intervals * (1.0 + 1e-9)) + 1.0;
    if (m.microrheology && m.trajectory.empty() && count >= 1.0 && count < least)
        report(
            "measure.microrheology",
            fmt::format(
                "microrheology needs at least {:g} frames, and there are {:g}: shorten measure.interval or "
                "granular.output.frames, or run longer",
                least, count));
}

void times(const Measure& m, const Granular& bed, const Report& report) {
    const double interval = m.interval.value_or(bed.output.frames.value_or(bed.duration / 100.0));
    if (m.interval && *m.interval < time_step(bed))
        report("measure.interval",
               fmt::format("interval = {:g} s is shorter than granular.time_step = {:g} s", *m.interval,
                           time_step(bed)));
    if (m.block < interval)
        report("measure.block",
               fmt::format("block = {:g} s is shorter than the interval of {:g} s", m.block, interval));
    if (m.from >= bed.duration && m.trajectory.empty())
        report("measure.from",
               fmt::format("from = {:g} s is not before the end of the run, {:g} s: nothing would "
                           "be measured",
                           m.from, bed.duration));
    if (m.order_interval) {
        const double ratio = *m.order_interval / interval;
        if (ratio < 0.999 || std::abs(ratio - std::round(ratio)) > 1e-6 * ratio)
            report("measure.order_interval",
                   fmt::format("order_interval = {:g} s is no whole multiple of the interval "
                               "of {:g} s",
                               *m.order_interval, interval));
    }
    frames(m, (bed.duration - m.from) / interval, report);
    if (m.flow && m.flow_lag > m.block)
        report("measure.flow_lag",
               fmt::format("flow_lag = {:g} s is longer than block = {:g} s", m.flow_lag, m.block));
    if (m.bead_drag_error && !m.bead_drag)
        report("measure.bead_drag_error", "there is no bead_drag that it is the error of: give "
                                          "measure.bead_drag, or leave the error out");
    if (m.s_low && m.s_high && !(*m.s_low < *m.s_high))
        report("measure.s_high",
               fmt::format("s_high = {:g} must be above s_low = {:g}", *m.s_high, *m.s_low));
}

void currents(const Measure& m, const Granular& bed, const Report& report) {
    if (!m.phonons)
        return;
    const double interval = m.interval.value_or(bed.output.frames.value_or(bed.duration / 100.0));
    if (m.phonon_interval) {
        const double ratio = interval / *m.phonon_interval;
        if (ratio < 0.999 || std::abs(ratio - std::round(ratio)) > 1e-6 * ratio)
            report("measure.phonon_interval",
                   fmt::format("phonon_interval = {:g} s: the interval of {:g} s is no whole multiple of it",
                               *m.phonon_interval, interval));
        if (*m.phonon_interval < time_step(bed))
            report("measure.phonon_interval",
                   fmt::format("phonon_interval = {:g} s is shorter than granular.time_step = {:g} s",
                               *m.phonon_interval, time_step(bed)));
    }
    if (m.phonon_lag && 2.0 * *m.phonon_lag > m.block)
        report("measure.phonon_lag", fmt::format("phonon_lag = {:g} s is longer than half of block = {:g} s",
                                                 *m.phonon_lag, m.block));
    constexpr double usual = 5e-3, least = 6.0; // s; intervals in a lag that a fit can use
    const double fine = m.phonon_interval.value_or(std::min(usual, interval)),
                 lag = m.phonon_lag.value_or(std::min(1.0, 0.5 * m.block));
    if (lag < least * fine)
        report(
            "measure.phonon_lag",
            fmt::format("the longest lag of the currents, {:g} s, is below {:g} of their intervals of {:g} "
                        "s; choose a longer phonon_lag and block, or a shorter phonon_interval",
                        lag, least, fine));
    if (m.trajectory.empty() && bed.duration - m.from < 2.0 * m.block)
        report("measure.phonons",
               fmt::format("phonons need at least 2 blocks for their errors: {:g} s are measured and block = "
                           "{:g} s; shorten measure.block or run longer",
                           bed.duration - m.from, m.block));
}

void headings(const Measure& m, const Granular& bed, const Report& report) {
    const double measured = bed.duration - m.from, high = heading_lag_high(m, measured);
    if (m.heading_lag_high && 2.0 * high > m.block)
        report("measure.heading_lag_high",
               fmt::format("heading_lag_high = {:g} s is longer than half of block = {:g} s", high, m.block));
    if (m.heading_lag_low && *m.heading_lag_low >= high)
        report("measure.heading_lag_low",
               fmt::format("heading_lag_low = {:g} s must be below the longest lag of {:g} s{}",
                           *m.heading_lag_low, high, m.heading_lag_high ? "" : ", a quarter of block"));
    if (m.heading_diffusion && m.trajectory.empty() && measured < 2.0 * high)
        report("measure.heading_diffusion",
               fmt::format("lags up to {:g} s need twice as much, and {:g} s are measured: shorten "
                           "measure.heading_lag_high or run longer",
                           high, measured));
}

void lengths(const Measure& m, const Granular& bed, const Report& report) {
    const auto want_below = [&](const std::optional<double>& value, const char* key, double most,
                                const char* why) {
        if (value && *value > most)
            report(std::string("measure.") + key,
                   fmt::format("{} = {:g} m: at most {:g} m, {}", key, *value, most, why));
    };
    want_below(m.spacing, "spacing", bed.box.shorter() / 4.0, "a quarter of the box");
    want_below(m.flow_spacing, "flow_spacing", bed.box.shorter() / 4.0, "a quarter of the box");
    want_below(m.order_cutoff, "order_cutoff", bed.box.shorter() / 4.0, "a quarter of the box");
    want_below(m.marked_within, "marked_within", bed.box.shorter() / 2.0, "half the box");
    want_below(m.profile_offset, "profile_offset", bed.box.shorter() / 2.0, "half the box");
    want_below(m.far_from, "far_from", 0.45 * bed.box.shorter(),
               "0.45 of the box: beyond it hardly a bead is left");
    if (m.order_cutoff && m.order_neighbours == measure::Neighbours::delaunay)
        report("measure.order_cutoff", "order_cutoff belongs to order_neighbours = \"cutoff\" only");
}

} // namespace

void check_measure(const Scene& scene, const Report& report) {
    if (!scene.measure || !scene.granular)
        return;
    rods(*scene.measure, *scene.granular, report);
    times(*scene.measure, *scene.granular, report);
    currents(*scene.measure, *scene.granular, report);
    headings(*scene.measure, *scene.granular, report);
    lengths(*scene.measure, *scene.granular, report);
}

} // namespace rodwake::scene
