#include "body_record.hpp"

#include "within_step.hpp"

#include <boost/math/tools/minima.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace rodwake::rods {

void add_body_step(SeparationRecord& record, const integrate::Step& step, const StateRates& rates, Box box,
                   const BodyForces& bodies) {
    const std::size_t size = step.state.size(), rods = size / 3;
    const auto keep = [&](integrate::State y, double time) {
        if (const Separation pair = closest_pair(y, box); pair.distance < record.smallest.distance) {
            record.smallest = pair;
            record.smallest_time = time;
        }
        if (const double gap = bodies.closest(y).gap; gap < record.bodies.smallest_gap) {
            record.bodies.smallest_gap = gap;
            record.bodies.smallest_gap_time = time;
        }
    };
    keep(step.state, step.time);
    if (rods > most_followed_rods)
        return;
    std::vector<double> rate_before(size), rate(size);
    rates(step.state_before, rate_before);
    rates(step.state, rate);
    const auto state = [&](double time) { return state_at(time, step, rate_before, rate); };

    // Where one of the two distances has a minimum between samples, it is found on the cubic through the
    // step.
    constexpr std::size_t parts = 4;
    std::array<double, parts + 1> times{};
    std::array<std::array<double, parts + 1>, 2> values{};
    for (std::size_t k = 0; k <= parts; ++k) {
        times[k] = step.time_before + (step.time - step.time_before) * static_cast<double>(k) / parts;
        const std::vector<double> y = state(times[k]);
        values[0][k] = closest_pair(y, box).distance;
        values[1][k] = bodies.closest(y).gap;
    }
    for (std::size_t which : {0, 1}) {
        const auto& value = values[which];
        const auto k = static_cast<std::size_t>(std::min_element(value.begin(), value.end()) - value.begin());
        const double known = which == 0 ? record.smallest.distance : record.bodies.smallest_gap;
        const std::size_t before = k == 0 ? k : k - 1, after = k == parts ? k : k + 1;
        if (value[k] - (std::max(value[before], value[after]) - value[k]) > known)
            continue;
        const auto distance = [&](double time) {
            const std::vector<double> y = state(time);
            return which == 0 ? closest_pair(y, box).distance : bodies.closest(y).gap;
        };
        const double inwards = 1e-3 * (times[1] - times[0]); // whether it is still lower inside the step
        if ((k == 0 && distance(times[0] + inwards) >= value[0]) ||
            (k == parts && distance(times[parts] - inwards) >= value[parts]))
            continue;
        constexpr int bits = 26; // half of a double's, as far as a minimum is known
        const auto lowest =
            boost::math::tools::brent_find_minima(distance, times[before], times[after], bits);
        keep(state(lowest.first), lowest.first);
    }

    // A pair that touches at one end of the step only touches for the share that a straight line gives.
    BodyRecord& late = record.bodies;
    if (!(step.time > late.tail_start) || late.touching.empty())
        return;
    const double from = std::max(step.time_before, late.tail_start);
    const std::vector<double> first =
        from > step.time_before ? state(from)
                                : std::vector<double>(step.state_before.begin(), step.state_before.end());
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (const integrate::State y : {integrate::State(first), step.state})
        for (const BodyContact& pair : bodies.contacts(y, 0.0))
            pairs.emplace_back(pair.first, pair.second);
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    for (const auto& [a, b] : pairs) {
        const double before = bodies.contact(first, a, b).overlap - bodies.touching_overlap(),
                     after = bodies.contact(step.state, a, b).overlap - bodies.touching_overlap();
        const double high = std::max(before, after), low = std::min(before, after);
        if (high > 0.0)
            late.touching[a * rods + b] += (step.time - from) * (low >= 0.0 ? 1.0 : high / (high - low));
    }
}

std::optional<Separation> bound_pair(const SeparationRecord& record, integrate::State y, double t_end,
                                     Box box) {
    const std::vector<double>& touching = record.bodies.touching;
    if (touching.empty())
        return std::nullopt;
    const auto longest = std::max_element(touching.begin(), touching.end());
    if (!(*longest >= bound_share * bound_part * t_end))
        return std::nullopt;
    const std::size_t rods = y.size() / 3, at = static_cast<std::size_t>(longest - touching.begin());
    const Offset d = offset(y, at / rods, at % rods, box);
    return Separation{at / rods, at % rods, std::hypot(d.x, d.y)};
}

} // namespace rodwake::rods
