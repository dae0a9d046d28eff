#include "rodwake/store/frames.hpp"

#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace rodwake::store {

namespace {

template<class Error>
void want_count(const char* what, std::size_t found, std::size_t wanted) {
    if (found != wanted)
        throw Error(fmt::format("frames: {} {}, expected {}", found, what, wanted));
}

void check_name(const std::string& name) {
    const auto bad = [](char c) { return c <= ' ' || c > '~' || c == '/' || c == '"' || c == '='; };
    if (name.empty() || name == "." || std::ranges::any_of(name, bad))
        throw InputError(fmt::format("frames: \"{}\" is no name; use letters, digits and _ -", name));
}

template<class Values>
void want_distinct(const char* what, const Values& values) {
    if (std::set(values.begin(), values.end()).size() != values.size())
        throw InputError(fmt::format("frames: {} are not distinct", what));
}

void want_positive(const char* what, std::span<const double> values) {
    for (const double value : values)
        if (!(value > 0.0) || !std::isfinite(value))
            throw InputError(fmt::format("frames: {} = {}: must be finite and positive", what, value));
}

void want_below(const char* what, std::span<const std::int32_t> values, std::size_t limit) {
    for (const std::int32_t value : values)
        if (value < 0 || static_cast<std::size_t>(value) >= limit)
            throw InputError(fmt::format("frames: {} = {}: must be from 0 to below {}", what, value, limit));
}

void want_values(const char* what, std::span<const double> values, std::size_t count) {
    want_count<RunError>(what, values.size(), count);
    if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); }))
        throw RunError(fmt::format("frames: {} that are not finite", what));
}

} // namespace

void check_layout(const FrameLayout& layout) {
    const std::size_t n = layout.particles(), loose = std::ranges::count(layout.species, 0);
    if (n == 0)
        throw InputError("frames: no particles");
    want_count<InputError>("ids", layout.id.size(), n);
    want_count<InputError>("masses", layout.mass.size(), n);
    want_count<InputError>("radii", layout.radius.size(), n);
    want_count<InputError>("owners of the spheres of rods", layout.rod_of_sphere.size(), n - loose);
    want_count<InputError>("masses of rods", layout.rod_mass.size(), layout.rods());
    want_positive("a side of the box", layout.box);
    want_positive("a mass", layout.mass);
    want_positive("a radius", layout.radius);
    want_positive("the mass of a rod", layout.rod_mass);
    want_below("a species", layout.species, layout.kinds.size());
    want_below("the rod of a sphere", layout.rod_of_sphere, layout.rods());
    want_distinct("ids", layout.id);
    want_distinct("ids of rods", layout.rod_id);
    want_distinct("names of observables", layout.observables);
    for (const std::string& name : layout.observables) {
        check_name(name);
        // Observables stand beside these in extended XYZ and in the readers' own tables.
        static const std::set<std::string> reserved = {"Lattice", "Properties", "pbc", "Time",
                                                       "Step",    "time",       "step"};
        if (reserved.contains(name))
            throw InputError(
                fmt::format("frames: no observable can be named \"{}\": the formats use it", name));
    }
    for (const Species& kind : layout.kinds) {
        check_name(kind.name);
        check_name(kind.symbol);
    }
}

void check_frame(const FrameLayout& layout, const Frame& frame, std::int64_t after_step) {
    if (frame.step <= after_step)
        throw RunError(fmt::format("frames: step {} after step {}", frame.step, after_step));
    want_values("times", {&frame.time, 1}, 1);
    want_values("components of positions", frame.position, 3 * layout.particles());
    want_values("components of velocities", frame.velocity, 3 * layout.particles());
    want_values("components of positions of rods", frame.rod_position, 3 * layout.rods());
    want_values("components of velocities of rods", frame.rod_velocity, 3 * layout.rods());
    want_values("components of orientations", frame.rod_orientation, 4 * layout.rods());
    want_values("components of angular momenta", frame.rod_angular_momentum, 3 * layout.rods());
    want_values("observables", frame.observables, layout.observables.size());
}

PeriodicCoordinate wrap(double x, double side) {
    double image = std::floor(x / side);
    if (!(std::abs(image) <= 0x1p30))
        throw RunError(fmt::format("frames: position {} is not near the box of side {}", x, side));
    double position = std::fma(-side, image, x);
    if (position < 0.0) // x/side was rounded up
        position = std::fma(-side, --image, x);
    if (position >= side) // just below a multiple of the side: rounded to it
        position = std::max(0.0, std::fma(-side, ++image, x));
    return {position, static_cast<std::int32_t>(image)};
}

WrappedVectors wrap(std::span<const double> positions, const FrameLayout& layout) {
    WrappedVectors out{{positions.begin(), positions.end()}, std::vector<std::int32_t>(positions.size(), 0)};
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (layout.periodic[i % 3]) {
            const PeriodicCoordinate item = wrap(positions[i], layout.box[i % 3]);
            out.place[i] = item.place;
            out.image[i] = item.image;
        }
    return out;
}

} // namespace rodwake::store
