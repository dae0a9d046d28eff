#include "rodwake/measure/frame.hpp"

#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/rod_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

void want_positive(const char* what, double value) {
    if (!(std::isfinite(value) && value > 0.0))
        throw InputError(fmt::format("measure: {} {}: must be finite and positive", what, value));
}

void want_values(const char* what, const std::vector<double>& values, std::size_t count) {
    if (values.size() != count)
        throw RunError(fmt::format("measure: {} {} in a frame, expected {}", values.size(), what, count));
    if (!std::ranges::all_of(values, [](double v) { return std::isfinite(v); }))
        throw RunError(fmt::format("measure: {} that are not finite", what));
}

} // namespace

Window room_within(bool round, const PeriodicBox& sides, double bead_radius) {
    const double away = 0.9 * bead_radius;
    if (round)
        return Window::circle(0.5 * sides.x, 0.5 * sides.y, 0.5 * sides.x - away);
    return Window::rectangle(away, away, sides.x - away, sides.y - away);
}

double seen_area(const Layout& layout) { return layout.window ? layout.window->area() : layout.box.area(); }

PeriodicBox image_box(const Layout& layout) { return layout.window ? layout.box * 2.0 : layout.box; }

PeriodicBox box_seen_by(std::size_t rod, const Layout& layout) {
    const double heading = layout.force                   ? layout.force->heading
                           : rod < layout.headings.size() ? layout.headings[rod]
                                                          : 0.0;
    const bool along_y = std::abs(std::sin(heading)) > std::abs(std::cos(heading));
    return along_y ? PeriodicBox(layout.box.y, layout.box.x) : layout.box;
}

std::vector<std::uint8_t> kinds_of(std::span<const double> radii, const Layout& layout) {
    std::vector<std::uint8_t> kinds;
    for (std::size_t i = 0; i < radii.size() && !layout.kind_radii.empty(); ++i) {
        const auto nearest = std::ranges::min_element(
            layout.kind_radii, {}, [&](double radius) { return std::abs(radius - radii[i]); });
        kinds.push_back(static_cast<std::uint8_t>(nearest - layout.kind_radii.begin()));
    }
    return kinds;
}

RodPosition place_of(std::size_t rod, const Layout& layout, const Frame& frame) {
    if (!layout.force)
        return frame.rods[rod];
    const MovingForce& force = *layout.force;
    return {force.x + force.vx * frame.time, force.y + force.vy * frame.time, force.heading};
}

void validate(const Layout& layout) {
    want_positive("side of the box", layout.box.x);
    want_positive("side of the box", layout.box.y);
    want_positive("bead radius", layout.bead_radius);
    if (layout.velocities)
        want_positive("bead mass", layout.bead_mass);
    if (layout.box.shorter() < 8.0 * layout.bead_radius)
        throw InputError(fmt::format("measure: a box of side {:.3g} a: must be at least 8 a",
                                     layout.box.shorter() / layout.bead_radius));
    if (layout.beads == 0)
        throw InputError("measure: there are no beads to measure");
}

void check_frame(const Layout& layout, const Frame& frame) {
    if (!std::isfinite(frame.time))
        throw RunError("measure: the time of a frame is not finite");

    // A frame of tracks names its beads in the order of their numbers.
    const std::size_t beads = layout.all_beads > 0 ? frame.x.size() : layout.beads;
    if (layout.all_beads > 0 && frame.bead.size() != beads)
        throw RunError(
            fmt::format("measure: a frame names {} of its {} beads", frame.bead.size(), frame.x.size()));
    for (std::size_t i = 0; layout.all_beads > 0 && i < beads; ++i)
        if (frame.bead[i] != untracked &&
            (frame.bead[i] >= layout.all_beads || (i > 0 && frame.bead[i] <= frame.bead[i - 1])))
            throw RunError("measure: beads of a frame that are not in the order of their numbers");
    for (const auto* values : {&frame.x, &frame.y, &frame.unwrapped_x, &frame.unwrapped_y})
        want_values("coordinates of beads", *values, beads);
    for (const auto* values : {&frame.vx, &frame.vy})
        want_values("velocities of beads", *values, layout.velocities ? beads : 0);
    if (frame.kind.size() != (layout.kind_radii.empty() ? 0 : beads) ||
        std::ranges::any_of(frame.kind, [&](std::size_t kind) { return kind >= layout.kind_radii.size(); }))
        throw RunError(fmt::format("measure: a frame of {} beads of {} kinds names the kinds of {}", beads,
                                   layout.kind_radii.size(), frame.kind.size()));
    for (const auto& [positions, side] :
         {std::pair(&frame.x, layout.box.x), std::pair(&frame.y, layout.box.y)})
        for (const double position : *positions)
            if (!(position >= 0.0 && (position < side || (layout.window && position == side))))
                throw RunError(fmt::format("measure: a bead at {} m, outside the box [0, {}): wrong box?",
                                           position, side));
    if (frame.rods.size() != layout.rods)
        throw RunError(
            fmt::format("measure: {} rods in a frame, expected {}", frame.rods.size(), layout.rods));
    for (const RodPosition& rod : frame.rods)
        if (layout.velocities &&
            !(std::isfinite(rod.x) && std::isfinite(rod.y) && std::isfinite(rod.heading)))
            throw RunError("measure: the position of a rod is not finite");
}

void FrameTimes::next(double time, const char* what, const std::optional<double>& grid) {
    const double step = time - last;
    if (frames > 0 && !(step > 0.0))
        throw RunError(fmt::format(
            "measure: {}: a frame at {:.9g} s follows one at {:.9g} s: times must grow", what, time, last));
    if (!grid && frames > 1 && std::abs(step - interval) > 1e-6 * interval)
        throw RunError(
            fmt::format("measure: {}: frames at {:.9g} s and {:.9g} s are {:.9g} s apart, those before "
                        "{:.9g} s: they must be evenly spaced",
                        what, last, time, step, interval));
    if (frames == 0)
        first = time;
    interval = grid ? *grid : frames == 1 ? step : interval;
    tick = grid && *grid > 0.0 ? static_cast<std::size_t>(std::lround((time - first) / *grid)) : frames;
    last = time;
    ++frames;
}

void FrameTimes::save(StateWriter& out) const {
    out.put(frames);
    out.put(last);
    out.put(interval);
}

void FrameTimes::load(StateReader& in) {
    frames = in.count();
    last = in.get();
    interval = in.get();
    tick = frames > 0 ? frames - 1 : 0;
}

namespace {

constexpr double finest = 512.0; ///< bins in x or y: a block of the displacement then takes 19 MB

/// Column or row of a coordinate: n stands for the periodic image of 0.
std::optional<std::size_t> column(double position, double spacing, std::size_t n) {
    const std::size_t middle = n / 2;
    const double k = std::floor(position / spacing + 0.5) + static_cast<double>(middle);
    if (!(k >= 0.0 && k <= static_cast<double>(n)))
        return std::nullopt;
    return static_cast<std::size_t>(k) % n;
}

std::size_t even_count(double side, double wanted) {
    if (!(std::isfinite(side) && side > 0.0))
        throw InputError(
            fmt::format("measure: a grid over a box of {:g} m: must be finite and positive", side));
    if (!(wanted > 0.0 && wanted <= side / 4.0 && wanted >= side / finest))
        throw InputError(fmt::format(
            "measure: spacing {:g} m of the grid: must be from {:g} m to a quarter of the box, {:g} m",
            wanted, side / finest, side / 4.0));
    return 2 * static_cast<std::size_t>(std::max(2.0, std::round(side / (2.0 * wanted))));
}

} // namespace

RodGrid::RodGrid(const PeriodicBox& sides, double wanted, double around)
    : box(sides), columns(even_count(sides.x, wanted)), rows(even_count(sides.y, wanted)),
      width(sides.x / static_cast<double>(columns)), height(sides.y / static_cast<double>(rows)),
      margin(around) {}

std::optional<std::size_t> RodGrid::bin(double x, double y) const {
    const bool in_margin =
        margin > 0.0 && !(std::abs(x) < 0.5 * box.x - margin && std::abs(y) < 0.5 * box.y - margin);
    if (bins() == 0 || in_margin)
        return std::nullopt;
    const auto i = column(x, width, columns), j = column(y, height, rows);
    if (!i || !j)
        return std::nullopt;
    return *j * columns + *i;
}

RodGrid grid_seen_by(std::size_t rod, const Layout& layout, double wanted) {
    const PeriodicBox box = box_seen_by(rod, layout);
    if (!layout.window)
        return {box, wanted};
    const double margin = 4.0 * layout.bead_radius + 2.0 * wanted; // wider than what a mean is taken over
    return {{box.x + 2.0 * margin, box.y + 2.0 * margin}, wanted, margin};
}

RelativePosition relative_position(const RodPosition& rod, double x, double y, const PeriodicBox& box) {
    const double dx = nearest_image(x - rod.x, box.x), dy = nearest_image(y - rod.y, box.y);
    const double c = std::cos(rod.heading), s = std::sin(rod.heading);
    return {c * dx + s * dy, -s * dx + c * dy};
}

} // namespace rodwake::measure
