#include "h5md_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::store {

namespace {

const std::string spheres = "particles/trajectory/", rods = "particles/trajectory_rods/";
constexpr hsize_t rows_at_once = 1024;

/// Box edges of one frame.
using Edges = std::array<double, 9>;

template<class Number>
std::vector<Number> read_column(const Hdf5Input& file, const std::string& path, hid_t type) {
    const Hdf5Table table(file, path, type);
    if (table.shape().size() != 1)
        file.refuse(path + " is not a single column of numbers");
    std::vector<Number> values(table.size());
    table.read(values.data());
    return values;
}

void read_moments(const Hdf5Input& file, TrajectoryInfo& info) {
    info.step = read_column<std::int64_t>(file, spheres + "position/step", H5T_STD_I64LE);
    info.time = read_column<double>(file, spheres + "position/time", H5T_IEEE_F64LE);
    if (info.frames() == 0)
        file.refuse("the trajectory holds no frames");
    if (info.time.size() != info.frames())
        file.refuse(fmt::format("{} steps at {} times", info.frames(), info.time.size()));
    for (std::size_t k = 0; k < info.frames(); ++k) {
        if (!std::isfinite(info.time[k]))
            file.refuse(fmt::format("the time of frame {} is not finite", k));
        if (k > 0 && (info.step[k] <= info.step[k - 1] || info.time[k] <= info.time[k - 1]))
            file.refuse(
                fmt::format("frame {} (step {}, {} s) is not later than the one before (step {}, {} s)", k,
                            info.step[k], info.time[k], info.step[k - 1], info.time[k - 1]));
    }
}

void check_boundary(const Hdf5Input& file) {
    const auto boundary = text_attribute(file, spheres + "box", "boundary");
    if (boundary.size() != 3 || boundary[0] != "periodic" || boundary[1] != "periodic")
        file.refuse("the box is not periodic in x and y");
}

std::array<double, 3> sides(const Hdf5Input& file, const Edges& edges) {
    const std::array<double, 3> box = {edges[0], edges[4], edges[8]};
    const Edges upright = {box[0], 0, 0, 0, box[1], 0, 0, 0, box[2]};
    const bool good = std::ranges::all_of(box, [](double side) { return side > 0.0 && std::isfinite(side); });
    if (!good || edges != upright)
        file.refuse("the edges of the box are not three positive sides along x, y and z");
    return box;
}

void read_box(const Hdf5Input& file, TrajectoryInfo& info) {
    check_boundary(file);
    const std::string path = spheres + "box/edges/value";
    const Hdf5Table table(file, path, H5T_IEEE_F64LE);
    table.want_shape({info.frames(), 3, 3});
    std::vector<Edges> edges(std::min<std::size_t>(rows_at_once, info.frames()));
    Edges first{};
    for (std::size_t from = 0; from < info.frames(); from += edges.size()) {
        const std::size_t count = std::min(edges.size(), info.frames() - from);
        table.read_rows(from, count, edges.data());
        if (from == 0)
            info.box = sides(file, first = edges[0]);
        for (std::size_t k = 0; k < count; ++k)
            if (edges[k] != first)
                file.refuse(fmt::format("the box changes in frame {}", from + k));
    }
}

/// The one radius or mass of all beads.
double common_value(const Hdf5Input& file, const TrajectoryInfo& info, const std::string& what) {
    const auto values = read_column<double>(file, spheres + what, H5T_IEEE_F64LE);
    if (values.size() != info.particles)
        file.refuse(fmt::format("{} particles have {} values of {}", info.particles, values.size(), what));
    if (!(values[0] > 0.0) || !std::isfinite(values[0]))
        file.refuse(fmt::format("the {} of bead 0 is {}: not positive and finite", what, values[0]));
    for (std::size_t i = 1; i < info.beads; ++i)
        if (values[i] != values[0])
            file.refuse(fmt::format("the {} of bead {} is {}, that of bead 0 {}: all beads must be alike",
                                    what, i, values[i], values[0]));
    return values[0];
}

void read_particles(const Hdf5Input& file, TrajectoryInfo& info) {
    const auto species = read_column<std::int32_t>(file, spheres + "species", H5T_STD_I32LE);
    const auto bead = [](std::int32_t kind) { return kind == 0; };
    info.particles = species.size();
    info.beads = static_cast<std::size_t>(std::ranges::find_if_not(species, bead) - species.begin());
    if (info.beads == 0 ||
        std::any_of(species.begin() + static_cast<std::ptrdiff_t>(info.beads), species.end(), bead))
        file.refuse(
            fmt::format("the beads (species 0) are not the first of its {} particles", info.particles));
    info.bead_radius = common_value(file, info, "radius");
    info.bead_mass = common_value(file, info, "mass");
}

void count_rods(const Hdf5Input& file, TrajectoryInfo& info) {
    if (file.has("particles/trajectory_rods"))
        info.rods = read_column<double>(file, rods + "mass", H5T_IEEE_F64LE).size();
    if (info.rods == 0 && info.particles > info.beads)
        file.refuse(fmt::format("{} particles are not beads, but particles/trajectory_rods tells of no rods",
                                info.particles - info.beads));
}

void read_parameters(const Hdf5Input& file, TrajectoryInfo& info) {
    if (!file.has("parameters"))
        file.refuse("group parameters is missing");
    for (const std::string& name : real_attributes(file, "parameters")) {
        const double value = real_attribute(file, "parameters", name);
        if (!std::isfinite(value))
            file.refuse(fmt::format("parameter {} is not finite", name));
        info.parameters.emplace(name, value);
    }
}

} // namespace

TrajectoryInfo read_trajectory_info(const Hdf5Input& file) {
    for (const char* group : {"particles", "particles/trajectory"})
        if (!file.has(group))
            file.refuse(fmt::format("group {} is missing: this is no trajectory", group));
    TrajectoryInfo info;
    read_moments(file, info);
    read_box(file, info);
    read_particles(file, info);
    count_rods(file, info);
    read_parameters(file, info);
    info.seed = unsigned_attribute(file, "rodwake", "seed");
    return info;
}

} // namespace rodwake::store
