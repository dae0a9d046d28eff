#include "rodwake/app/camera.hpp"

#include "measure_frames.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/png.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t fewest_for_stiffness = 32;

fs::path trajectory_of(const fs::path& run) {
    if (fs::is_regular_file(run))
        return run;
    fs::path file = run / "trajectory.h5md";
    if (!fs::is_directory(run))
        throw InputError(run.string() + ": not a run directory; rodwake dem SCENE makes one");
    if (!fs::is_regular_file(file))
        throw InputError(fmt::format("{}: holds no frames (trajectory.h5md); run its scene with "
                                     "granular.output.formats = [\"h5md\"] and one run",
                                     run.string()));
    return file;
}

measure::Layout layout_of(const store::TrajectoryInfo& info) {
    const PeriodicBox sides{info.box[0], info.box[1]};
    measure::Layout layout{.box = sides,
                           .bead_radius = info.bead_radius,
                           .bead_mass = info.bead_mass,
                           .beads = info.beads,
                           .rods = info.rods};
    if (!info.periodic)
        layout.window =
            measure::room_within(info.parameters.contains("wall_radius"), sides, info.bead_radius);
    return layout;
}

void add_rows(fmt::memory_buffer& out, std::size_t picture, std::span<const measure::Spot> spots) {
    for (const measure::Spot& spot : spots) {
        if (std::isnan(spot.heading))
            fmt::format_to(std::back_inserter(out), "{},{},{},{},,bead\n", picture, spot.particle, spot.x,
                           spot.y);
        else
            fmt::format_to(std::back_inserter(out), "{},{},{},{},{},rod\n", picture, spot.particle, spot.x,
                           spot.y, spot.heading);
    }
}

/// Seconds between pictures.
double interval_of(const store::TrajectoryInfo& info, std::size_t every, const fs::path& file) {
    if (info.frames() < every + 1)
        throw InputError(
            fmt::format("{}: {} frames are fewer than two pictures", file.string(), info.frames()));
    return static_cast<double>(every) * (info.time.back() - info.time.front()) /
           static_cast<double>(info.frames() - 1);
}

std::string window_text(const measure::Camera& camera, const measure::Layout& layout) {
    const std::optional<measure::Window> seen = measure::seen_by(camera, layout);
    if (!seen)
        return fmt::format("window = \"periodic\"           # the whole box\nbox = [{}, {}]\n", layout.box.x,
                           layout.box.y);
    if (seen->corners.empty())
        return fmt::format("window = {{ circle = [{}, {}, {}] }}\n", seen->centre.x, seen->centre.y,
                           seen->radius);
    const measure::Corner low = seen->low(), high = seen->high();
    return fmt::format("window = {{ rectangle = [{}, {}, {}, {}] }}\n", low.x, low.y, high.x, high.y);
}

std::string scene_text(const measure::Camera& camera, const measure::Layout& layout, double interval,
                       std::size_t pictures, const std::string& command) {
    const double between = static_cast<double>(std::max<std::size_t>(1, pictures / 40)) * interval,
                 length = interval * static_cast<double>(pictures - 1);
    return fmt::format(
        "# {}\nschema = 1\ntitle = \"A bed, seen by a camera\"\n\n[tracks]\nfile = \"tracks.csv\"\n"
        "frames_per_second = {}\npixel = {}                   # m\nbead_radius = {}\n{}{}\n"
        "[measure]\norder = true\norder_interval = {}\nmicrorheology = {}\nblock = {}\n",
        command, 1.0 / interval, camera.pixel, layout.bead_radius, window_text(camera, layout),
        camera.noise > 0.0 ? fmt::format("localisation = {}   # m\n", camera.noise) : "", between,
        pictures >= fewest_for_stiffness ? "true" : "false     # of 32 pictures and more", 0.25 * length);
}

/// Beads are white, rods grey: a finder has it easy.
std::vector<measure::Disc> discs_of(const store::StoredFrame& frame, const store::TrajectoryInfo& info) {
    std::vector<measure::Disc> discs;
    for (std::size_t i = 0; i < frame.x.size(); ++i)
        discs.push_back({frame.x[i], frame.y[i], info.bead_radius, 1.0});
    for (std::size_t i = 0; i < info.sphere_radius.size(); ++i)
        discs.push_back({frame.sphere_x[i], frame.sphere_y[i], info.sphere_radius[i], 0.5});
    return discs;
}

/// Draws the first pictures of a film.
class Images {
public:
    Images(const measure::Camera& camera, const measure::Layout& layout, const fs::path& folder)
        : wanted_(camera.images), folder_(folder / "images") {
        if (wanted_ == 0)
            return;
        sensor_.emplace(camera, layout);
        fs::create_directories(folder_);
    }

    /// A frame that `film` takes next.
    void expose(const measure::Film& film, const store::StoredFrame& frame,
                const store::TrajectoryInfo& info) {
        if (drawn_ < wanted_ && film.is_open())
            sensor_->expose(discs_of(frame, info));
    }

    /// The picture is complete.
    void develop() {
        if (drawn_ == wanted_)
            return;
        const auto grey = sensor_->develop();
        store::write_atomically(name_of(drawn_),
                                store::png_of_grey(sensor_->width(), sensor_->height(), grey));
        ++drawn_;
    }

    /// How many there are; those of a longer film before it go.
    std::size_t finish() const {
        for (std::size_t k = drawn_; fs::remove(name_of(k)); ++k) {
        }
        return drawn_;
    }

private:
    fs::path name_of(std::size_t picture) const { return folder_ / fmt::format("{:06}.png", picture); }

    std::size_t wanted_, drawn_ = 0;
    fs::path folder_;
    std::optional<measure::Sensor> sensor_;
};

} // namespace

Filmed film(const fs::path& run, const CameraFor& camera_for, const fs::path& folder,
            const std::string& command, const std::function<bool()>& stop) {
    const fs::path file = trajectory_of(run);
    store::H5mdReader reader(file);
    const measure::Layout layout = layout_of(reader.info());
    const measure::Camera camera = camera_for(layout);
    const double interval = interval_of(reader.info(), camera.every, file);
    measure::Film film(camera, layout);
    Images images(camera, layout, folder);
    Filmed filmed{.tracks = folder / "tracks.csv", .scene = folder / "camera.toml"};
    fmt::memory_buffer rows;
    rows.append(std::string_view("frame,particle,x,y,theta,kind\n"));
    store::StoredFrame stored;
    measure::Frame frame;
    for (std::size_t i = 0; i < reader.info().frames(); ++i) {
        if (stop())
            return filmed;
        reader.read(i, stored);
        fill_frame(frame, stored, layout.box);
        images.expose(film, stored, reader.info());
        if (!film.expose(frame))
            continue;
        images.develop();
        add_rows(rows, film.pictures() - 1, film.spots());
        filmed.spots += film.spots().size();
    }
    filmed.pictures = film.pictures();
    filmed.images = images.finish();
    fs::create_directories(folder);
    store::write_atomically(filmed.tracks, {rows.data(), rows.size()});
    store::write_atomically(filmed.scene, scene_text(camera, layout, interval, filmed.pictures, command));
    return filmed;
}

} // namespace rodwake::app
