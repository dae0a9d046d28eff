#include "granular_files.hpp"

#include "granular_checkpoint.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/extended_xyz.hpp"
#include "rodwake/store/generations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rodwake::app {

namespace {

using granular::State;

std::vector<granular::Clump> clumps_of(const granular::GranularProblem& problem) {
    std::vector<granular::Clump> clumps;
    for (const granular::RodSpec& rod : problem.rods)
        clumps.push_back(granular::make_clump(rod.shape));
    return clumps;
}

void add_particle(store::FrameLayout& layout, std::int32_t species, std::size_t id, double mass,
                  double radius) {
    layout.species.push_back(species);
    layout.id.push_back(static_cast<std::int32_t>(id));
    layout.mass.push_back(mass);
    layout.radius.push_back(radius);
}

store::FrameLayout layout_of(const granular::GranularProblem& p, const std::vector<double>& radii,
                             const std::vector<granular::Clump>& clumps, std::size_t every_bead) {
    store::FrameLayout layout;
    const double height = p.plates.gap + 2.0 * p.plates.amplitude(p.gravity);
    const PeriodicBox& sides = granular::bed_sides(p);
    layout.box = {sides.x, sides.y, height};
    if (p.container)
        layout.periodic = {false, false, false};
    for (std::size_t i = 0; i < p.beads; i += every_bead) {
        const double radius = radii.empty() ? p.bead_radius : radii[i];
        add_particle(layout, 0, i, granular::bead_mass(p, radius), radius);
    }
    std::size_t sphere = p.beads;
    for (std::size_t r = 0; r < clumps.size(); ++r) {
        for (const double radius : clumps[r].radius) {
            add_particle(layout, 1, sphere++, clumps[r].sphere_mass(), radius);
            layout.rod_of_sphere.push_back(static_cast<std::int32_t>(r));
        }
        layout.rod_id.push_back(static_cast<std::int32_t>(r));
        layout.rod_mass.push_back(clumps[r].mass);
    }
    return layout;
}

void put(std::vector<double>& out, const Eigen::Vector3d& v) { out.insert(out.end(), {v.x(), v.y(), v.z()}); }

std::span<const std::byte> bytes(const std::vector<double>& values) {
    return std::as_bytes(std::span(values));
}

std::vector<double> doubles(const std::vector<std::byte>& record) {
    std::vector<double> values(record.size() / sizeof(double));
    std::memcpy(values.data(), record.data(), record.size());
    return values;
}

} // namespace

GranularFiles::GranularFiles(std::filesystem::path folder, const granular::GranularProblem& problem,
                             const State& state, const GranularSchedule& schedule, const LogLengths& kept,
                             std::size_t states)
    : folder_(std::move(folder)), problem_(problem), schedule_(schedule), clumps_(clumps_of(problem)),
      layout_(layout_of(problem, state.beads.radius, clumps_, schedule.every_bead)),
      frame_doubles_(2 + 6 * layout_.particles() + 13 * layout_.rods()),
      row_doubles_(field_count<granular::TableRow> + field_count<granular::TrackPoint> * layout_.rods()) {
    std::filesystem::create_directories(folder_);
    const auto open = [&](std::optional<store::Journal>& log, const char* name, std::size_t size,
                          std::size_t records) {
        using enum store::Journal::OfAnother;
        log.emplace(folder_ / name, fmt::format("{}, {} bytes", name, size), records > 0 ? refuse : replace);
        log->keep(records);
    };
    open(rows_, "rows.log", row_doubles_ * sizeof(double), kept.rows);
    if (schedule_.h5md || schedule_.xyz)
        open(frames_, "frames.log", frame_doubles_ * sizeof(double), kept.frames);
    if (schedule_.last_period)
        open(period_, "last_period.log", frame_doubles_ * sizeof(double), kept.period_frames);
    if (schedule_.archive_every > 0)
        open(states_, "archive.log", state_bytes(state).size(), states);
}

void GranularFiles::add_row(const granular::TableRow& r, const std::vector<granular::TrackPoint>& track) {
    const auto append = [](std::vector<double>& record, const auto& numbers) {
        record.insert(record.end(), numbers.begin(), numbers.end());
    };
    std::vector<double> record;
    append(record, field_values(r));
    for (const granular::TrackPoint& p : track)
        append(record, field_values(p));
    rows_->append(0, bytes(record));
}

std::vector<double> GranularFiles::frame_record(const State& state, double time) const {
    std::vector<double> record = {static_cast<double>(state.step), time};
    record.reserve(frame_doubles_);
    for (const auto& spheres : {sphere_positions(state, clumps_), sphere_velocities(state, clumps_)})
        for (const std::int32_t id : layout_.id)
            put(record, Eigen::Map<const Eigen::Vector3d>(spheres.data() + 3 * std::size_t(id)));
    for (const granular::RodBody& rod : state.rods)
        put(record, rod.position);
    for (const granular::RodBody& rod : state.rods)
        put(record, rod.velocity);
    for (const granular::RodBody& rod : state.rods) {
        const Eigen::Quaterniond& q = rod.orientation;
        record.insert(record.end(), {q.w(), q.x(), q.y(), q.z()});
    }
    for (const granular::RodBody& rod : state.rods)
        put(record, rod.angular_momentum);
    return record;
}

void GranularFiles::add_frame(const State& state, double time) {
    if (frames_)
        frames_->append(0, bytes(frame_record(state, time)));
}

void GranularFiles::add_period_frame(const State& state, double time) {
    if (period_)
        period_->append(0, bytes(frame_record(state, time)));
}

void GranularFiles::keep(const State& state) {
    if (states_)
        states_->append(0, state_bytes(state));
}

std::vector<State> GranularFiles::kept_states() {
    std::vector<State> states;
    for (std::size_t i = 0; states_ && i < states_->size(); ++i)
        states.push_back(state_of(states_->read(i), "archive.log"));
    return states;
}

LogLengths GranularFiles::sync() {
    LogLengths lengths;
    const auto synced = [](std::optional<store::Journal>& log) {
        if (!log)
            return std::uint64_t{0};
        log->sync();
        return std::uint64_t{log->size()};
    };
    lengths.rows = synced(rows_);
    lengths.frames = synced(frames_);
    lengths.period_frames = synced(period_);
    if (states_)
        states_->sync();
    return lengths;
}

void GranularFiles::write_tables() {
    const auto table_names = field_names<granular::TableRow>();
    std::vector<std::string> names(table_names.begin(), table_names.end());
    const std::size_t of_table = names.size();
    for (std::size_t r = 0; r < layout_.rods(); ++r)
        for (const std::string_view name : field_names<granular::TrackPoint>())
            names.push_back(fmt::format("{}{}", name, r));
    std::vector<std::vector<double>> columns(names.size());
    for (std::size_t i = 0; i < rows_->size(); ++i) {
        const std::vector<double> record = doubles(rows_->read(i));
        for (std::size_t k = 0; k < record.size(); ++k)
            columns[k].push_back(record[k]);
    }
    const std::span all_names(names);
    const std::span all_columns(columns);
    store::write_atomically(folder_ / "table.csv",
                            store::to_csv(all_names.first(of_table), all_columns.first(of_table)));
    if (layout_.rods() == 0)
        return;
    std::vector<std::string> track_names(names.begin() + static_cast<std::ptrdiff_t>(of_table), names.end());
    std::vector<std::vector<double>> track(columns.begin() + static_cast<std::ptrdiff_t>(of_table),
                                           columns.end());
    track_names.insert(track_names.begin(), "t");
    track.insert(track.begin(), columns[0]);
    store::write_atomically(folder_ / "tracks.csv", store::to_csv(track_names, track));
}

void GranularFiles::write_trajectory(const std::string& name, store::Journal& log,
                                     const store::H5mdInfo& info, bool for_viewers) {
    std::optional<store::H5mdWriter> h5md;
    std::optional<store::ExtendedXyzWriter> text;
    if (schedule_.h5md || !for_viewers)
        h5md.emplace(folder_ / (name + ".h5md"), layout_, info);
    if (for_viewers && schedule_.xyz)
        text.emplace(folder_ / (name + ".xyz"), layout_, problem_.bead_radius);
    for (std::size_t i = 0; i < log.size(); ++i) {
        const std::vector<double> record = doubles(log.read(i));
        // The frame is cut out of its record.
        const std::size_t particles = layout_.particles(), rods = layout_.rods();
        store::Frame frame;
        const double* at = record.data();
        const auto take = [&](std::size_t count) {
            const std::span<const double> part(at, count);
            at += count;
            return part;
        };
        frame.step = static_cast<std::int64_t>(*at++);
        frame.time = *at++;
        frame.position = take(3 * particles);
        frame.velocity = take(3 * particles);
        frame.rod_position = take(3 * rods);
        frame.rod_velocity = take(3 * rods);
        frame.rod_orientation = take(4 * rods);
        frame.rod_angular_momentum = take(3 * rods);
        if (h5md)
            h5md->add_frame(frame);
        if (text)
            text->add_frame(frame);
    }
    if (h5md)
        h5md->commit();
    if (text)
        text->commit();
}

void GranularFiles::finish_frames(const store::H5mdInfo& info) {
    if (frames_)
        write_trajectory("trajectory", *frames_, info, true);
    if (period_ && period_->size() > 0)
        write_trajectory("last_period", *period_, info, false);
}

void remove_progress(const std::filesystem::path& folder) {
    const std::filesystem::path checkpoint = folder / "checkpoint.rwc";
    constexpr std::array logs = {"rows.log", "frames.log", "last_period.log", "archive.log"};
    const auto is_there = [&](const std::filesystem::path& name) {
        return std::filesystem::exists(folder / name);
    };
    if (!is_there("checkpoint.rwc") && !is_there(store::previous_generation("checkpoint.rwc")) &&
        std::ranges::none_of(logs, is_there))
        return;
    store::remove_generations(checkpoint);
    store::sync_folder_of(checkpoint);
    for (const char* name : logs)
        std::filesystem::remove(folder / name);
}

} // namespace rodwake::app
