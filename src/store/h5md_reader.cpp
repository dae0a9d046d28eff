#include "rodwake/store/h5md_reader.hpp"

#include "h5md_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace rodwake::store {

namespace {

const std::string advice =
    "give a trajectory.h5md as rodwake dem writes it, or repeat the run if this should be one";

/// Position and number of the box of one kind of bodies.
struct Places {
    Hdf5Table position, image;
    std::vector<double> place; ///< of the frame read last, [count][3]
    std::vector<std::int32_t> box;

    Places(const Hdf5Input& file, const std::string& group, hsize_t frames, hsize_t count)
        : position(file, group + "position/value", H5T_IEEE_F64LE),
          image(file, group + "image/value", H5T_STD_I32LE), place(3 * count), box(3 * count) {
        position.want_shape({frames, count, 3});
        image.want_shape({frames, count, 3});
    }

    void read(std::size_t frame) {
        position.read_rows(frame, 1, place.data());
        image.read_rows(frame, 1, box.data());
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
    Places places;
    Vectors orientation;

    Rods(const Hdf5Input& file, hsize_t frames, hsize_t count)
        : places(file, "particles/trajectory_rods/", frames, count),
          orientation(file, "particles/trajectory_rods/orientation/value", {frames, count, 4}) {}
};

bool finite(const std::vector<double>& values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

bool is_orientation(const std::array<double, 4>& q) {
    const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    return norm > 0.0 && std::isfinite(norm);
}

} // namespace

struct H5mdReader::Impl {
    Hdf5Input file;
    TrajectoryInfo info;
    Places places;
    Vectors velocity;
    std::optional<Rods> rods;

    explicit Impl(const std::filesystem::path& path)
        : file(path, advice), info(read_trajectory_info(file)),
          places(file, "particles/trajectory/", info.frames(), info.particles),
          velocity(file, "particles/trajectory/velocity/value", {info.frames(), info.particles, 3}) {
        if (info.rods > 0)
            rods.emplace(file, info.frames(), info.rods);
    }

    [[noreturn]] void refuse(std::size_t frame, const std::string& what) const {
        file.refuse(fmt::format("frame {}: {}", frame, what));
    }

    /// Places in the box are finite; what is not looked at otherwise must be, too.
    void check(std::size_t frame, const char* kind, std::size_t count,
               const std::vector<double>& place) const {
        for (std::size_t i = 0; i < count; ++i) {
            const double x = place[3 * i], y = place[3 * i + 1];
            if (!(x >= 0.0 && x < info.box[0] && y >= 0.0 && y < info.box[1]))
                refuse(frame, fmt::format("{} {} is at ({}, {}) m, outside the box of {} x {} m", kind, i, x,
                                          y, info.box[0], info.box[1]));
        }
        if (!finite(place))
            refuse(frame, "positions that are not finite");
    }

    void read_beads(std::size_t frame, StoredFrame& out) {
        places.read(frame);
        velocity.read(frame);
        check(frame, "bead", info.beads, places.place);
        if (!finite(velocity.value))
            refuse(frame, "velocities that are not finite");
        take(places.place, 0, out.x);
        take(places.place, 1, out.y);
        take(places.box, 0, out.image_x);
        take(places.box, 1, out.image_y);
        take(velocity.value, 0, out.vx);
        take(velocity.value, 1, out.vy);
    }

    /// One component of the beads.
    template<class Number>
    void take(const std::vector<Number>& rows, std::size_t component, std::vector<Number>& out) const {
        out.resize(info.beads);
        for (std::size_t i = 0; i < info.beads; ++i)
            out[i] = rows[3 * i + component];
    }

    void read_rods(std::size_t frame, StoredFrame& out) {
        out.rods.resize(info.rods);
        if (!rods)
            return;
        rods->places.read(frame);
        rods->orientation.read(frame);
        check(frame, "rod", info.rods, rods->places.place);
        for (std::size_t i = 0; i < info.rods; ++i)
            if (!is_orientation((out.rods[i] = rod(i)).orientation))
                refuse(frame, fmt::format("the orientation of rod {} is 0 or not finite", i));
    }

    StoredRod rod(std::size_t i) const {
        const double* place = &rods->places.place[3 * i];
        const std::int32_t* box = &rods->places.box[3 * i];
        const double* q = &rods->orientation.value[4 * i];
        return {place[0], place[1], box[0], box[1], {q[0], q[1], q[2], q[3]}};
    }
};

H5mdReader::H5mdReader(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {}

H5mdReader::~H5mdReader() = default;
H5mdReader::H5mdReader(H5mdReader&&) noexcept = default;
H5mdReader& H5mdReader::operator=(H5mdReader&&) noexcept = default;

const TrajectoryInfo& H5mdReader::info() const { return impl_->info; }

void H5mdReader::read(std::size_t frame, StoredFrame& out) {
    if (frame >= info().frames())
        impl_->file.refuse(fmt::format("no frame {}: it holds 0 to {}", frame, info().frames() - 1));
    set_up_hdf5(); // this may be another thread than the one that opened the file
    out.step = info().step[frame];
    out.time = info().time[frame];
    impl_->read_beads(frame, out);
    impl_->read_rods(frame, out);
}

} // namespace rodwake::store
