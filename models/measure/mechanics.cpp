#include "rodwake/measure/mechanics.hpp"

#include "blocks.hpp"
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

/// Mean rates, and what follows from them.
enum Rate : std::size_t { mean_force, mean_drift, mean_speed, mean_drag };

Row rates_of(std::span<const Share> shares, std::size_t without, double mass) {
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

void set_rates(MechanicsResult& result, std::span<const Share> shares, double mass, bool rods) {
    Jackknife rates{rates_of(shares, shares.size(), mass), {}};
    for (std::size_t b = 0; b < shares.size(); ++b)
        rates.without.push_back(rates_of(shares, b, mass));
    const auto estimate = [&](Rate i) {
        return Estimate{rates.all[i], shares.size() < 2 ? unknown_error : rates.error(i), shares.size()};
    };
    result.blocks = shares.size();
    result.force = estimate(mean_force);
    result.drift = estimate(mean_drift);
    if (rods)
        result.speed = estimate(mean_speed);
    if (rates.all[mean_drift] > 0.0)
        result.drag_rate = estimate(mean_drag);
}

double part_of(const Estimate& e) { return e.error / e.value; }

double mass_of(const Layout& layout) { return static_cast<double>(layout.beads) * layout.bead_mass; }

DriftDecay decay_of(std::span<const MechanicsAccumulator> runs, std::span<const RodPushes> pushes,
                    const Estimate& drag_rate) {
    std::vector<DriftPath> paths;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        // Impulses are left out where only a steady force pushes.
        DriftPath path;
        for (const Mark& mark : runs[r].path()) {
            path.time.push_back(mark.time);
            path.x.push_back(mark.x);
            path.y.push_back(mark.y);
            if (pushes[r].advance.empty())
                continue;
            path.impulse_x.push_back(at(pushes[r].time, pushes[r].impulse_x, mark.time));
            path.impulse_y.push_back(at(pushes[r].time, pushes[r].impulse_y, mark.time));
        }
        paths.push_back(path);
    }
    DriftDecayOptions options;
    options.block = runs[0].options().block;
    return drift_decay(paths, mass_of(runs[0].layout()), drag_rate, options);
}

std::vector<Share> shares_of(std::span<const MechanicsAccumulator> runs, std::span<const RodPushes> pushes) {
    if (runs.empty() || runs.size() != pushes.size())
        throw InputError("measure: mechanics: needs the frames and the tracks of the same runs");
    std::vector<Share> shares;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (!(runs[r].layout() == runs[0].layout()))
            throw InputError("measure: mechanics: the runs are of different beds");
        const std::vector<Mark> marks = runs[r].marks();
        if (marks.size() < 2)
            throw InputError(
                "measure: mechanics: needs at least 2 frames a run: measure "
                "more often, from an earlier time or position (from, from_travel), or run longer");
        for (std::size_t b = 1; b < marks.size(); ++b) {
            const Mark &from = marks[b - 1], &to = marks[b];
            const auto grown = [&](const Row& values) {
                return at(pushes[r].time, values, to.time) - at(pushes[r].time, values, from.time);
            };
            const double px = grown(pushes[r].impulse_x), py = grown(pushes[r].impulse_y),
                         p = std::hypot(px, py);
            const double along = p > 0.0 ? ((to.x - from.x) * px + (to.y - from.y) * py) / p : 0.0;
            shares.push_back(
                {to.time - from.time, p, along, pushes[r].advance.empty() ? 0.0 : grown(pushes[r].advance)});
        }
    }
    return shares;
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
    path_.push_back({frame.time, mean(frame.unwrapped_x), mean(frame.unwrapped_y)});
}

std::vector<Mark> MechanicsAccumulator::marks() const {
    std::vector<Mark> marks;
    for (const Mark& mark : path_)
        if (marks.empty() ||
            mark.time >= marks.front().time + options_.block * (static_cast<double>(marks.size()) - 1e-9))
            marks.push_back(mark);
    if (marks.size() > 1 && path_.back().time - marks.back().time < 0.5 * options_.block)
        marks.pop_back();
    if (!marks.empty() && path_.back().time > marks.back().time)
        marks.push_back(path_.back());
    return marks;
}

void MechanicsAccumulator::save(StateWriter& out) const {
    out.put(path_.size());
    for (const Mark& mark : path_)
        for (const double value : {mark.time, mark.x, mark.y})
            out.put(value);
}

void MechanicsAccumulator::load(StateReader& in) {
    path_.clear();
    for (std::size_t left = in.count(); left > 0; --left) { // a wrong number ends where the numbers do
        Mark& mark = path_.emplace_back();
        for (double* value : {&mark.time, &mark.x, &mark.y})
            *value = in.get();
    }
}

bool usable_inertia(const Estimate& inertia) {
    constexpr double largest = 0.2; // constants would be off by as much, more than by the bare mass
    return inertia.count > 0 && inertia.value > 0.0 && inertia.error <= largest * inertia.value;
}

DriftDecay measured_decay(std::span<const MechanicsAccumulator> runs, std::span<const RodPushes> pushes) {
    MechanicsResult result;
    set_rates(result, shares_of(runs, pushes), mass_of(runs[0].layout()), false);
    return decay_of(runs, pushes, result.drag_rate);
}

MechanicsResult reduce(std::span<const MechanicsAccumulator> runs, std::span<const RodPushes> pushes,
                       const Estimate& shear_speed, const std::optional<Estimate>& inertia) {
    const std::vector<Share> shares = shares_of(runs, pushes);
    const Layout& layout = runs[0].layout();
    const bool rods = !pushes[0].advance.empty();
    MechanicsResult result;
    if (rods) {
        // The distance that the rod came is the least of the runs.
        result.before = result.along = INFINITY;
        for (std::size_t r = 0; r < runs.size(); ++r) {
            const double first = at(pushes[r].time, pushes[r].advance, runs[r].path().front().time),
                         last = at(pushes[r].time, pushes[r].advance, runs[r].path().back().time);
            result.before = std::min(result.before, std::abs(first));
            result.along = std::min(result.along, std::abs(last - first));
        }
    }
    set_rates(result, shares, mass_of(layout), rods);
    result.decay = decay_of(runs, pushes, result.drag_rate);

    // Errors of independent factors add up in squares. A measured m* is made from the drag rate: what is
    // independent is the decay rate, their ratio.
    const Estimate &c = shear_speed, &g = result.drag_rate, &v = result.speed;
    const bool measured = !inertia && usable_inertia(result.decay.inertia);
    result.inertia = inertia ? *inertia : measured ? result.decay.inertia : Estimate{};
    if (c.count > 0 && g.count > 0 && v.count > 0 && v.value != 0.0) {
        const double m = result.inertia.count > 0 ? result.inertia.value : 1.0, box = layout.box.shorter();
        const double xi = m * c.value * c.value / (g.value * std::abs(v.value));
        const double damping =
            measured ? part_of(result.decay.rate) : std::hypot(part_of(g), inertia ? part_of(*inertia) : 0.0);
        const double part = std::hypot(2.0 * part_of(c), damping, part_of(v));
        result.screening = {xi, xi * part, g.count};
        result.peclet = {box / xi, box / xi * part, g.count};
    }

    // Without a rod the drift has to be steady, no wake.
    if (!rods) {
        result.steady = g.count == 0 || runs[0].path().front().time * g.value >= 3.0;
        return result;
    }
    const double half = 0.5 * layout.box.shorter();
    result.wanted = result.screening.count > 0 ? std::min(half, result.screening.value) : half;
    result.steady = result.before >= result.wanted && result.along >= result.wanted;
    return result;
}

} // namespace rodwake::measure
