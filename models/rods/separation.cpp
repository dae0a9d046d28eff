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

double square_distance(State y, std::size_t a, std::size_t b, Box box) {
    return square(offset(y, a, b, box));
}

/// d(r^2)/dt
double square_rate(State y, std::size_t a, std::size_t b, Offset d) {
    const double ta = y[3 * a + 2], tb = y[3 * b + 2];
    return 2.0 * (d.x * (std::cos(ta) - std::cos(tb)) + d.y * (std::sin(ta) - std::sin(tb)));
}

/// Cubic on [0, 1] with end values f0, f1 and end slopes g0, g1.
struct Hermite {
    double f0, f1, g0, g1;

    /// With g0 < 0 < g1.
    double minimum_at() const {
        const double a = 3.0 * (2.0 * (f0 - f1) + g0 + g1), b = 2.0 * (3.0 * (f1 - f0) - 2.0 * g0 - g1);
        const double root = std::sqrt(std::max(0.0, b * b - 4.0 * a * g0));
        return std::clamp(-2.0 * g0 / (b + root), 0.0, 1.0); // slope a u^2 + b u + g0, its rising zero
    }
    double at(double u) const {
        const double v = 1.0 - u;
        return v * v * ((1.0 + 2.0 * u) * f0 + u * g0) + u * u * ((1.0 + 2.0 * v) * f1 - v * g1);
    }
};

/// The closest distance on the cubic of the offset itself. The cubic of its square loses digits if the
/// distance is small beside those at the ends.
double distance_of_offsets(const integrate::Step& step, std::size_t a, std::size_t b, Offset d0, Offset d1,
                           double u) {
    const double h = step.time - step.time_before;
    const auto rate = [&](State y, auto part) { return h * (part(y[3 * a + 2]) - part(y[3 * b + 2])); };
    const auto cosine = [](double angle) { return std::cos(angle); };
    const auto sine = [](double angle) { return std::sin(angle); };
    const Hermite x{d0.x, d1.x, rate(step.state_before, cosine), rate(step.state, cosine)},
        y{d0.y, d1.y, rate(step.state_before, sine), rate(step.state, sine)};
    return std::hypot(x.at(u), y.at(u));
}

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
    const double u = curve.minimum_at(), lowest = curve.at(u);
    const double distance = lowest > lost * std::max(curve.f0, curve.f1)
                                ? std::sqrt(lowest)
                                : distance_of_offsets(step, a, b, d0, d1, u);
    return Approach{step.time_before + u * h, {a, b, distance}};
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
    Separation best{0, 1, square_distance(y, 0, 1, box)};
    Sweep(y, box).pairs([&](double gap) { return gap > 0.0 && gap * gap > best.distance; },
                        [&](std::size_t a, std::size_t b) {
                            const double found = square_distance(y, a, b, box);
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
                            limit = std::min(limit, std::sqrt(square_distance(y, a, b, box)) /
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

constexpr double infinity = std::numeric_limits<double>::infinity();

void keep_smaller(SeparationRecord& record, const Separation& pair, double time) {
    if (pair.distance < record.smallest.distance) {
        record.smallest = pair;
        record.smallest_time = time;
    }
}

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

void add_late_step(SeparationRecord& record, const integrate::Step& step, const StateRates& rates, Box box) {
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

} // namespace

SeparationRecord start_record(integrate::State y, double tail_start, Box box) {
    const std::size_t rods = y.size() / 3;
    if (rods < 2)
        return {{0, 0, infinity}, 0.0, tail_start, {}};
    const std::size_t followed = rods <= most_followed_rods ? rods * rods : 0;
    return {closest_pair(y, box), 0.0, tail_start, std::vector<TailWindow>(followed, {infinity, 0.0, 0.0})};
}

void add_step(SeparationRecord& record, const integrate::Step& step, const StateRates& rates, Box box,
              const BodyForces& bodies) {
    if (step.state.size() < 6)
        return;
    keep_smaller(record, closest_pair(step.state, box), step.time);
    if (bodies.any())
        add_body_step(record, step, rates, box, bodies);
    else if (const auto approach = closest_approach(step, box, record.smallest.distance))
        keep_smaller(record, approach->pair, approach->time);
    if (step.time >= record.tail_start && !record.late.empty())
        add_late_step(record, step, rates, box);
}

namespace {

using Words = std::array<std::uint32_t, 4>;

/// A pair's own bits, from those of its first rod.
Words bits_of_pair(const Words& first, std::size_t second, std::uint32_t draw) {
    return philox_block({static_cast<std::uint32_t>(second), draw, first[2], first[3]}, {first[0], first[1]});
}

/// Inverse Gaussian, by Michael, Schucany and Haas, Am. Stat. 30, 88 (1976); the smaller root without
/// cancellation.
double inverse_gaussian(double mean, double shape, double normal, double uniform) {
    const double a = 0.5 * mean * normal * normal / shape;
    const double root = mean / (1.0 + a + std::sqrt(a * (2.0 + a)));
    return uniform * (mean + root) <= mean ? root : mean * (mean / root);
}

/// When a pair that is d0 > 0 and d1 short of contact at the ends of a step of variance `spread` met first,
/// as a share of the step; given that it did.
double meeting_share(double d0, double d1, double spread, const Words& bits, double uniform) {
    const double end = std::max(std::abs(d1), 1e-9 * d0);
    const double odds = inverse_gaussian(d0 / end, d0 * d0 / spread, integrate::normals_of(bits)[0], uniform);
    return odds / (1.0 + odds);
}

} // namespace

Words NoisePlace::bits(Use use, std::size_t rod) const {
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
        const Words of_rod = position.bits(NoisePlace::Use::meeting, a), bits = bits_of_pair(of_rod, b, 0);
        if (d1 > 0.0 && integrate::uniform_of(bits[0], bits[1]) >= std::exp(-2.0 * d0 * d1 / spread))
            return;
        const double share = meeting_share(d0, d1, spread, bits_of_pair(of_rod, b, 1),
                                           integrate::uniform_of(bits[2], bits[3]));
        if (!first || share < first->share || (share == first->share && a < first->first))
            first = {share, a, b};
    };
    Sweep(step.state_before, box).pairs([&](double separation) { return separation > reach; }, look_at);
    return first;
}

} // namespace rodwake::rods
