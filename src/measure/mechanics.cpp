#include "rodwake/measure/mechanics.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::measure {

namespace {

using Row = std::vector<double>;
using Mark = MechanicsAccumulator::Mark;

double mean(const Row& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Between the rows of a track.
double at(const Row& times, const Row& values, double time) {
    const auto after = std::ranges::lower_bound(times, time - 1e-9);
    if (after == times.end() || times.front() > time + 1e-9)
        throw RunError(fmt::format("measure: mechanics: no row of tracks.csv at t = {:g} s, where beads were "
                                   "measured",
                                   time));
    const auto i = static_cast<std::size_t>(after - times.begin());
    if (i == 0 || times[i] <= time)
        return values[i];
    const double part = (time - times[i - 1]) / (times[i] - times[i - 1]);
    return values[i - 1] + part * (values[i] - values[i - 1]);
}

/// Of a block of time.
struct Share {
    double seconds, impulse, drift, advance; ///< s, N s, m, m
};

Share share_of(const RodPushes& pushes, const Mark& from, const Mark& to) {
    const auto grown = [&](const Row& values) {
        return at(pushes.time, values, to.time) - at(pushes.time, values, from.time);
    };
    const double px = grown(pushes.impulse_x), py = grown(pushes.impulse_y), p = std::hypot(px, py);
    const double along = p > 0.0 ? ((to.x - from.x) * px + (to.y - from.y) * py) / p : 0.0;
    return {to.time - from.time, p, along, grown(pushes.advance)};
}

/// Mean rates, and what follows from them.
struct Rates {
    double force, drift, speed, drag;
};

Rates rates_of(std::span<const Share> shares, std::size_t without, double mass) {
    Share sum{};
    for (std::size_t b = 0; b < shares.size(); ++b) {
        if (b == without)
            continue;
        sum.seconds += shares[b].seconds;
        sum.impulse += shares[b].impulse;
        sum.drift += shares[b].drift;
        sum.advance += shares[b].advance;
    }
    const double way = sum.advance < 0.0 ? -1.0 : 1.0; // of a rod that is pulled backwards
    return {sum.impulse / sum.seconds, sum.drift / sum.seconds, (sum.advance - way * sum.drift) / sum.seconds,
            sum.impulse / (mass * sum.drift)};
}

Estimate jackknife(std::span<const Rates> without, double whole, double Rates::*rate) {
    const double n = static_cast<double>(without.size());
    if (without.size() < 2)
        return {whole, unknown_error, without.size()};
    double mean = 0.0, scatter = 0.0;
    for (const Rates& r : without)
        mean += r.*rate / n;
    for (const Rates& r : without)
        scatter += (r.*rate - mean) * (r.*rate - mean);
    return {whole, std::sqrt(scatter * (n - 1.0) / n), without.size()};
}

void set_rates(MechanicsResult& result, std::span<const Share> shares, double mass) {
    std::vector<Rates> without;
    for (std::size_t b = 0; b < shares.size(); ++b)
        without.push_back(rates_of(shares, b, mass));
    const Rates all = rates_of(shares, shares.size(), mass);
    result.blocks = shares.size();
    result.force = jackknife(without, all.force, &Rates::force);
    result.drift = jackknife(without, all.drift, &Rates::drift);
    result.speed = jackknife(without, all.speed, &Rates::speed);
    if (all.drift > 0.0)
        result.drag_rate = jackknife(without, all.drag, &Rates::drag);
}

/// Errors of independent factors add up in squares.
void set_screening(MechanicsResult& result, const Estimate& shear_speed, double box) {
    const Estimate &c = shear_speed, &g = result.drag_rate, &v = result.speed;
    if (c.count == 0 || g.count == 0 || v.value == 0.0)
        return;
    const double xi = c.value * c.value / (g.value * std::abs(v.value));
    const double part = std::hypot(2.0 * c.error / c.value, g.error / g.value, v.error / v.value);
    result.screening = {xi, xi * part, g.count};
    result.peclet = {box / xi, box / xi * part, g.count};
}

} // namespace

MechanicsAccumulator::MechanicsAccumulator(const Layout& layout, const MechanicsOptions& options)
    : layout_(layout), options_(options) {
    validate(layout);
    if (!(std::isfinite(options.block) && options.block > 0.0))
        throw InputError(
            fmt::format("measure: mechanics, blocks of {:g} s: must be finite and positive", options.block));
}

void MechanicsAccumulator::add(const Frame& frame) {
    check_frame(layout_, frame);
    last_ = {frame.time, mean(frame.unwrapped_x), mean(frame.unwrapped_y)};
    const double next = firsts_.empty()
                            ? -INFINITY
                            : firsts_.front().time + options_.block * static_cast<double>(firsts_.size());
    if (frame.time >= next - 1e-9 * options_.block)
        firsts_.push_back(last_);
}

std::vector<Mark> MechanicsAccumulator::marks() const {
    std::vector<Mark> marks = firsts_;
    if (marks.size() > 1 && last_.time - marks.back().time < 0.5 * options_.block)
        marks.pop_back();
    if (!marks.empty() && last_.time > marks.back().time)
        marks.push_back(last_);
    return marks;
}

void MechanicsAccumulator::save(StateWriter& out) const {
    out.put(firsts_.size());
    for (const Mark& mark : firsts_)
        for (const double value : {mark.time, mark.x, mark.y})
            out.put(value);
    for (const double value : {last_.time, last_.x, last_.y})
        out.put(value);
}

void MechanicsAccumulator::load(StateReader& in) {
    const auto next = [&](Mark& mark) {
        for (double* value : {&mark.time, &mark.x, &mark.y})
            *value = in.get();
    };
    firsts_.resize(in.count());
    for (Mark& mark : firsts_)
        next(mark);
    next(last_);
}

MechanicsResult reduce(std::span<const MechanicsAccumulator> runs, std::span<const RodPushes> pushes,
                       const Estimate& shear_speed) {
    if (runs.empty() || runs.size() != pushes.size())
        throw InputError("measure: mechanics: needs the frames and the tracks of the same runs");
    MechanicsResult result;
    result.before = result.along = INFINITY;
    std::vector<Share> shares;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (!(runs[r].layout() == runs[0].layout()))
            throw InputError("measure: mechanics: the runs are of different beds");
        const std::vector<Mark> marks = runs[r].marks();
        if (marks.size() < 2)
            throw InputError("measure: mechanics: needs at least 2 frames a run: measure "
                             "more often, from an earlier time or place (from, from_travel), or run longer");
        for (std::size_t b = 1; b < marks.size(); ++b)
            shares.push_back(share_of(pushes[r], marks[b - 1], marks[b]));
        const double first = at(pushes[r].time, pushes[r].advance, marks.front().time),
                     last = at(pushes[r].time, pushes[r].advance, marks.back().time);
        result.before = std::min(result.before, std::abs(first));
        result.along = std::min(result.along, std::abs(last - first));
    }
    const Layout& layout = runs[0].layout();
    set_rates(result, shares, static_cast<double>(layout.beads) * layout.bead_mass);
    set_screening(result, shear_speed, layout.box.shorter());
    const double half = 0.5 * layout.box.shorter();
    result.wanted = result.screening.count > 0 ? std::min(half, result.screening.value) : half;
    result.steady = result.before >= result.wanted && result.along >= result.wanted;
    return result;
}

} // namespace rodwake::measure
