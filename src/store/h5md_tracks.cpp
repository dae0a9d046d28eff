// Tracks from H5MD of any program: elements fixed or in time, 2 or 3 dimensions, numbers of any precision.

#include "frame_rows.hpp"
#include "h5md_format.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace rodwake::store {

namespace {

const std::string tracks_advice = "give an H5MD file with particles/<group>/position/value and step";

herr_t add_link_name(hid_t, const char* name, const H5L_info_t*, void* names) {
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
    return 0;
}

std::vector<std::string> names_in(const Hdf5Input& file, const std::string& group) {
    std::vector<std::string> names;
    hsize_t start = 0;
    if (file.has(group))
        H5Literate_by_name(file.get(), group.c_str(), H5_INDEX_NAME, H5_ITER_INC, &start, add_link_name,
                           &names, H5P_DEFAULT);
    return names;
}

/// particles/<the group that is meant>/
std::string particle_group(const Hdf5Input& file, const std::string& given) {
    std::vector<std::string> names = names_in(file, "particles");
    std::erase_if(names,
                  [&](const std::string& name) { return !file.has("particles/" + name + "/position"); });
    if (!given.empty()) {
        if (std::ranges::find(names, given) == names.end())
            file.refuse(fmt::format("no positions of particles/{} (tracks.group); there are: {}", given,
                                    fmt::join(names, ", ")));
        return "particles/" + given + "/";
    }
    if (names.empty())
        file.refuse("no positions in a group of particles");
    for (const char* usual : {"trajectory", "all"})
        if (std::ranges::find(names, usual) != names.end())
            return std::string("particles/") + usual + "/";
    if (names.size() > 1)
        file.refuse(
            fmt::format("several groups of particles: {}; name one in tracks.group", fmt::join(names, ", ")));
    return "particles/" + names.front() + "/";
}

/// A quantity of each particle: the same in all frames, or <path>/value with a row for each.
class Element {
public:
    Element(const Hdf5Input& file, const std::string& path, hid_t type, std::size_t columns)
        : in_time_(file.has(path + "/value")), columns_(columns),
          table_(file, in_time_ ? path + "/value" : path, type) {
        const std::size_t rank = (in_time_ ? 2U : 1U) + (columns > 1 ? 1U : 0U);
        const auto& shape = table_.shape();
        if (shape.size() != rank || (columns > 1 && shape.back() != columns))
            file.refuse(fmt::format("{} is of shape {}: expected {}particles{}", path, shape,
                                    in_time_ ? "frames, " : "",
                                    columns > 1 ? fmt::format(", {}", columns) : ""));
    }

    bool in_time() const { return in_time_; }
    std::size_t frames() const { return in_time_ ? table_.shape()[0] : 1; }
    std::size_t particles() const { return table_.shape()[in_time_ ? 1 : 0]; }
    const Hdf5Table& table() const { return table_; }

    /// False if `values` stay as they are: those of all frames.
    template<class T>
    bool read(std::size_t frame, std::vector<T>& values) const {
        if (!in_time_ && !values.empty())
            return false;
        values.resize(particles() * columns_);
        table_.read_rows(in_time_ ? frame : 0, in_time_ ? 1 : particles(), values.data());
        return true;
    }

private:
    bool in_time_;
    std::size_t columns_;
    Hdf5Table table_;
};

/// A number of a dataset, 0 where there is none.
double offset_of(const Hdf5Table& table) {
    double value = 0.0;
    if (H5Aexists(table.get(), "offset") > 0) {
        const Hdf5Handle attribute(H5Aopen(table.get(), "offset", H5P_DEFAULT), H5Aclose, "open an offset");
        const Hdf5Handle space(H5Aget_space(attribute.get()), H5Sclose, "read an offset's shape");
        if (H5Sget_simple_extent_npoints(space.get()) == 1)
            H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &value);
    }
    return value;
}

/// Steps or times of `frames` frames: one each, or a number, their distance.
template<class T>
std::vector<T> moments(const Hdf5Input& file, const std::string& path, hid_t type, std::size_t frames) {
    const Hdf5Table table(file, path, type);
    std::vector<T> values(std::max<std::size_t>(1, table.size()));
    table.read(values.data());
    if (table.shape().size() == 1 && table.size() == frames)
        return values;
    if (table.size() != 1)
        file.refuse(fmt::format("{} is of shape {}, and there are {} frames", path, table.shape(), frames));
    const auto every = static_cast<double>(values[0]);
    const double first = offset_of(table);
    values.resize(frames);
    for (std::size_t k = 0; k < frames; ++k) {
        const double moment = first + static_cast<double>(k) * every;
        if (!(std::abs(moment) < 0x1p53))
            file.refuse(fmt::format("{} is {} in frame {}", path, moment, k));
        values[k] = static_cast<T>(moment);
    }
    return values;
}

/// One group of particles.
struct Bodies {
    std::string group;
    Element position;
    std::size_t dimensions;
    std::optional<Element> id, species, orientation;
    std::optional<std::int64_t> nobody; ///< the id of a row without a particle
    std::vector<double> place, turned;
    std::vector<std::int64_t> ids, kinds;

    Bodies(const Hdf5Input& file, std::string of)
        : group(std::move(of)),
          position(file, group + "position", H5T_NATIVE_DOUBLE, dimensions_of(file, group)),
          dimensions(dimensions_of(file, group)) {
        if (!position.in_time())
            file.refuse(group + "position has no frames in time");
        open(file, "id", H5T_NATIVE_INT64, 1, id);
        open(file, "species", H5T_NATIVE_INT64, 1, species);
        open(file, "orientation", H5T_NATIVE_DOUBLE, 4, orientation);
        if (id)
            nobody = fill_value(id->table());
    }

    void read(std::size_t frame) {
        position.read(frame, place);
        if (id)
            id->read(frame, ids);
        if (species)
            species->read(frame, kinds);
        if (orientation)
            orientation->read(frame, turned);
    }

    std::optional<std::int64_t> id_of(std::size_t i) const {
        return id ? std::optional(ids[i]) : std::nullopt;
    }

private:
    static std::size_t dimensions_of(const Hdf5Input& file, const std::string& group) {
        const bool in_time = file.has(group + "position/value");
        const Hdf5Table table(file, group + (in_time ? "position/value" : "position"), H5T_NATIVE_DOUBLE);
        const auto& shape = table.shape();
        if (shape.empty() || (shape.back() != 2 && shape.back() != 3))
            file.refuse(
                fmt::format("{}position is of shape {}: expected two or three coordinates", group, shape));
        return shape.back();
    }

    void open(const Hdf5Input& file, const char* name, hid_t type, std::size_t columns,
              std::optional<Element>& element) const {
        if (!file.has(group + name))
            return;
        element.emplace(file, group + name, type, columns);
        if (element->particles() != position.particles() ||
            (element->in_time() && element->frames() != position.frames()))
            file.refuse(fmt::format("{}{} has {} particles in {} frames, position has {} in {}", group, name,
                                    element->particles(), element->frames(), position.particles(),
                                    position.frames()));
    }

    static std::optional<std::int64_t> fill_value(const Hdf5Table& table) {
        const Hdf5Handle made(H5Dget_create_plist(table.get()), H5Pclose, "read about ids");
        H5D_fill_value_t kind{};
        std::int64_t value = 0;
        if (H5Pfill_value_defined(made.get(), &kind) < 0 || kind != H5D_FILL_VALUE_USER_DEFINED ||
            H5Pget_fill_value(made.get(), H5T_NATIVE_INT64, &value) < 0)
            return std::nullopt;
        return value;
    }
};

class H5mdTracks {
public:
    H5mdTracks(const std::filesystem::path& path, const TrackColumns& given)
        : path_(path.string()), given_(given), file_(path, tracks_advice),
          out_(given,
               [this] { return fmt::format("{}: {}position, frame {}", path_, bodies_.group, frame_); }),
          bodies_(file_, particle_group(file_, given.group)) {
        const std::string rods = bodies_.group.substr(0, bodies_.group.size() - 1) + "_rods/";
        if (file_.has(rods + "position") && bodies_.species)
            rods_.emplace(file_, rods);
    }

    TrackRows read(const TrackProgress& on_progress) {
        const std::string position = bodies_.group + "position/";
        const std::size_t frames = bodies_.position.frames();
        const auto step = moments<std::int64_t>(file_, position + "step", H5T_NATIVE_INT64, frames);
        std::vector<double> time;
        if (given_.own_times && file_.has(position + "time")) {
            time = moments<double>(file_, position + "time", H5T_NATIVE_DOUBLE, frames);
            const double unit = si_factor(file_, position + "time", H5mdUnit::time);
            std::ranges::for_each(time, [&](double& t) { t *= unit; });
        }
        for (frame_ = 0; frame_ < frames; ++frame_) {
            out_.begin(step[frame_], time.empty() ? std::nullopt : std::optional(time[frame_]));
            if (frame_ == 0)
                read_box();
            add_frame();
            if (!on_progress(static_cast<double>(frame_ + 1) / static_cast<double>(frames)))
                break;
        }
        out_.rows().length_unit = unit();
        return out_.take(path_);
    }

private:
    void add_frame() {
        bodies_.read(frame_);
        if (rods_)
            rods_->read(frame_);
        const std::size_t d = bodies_.dimensions;
        for (std::size_t i = 0; i < bodies_.position.particles(); ++i) {
            if (bodies_.id && bodies_.nobody && bodies_.ids[i] == *bodies_.nobody)
                continue;
            if (rods_ && bodies_.kinds[i] != 0) // a sphere of a rod
                continue;
            std::optional<bool> rod;
            if (bodies_.species)
                rod = !given_.rod_kinds.empty() && names_rod(given_, std::to_string(bodies_.kinds[i]));
            out_.add(bodies_.id_of(i), bodies_.place[d * i], bodies_.place[d * i + 1], heading(bodies_, i),
                     rod);
        }
        for (std::size_t i = 0; rods_ && i < rods_->position.particles(); ++i) // below all numbers of beads
            out_.add(-1 - rods_->id_of(i).value_or(static_cast<std::int64_t>(i)),
                     rods_->place[rods_->dimensions * i], rods_->place[rods_->dimensions * i + 1],
                     heading(*rods_, i), true);
    }

    static std::optional<double> heading(const Bodies& of, std::size_t i) {
        if (!of.orientation)
            return std::nullopt;
        const double* q = &of.turned[4 * i];
        return std::atan2(2.0 * (q[0] * q[3] + q[1] * q[2]), 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]));
    }

    /// Edges as a vector or a matrix, fixed or in time.
    void read_box() {
        const std::string box = bodies_.group + "box", edges = box + "/edges";
        if (!file_.has(box) || H5Aexists_by_name(file_.get(), box.c_str(), "boundary", H5P_DEFAULT) <= 0)
            return;
        const auto boundary = text_attribute(file_, box, "boundary");
        const bool periodic = boundary.size() >= 2 && boundary[0] == "periodic" && boundary[1] == "periodic";
        if (!file_.has(edges)) {
            if (periodic)
                file_.refuse(edges + " is missing, and the box is periodic");
            return;
        }
        const bool in_time = file_.has(edges + "/value");
        const Hdf5Table table(file_, in_time ? edges + "/value" : edges, H5T_NATIVE_DOUBLE);
        const std::size_t d = bodies_.dimensions,
                          rows = in_time && !table.shape().empty() ? table.shape()[0] : 1,
                          each = table.size() / std::max<std::size_t>(1, rows);
        if (each != d && each != d * d)
            file_.refuse(fmt::format("{} is of shape {}: expected {} or {} x {} numbers", edges,
                                     table.shape(), d, d, d));
        std::vector<double> all(table.size());
        table.read(all.data());
        for (std::size_t at = 0; at + each <= all.size(); at += each) {
            const double* e = &all[at];
            const bool matrix = each == d * d;
            bool tilted = false;
            for (std::size_t k = 0; matrix && k < each; ++k)
                tilted |= k % (d + 1) != 0 && e[k] != 0.0;
            out_.box({e[0], matrix ? e[d + 1] : e[1], periodic, tilted});
        }
    }

    std::string unit() const {
        for (const std::string& owner : {bodies_.group + "position/value", bodies_.group + "position"})
            if (H5Aexists_by_name(file_.get(), owner.c_str(), "unit", H5P_DEFAULT) > 0)
                if (const auto said = text_attribute(file_, owner, "unit"); !said.empty())
                    return said.front();
        return "";
    }

    std::string path_;
    const TrackColumns& given_;
    Hdf5Input file_;
    FrameRows out_;
    Bodies bodies_;
    std::optional<Bodies> rods_;
    std::size_t frame_ = 0;
};

} // namespace

TrackRows read_h5md_tracks(const std::filesystem::path& file, const TrackColumns& columns,
                           const TrackProgress& on_progress) {
    const Hdf5Guard guard;
    return H5mdTracks(file, columns).read(on_progress);
}

} // namespace rodwake::store
