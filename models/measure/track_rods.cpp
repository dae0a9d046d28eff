#include "track_rods.hpp"

#include "rodwake/core/periodic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::measure {

namespace {

constexpr double half_turn = std::numbers::pi, whole_turn = 2.0 * std::numbers::pi;
constexpr std::int64_t longest_absence = 50; // frames after which a rod could be anyone
constexpr std::size_t recent = 10;           // rows that tell how fast a rod goes

bool is_unwrapped(const Tracks& tracks) { return tracks.window || tracks.has_images; }

/// From one place to another: nearest images in a periodic box, where image indices do not say more.
struct RodWay {
    double x = 0.0, y = 0.0;

    RodWay(const Tracks& tracks, double x0, double y0, double x1, double y1)
        : x(is_unwrapped(tracks) ? x1 - x0 : nearest_image(x1 - x0, tracks.box.x)),
          y(is_unwrapped(tracks) ? y1 - y0 : nearest_image(y1 - y0, tracks.box.y)) {}
};

RodWay step(const Tracks& tracks, const RodTrack& rod, std::size_t from, std::size_t to) {
    return {tracks, rod.x[from], rod.y[from], rod.x[to], rod.y[to]};
}

/// Whether the second may be the first, come again under another number.
bool goes_on(const Tracks& tracks, const RodTrack& first, const RodTrack& second, double spacing) {
    const std::size_t last = first.frame.back(), begin = second.frame.front();
    if (begin <= last || tracks.tick[begin] - tracks.tick[last] > longest_absence)
        return false;
    const RodWay way(tracks, first.x.back(), first.y.back(), second.x.front(), second.y.front());
    // It may go half as fast again as at the end of the first.
    const std::size_t end = first.frame.size() - 1, from = end > recent ? end - recent : 0;
    const RodWay late = step(tracks, first, from, end);
    const double speed =
        from == end ? 0.0 : std::hypot(late.x, late.y) / (tracks.time[last] - tracks.time[first.frame[from]]);
    const double reach = 1.5 * speed * (tracks.time[begin] - tracks.time[last]) + spacing;
    return std::hypot(way.x, way.y) <= reach;
}

/// Of the rods of which this holds the first, if all others may be the same one once more, later; `is_later`
/// (rod, other) says so. Nothing: there is a rival, or none.
template<class Holds, class IsLater>
std::optional<std::size_t> without_rival(std::size_t count, const Holds& holds, const IsLater& is_later) {
    std::vector<std::size_t> found;
    for (std::size_t k = 0; k < count; ++k)
        if (holds(k))
            found.push_back(k);
    for (const std::size_t k : found)
        if (std::ranges::all_of(found, [&](std::size_t other) { return other == k || is_later(k, other); }))
            return k;
    return std::nullopt;
}

/// A rod that goes on as another: both without a rival. Nothing: none does.
bool join_two(Tracks& tracks, double spacing) {
    auto& rods = tracks.rods;
    const auto follows = [&](std::size_t k, std::size_t next) {
        return goes_on(tracks, rods[k], rods[next], spacing);
    };
    const auto precedes = [&](std::size_t k, std::size_t before) { return follows(before, k); };
    for (std::size_t i = 0; i < rods.size(); ++i) {
        const auto next = without_rival(
            rods.size(), [&](std::size_t k) { return follows(i, k); }, follows);
        if (!next || without_rival(
                         rods.size(), [&](std::size_t k) { return follows(k, *next); }, precedes) != i)
            continue;
        RodTrack& first = rods[i];
        const RodTrack& second = rods[*next];
        first.frame.insert(first.frame.end(), second.frame.begin(), second.frame.end());
        for (auto part : {&RodTrack::x, &RodTrack::y, &RodTrack::heading})
            (first.*part).insert((first.*part).end(), (second.*part).begin(), (second.*part).end());
        rods.erase(rods.begin() + static_cast<std::ptrdiff_t>(*next));
        ++tracks.counts.joined;
        return true;
    }
    return false;
}

void axes_to_headings(const Tracks& tracks, RodTrack& rod) {
    for (std::size_t i = 0; i < rod.frame.size();) {
        if (std::isnan(rod.heading[i])) {
            ++i;
            continue;
        }
        // Rows in which an axis can be followed: where it turns by an eighth at most and is not away for
        // long.
        constexpr std::int64_t longest_gap = 5; // frames
        std::size_t last = i;
        const auto since_last = [&](std::size_t row) {
            return tracks.tick[rod.frame[row]] - tracks.tick[rod.frame[last]];
        };
        for (std::size_t row = i + 1; row < rod.frame.size() && since_last(row) <= longest_gap + 1; ++row) {
            if (std::isnan(rod.heading[row]))
                continue;
            if (std::abs(std::remainder(rod.heading[row] - rod.heading[last], half_turn)) > half_turn / 4.0)
                break;
            last = row;
        }
        const std::size_t end = last + 1;
        // Headings of rows whose axes hang together, from the way they go; NaN if it is too short to tell.
        double along = 0.0;
        std::size_t before = i;
        for (std::size_t row = i + 1; row < end; ++row) {
            if (std::isnan(rod.heading[row]))
                continue;
            rod.heading[row] =
                rod.heading[before] + std::remainder(rod.heading[row] - rod.heading[before], half_turn);
            const double heading = 0.5 * (rod.heading[row] + rod.heading[before]);
            const RodWay way = step(tracks, rod, before, row);
            along += way.x * std::cos(heading) + way.y * std::sin(heading);
            before = row;
        }
        for (std::size_t row = i; row < end; ++row)
            rod.heading[row] = std::abs(along) < tracks.bead_radius
                                   ? std::nan("")
                                   : rod.heading[row] + (along < 0.0 ? half_turn : 0.0);
        i = end;
    }
}

} // namespace

void settle_rods(Tracks& tracks, double spacing, bool ahead, bool join) {
    constexpr std::size_t crowd = 100; // of so many rods nobody is without a rival
    while (join && tracks.rods.size() <= crowd && join_two(tracks, spacing)) {
    }
    for (RodTrack& rod : tracks.rods) {
        if (ahead)
            axes_to_headings(tracks, rod);
        for (const double heading : rod.heading)
            tracks.counts.headless += std::isnan(heading);
    }
}

std::optional<double> first_heading(const RodTrack& rod) {
    const auto found = std::ranges::find_if(rod.heading, [](double h) { return !std::isnan(h); });
    return found == rod.heading.end() ? std::nullopt : std::optional(*found);
}

void RodPlayer::play(std::size_t frame, std::vector<RodPosition>& positions) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    positions.assign(next_.size(), {unknown, unknown, unknown});
    for (std::size_t k = 0; k < next_.size(); ++k) {
        const RodTrack& rod = tracks_.rods[k];
        std::size_t& row = next_[k];
        if (row == rod.frame.size() || rod.frame[row] != frame)
            continue;
        const double x = rod.x[row], y = rod.y[row], heading = rod.heading[row];
        positions[k] = {is_unwrapped(tracks_) ? x : x_(k, x, tracks_.box.x),
                        is_unwrapped(tracks_) ? y : y_(k, y, tracks_.box.y),
                        std::abs(heading) > half_turn ? std::remainder(heading, whole_turn) : heading};
        ++row;
    }
}

HeadingTrack poses_of(const Tracks& tracks, std::size_t rod) {
    const RodTrack& track = tracks.rods[rod];
    const std::vector<double> unknown(tracks.frames(), std::nan(""));
    HeadingTrack poses{tracks.time, unknown, unknown, unknown};
    Unwrapping x(1), y(1);
    std::optional<double> before;
    for (std::size_t row = 0; row < track.frame.size(); ++row) {
        const std::size_t f = track.frame[row];
        poses.x[f] = is_unwrapped(tracks) ? track.x[row] : x(0, track.x[row], tracks.box.x);
        poses.y[f] = is_unwrapped(tracks) ? track.y[row] : y(0, track.y[row], tracks.box.y);
        if (std::isnan(track.heading[row]))
            continue;
        double heading = track.heading[row];
        if (before && !(std::abs(heading - *before) <= half_turn)) // the nearest turn
            heading = *before + std::remainder(heading - *before, whole_turn);
        before = poses.heading[f] = heading;
    }
    return poses;
}

} // namespace rodwake::measure
