#include "rods_film.hpp"

#include "rodwake/core/build_info.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/hdf5_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace rodwake::app {

namespace {

constexpr const char* log_name = "medium_film.log";

std::vector<double> scaled(std::span<const double> values, double by) {
    std::vector<double> result(values.begin(), values.end());
    for (double& value : result)
        value *= by;
    return result;
}

/// Every third of the rods' coordinates, from `first` on.
std::vector<double> coordinate(std::span<const double> poses, std::size_t first, double scale) {
    std::vector<double> values;
    values.reserve(poses.size() / 3);
    for (std::size_t i = first; i < poses.size(); i += 3)
        values.push_back(poses[i] * scale);
    return values;
}

} // namespace

RodsFilm::RodsFilm(std::filesystem::path folder, const RodsPlan& plan, double kept_until)
    : folder_(std::move(folder)), plan_(plan), medium_(plan.of.scene.medium->memory()),
      rods_(plan.problem.rods.size()), size_(medium::film_frame_size(medium_, rods_)),
      log_(folder_ / log_name, fmt::format("film, {} numbers", size_),
           kept_until < 0.0 ? store::Journal::OfAnother::replace : store::Journal::OfAnother::refuse) {
    const std::vector<double> times = medium::film_times(medium_, plan.problem.t_end);
    log_.keep(static_cast<std::size_t>(std::ranges::upper_bound(times, kept_until) - times.begin()));
}

void RodsFilm::add(const medium::FilmFrame& frame) {
    std::vector<double> record = {frame.time};
    record.reserve(size_);
    for (const std::span<const double> part : {frame.poses, frame.ux, frame.uy})
        record.insert(record.end(), part.begin(), part.end());
    log_.append(0, std::as_bytes(std::span(record)));
}

void RodsFilm::write(const OutputUnits& units, const std::string& command) {
    store::Hdf5Writer file(folder_ / "medium_film.h5");
    const BuildInfo build = build_info();
    file.attribute("/", "schema", std::int64_t{1});
    file.attribute("/", "rodwake_version", build.version);
    file.attribute("/", "git", build.git);
    file.attribute("/", "command", command);
    file.attribute("/", "scene", scene::to_toml(plan_.of.scene));
    file.attribute("/", "units", units.system);
    file.attribute("/", "what",
                   medium_.self_field
                       ? "displacement u of the medium, of all rods"
                       : "displacement u of the medium, of all rods; each feels u less its own");
    file.attribute("/", "box", medium_.box * units.length);
    file.attribute("/", "force_width", medium_.force_width * units.length);
    // The points of the grid along y are the same as along x.
    const medium::FieldGrid grid(medium_.film_grid);
    std::vector<double> positions;
    positions.reserve(grid.points());
    for (std::size_t i = 0; i < grid.points(); ++i)
        positions.push_back(grid.place(i, medium_.box) * units.length);
    file.dataset("/x", positions, {positions.size()}, units.length_name);
    file.dataset("/y", positions, {positions.size()}, units.length_name);
    const std::size_t frames = log_.size(), side = medium_.film_grid, points = side * side;
    std::vector<double> values(size_);
    for (std::size_t k = 0; k < frames; ++k) {
        const std::vector<std::byte> record = log_.read(k);
        std::memcpy(values.data(), record.data(), record.size());
        const std::span<const double> all(values), poses = all.subspan(1, 3 * rods_);
        file.part("/t", scaled(all.first(1), units.time), k, {frames}, units.time_name);
        file.part("/rods/x", coordinate(poses, 0, units.length), k, {frames, rods_}, units.length_name);
        file.part("/rods/y", coordinate(poses, 1, units.length), k, {frames, rods_}, units.length_name);
        file.part("/rods/theta", coordinate(poses, 2, 1.0), k, {frames, rods_}, "rad");
        const std::span<const double> u = all.subspan(1 + 3 * rods_);
        file.part("/ux", scaled(u.first(points), units.length), k, {frames, side, side}, units.length_name);
        file.part("/uy", scaled(u.subspan(points), units.length), k, {frames, side, side}, units.length_name);
    }
    file.commit();
}

void RodsFilm::remove_log() { std::filesystem::remove(folder_ / log_name); }

} // namespace rodwake::app
