// Films that rodwake convert wrote, as rows of tracks.

#include "h5md_format.hpp"
#include "hdf5_input.hpp"
#include "rodwake/store/track_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rodwake::store {

namespace {

constexpr std::int64_t empty_row = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t in_no_track = empty_row + 1;

/// The box of all frames. One that changes or is tilted is none here, and the row says why.
void read_box(const Hdf5Input& file, const std::vector<std::int64_t>& step, TrackRows& rows) {
    const auto boundary = text_attribute(file, spheres + "box", "boundary");
    if (boundary.size() < 2 || boundary[0] != "periodic" || boundary[1] != "periodic")
        return;
    const Hdf5Table table(file, spheres + "box/edges/value", H5T_NATIVE_DOUBLE);
    table.want_shape({step.size(), 3, 3});
    std::vector<std::array<double, 9>> edges(step.size());
    table.read(edges.data());
    const auto& first = edges.front();
    for (std::size_t k = 0; k < edges.size() && rows.no_box.empty(); ++k) {
        const auto& e = edges[k];
        if (!(e[0] > 0.0 && e[4] > 0.0 && std::isfinite(e[0]) && std::isfinite(e[4])))
            rows.no_box = fmt::format("the sides of its box in frame {}, {:g} and {:g}, are not positive", k,
                                      e[0], e[4]);
        else if (e[1] != 0.0 || e[3] != 0.0)
            rows.no_box = fmt::format("its box is not upright (frame {}, step {})", k, step[k]);
        else if (e[0] != first[0] || e[4] != first[4])
            rows.no_box =
                fmt::format("its box changes in frame {} (step {}), from {:g} x {:g} to {:g} x {:g}", k,
                            step[k], first[0], first[4], e[0], e[4]);
    }
    if (rows.no_box.empty())
        rows.box = PeriodicBox(first[0], first[4]);
}

/// Beads or rods: `group` is their place in the file.
struct FilmBodies {
    Hdf5Table position, id;
    std::optional<Hdf5Table> image, orientation, radius;
    std::size_t columns; ///< of the largest frame

    FilmBodies(const Hdf5Input& file, const std::string& group, std::size_t frames)
        : position(file, group + "position/value", H5T_NATIVE_DOUBLE),
          id(file, group + "id/value", H5T_NATIVE_INT64),
          columns(position.shape().size() == 3 ? position.shape()[1] : 0) {
        position.want_shape({frames, columns, 3});
        id.want_shape({frames, columns});
        if (file.has(group + "image"))
            image.emplace(file, group + "image/value", H5T_STD_I32LE).want_shape({frames, columns, 3});
        if (file.has(group + "orientation"))
            orientation.emplace(file, group + "orientation/value", H5T_NATIVE_DOUBLE)
                .want_shape({frames, columns, 4});
        if (file.has(group + "radius"))
            radius.emplace(file, group + "radius/value", H5T_NATIVE_DOUBLE).want_shape({frames, columns});
    }
};

/// Appends the rows of all frames, some at a time; false after a stop.
bool append_bodies(const FilmBodies& of, bool are_rods, bool with_radii,
                   const std::vector<std::int64_t>& step, const std::vector<double>& time, TrackRows& rows,
                   const TrackProgress& on_progress) {
    const std::size_t frames = step.size(), n = of.columns,
                      at_once = std::max<std::size_t>(1, 65536 / std::max<std::size_t>(1, n));
    std::vector<double> place(3 * n * at_once), turned(of.orientation ? 4 * n * at_once : 0);
    std::vector<std::int64_t> ids(n * at_once);
    std::vector<std::int32_t> image(of.image ? 3 * n * at_once : 0);
    std::vector<double> radius(n * at_once, std::nan(""));
    for (std::size_t from = 0; from < frames && n > 0; from += at_once) {
        const std::size_t count = std::min(at_once, frames - from);
        of.position.read_rows(from, count, place.data());
        of.id.read_rows(from, count, ids.data());
        if (of.image)
            of.image->read_rows(from, count, image.data());
        if (of.orientation)
            of.orientation->read_rows(from, count, turned.data());
        if (of.radius && with_radii)
            of.radius->read_rows(from, count, radius.data());
        for (std::size_t i = 0; i < n * count; ++i) {
            if (ids[i] == empty_row)
                continue;
            const std::size_t frame = from + i / n;
            if (time.empty())
                rows.frame.push_back(step[frame]);
            else
                rows.time.push_back(time[frame]);
            rows.id.push_back(ids[i] == in_no_track ? no_track : ids[i]);
            rows.x.push_back(place[3 * i]);
            rows.y.push_back(place[3 * i + 1]);
            if (of.image) {
                rows.image_x.push_back(image[3 * i]);
                rows.image_y.push_back(image[3 * i + 1]);
            }
            if (with_radii)
                rows.radius.push_back(radius[i]);
            rows.is_rod.push_back(are_rods);
            // The heading of the x axis that the quaternion turns, its real part first; NaN: not known.
            const double* q = of.orientation ? &turned[4 * i] : nullptr;
            rows.heading.push_back(
                q ? std::atan2(2.0 * (q[0] * q[3] + q[1] * q[2]), 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]))
                  : std::nan(""));
        }
        if (!on_progress(static_cast<double>(from + count) / static_cast<double>(frames)))
            return false;
    }
    return true;
}

template<class T>
std::vector<T> column(const Hdf5Input& file, const std::string& path, hid_t type) {
    const Hdf5Table table(file, path, type);
    std::vector<T> values(table.size());
    table.read(values.data());
    return values;
}

} // namespace

TrackRows read_film(const std::filesystem::path& film, const std::string& source, bool own_times,
                    bool with_radii, const TrackProgress& on_progress) {
    const Hdf5Guard guard;
    const Hdf5Input file(film, "remove it, and the same command makes it again from " + source);
    TrackRows rows;
    // Findings of the converter from when it read the source.
    const auto count = [&](const char* name) {
        return static_cast<std::size_t>(integer_attribute(file, "rodwake", name));
    };
    rows.without_place = count("without_place");
    rows.hidden = count("hidden");
    rows.branches = count("branches");
    rows.dangling = count("dangling");
    rows.certain_ids = count("certain_ids") != 0;
    rows.first_without_place = text_attribute(file, "rodwake", "first_without_place").front();
    rows.length_unit = text_attribute(file, "rodwake", "length_unit").front();
    if (H5Aexists_by_name(file.get(), "rodwake", "warnings", H5P_DEFAULT) > 0)
        rows.warnings = text_attribute(file, "rodwake", "warnings");
    const auto step = column<std::int64_t>(file, spheres + "position/step", H5T_NATIVE_INT64);
    std::vector<double> time;
    if (own_times) {
        if (!file.has(spheres + "position/time"))
            throw InputError(source + ": its frames have no times: set tracks.frames_per_second, how many "
                                      "frames (of files with time steps: steps) a second has");
        time = column<double>(file, spheres + "position/time", H5T_NATIVE_DOUBLE);
        if (time.size() != step.size())
            file.refuse("steps and times differ in number");
    }
    read_box(file, step, rows);
    const FilmBodies beads(file, spheres, step.size());
    if (with_radii && !beads.radius)
        throw InputError(source +
                         ": has no radii of particles, by which tracks.bead_kinds sorts them: convert "
                         "it to CSV (rodwake convert) and name the kinds in tracks.bead_kinds");
    if (!append_bodies(beads, false, with_radii, step, time, rows, on_progress))
        return rows;
    if (file.has(store::rods + "position"))
        append_bodies(FilmBodies(file, store::rods, step.size()), true, with_radii, step, time, rows,
                      on_progress);
    if (rows.size() == 0)
        throw InputError(
            fmt::format("{}: has no particle with a position in its {} frames", source, step.size()));
    if (std::ranges::all_of(rows.heading, [](double h) { return std::isnan(h); }))
        rows.heading.clear();
    return rows;
}

} // namespace rodwake::store
