// Sums of squared displacements over lags: what the mean-square displacement is reduced from.

#include "rodwake/core/error.hpp"
#include "rodwake/measure/microrheology.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
constexpr auto groups = MicrorheologyAccumulator::groups;

std::size_t first_of(std::size_t group, std::size_t beads) { return group * beads / groups; }

/// Displacements since the first frame without their mean, which is the drift of the whole bed, of the first
/// `wanted` beads of the order.
Row displacements(const Row& free, const Row& first, const std::vector<std::size_t>& order,
                  std::size_t wanted) {
    Row moved(order.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        moved[i] = free[order[i]] - first[i];
    const double mean = std::accumulate(moved.begin(), moved.end(), 0.0) / static_cast<double>(moved.size());
    moved.resize(wanted);
    for (double& m : moved)
        m -= mean;
    return moved;
}

double variance(const Row& values) {
    const double n = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double sum = 0.0;
    for (const double v : values)
        sum += (v - mean) * (v - mean);
    return sum / n;
}

} // namespace

MicrorheologyAccumulator::MicrorheologyAccumulator(const Layout& layout, const MicrorheologyOptions& options)
    : layout_(layout), options_(options) {
    validate(layout);
    if (!(std::isfinite(options.longest_lag) && options.longest_lag >= 0.0))
        throw InputError(
            fmt::format("measure: microrheology, longest lag {:g} s: must be finite and positive, or 0 "
                        "for as long as the run allows",
                        options.longest_lag));
    for (const auto& s : {options.s_low, options.s_high})
        if (s && !(std::isfinite(*s) && *s > 0.0))
            throw InputError(
                fmt::format("measure: microrheology, s = {:g} 1/s as an end of the range for s -> 0: "
                            "must be finite and positive",
                            *s));
    if (options.s_low && options.s_high && *options.s_low >= *options.s_high)
        throw InputError(fmt::format("measure: microrheology, range of s from {:g} to {:g} 1/s: must rise",
                                     *options.s_low, *options.s_high));
    if (layout.beads < groups)
        throw InputError(fmt::format("measure: microrheology of {} beads: needs at least {}, since their "
                                     "mean displacement is taken off",
                                     layout.beads, groups));
    set_group_sizes(layout.beads);
}

void MicrorheologyAccumulator::set_group_sizes(std::size_t beads) {
    measured_ = beads;
    group_sizes_.clear();
    for (std::size_t g = 0; g < groups; ++g)
        group_sizes_.push_back(static_cast<double>(first_of(g + 1, beads) - first_of(g, beads)));
}

double MicrorheologyAccumulator::interval() const {
    return on_grid() || lags_.empty() ? times_.interval : lag(lags_.begin()->first);
}

double MicrorheologyAccumulator::lag(long key) const {
    const LagSums& of = lags_.at(key);
    return on_grid() ? static_cast<double>(key) * times_.interval : of.time / of.origins;
}

double MicrorheologyAccumulator::weight(long key, std::size_t group) const {
    const LagSums& of = lags_.at(key);
    return layout_.all_beads > 0 ? of.pairs[group] : of.origins * group_sizes_[group];
}

bool MicrorheologyAccumulator::is_well_known(long key) const {
    if (!times_.has_all_frames())
        return lag(key) <= 0.75 * (times_.last - times_.first);
    double stride = 1.0; // of the frames of its octave
    while (static_cast<double>(key) > stride * channels)
        stride *= 2.0;
    return 4.0 * stride * lags_.at(key).origins >= static_cast<double>(frames());
}

double MicrorheologyAccumulator::temperature() const {
    return frames() > 0 ? temperature_sum_ / static_cast<double>(frames()) : 0.0;
}

void MicrorheologyAccumulator::add(const Frame& frame) {
    check_frame(layout_, frame);
    times_.next(frame.time, "microrheology", layout_.grid);
    if (times_.frames == 1 && layout_.all_beads == 0) {
        // Beads are grouped by their height in the first frame.
        order_.resize(layout_.beads);
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        std::ranges::stable_sort(order_, {}, [&](std::size_t i) { return frame.y[i]; });
        if (options_.kind) {
            const auto others = std::stable_partition(
                order_.begin(), order_.end(), [&](std::size_t i) { return frame.kind[i] == *options_.kind; });
            set_group_sizes(static_cast<std::size_t>(others - order_.begin()));
        }
        for (const std::size_t i : order_) {
            first_x_.push_back(frame.unwrapped_x[i]);
            first_y_.push_back(frame.unwrapped_y[i]);
        }
    }
    if (times_.frames == 2 && options_.longest_lag > 0.0 && on_grid() && !within_longest(times_.interval))
        throw InputError(
            fmt::format("measure: microrheology, longest lag {:g} s: is below the {:g} s between frames",
                        options_.longest_lag, times_.interval));
    if (layout_.velocities)
        temperature_sum_ += (variance(frame.vx) + variance(frame.vy)) / 2.0;
    if (layout_.all_beads > 0)
        return add_named(frame);
    push(0, {times_.tick,
             frame.time,
             displacements(frame.unwrapped_x, first_x_, order_, measured_),
             displacements(frame.unwrapped_y, first_y_, order_, measured_),
             {}});
}

bool MicrorheologyAccumulator::within_longest(double seconds) const {
    return options_.longest_lag == 0.0 ||
           seconds <= options_.longest_lag * (1.0 + 1e-9); // 16 * 0.1 s is within 1.6 s
}

void MicrorheologyAccumulator::correlate(const OctaveFrame& before, const OctaveFrame& now, LagSums& sums) {
    std::array<Moved, groups> moved{};
    for (std::size_t g = 0; g < groups; ++g) {
        double sum = 0.0;
        for (std::size_t i = first_of(g, now.x.size()), end = first_of(g + 1, now.x.size()); i < end; ++i) {
            const double dx = now.x[i] - before.x[i], dy = now.y[i] - before.y[i];
            sum += dx * dx + dy * dy;
            moved[g].x += dx;
            moved[g].y += dy;
        }
        moved[g].beads = group_sizes_[g];
        sums.sum[g] += sum;
    }
    add_halves(sums, moved);
    sums.origins += 1.0;
    sums.time += now.time - before.time;
}

void MicrorheologyAccumulator::push(std::size_t number, const OctaveFrame& now) {
    constexpr double bins_per_octave = 16.0;
    const std::size_t most = on_grid() ? channels : 4 * channels;
    if (number == levels_.size())
        levels_.emplace_back();
    std::vector<OctaveFrame>& past = levels_[number];
    for (std::size_t back = past.size(); back-- > 0;) {
        const OctaveFrame& before = past[back];
        const std::size_t ticks = now.tick - before.tick, channel = ticks >> number;
        const double seconds =
            on_grid() ? static_cast<double>(ticks) * times_.interval : now.time - before.time;
        if (channel > most || !within_longest(seconds))
            break;
        if (number > 0 && channel <= most / 2) // the octave before has it
            continue;
        LagSums& sums =
            lags_[on_grid() ? static_cast<long>(ticks) : std::lround(bins_per_octave * std::log2(seconds))];
        layout_.all_beads > 0 ? correlate_named(before, now, sums) : correlate(before, now, sums);
    }
    if (past.size() == most)
        std::rotate(past.begin(), past.begin() + 1, past.end());
    else
        past.emplace_back();
    past.back() = now;
    // every second tick, where there is a lag to come
    const std::size_t next = std::size_t{1} << (number + 1), fewest = most / 2 + 1;
    const double first_lag = static_cast<double>(fewest * next) * times_.interval;
    if ((now.tick + 1) % next == 0 && (!on_grid() || within_longest(first_lag)))
        push(number + 1, now);
}

void MicrorheologyAccumulator::save(StateWriter& out) const {
    times_.save(out);
    out.put(temperature_sum_);
    out.put(order_.size());
    for (const std::size_t bead : order_)
        out.put(bead);
    if (options_.kind)
        out.put(measured_);
    out.put(first_x_);
    out.put(first_y_);
    out.put(levels_.size());
    for (const std::vector<OctaveFrame>& level : levels_) {
        out.put(level.size());
        for (const OctaveFrame& past : level) {
            out.put(past.tick);
            out.put(past.x);
            out.put(past.y);
        }
    }
    out.put(lags_.size());
    for (const auto& [key, sums] : lags_) {
        out.put(static_cast<std::size_t>(key));
        out.put(sums.origins);
        out.put(sums.sum);
    }
}

void MicrorheologyAccumulator::load(StateReader& in) {
    times_.load(in);
    temperature_sum_ = in.get();
    const std::size_t beads = layout_.beads, expected = frames() > 0 ? beads : 0, count = in.count();
    if (count != expected) // every bead once; none before the first frame
        throw RunError(fmt::format("measure: microrheology: {} beads stored, expected {}", count, expected));
    order_.resize(count);
    std::vector<bool> seen(beads, false);
    for (std::size_t& bead : order_) {
        bead = in.count();
        if (bead >= beads || seen[bead])
            throw RunError(
                fmt::format("measure: microrheology: bead {} in the stored order of {} beads", bead, beads));
        seen[bead] = true;
    }
    if (options_.kind)
        set_group_sizes(in.count());
    first_x_ = in.array(order_.size());
    first_y_ = in.array(order_.size());
    levels_.clear();
    for (std::size_t left = in.count(); left > 0; --left) {
        const std::size_t stored = in.count();
        if (stored > channels)
            throw RunError(
                fmt::format("measure: microrheology: {} stored frames of an octave, at most {} are legal",
                            stored, channels));
        std::vector<OctaveFrame>& level = levels_.emplace_back(stored);
        for (OctaveFrame& past : level) {
            past.tick = in.count();
            past.x = in.array(measured_);
            past.y = in.array(measured_);
        }
    }
    lags_.clear();
    for (std::size_t left = in.count(); left > 0; --left) {
        LagSums& sums = lags_[static_cast<long>(in.count())];
        sums.origins = in.get();
        std::ranges::copy(in.array(groups), sums.sum.begin());
    }
}

} // namespace rodwake::measure
