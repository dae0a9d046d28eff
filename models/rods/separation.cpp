#include "rodwake/rods/separation.hpp"

#include "body_record.hpp"
#include "rodwake/core/periodic.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/integrate/additive_noise.hpp"
#include "rodwake/rods/separation_record.hpp"
#include "sweep.hpp"
#include "within_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::rods {

namespace {

using integrate::State;

Offset plane_offset(State y, std::size_t a, std::size_t b) {
    return {y[3 * a] - y[3 * b], y[3 * a + 1] - y[3 * b + 1]};
}

double square(Offset d) { return d.x * d.x + d.y * d.y; }

/// d(r^2)/dt
double square_rate(State y, std::size_t a, std::size_t b, Offset d) {
    const double ta = y[3 * a + 2], tb = y[3 * b + 2];
    return 2.0 * (d.x * (std::cos(ta) - std::cos(tb)) + d.y * (std::sin(ta) - std::sin(tb)));
}

/// Cubic on [0, 1] with end values f0, f1 and end slopes g0, g1.
struct Hermite {
    double f0, f1, g0, g1;

    double at(double u) const {
        const double v = 1.0 - u;
        return v * v * ((1.0 + 2.0 * u) * f0 + u * g0) + u * u * ((1.0 + 2.0 * v) * f1 - v * g1);
    }
};

/// The closest approach to one image of b, `shift` away from b itself.
std::optional<Approach> approach_of_image(const integrate::Step& step, std::size_t a, std::size_t b,
                                          Offset shift) {
    constexpr double lost = 1e6 * 8.0 * std::numeric_limits<double>::epsilon(); // six digits left of a square
    const double h = step.time - step.time_before;
    const Offset before = plane_offset(step.state_before, a, b), after = plane_offset(step.state, a, b);
    const Offset d0{before.x - shift.x, before.y - shift.y}, d1{after.x - shift.x, after.y - shift.y};
    const double g0 = h * square_rate(step.state_before, a, b, d0),
                 g1 = h * square_rate(step.state, a, b, d1);
    if (!(g0 < 0.0 && g1 > 0.0))
        return std::nullopt;
    const Hermite curve{square(d0), square(d1), g0, g1};

    // The minimum is the rising zero of the slope p u^2 + q u + g0.
    const double p = 3.0 * (2.0 * (curve.f0 - curve.f1) + g0 + g1),
                 q = 2.0 * (3.0 * (curve.f1 - curve.f0) - 2.0 * g0 - g1);
    const double root = std::sqrt(std::max(0.0, q * q - 4.0 * p * g0));
    const double u = std::clamp(-2.0 * g0 / (q + root), 0.0, 1.0), lowest = curve.at(u);
    const double time = step.time_before + u * h;
    if (lowest > lost * std::max(curve.f0, curve.f1))
        return Approach{time, {a, b, std::sqrt(lowest)}};

    // The cubic of the square loses digits if the distance is small beside those at the ends: take the cubics
    // of the offset itself.
    const auto rate = [&](State y) -> Offset {
        const double ta = y[3 * a + 2], tb = y[3 * b + 2];
        return {h * (std::cos(ta) - std::cos(tb)), h * (std::sin(ta) - std::sin(tb))};
    };
    const Offset r0 = rate(step.state_before), r1 = rate(step.state);
    const Hermite x{d0.x, d1.x, r0.x, r1.x}, y{d0.y, d1.y, r0.y, r1.y};
    return Approach{time, {a, b, std::hypot(x.at(u), y.at(u))}};
}

/// The closer approach of the two images that are nearest at the start and at the end of the step.
std::optional<Approach> approach_of_pair(const integrate::Step& step, std::size_t a, std::size_t b, Box box) {
    if (!box)
        return approach_of_image(step, a, b, {0.0, 0.0});
    const auto image_shift = [&](State y) {
        const Offset d = plane_offset(y, a, b);
        return Offset{nearest_shift(d.x, box->x), nearest_shift(d.y, box->y)};
    };
    const Offset start = image_shift(step.state_before), end = image_shift(step.state);
    const auto first = approach_of_image(step, a, b, start);
    if (start.x == end.x && start.y == end.y)
        return first;
    const auto second = approach_of_image(step, a, b, end);
    return !first || (second && second->pair.distance < first->pair.distance) ? second : first;
}

} // namespace

Offset offset(State y, std::size_t a, std::size_t b, Box box) {
    const Offset d = plane_offset(y, a, b);
    return box ? Offset{nearest_image(d.x, box->x), nearest_image(d.y, box->y)} : d;
}

namespace {

bool comes_first(std::size_t a, std::size_t b, const Separation& other) {
    return a < other.first || (a == other.first && b < other.second);
}

/// The longest way that a rod moved in the step.
double longest_move(const integrate::Step& step) {
    double longest = 0.0;
    for (std::size_t k = 0; k < step.state.size(); k += 3)
        longest = std::max(longest, std::hypot(step.state[k] - step.state_before[k],
                                               step.state[k + 1] - step.state_before[k + 1]));
    return longest;
}

} // namespace

Separation closest_pair(State y, Box box) {
    Separation best{0, 1, square(offset(y, 0, 1, box))};
    Sweep(y, box).pairs([&](double gap) { return gap > 0.0 && gap * gap > best.distance; },
                        [&](std::size_t a, std::size_t b) {
                            const double found = square(offset(y, a, b, box));
                            if (found < best.distance || (found == best.distance && comes_first(a, b, best)))
                                best = {a, b, found};
                        });
    best.distance = std::sqrt(best.distance);
    return best;
}

double passing_resolution(State y, double first, double tolerance) {
    double farthest = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i)
        if (i % 3 != 2)
            farthest = std::max(farthest, std::abs(y[i]));
    constexpr double few_steps = 64.0; // of rounding
    const double rounding = few_steps * std::numeric_limits<double>::epsilon() * farthest;
    return std::min(std::max(tolerance, rounding), 1e-3 * first);
}

// No relative speed is above 2, so a pair farther apart than 3 * 2 times the present limit cannot lower it.
double encounter_step(State y, Box box) {
    constexpr double farthest = 6.0 * (1.0 + 1e-12); // with room for rounding
    double limit = std::numeric_limits<double>::infinity();
    Sweep(y, box).pairs([&](double gap) { return gap > farthest * limit; },
                        [&](std::size_t a, std::size_t b) {
                            const double relative_speed =
                                2.0 * std::abs(std::sin(0.5 * (y[3 * a + 2] - y[3 * b + 2])));
                            limit = std::min(limit, std::sqrt(square(offset(y, a, b, box))) /
                                                        (3.0 * std::max(relative_speed, 0.5)));
                        });
    return limit;
}

double wake_step(State y, const elastic::Medium& medium, Box box) {
    const std::size_t rods = y.size() / 3;
    std::vector<double> c(rods), s(rods);
    for (std::size_t k = 0; k < rods; ++k) {
        c[k] = std::cos(y[3 * k + 2]);
        s[k] = std::sin(y[3 * k + 2]);
    }
    double limit = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = 0; b < rods; ++b) {
            const Offset d = offset(y, a, b, box);
            const double behind = -(d.x * c[b] + d.y * s[b]), across = std::abs(d.y * c[b] - d.x * s[b]);
            if (!(behind > 0.0 && across < 3.0 * limit)) // a rod to itself, too; no speed is above 1
                continue;
            const double width = std::sqrt(4.0 * behind * medium.xi / medium.nu());
            limit = std::min(limit, (across + width) / (3.0 * std::abs(s[a] * c[b] - c[a] * s[b])));
        }
    return limit;
}

bool has_wide_wakes(const elastic::Medium& medium) { return medium.nu() <= 10.0; }

// Pairs that need no look. On the cubic of a pair the weights of its end slopes g0, g1 are at most 4/27, and
// |g| <= h d(r^2)/dt <= 4 h r. With m the smaller and M the larger separation at the ends it stays above
//
//   m^2 - (4/27) 4 h (m + M) >= m^2 - (32/27) k (m + k),   k the larger of h and the longest move of a rod,
//
// since M <= m + 2 k. For m >= B + 2 k that is above B^2: 4 B k + 4 k^2 outweigh (32/27) (B k + 3 k^2). So m
// must be below B + 2 k for the pair to come closer than B, and its separation before below B + 4 k: if it is
// not the smaller one it is at most 2 k more. The same holds for an image that is nearest at one end only.
std::optional<Approach> closest_approach(const integrate::Step& step, Box box, double below) {
    const double reach = 4.0 * std::max(step.time - step.time_before, longest_move(step));
    std::optional<Approach> best;
    double bound = below;
    Sweep(step.state_before, box)
        .pairs([&](double gap) { return gap > (bound + reach) * (1.0 + 1e-12); },
               [&](std::size_t a, std::size_t b) {
                   const auto found = approach_of_pair(step, a, b, box);
                   if (!found || !(found->pair.distance < below))
                       return;
                   const double distance = found->pair.distance;
                   if (!best || distance < bound || (distance == bound && comes_first(a, b, best->pair))) {
                       best = found;
                       bound = distance;
                   }
               });
    return best;
}

std::optional<double> first_approach_time(const integrate::Step& step, Box box, double below) {
    const double reach = below + 4.0 * std::max(step.time - step.time_before, longest_move(step));
    std::optional<double> first;
    Sweep(step.state_before, box)
        .pairs([&](double gap) { return gap > reach * (1.0 + 1e-12); },
               [&](std::size_t a, std::size_t b) {
                   const auto found = approach_of_pair(step, a, b, box);
                   if (found && found->pair.distance < below)
                       first = std::min(found->time, first.value_or(found->time));
               });
    return first;
}

double fall_time(const integrate::Step& step, std::size_t a, std::size_t b, double distance) {
    const double h = step.time - step.time_before;
    const Offset d0 = plane_offset(step.state_before, a, b), d1 = plane_offset(step.state, a, b);
    const Hermite curve{square(d0), square(d1), h * square_rate(step.state_before, a, b, d0),
                        h * square_rate(step.state, a, b, d1)};
    double outside = 0.0, inside = 1.0;
    for (int k = 0; k < 53; ++k) {
        const double middle = 0.5 * (outside + inside);
        (curve.at(middle) > distance * distance ? outside : inside) = middle;
    }
    return step.time_before + inside * h;
}

namespace {

void add_late(SeparationRecord& record, integrate::State y, integrate::State ydot, Box box) {
    const std::size_t rods = y.size() / 3;
    for (std::size_t a = 0; a < rods; ++a)
        for (std::size_t b = a + 1; b < rods; ++b) {
            const Offset d = offset(y, a, b, box);
            const double r = std::hypot(d.x, d.y);
            TailWindow& range = record.late[a * rods + b];
            range = {std::min(range.min_separation, r), std::max(range.max_separation, r),
                     std::max({range.max_turning, std::abs(ydot[3 * a + 2]), std::abs(ydot[3 * b + 2])})};
        }
}

} // namespace

SeparationRecord start_record(integrate::State y, double tail_start, Box box, const BodyForces& bodies,
                              double t_end) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const std::size_t rods = y.size() / 3;
    if (rods < 2)
        return {{0, 0, infinity}, 0.0, tail_start, {}};
    const std::size_t followed = rods <= most_followed_rods ? rods * rods : 0;
    SeparationRecord record{closest_pair(y, box), 0.0, tail_start,
                            std::vector<TailWindow>(followed, {infinity, 0.0, 0.0})};
    if (bodies.any()) {
        record.bodies.smallest_gap = bodies.closest(y).gap;
        record.bodies.tail_start = (1.0 - bound_part) * t_end;
        record.bodies.touching.resize(followed);
    }
    return record;
}

void add_step(SeparationRecord& record, const integrate::Step& step, const StateRates& rates, Box box,
              const BodyForces& bodies) {
    if (step.state.size() < 6)
        return;
    const auto keep_smaller = [&](const Separation& pair, double time) {
        if (pair.distance < record.smallest.distance) {
            record.smallest = pair;
            record.smallest_time = time;
        }
    };
    keep_smaller(closest_pair(step.state, box), step.time);
    if (bodies.any())
        add_body_step(record, step, rates, box, bodies);
    else if (const auto approach = closest_approach(step, box, record.smallest.distance))
        keep_smaller(approach->pair, approach->time);
    if (step.time < record.tail_start || record.late.empty())
        return;

    // The last part: its beginning if that lies in this step, and the step's end.
    std::vector<double> rate(step.state.size()), other(step.state.size());
    rates(step.state, rate);
    if (step.time_before < record.tail_start && record.tail_start < step.time) {
        rates(step.state_before, other);
        const auto y = state_at(record.tail_start, step, other, rate);
        rates(y, other);
        add_late(record, y, other, box);
    }
    add_late(record, step.state, rate, box);
}

std::array<std::uint32_t, 4> NoisePlace::bits(Use use, std::size_t rod) const {
    return philox_block(
        {node, (span << 8) | static_cast<std::uint32_t>(use), run, static_cast<std::uint32_t>(rod)},
        {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
}

std::optional<Meeting> bridge_contact(const integrate::Step& step, double distance, double rate, Box box,
                                      const NoisePlace& position) {
    const double spread = rate * (step.time - step.time_before);
    // A pair farther apart than the reach has met with a probability below exp(-36).
    const double reach = distance + 2.0 * longest_move(step) + std::sqrt(18.0 * spread);
    std::optional<Meeting> first;
    const auto gap = [&](State y, std::size_t a, std::size_t b) {
        const Offset d = offset(y, a, b, box);
        return std::hypot(d.x, d.y) - distance;
    };
    const auto look_at = [&](std::size_t a, std::size_t b) {
        const double d0 = gap(step.state_before, a, b);
        if (d0 > reach - distance)
            return;
        const double d1 = gap(step.state, a, b);
        const std::array<std::uint32_t, 4> of_rod = position.bits(NoisePlace::Use::meeting, a);
        const auto bits_of_pair = [&](std::uint32_t draw) {
            return philox_block({static_cast<std::uint32_t>(b), draw, of_rod[2], of_rod[3]},
                                {of_rod[0], of_rod[1]});
        };
        const auto bits = bits_of_pair(0);
        if (d1 > 0.0 && integrate::uniform_of(bits[0], bits[1]) >= std::exp(-2.0 * d0 * d1 / spread))
            return;

        // They met: odds is the ratio of the times before and after, inverse Gaussian (Michael, Schucany and
        // Haas, Am. Stat. 30, 88 (1976)). `root` is the smaller root without cancellation.
        const double normal = integrate::normals_of(bits_of_pair(1))[0],
                     uniform = integrate::uniform_of(bits[2], bits[3]);
        const double mean = d0 / std::max(std::abs(d1), 1e-9 * d0), shape = d0 * d0 / spread;
        const double c = 0.5 * mean * normal * normal / shape;
        const double root = mean / (1.0 + c + std::sqrt(c * (2.0 + c)));
        const double odds = uniform * (mean + root) <= mean ? root : mean * (mean / root);
        const double share = odds / (1.0 + odds);
        if (!first || share < first->share || (share == first->share && a < first->first))
            first = {share, a, b};
    };
    Sweep(step.state_before, box).pairs([&](double separation) { return separation > reach; }, look_at);
    return first;
}

} // namespace rodwake::rods
