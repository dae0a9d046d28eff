#include "measured_tracks.hpp"

#include "film_rods.hpp"
#include "fit/fit_data.hpp"
#include "measure_frames.hpp"
#include "rodwake/app/convert.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/measure/tracks.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/track_file.hpp"
#include "run/log.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using scene::Scene, scene::WindowKind;

/// Rows that could not be used for everything.
struct RowsLeftOut {
    std::string why;
    std::size_t rows = 0;

    static constexpr auto fields() {
        using R = RowsLeftOut;
        return std::tuple{field("why", &R::why, {"", "why rows, or positions, are missing in the measures"}),
                          field("rows", &R::rows, {"1", "how many (0: a warning of the file)"})};
    }
};

/// tracks.json
struct TracksReport {
    std::string file, window, length_unit;
    std::size_t rows = 0, frames = 0, particles = 0, rods = 0;
    double bead_radius = 0.0, beads_per_frame = 0.0, mean_length = 0.0, lost_share = 0.0, interval = 0.0,
           duration = 0.0, area = 0.0, phi_b = 0.0;
    std::vector<double> box = {};
    std::vector<FilmRod> rod_tracks = {};
    std::vector<RowsLeftOut> left_out = {};

    static constexpr auto fields() {
        using R = TracksReport;
        return std::tuple{
            field("file", &R::file, {"", "of the tracks"}),
            field("window", &R::window, {"", "what is seen: hull, periodic, circle or rectangle"}),
            field("length_unit", &R::length_unit, {"", "as the file names it (empty: it does not)"}),
            field("rows", &R::rows, {"1", "of the file, with positions and without"}),
            field("frames", &R::frames, {"1", "that have rows"}),
            field("particles", &R::particles, {"1", "different beads that are tracked"}),
            field("rods", &R::rods, {"1", "different rods"}),
            field("beads_per_frame", &R::beads_per_frame, {"1", "on average"}),
            field("mean_length", &R::mean_length,
                  {"1", "frames from where a bead is first seen to where last"}),
            field("lost_share", &R::lost_share, {"1", "of these frames, those in which it is not seen"}),
            field("interval", &R::interval, {"s", "between frames; at uneven times the mean"}),
            field("duration", &R::duration, {"s", "from the first frame to the last"}),
            field("area", &R::area, {"a^2", "of the window"}),
            field("phi_b", &R::phi_b, {"1", "area fraction of the beads in the window"}),
            field("bead_radius", &R::bead_radius, {"m", "a"}),
            field("box", &R::box, {"m", "sides of the periodic box, or of the rectangle around the window"}),
            field("rod_tracks", &R::rod_tracks, {"", "of each rod, in the order of their numbers from 0"}),
            field("left_out", &R::left_out, {"", "what was left out, and why"})};
    }
};

/// `key`: file or rods_file.
fs::path file_of(const Scene& scene, const char* key, const std::string& name) {
    std::string looked;
    for (const fs::path& candidate : data_file_places(name, scene, {})) {
        if (fs::is_regular_file(candidate))
            return candidate;
        looked += (looked.empty() ? "" : ", ") + fs::absolute(candidate).lexically_normal().string();
    }
    throw InputError(
        fmt::format("{}: tracks.{} = \"{}\": no such file; looked for {}", scene.path, key, name, looked));
}

/// With those of rods, where they are not in a file of their own.
store::TrackColumns columns_of(const scene::Tracks& keys, bool of_rods, bool of_beads) {
    const scene::TracksColumns& c = keys.columns;
    const bool own_times = !keys.frames_per_second && keys.time_column.empty();
    store::TrackColumns columns{c.frame,          c.id, c.x,       c.y,           "", c.kind,
                                keys.time_column, {},   own_times, keys.rod_kinds};
    if (of_rods) {
        columns.heading = c.heading;
        columns.ends = c.ends;
    }
    if (of_beads) {
        columns.radius = c.radius;
        for (const scene::TracksKind& kind : keys.bead_kinds)
            columns.kinds.push_back({kind.names, kind.radius / keys.pixel});
    }
    return columns;
}

/// Behind the rows of the beads.
void append_rods(TrackRows& rows, TrackRows rods) {
    rows.is_rod.resize(rows.size(), 0);
    rows.is_rod.resize(rows.size() + rods.size(), 1);
    for (auto of_rods : {&TrackRows::heading, &TrackRows::length}) {
        (rows.*of_rods).resize(rows.size(), std::nan(""));
        (rods.*of_rods).resize(rods.size(), std::nan(""));
    }
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(rows.frame, rods.frame);
    append(rows.time, rods.time);
    append(rows.id, rods.id);
    append(rows.y, rods.y);
    append(rows.heading, rods.heading);
    if (!rows.radius.empty())
        rows.radius.resize(rows.size() + rods.size(), std::nan(""));
    if (!rows.length.empty() || !rods.length.empty()) {
        rows.length.resize(rows.size(), std::nan(""));
        rods.length.resize(rods.size(), std::nan(""));
        append(rows.length, rods.length);
    }
    const bool images = rows.image_x.size() == rows.size() && rods.image_x.size() == rods.size();
    for (auto image : {&TrackRows::image_x, &TrackRows::image_y}) {
        append(rows.*image, rods.*image);
        (rows.*image).resize(images ? (rows.*image).size() : 0);
    }
    append(rows.x, rods.x); // last: it is what the others are as long as
    rows.certain_ids = rows.certain_ids && rods.certain_ids;
    rows.dangling += rods.dangling;
    append(rows.warnings, rods.warnings);
    if (rows.without_place == 0)
        rows.first_without_place = rods.first_without_place;
    rows.without_place += rods.without_place;
}

/// Rows of a file: of CSV at once, of any other format from the film that is made of it in `folder`, whose
/// name goes to `films`. No rows after a stop.
TrackRows rows_of(const scene::Tracks& keys, const fs::path& file, TrackFormat format, bool are_rods,
                  const fs::path& folder, const RunContext& context, std::vector<fs::path>& films,
                  const std::function<void(double)>& on_progress) {
    const store::TrackColumns columns = columns_of(keys, are_rods || keys.rods_file.empty(), !are_rods);
    const auto go_on = [&](double from, double part) {
        on_progress(from + (1.0 - from) * part);
        return !context.stopped();
    };
    if (format == TrackFormat::automatic)
        format = store::track_format(file);
    if (format == TrackFormat::csv)
        return store::read_track_csv(file, columns, [&](double part) { return go_on(0.0, part); });
    if (!keys.time_column.empty() && format != TrackFormat::xyz)
        throw InputError(file.string() + ": has no columns of times: leave tracks.time_column out, or give "
                                         "tracks.frames_per_second");
    const fs::path film =
        film_of(keys, file, format, folder, context, [&](double part) { on_progress(0.8 * part); });
    if (film.empty())
        return {};
    films.push_back(film);
    if (!columns.radius.empty())
        throw InputError(file.string() + ": tracks.columns.radius is for CSV: leave it out, and radii are "
                                         "those of the file if there are tracks.bead_kinds");
    return store::read_film(film, file.string(), columns.own_times || !columns.time.empty(),
                            !columns.kinds.empty(), [&](double part) { return go_on(0.8, part); });
}

/// The box of the file is as good as one of the scene, which goes first.
measure::TrackScale scale_of(const scene::Tracks& keys, const TrackRows& rows, const std::string& file) {
    measure::TrackScale scale{keys.pixel,
                              keys.frames_per_second.value_or(1.0),
                              keys.bead_radius,
                              keys.box,
                              {},
                              rows.length.empty() ? keys.angle : 1.0,
                              keys.thin_end == scene::ThinEnd::ahead,
                              keys.longest_step.length};
    for (const scene::TracksKind& kind : keys.bead_kinds)
        scale.kind_radii.push_back(kind.radius);
    const bool own = keys.window.kind == WindowKind::automatic || keys.window.kind == WindowKind::periodic;
    if (own && !keys.box) {
        if (rows.box)
            scale.box = PeriodicBox(rows.box->x * keys.pixel, rows.box->y * keys.pixel);
        else if (!rows.no_box.empty())
            throw InputError(
                fmt::format("{}: {}: give tracks.window = \"hull\", or tracks.window = \"periodic\" "
                            "and tracks.box",
                            file, rows.no_box));
        else if (keys.window.kind == WindowKind::periodic)
            throw InputError(file + ": has no periodic box: give tracks.box, for example box = \"78 a\"");
    }
    const std::vector<double>& s = keys.window.sizes;
    if (keys.window.kind == WindowKind::circle)
        scale.window = measure::Window::circle(s[0], s[1], s[2]);
    if (keys.window.kind == WindowKind::rectangle)
        scale.window = measure::Window::rectangle(s[0], s[1], s[2], s[3]);
    return scale;
}

/// film_frame.csv
struct FilmBead {
    double t, x, y, psi6, orientation, radius;

    static constexpr auto fields() {
        using R = FilmBead;
        return std::tuple{
            field("t", &R::t, {"s", "of the frame, the same in all rows"}),
            field("x", &R::x, {"m", "as in rod_tracks.csv"}),
            field("y", &R::y, {"m", "as in rod_tracks.csv"}),
            field("psi6", &R::psi6,
                  {"1", "size of the local bond order, neighbours as measure.order has them (empty: too near "
                        "the border of the window, or order is not measured)"}),
            field("orientation", &R::orientation, {"rad", "of the close-packed rows from +x; empty as psi6"}),
            field("radius", &R::radius, {"m", "of the bead"})};
    }
};

TracksReport report_of(const scene::Tracks& keys, const fs::path& file, const TrackRows& kept,
                       const measure::Tracks& tracks) {
    const double a = keys.bead_radius, area = seen_area(measure::layout_of(tracks)) / (a * a);
    const WindowKind found = tracks.window ? WindowKind::hull : WindowKind::periodic;
    TracksReport r{
        file.filename().string(),
        std::string(to_string(keys.window.kind == WindowKind::automatic ? found : keys.window.kind)),
        kept.length_unit};
    r.rows = tracks.counts.rows + kept.without_place + kept.hidden;
    r.frames = tracks.frames();
    r.particles = tracks.beads;
    r.rods = tracks.rods.size();
    r.bead_radius = a;
    r.box = {tracks.box.x, tracks.box.y};
    r.rod_tracks = film_rods(tracks);
    r.beads_per_frame = tracks.beads_per_frame();
    r.mean_length = tracks.mean_length();
    r.lost_share = tracks.lost_share();
    r.interval = tracks.interval;
    r.duration = tracks.time.back() - tracks.time.front();
    r.area = area;
    r.phi_b = r.beads_per_frame * std::numbers::pi * tracks.mean_square_radius() / area;
    // Everything that is missing. The reader that met it reported most of it already.
    const measure::TrackCounts& counts = tracks.counts;
    const auto add = [&](std::size_t rows, std::string why) {
        if (rows > 0)
            r.left_out.push_back({std::move(why), rows});
    };
    add(kept.without_place, "rows without a position, the first at " + kept.first_without_place);
    add(kept.hidden, "spots hidden by TrackMate's filters");
    add(kept.branches, "links cut where tracks split or merge");
    add(counts.dangling, "links to spots that are not in the file");
    add(counts.repeated, "rows of a particle that the frame has already");
    add(counts.outside, "rows outside of the window");
    add(counts.restarts, "tracks cut where they jump: their number goes on " + tracks.cut_rule);
    add(counts.untracked, "rows in no track, used where one frame is enough");
    add(counts.empty_frames, "frames without any row");
    add(counts.headless, "rows of rods whose heading is not known");
    add(counts.joined, "rods that went on under another number, joined");
    for (const std::string& warning : tracks.warnings)
        r.left_out.push_back({warning, 0});
    return r;
}

/// Nothing if it was stopped.
std::optional<measure::Tracks> read(const Scene& scene, const RunContext& context, const fs::path& folder,
                                    Progress& progress, const Logger& log) {
    const scene::Tracks& keys = *scene.tracks;
    const fs::path file = file_of(scene, "file", keys.file);
    std::vector<fs::path> films;
    TrackRows rows = rows_of(keys, file, keys.format, false, folder, context, films,
                             [&](double part) { progress.update(0.5 * part); });
    if (!context.stopped() && !keys.rods_file.empty())
        append_rods(rows, rows_of(keys, file_of(scene, "rods_file", keys.rods_file), TrackFormat::automatic,
                                  true, folder, context, films, [](double) {}));
    if (context.stopped())
        return std::nullopt;
    // Films go that belong to files which the scene no longer names or which have changed.
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("film_") && name.ends_with(".h5md") &&
            std::ranges::count(films, entry.path()) == 0)
            fs::remove(entry.path());
    }
    TrackRows facts; // what the reader left out; the rows themselves are given away
    facts.without_place = rows.without_place;
    facts.first_without_place = rows.first_without_place;
    facts.branches = rows.branches;
    facts.hidden = rows.hidden;
    facts.dangling = rows.dangling;
    facts.warnings = rows.warnings;
    facts.length_unit = rows.length_unit;
    for (const std::string& warning : rows.warnings)
        log->warn("{}: {}", file.filename().string(), warning);
    const measure::TrackScale scale = scale_of(keys, rows, file.string());
    // The mean length of each rod is taken by its number, in units of the file.
    std::map<std::int64_t, std::pair<double, double>> sums;
    for (std::size_t row = 0; row < rows.length.size(); ++row)
        if (row < rows.is_rod.size() && rows.is_rod[row] && !std::isnan(rows.length[row])) {
            sums[rows.id[row]].first += rows.length[row];
            sums[rows.id[row]].second += 1.0;
        }
    std::map<std::int64_t, double> lengths;
    for (const auto& [number, sum] : sums)
        lengths[number] = sum.first / sum.second;
    measure::Tracks tracks = measure::ordered_tracks(std::move(rows), scale, file.string());
    TracksReport report = report_of(keys, file, facts, tracks);
    for (FilmRod& rod : report.rod_tracks)
        if (const auto at = lengths.find(rod.number); at != lengths.end())
            rod.length = at->second * keys.pixel;
    store::write_atomically(folder / "tracks.json", json_text(record_json(report), 2) + "\n");
    std::string text =
        fmt::format("tracks: {} frames, {} particles, {:.1f} frames long on average, {:.2g} % lost",
                    report.frames, report.particles, report.mean_length, 100.0 * report.lost_share);
    if (report.rods > 0)
        text += fmt::format(", {} rod{}", report.rods, report.rods == 1 ? "" : "s");
    for (const RowsLeftOut& left : report.left_out)
        if (left.rows > 0)
            text += fmt::format("; {} {}", left.rows, left.why);
    log->info("{}", text);
    return tracks;
}

/// Over its frames; nothing if it was stopped.
std::optional<measure::Measures> sums_of(const Scene& scene, const measure::Tracks& tracks,
                                         Progress& progress, const RunContext& context) {
    // Every how many intervals a frame is measured; at uneven times frames are at least the interval apart.
    const double ratio =
        tracks.on_grid ? scene.measure->interval.value_or(tracks.interval) / tracks.interval : 1.0;
    if (ratio < 0.999 || std::abs(ratio - std::round(ratio)) > 1e-4 * ratio)
        throw InputError(
            fmt::format("{}: frames are {:g} s apart; measure.interval = {:g} s is no whole multiple "
                        "of that",
                        scene.path, tracks.interval, *scene.measure->interval));
    const auto stride = static_cast<std::size_t>(std::round(ratio));
    const double least = tracks.on_grid ? 0.0 : scene.measure->interval.value_or(0.0) * (1.0 - 1e-9),
                 mean = tracks.has_all_frames() ? tracks.interval
                                                : (tracks.time.back() - tracks.time.front()) /
                                                      static_cast<double>(tracks.frames() - 1);
    MeasurePlan plan = measure_plan(scene, measure::layout_of(tracks, stride),
                                    std::max(static_cast<double>(stride) * mean, least));
    double next = -HUGE_VAL;
    measure::for_each_frame(tracks, stride, [&](const measure::Frame& frame, double part) {
        if (frame.time >= next) {
            plan.sums.add(frame);
            next = frame.time + least;
        }
        progress.update(0.5 + 0.5 * part);
        return !context.stopped();
    });
    return context.stopped() ? std::nullopt : std::optional(std::move(plan.sums));
}

} // namespace

std::vector<std::string> look_at_tracks(const Scene& scene, const RunContext* context) {
    const scene::Tracks& keys = *scene.tracks;
    std::vector<std::string> found;
    const auto look = [&](const char* key, const std::string& name, TrackFormat format, bool of_rods) {
        const fs::path file = file_of(scene, key, name);
        if (format == TrackFormat::automatic)
            format = store::track_format(file);
        std::vector<std::string> hints;
        if (format == TrackFormat::csv) // the reader of the run, stopped at the first row that has a place
            hints = store::read_track_csv(file, columns_of(keys, of_rods, name == keys.file), [](double) {
                        return false;
                    }).warnings;
        else if (context)
            hints.push_back("its first frames: " + look_into(keys, file, format, *context));
        for (const std::string& line : hints)
            found.push_back(file.filename().string() + ": " + line);
    };
    look("file", keys.file, keys.format, keys.rods_file.empty());
    if (!keys.rods_file.empty())
        look("rods_file", keys.rods_file, TrackFormat::automatic, true);
    return found;
}

std::span<const ColumnInfo> tracks_values() { return values_of<TracksReport>(); }
std::span<const ColumnInfo> film_frame_columns() { return columns_of<FilmBead>(); }

std::optional<CaseResults> measure_tracks(const Case& case_, const RunContext& context,
                                          const fs::path& folder, const Logger& log) {
    const Scene& scene = case_.scene;
    Progress progress(context, "measure", 1.0, "film");
    const auto tracks = read(scene, context, folder, progress, log);
    if (!tracks)
        return std::nullopt;
    for (const std::string& warning : tracks->warnings)
        log->warn("{}", warning);
    if (tracks->counts.dangling > 0)
        log->warn("{}: {} links to spots that are not in the file: tracks end there", scene.tracks->file,
                  tracks->counts.dangling);
    require_rods(scene, *tracks, scene.tracks->file);
    CaseResults results;
    MeasuredCase data{scene, {}, {}, results.row, tracks->time.back() - tracks->time.front()};
    auto sums = sums_of(scene, *tracks, progress, context);
    if (!sums)
        return std::nullopt;
    if (!tracks->x.empty()) // a film may have rods alone
    {
        std::size_t most = 0;
        for (std::size_t f = 1; f < tracks->frames(); ++f)
            if (tracks->start[f + 1] - tracks->start[f] > tracks->start[most + 1] - tracks->start[most])
                most = f;
        const auto from = static_cast<std::ptrdiff_t>(tracks->start[most]),
                   to = static_cast<std::ptrdiff_t>(tracks->start[most + 1]);
        const Column x(tracks->x.begin() + from, tracks->x.begin() + to),
            y(tracks->y.begin() + from, tracks->y.begin() + to);
        const std::vector<std::complex<double>> psi = local_order(scene, *sums, x, y);
        std::vector<FilmBead> beads;
        for (std::size_t i = 0; i < x.size(); ++i) {
            const bool known = !std::isnan(psi[i].real());
            beads.push_back(
                {tracks->time[most], x[i], y[i], known ? std::abs(psi[i]) : std::nan(""),
                 known ? std::arg(psi[i]) / 6.0 : std::nan(""),
                 tracks->radius.empty() ? tracks->bead_radius : tracks->radius[tracks->start[most] + i]});
        }
        store::write_atomically(folder / "film_frame.csv", csv_of(beads));
    }
    data.sums = std::span(&*sums, 1);
    if (!tracks->rods.empty()) {
        const FilmRods rods(*tracks);
        store::write_atomically(folder / "rod_tracks.csv", rods.csv());
        data.tables.push_back(rods.tables());
    }
    results.row.name = case_.name;
    results.row.bead_radius = tracks->bead_radius;
    results.row.phi_b = tracks->beads_per_frame() * std::numbers::pi * std::pow(tracks->bead_radius, 2) *
                        tracks->mean_square_radius() / seen_area(sums->layout());
    results.row.runs = 1;
    report_measures(data, results);
    return results;
}

void describe_tracks(const Plan& plan, Lines& lines) {
    const scene::Tracks& keys = *plan.scene.tracks;
    lines.push_back(
        {true, fmt::format("tracks of {} instead of a bed; 1 of the file is {:.4g} a; window: {}", keys.file,
                           keys.pixel / keys.bead_radius, to_string(keys.window.kind))});
    for (const std::string& line : plan.tracks)
        lines.push_back({true, line});
    for (const MeasureKind& kind : measure_kinds()) {
        const bool wanted = kind.wanted(*plan.scene.measure);
        lines.push_back({wanted, fmt::format("measure {}: {}", kind.name,
                                             wanted ? kind.describe(plan.scene) : "not named in [measure]")});
    }
}

} // namespace rodwake::app
