#include "rodwake/store/h5md_reader.hpp"

#include "h5md_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

namespace rodwake::store {

namespace {

constexpr hsize_t rows_at_once = 1024;

/// Box edges of one frame.
using Edges = std::array<double, 9>;

void scale(std::vector<double>& values, double factor) {
    for (double& value : values)
        value *= factor;
}

template<class Number>
std::vector<Number> read_column(const Hdf5Input& file, const std::string& path, hid_t type) {
    const Hdf5Table table(file, path, type);
    if (table.shape().size() != 1)
        file.refuse(path + " is not a single column of numbers");
    std::vector<Number> values(table.size());
    table.read(values.data());
    return values;
}

void read_box(const Hdf5Input& file, TrajectoryInfo& info) {
    // The box is periodic in x and y, or has a wall in both.
    const auto boundary = text_attribute(file, spheres + "box", "boundary");
    if (boundary.size() != 3 || boundary[0] != boundary[1] ||
        (boundary[0] != "periodic" && boundary[0] != "none"))
        file.refuse("the box is not periodic in x and y, nor has it a wall (boundary \"none\") in both");
    info.periodic = boundary[0] == "periodic";
    const std::string path = spheres + "box/edges/value";
    const Hdf5Table table(file, path, H5T_IEEE_F64LE);
    table.want_shape({info.frames(), 3, 3});
    std::vector<Edges> edges(std::min<std::size_t>(rows_at_once, info.frames()));
    Edges first{};
    for (std::size_t from = 0; from < info.frames(); from += edges.size()) {
        const std::size_t count = std::min(edges.size(), info.frames() - from);
        table.read_rows(from, count, edges.data());
        if (from == 0) {
            first = edges[0];
            info.box = {first[0], first[4], first[8]};
            const Edges upright = {info.box[0], 0, 0, 0, info.box[1], 0, 0, 0, info.box[2]};
            if (first != upright ||
                !std::ranges::all_of(info.box, [](double side) { return side > 0.0 && std::isfinite(side); }))
                file.refuse("the edges of the box are not three positive sides along x, y and z");
        }
        for (std::size_t k = 0; k < count; ++k)
            if (edges[k] != first)
                file.refuse(fmt::format("the box changes in frame {}", from + k));
    }
    for (double& side : info.box)
        side *= si_factor(file, path, H5mdUnit::length);
}

/// The radii or masses of the beads, SI.
std::vector<double> bead_values(const Hdf5Input& file, const TrajectoryInfo& info, const std::string& what,
                                H5mdUnit unit) {
    auto values = read_column<double>(file, spheres + what, H5T_IEEE_F64LE);
    if (values.size() != info.particles)
        file.refuse(fmt::format("{} particles have {} values of {}", info.particles, values.size(), what));
    values.resize(info.beads);
    const double factor = si_factor(file, spheres + what, unit);
    for (std::size_t i = 0; i < info.beads; ++i) {
        if (!(values[i] > 0.0) || !std::isfinite(values[i]))
            file.refuse(fmt::format("the {} of bead {} is {}: not positive and finite", what, i, values[i]));
        values[i] *= factor;
    }
    return values;
}

/// Radius and mass of the beads; of several sizes the radius that lengths refer to, and the mean mass.
void read_sizes(const Hdf5Input& file, TrajectoryInfo& info) {
    info.radius = bead_values(file, info, "radius", H5mdUnit::length);
    const std::vector<double> mass = bead_values(file, info, "mass", H5mdUnit::mass);
    const auto differ = [](const std::vector<double>& values) {
        return std::ranges::adjacent_find(values, std::ranges::not_equal_to()) != values.end();
    };
    info.bead_radius = info.radius[0];
    info.bead_mass = mass[0];
    if (differ(mass)) {
        info.bead_mass = 0.0;
        for (const double m : mass)
            info.bead_mass += m / static_cast<double>(mass.size());
    }
    if (!differ(info.radius))
        return;
    const auto unit = info.parameters.find("bead_radius");
    if (unit == info.parameters.end())
        file.refuse(
            "beads have different radii, and parameters/bead_radius, the unit of lengths, is missing");
    info.bead_radius = unit->second;
}

/// The part of a trajectory that is the same in every frame, read and checked. Throws InputError.
TrajectoryInfo read_trajectory_info(const Hdf5Input& file) {
    for (const char* group : {"particles", "particles/trajectory"})
        if (!file.has(group))
            file.refuse(fmt::format("group {} is missing: this is no trajectory", group));
    TrajectoryInfo info;
    info.step = read_column<std::int64_t>(file, spheres + "position/step", H5T_STD_I64LE);
    info.time = read_column<double>(file, spheres + "position/time", H5T_IEEE_F64LE);
    scale(info.time, si_factor(file, spheres + "position/time", H5mdUnit::time));
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
    read_box(file, info);
    const auto species = read_column<std::int32_t>(file, spheres + "species", H5T_STD_I32LE);
    const auto bead = [](std::int32_t kind) { return kind == 0; };
    info.particles = species.size();
    info.beads = static_cast<std::size_t>(std::ranges::find_if_not(species, bead) - species.begin());
    if (info.beads == 0 ||
        std::any_of(species.begin() + static_cast<std::ptrdiff_t>(info.beads), species.end(), bead))
        file.refuse(
            fmt::format("the beads (species 0) are not the first of its {} particles", info.particles));
    if (file.has("particles/trajectory_rods"))
        info.rods = read_column<double>(file, rods + "mass", H5T_IEEE_F64LE).size();
    if (info.rods == 0 && info.particles > info.beads)
        file.refuse(fmt::format("{} particles are not beads, but particles/trajectory_rods contains no rods",
                                info.particles - info.beads));
    if (!file.has("parameters"))
        file.refuse("group parameters is missing");
    for (const std::string& name : real_attributes(file, "parameters")) {
        const double value = real_attribute(file, "parameters", name);
        if (!std::isfinite(value))
            file.refuse(fmt::format("parameter {} is not finite", name));
        info.parameters.emplace(name, value);
    }
    read_sizes(file, info);
    info.seed = unsigned_attribute(file, "rodwake", "seed");
    return info;
}

const std::string trajectory_advice =
    "give a trajectory.h5md as rodwake dem writes it, or repeat the run if this should be one";

/// Which row of a frame is whose, where bodies have numbers (`id`); the order is that of the first frame.
class BodyOrder {
public:
    BodyOrder(const Hdf5Input& file, const std::string& group, hsize_t frames, hsize_t count)
        : file_(file), path_(group + "id"), row_(count) {
        const bool in_time = file.has(path_) && file.has(path_ + "/value");
        if (file.has(path_))
            ids_.emplace(file, path_ + (in_time ? "/value" : ""), H5T_NATIVE_INT64);
        if (ids_)
            ids_->want_shape(in_time ? std::vector<hsize_t>{frames, count} : std::vector<hsize_t>{count});
        for (std::size_t i = 0; i < count; ++i)
            row_[i] = i;
        if (!ids_)
            return;
        first_ = now_ = std::vector<std::int64_t>(count);
        ids_->read_rows(0, in_time ? 1 : count, first_.data());
        for (std::size_t i = 0; i < count; ++i)
            if (!body_.emplace(first_[i], i).second)
                file.refuse(fmt::format("{} {} appears twice in frame 0", path_, first_[i]));
        if (!in_time)
            ids_.reset(); // the same in all frames
    }

    /// Only rows of a body's own species, of which the first `beads` are one, can be its rows.
    void read(std::size_t frame, std::size_t beads) {
        if (!ids_)
            return;
        ids_->read_rows(frame, 1, now_.data());
        if (now_ == first_ && in_order_)
            return;
        in_order_ = now_ == first_;
        std::vector<bool> seen(row_.size(), false);
        for (std::size_t i = 0; i < now_.size(); ++i) {
            const auto at = body_.find(now_[i]);
            const auto refuse = [&](const char* why) {
                file_.refuse(fmt::format("frame {}: {} {} {}", frame, path_, now_[i], why));
            };
            if (at == body_.end())
                refuse("is not in frame 0: all frames must hold the same bodies");
            if (seen[at->second])
                refuse("appears twice");
            if ((i < beads) != (at->second < beads))
                refuse("is a bead in one frame and none in another");
            seen[at->second] = true;
            row_[at->second] = i;
        }
    }

    std::size_t operator[](std::size_t body) const { return row_[body]; }

private:
    const Hdf5Input& file_;
    std::string path_;
    std::optional<Hdf5Table> ids_;
    std::vector<std::size_t> row_;
    std::vector<std::int64_t> first_, now_;
    std::unordered_map<std::int64_t, std::size_t> body_;
    bool in_order_ = true;
};

/// Position and number of the box of one kind of bodies.
struct BodyPositions {
    Hdf5Table position, image;
    BodyOrder row;
    double factor;
    std::size_t beads;         ///< of the bodies
    std::vector<double> place; ///< of the frame read last, [count][3]
    std::vector<std::int32_t> box;

    BodyPositions(const Hdf5Input& file, const std::string& group, hsize_t frames, hsize_t count,
                  std::size_t beads_of)
        : position(file, group + "position/value", H5T_IEEE_F64LE),
          image(file, group + "image/value", H5T_STD_I32LE), row(file, group, frames, count),
          factor(si_factor(file, group + "position/value", H5mdUnit::length)), beads(beads_of),
          place(3 * count), box(3 * count) {
        position.want_shape({frames, count, 3});
        image.want_shape({frames, count, 3});
    }

    void read(std::size_t frame, const std::array<double, 3>& sides) {
        position.read_rows(frame, 1, place.data());
        image.read_rows(frame, 1, box.data());
        row.read(frame, beads);
        if (factor == 1.0)
            return;
        scale(place, factor);
        for (std::size_t i = 0; i < place.size(); ++i) // below the side, and rounded to it
            if (const double side = sides[i % 3];
                i % 3 < 2 && place[i] >= side && place[i] <= side * (1.0 + 1e-15))
                place[i] = std::nextafter(side, 0.0);
    }
};

/// One quantity of each body.
struct Vectors {
    Hdf5Table table;
    std::vector<double> value; ///< of the frame read last

    Vectors(const Hdf5Input& file, const std::string& path, const std::vector<hsize_t>& shape)
        : table(file, path, H5T_IEEE_F64LE), value(shape[1] * shape[2]) {
        table.want_shape(shape);
    }

    void read(std::size_t frame) { table.read_rows(frame, 1, value.data()); }
};

struct Rods {
    BodyPositions places;
    Vectors orientation;

    Rods(const Hdf5Input& file, hsize_t frames, hsize_t count)
        : places(file, "particles/trajectory_rods/", frames, count, 0),
          orientation(file, "particles/trajectory_rods/orientation/value", {frames, count, 4}) {}
};

bool finite(const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}
} // namespace

struct H5mdReader::Impl {
    Hdf5Input file;
    TrajectoryInfo info;
    BodyPositions places;
    Vectors velocity;
    double speed; ///< unit of the velocities, m/s
    std::optional<Rods> rods;

    explicit Impl(const std::filesystem::path& path)
        : file(path, trajectory_advice), info(read_trajectory_info(file)),
          places(file, "particles/trajectory/", info.frames(), info.particles, info.beads),
          velocity(file, "particles/trajectory/velocity/value", {info.frames(), info.particles, 3}),
          speed(si_factor(file, "particles/trajectory/velocity/value", H5mdUnit::speed)) {
        if (info.rods > 0)
            rods.emplace(file, info.frames(), info.rods);
    }

    [[noreturn]] void refuse(std::size_t frame, const std::string& what) const {
        file.refuse(fmt::format("frame {}: {}", frame, what));
    }

    /// Positions in the box are finite; what is not looked at otherwise must be, too. Images of the box so
    /// large that nothing walks there would cost positions their digits.
    void check(std::size_t frame, const char* kind, std::size_t count, const BodyPositions& bodies) const {
        for (std::size_t i = 0; i < count; ++i) {
            const double x = bodies.place[3 * i], y = bodies.place[3 * i + 1];
            if (!(x >= 0.0 && x < info.box[0] && y >= 0.0 && y < info.box[1]))
                refuse(frame, fmt::format("{} {} is at ({}, {}) m, outside the box of {} x {} m", kind, i, x,
                                          y, info.box[0], info.box[1]));
        }
        if (!finite(bodies.place))
            refuse(frame, "positions that are not finite");
        constexpr std::int32_t most = 1'000'000;
        const auto far =
            std::ranges::find_if(bodies.box, [](std::int32_t n) { return n > most || n < -most; });
        if (far != bodies.box.end())
            refuse(frame, fmt::format("{} {} is in image {} of the box, farther than {}", kind,
                                      (far - bodies.box.begin()) / 3, *far, most));
    }

    /// One component of the beads.
    template<class Number>
    void take(const std::vector<Number>& rows, std::size_t component, std::vector<Number>& out) const {
        out.resize(info.beads);
        for (std::size_t i = 0; i < info.beads; ++i)
            out[i] = rows[3 * places.row[i] + component];
    }

    void read(std::size_t frame, StoredFrame& out) {
        places.read(frame, info.box);
        velocity.read(frame);
        scale(velocity.value, speed);
        check(frame, "bead", info.beads, places);
        if (!finite(velocity.value))
            refuse(frame, "velocities that are not finite");
        take(places.place, 0, out.x);
        take(places.place, 1, out.y);
        take(places.place, 2, out.z);
        take(places.box, 0, out.image_x);
        take(places.box, 1, out.image_y);
        take(velocity.value, 0, out.vx);
        take(velocity.value, 1, out.vy);
        take(velocity.value, 2, out.vz);
        out.rods.resize(info.rods);
        if (!rods)
            return;
        rods->places.read(frame, info.box);
        rods->orientation.read(frame);
        check(frame, "rod", info.rods, rods->places);
        for (std::size_t i = 0; i < info.rods; ++i) {
            const std::size_t row = rods->places.row[i];
            const double* place = &rods->places.place[3 * row];
            const std::int32_t* box = &rods->places.box[3 * row];
            const double* q = &rods->orientation.value[4 * row];
            out.rods[i] = {place[0], place[1], box[0], box[1], {q[0], q[1], q[2], q[3]}};
            const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
            if (!(norm > 0.0 && std::isfinite(norm)))
                refuse(frame, fmt::format("the orientation of rod {} is 0 or not finite", i));
        }
    }
};

H5mdReader::H5mdReader(const std::filesystem::path& path)
    : impl_((Hdf5Guard(), std::make_unique<Impl>(path))) {}

H5mdReader::~H5mdReader() {
    const Hdf5Guard guard;
    impl_.reset();
}
H5mdReader::H5mdReader(H5mdReader&&) noexcept = default;
H5mdReader& H5mdReader::operator=(H5mdReader&&) noexcept = default;

const TrajectoryInfo& H5mdReader::info() const { return impl_->info; }

void H5mdReader::read(std::size_t frame, StoredFrame& out) {
    const Hdf5Guard guard;
    if (frame >= info().frames())
        impl_->file.refuse(fmt::format("no frame {}: it holds 0 to {}", frame, info().frames() - 1));
    set_up_hdf5(); // this may be another thread than the one that opened the file
    out.step = info().step[frame];
    out.time = info().time[frame];
    impl_->read(frame, out);
}

} // namespace rodwake::store
