// Data of a fit, read or given, are brought into shape, and checked for units and headings that look wrong.

#include "rodwake/app/fit.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rodwake::app {

namespace {

using States = std::vector<std::vector<double>>;
constexpr double turn = 2.0 * std::numbers::pi;

/// The heading that is nearest to the one before it, by whole turns. Untouched where it is near already.
double unwrapped(double heading, double before) {
    return std::abs(heading - before) <= std::numbers::pi
               ? heading
               : heading - turn * std::nearbyint((heading - before) / turn);
}

/// How all rods move: path lengths, the part along the heading between two rows, and the time it took.
struct Motion {
    double path = 0.0, along = 0.0, time = 0.0;
    double x = 0.0, y = 0.0; ///< sums of the displacements
    double largest = 0.0;    ///< heading, as in the file

    double cosine() const { return path > 0.0 ? along / path : 1.0; }
};

/// `unit`: of the headings, rad. Rows in which a rod stands still, as after a contact, do not count.
Motion motion_of(const fitting::Trajectory& track, double unit) {
    Motion sum;
    const std::size_t rows = std::min(track.times.size(), track.states.size());
    for (std::size_t row = 1; row < rows; ++row)
        for (std::size_t k = 0; k + 2 < std::min(track.states[row].size(), track.states[row - 1].size());
             k += 3) {
            const auto &a = track.states[row - 1], &b = track.states[row];
            const double dx = b[k] - a[k], dy = b[k + 1] - a[k + 1];
            if (dx == 0.0 && dy == 0.0)
                continue;
            const double heading = 0.5 * (unit * a[k + 2] + unwrapped(unit * b[k + 2], unit * a[k + 2]));
            sum.x += dx, sum.y += dy;
            sum.largest = std::max(sum.largest, std::abs(b[k + 2]));
            sum.path += std::hypot(dx, dy);
            sum.along += dx * std::cos(heading) + dy * std::sin(heading);
            sum.time += track.times[row] - track.times[row - 1];
        }
    return sum;
}

void add_motion(const FitTrackData& track, std::vector<std::string>& remarks) {
    const Motion motion = motion_of(track.data, 1.0);
    const double speed = motion.along / motion.time, path_speed = motion.path / motion.time;
    if (!std::isfinite(path_speed))
        return;
    const auto text = [&](double v) {
        return fmt::format(
            "{}: the rods move at {:.3g} in reduced units, where the model has 1: f_over_mu and speed of "
            "[[fit.trajectories]] convert the units of a file, and a track in Python is in reduced units "
            "already; "
            "speed = {:.3g} would do",
            track.file.string(), v, v * track.length / track.time);
    };
    if (path_speed < 0.1 || (speed > 10.0 && path_speed > 10.0))
        throw InputError(text(path_speed));
    if (motion.cosine() < 0.3 && speed < 0.5)
        remarks.push_back(
            fmt::format("{}: the rods do not move along their headings (mean cosine {:.2f}): theta is "
                        "counter-clockwise from +x, in radians",
                        track.file.string(), motion.cosine()));
    else if (speed < 0.6 || speed > 1.6)
        remarks.push_back(text(speed));
}

} // namespace

void settle_track(FitTrackData& track, std::optional<PeriodicBox> box) {
    States& states = track.data.states;
    track.data.box = box;

    // Rods that left through a side of the box and came in again at the other continue where they were.
    if (box)
        for (std::size_t row = 1; row < states.size(); ++row)
            for (std::size_t k = 0; k < states[row].size(); ++k)
                if (k % 3 != 2)
                    states[row][k] = states[row - 1][k] + nearest_image(states[row][k] - states[row - 1][k],
                                                                        k % 3 ? box->y : box->x);

    // Motion follows headings in degrees far better than the same numbers as radians, and not only because
    // all are near 0.
    const Motion motion = motion_of(track.data, turn / 360.0);
    const double in_rad = motion_of(track.data, 1.0).cosine(), in_deg = motion.cosine();
    const double spread = motion.path > 0.0 ? 1.0 - std::hypot(motion.x, motion.y) / motion.path : 0.0;
    const bool distinct = motion.largest > turn || 1.0 - in_deg < 0.5 * spread;
    if (distinct && in_rad < 0.9 && 1.0 - in_deg < 0.25 * (1.0 - in_rad))
        throw InputError(fmt::format("{}: the headings look like degrees: the rods move along them if they "
                                     "are (mean cosine {:.2f}), not if they "
                                     "are radians ({:.2f}); multiply theta by pi/180",
                                     track.file.string(), in_deg, in_rad));
    track.unwrapped = false;
    for (std::size_t row = 1; row < states.size(); ++row)
        for (std::size_t k = 2; k < states[row].size(); k += 3) {
            const double heading = unwrapped(states[row][k], states[row - 1][k]);
            track.unwrapped = track.unwrapped || heading != states[row][k];
            states[row][k] = heading;
        }
}

std::vector<std::string> data_remarks(const FitPlan& plan) {
    std::vector<std::string> remarks;
    for (const FitProfileData& profile : plan.profiles) {
        // Displacements against the distances at which they are: strains of above 1, or of nothing.
        double position = 0.0, value = 0.0;
        const fitting::Profile& data = profile.data;
        for (std::size_t i = 0; i < data.place.size(); ++i) {
            position = std::max(position, std::hypot(data.place[i], data.at));
            value = std::max(value, std::abs(data.value[i]));
        }
        if (value > position || (value > 0.0 && value < 1e-5 * position))
            remarks.push_back(
                fmt::format("{}: displacements of up to {:.2g} at positions up to {:.2g}: if their units "
                            "differ, give place_unit or value_unit",
                            profile.file.string(), value, position));
    }
    for (const FitTrackData& track : plan.tracks) {
        add_motion(track, remarks);
        if (!track.data.box)
            continue;

        // The periodic box is in the unit of the file; rods that see the images are not far from its sides.
        double largest = 0.0;
        for (const std::vector<double>& state : track.data.states)
            for (std::size_t k = 0; k < state.size(); ++k)
                if (k % 3 != 2)
                    largest = std::max(largest, std::abs(state[k] - state[k % 3]));
        if (track.data.box->shorter() > 100.0 * largest)
            remarks.push_back(fmt::format(
                "{}: fit.box = {:.3g} is far larger than the distances between the rods, up to "
                "{:.3g}: for tracks it is in the unit of the file",
                track.file.string(), track.data.box->shorter() * track.length, largest * track.length));
    }
    return remarks;
}

namespace {

/// measure.mirror puts the same numbers on both sides, which must not count twice.
bool is_mirrored(const fitting::Map& map) {
    const std::size_t nx = map.x.size(), ny = map.y.size();
    const double spacing = map.y[1] - map.y[0];
    std::size_t compared = 0;
    for (std::size_t j = 0; j < ny; ++j)
        for (std::size_t k = 0; k < nx; ++k) {
            const auto other = std::ranges::find_if(
                map.y, [&](double y) { return std::abs(y + map.y[j]) < 1e-6 * spacing; });
            if (map.y[j] >= 0.0 || other == map.y.end())
                continue;
            const std::size_t a = j * nx + k, b = static_cast<std::size_t>(other - map.y.begin()) * nx + k;
            if (!map.known[a] || !map.known[b])
                continue;
            ++compared;
            if (map.Ux[a] != map.Ux[b] || map.Uy[a] != -map.Uy[b])
                return false;
        }
    return compared > 0;
}

} // namespace

void settle_map(FitMapData& out, std::optional<double> independent_spacing) {
    fitting::Map& map = out.data;

    // If no bin has a sigma, weights are equal; if some have, the others are left out.
    const auto sigma_known = [&](std::size_t bin) {
        return std::isfinite(map.sigma_x[bin]) && std::isfinite(map.sigma_y[bin]);
    };
    bool any = false;
    for (std::size_t bin = 0; bin < map.bins(); ++bin)
        any = any || (map.known[bin] && sigma_known(bin));
    for (std::size_t bin = 0; any && bin < map.bins(); ++bin)
        if (map.known[bin] && !sigma_known(bin)) {
            map.known[bin] = false;
            ++out.left_out;
        }
    if (!any) {
        map.sigma_x.clear();
        map.sigma_y.clear();
    }

    // One half of a mirrored map counts, without y = 0, where mirroring makes U_y zero.
    out.mirrored = is_mirrored(map);
    for (std::size_t bin = 0; out.mirrored && bin < map.bins(); ++bin)
        map.known[bin] = map.known[bin] && map.place_y(bin) > 0.0;

    // Bins closer than independent values share their worth; together they are worth one value at least.
    if (independent_spacing)
        map.independent = std::max(std::min(1.0, (map.x[1] - map.x[0]) / *independent_spacing) *
                                       std::min(1.0, (map.y[1] - map.y[0]) / *independent_spacing),
                                   1.0 / static_cast<double>(map.bins()));
}

} // namespace rodwake::app
