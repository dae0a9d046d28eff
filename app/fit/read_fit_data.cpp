#include "fit_data.hpp"

#include "rodwake/app/run.hpp"
#include "rodwake/core/box_sides.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/fitting/wake.hpp"
#include "rodwake/store/csv.hpp"
#include "run/catalogue.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_rods = 1000;

std::string where(const fs::path& file, std::size_t line) {
    return fmt::format("{}:{}", file.string(), line);
}

std::string name_or_stem(const std::string& name, const fs::path& file) {
    return name.empty() ? file.stem().string() : name;
}

/// Reads a table of rods, which may be missing in some rows, as in a film.
store::Table read_rods(const fs::path& file) {
    static const std::vector<std::string> time = {"t"}, needed = {"t", "x0", "y0", "theta0"};
    std::vector<std::string> names;
    for (std::size_t rod = 0; rod < most_rods; ++rod)
        for (const char* name : {"x", "y", "theta"})
            names.push_back(name + std::to_string(rod));
    store::Table table = store::read_csv(file, time, names);
    if (!table.find("x0") || !table.find("y0") || !table.find("theta0"))
        throw InputError(fmt::format("{}:1:1: no column \"{}\"; the header must have at least {}",
                                     file.string(),
                                     !table.find("x0")   ? "x0"
                                     : !table.find("y0") ? "y0"
                                                         : "theta0",
                                     fmt::join(needed, ",")));
    return table;
}

} // namespace

std::vector<fs::path> data_file_places(const std::string& file, const scene::Scene& scene,
                                       const fs::path& run_directory) {
    if (fs::path(file).is_absolute())
        return {file};
    std::vector<fs::path> candidates;
    if ((scene.measure || scene.granular) && !run_directory.empty())
        candidates.push_back(run_directory / file);
    const fs::path beside = (fs::path(scene.path).parent_path() / file).lexically_normal();
    candidates.push_back(beside);
    if (beside != fs::path(file).lexically_normal())
        candidates.emplace_back(file);
    return candidates;
}

fs::path find_fit_file(const std::string& file, const scene::Scene& scene, const fs::path& run_directory) {
    const auto candidates = data_file_places(file, scene, run_directory);
    std::string looked;
    for (const fs::path& candidate : candidates) {
        if (fs::is_regular_file(candidate))
            return candidate;
        if (std::error_code none; fs::exists(candidate, none))
            throw InputError(
                fmt::format("{}: is not a regular file; [fit] names files with data", candidate.string()));
        looked += fmt::format("{}{}", looked.empty() ? "" : ", ",
                              fs::absolute(candidate).lexically_normal().string());
    }
    const char* hint =
        made_by_run(file, scene) ? "; rodwake run makes what this scene measures before it is fitted" : "";
    throw InputError(fmt::format("{}: no such file to fit; looked for {}{}", file, looked, hint));
}

bool made_by_run(const std::string& file, const scene::Scene& scene) {
    const std::string name = fs::path(file).filename().string();
    const FileKind* kind = kind_of(name);
    if (!kind || !kind->stage)
        return false;
    const bool on_top = name == file, of_a_run = file.starts_with("runs/"); // of an ensemble
    if (name == "rod_tracks.csv")
        return scene.tracks && on_top;
    return *kind->stage == Stage::measure
               ? scene.measure && scene.measure->displacement && on_top
               : *kind->stage == Stage::granular && scene.granular && (on_top || of_a_run);
}

FitProfileData read_fit_profile(const scene::FitProfile& keys, const fs::path& file,
                                std::optional<double> independent_spacing) {
    static const std::vector<std::string> required = {"x", "value"}, optional = {"sigma"};
    const store::Table table = store::read_csv(file, required, optional);
    std::vector<double> x = *table.find("x");
    for (double& position : x)
        position *= keys.columns.place_factor;
    const auto& value = *table.find("value");
    const auto* sigma = table.find("sigma");
    if (sigma && std::ranges::all_of(*sigma, [](double s) { return std::isnan(s); }))
        sigma = nullptr; // none is known
    FitProfileData out{name_or_stem(keys.name, file), file, {}, 0};
    fitting::Profile& data = out.data;
    data.name = out.name;
    data.component = keys.component == "Ux" ? fitting::Component::Ux : fitting::Component::Uy;
    data.along = keys.along == "x" ? fitting::Axis::x : fitting::Axis::y;
    data.at = keys.at;
    for (std::size_t i = 0; i < table.rows(); ++i) {
        if (!keys.range.empty() && (x[i] < keys.range[0] || x[i] > keys.range[1]))
            continue;
        if (sigma && std::isnan((*sigma)[i])) {
            ++out.left_out;
            continue;
        }
        if (sigma && !((*sigma)[i] > 0.0))
            throw InputError(
                fmt::format("{}: sigma = {}: must be above 0; leave the column out if the errors are "
                            "unknown",
                            where(file, table.lines[i]), (*sigma)[i]));
        data.place.push_back(x[i]);
        data.value.push_back(value[i] * keys.columns.value_factor);
        if (sigma)
            data.sigma.push_back((*sigma)[i] * keys.columns.value_factor);
        data.where.push_back(where(file, table.lines[i]));
    }
    if (data.place.empty())
        throw InputError(file.string() + ": holds no points to fit" +
                         (keys.range.empty() ? "" : " within fit.profiles.range"));
    if (independent_spacing)
        fitting::share_data(data, *independent_spacing);
    return out;
}

FitTrackData read_fit_track(const scene::FitTrajectory& keys, const fs::path& file,
                            std::optional<PeriodicBox> box, const rods::RodBodies& bodies) {
    const store::Table table = read_rods(file);
    // Columns x<k>, y<k>, theta<k> of each rod in turn, as far as they go; of these the rods that keys name.
    std::vector<const std::vector<double>*> all, columns;
    for (std::size_t k = 0; k < 3 * most_rods; ++k) {
        static constexpr const char* names[] = {"x", "y", "theta"};
        const auto* column = table.find(names[k % 3] + std::to_string(k / 3));
        if (!column)
            break;
        all.push_back(column);
    }
    if (all.size() % 3 != 0)
        throw InputError(fmt::format("{0}: rod {1} lacks one of the columns x{1}, y{1}, theta{1}",
                                     file.string(), all.size() / 3));
    for (const long rod : keys.rods) {
        const auto first = 3 * static_cast<std::size_t>(rod);
        if (first >= all.size())
            throw InputError(
                fmt::format("{}: fit.trajectories.rods names rod {}; there are {}, numbered from 0",
                            file.string(), rod, all.size() / 3));
        columns.insert(columns.end(), {all[first], all[first + 1], all[first + 2]});
    }
    if (keys.rods.empty())
        columns = all;
    FitTrackData out{name_or_stem(keys.name, file),
                     file,
                     columns.size() / 3,
                     keys.f_over_mu,
                     keys.f_over_mu / keys.speed,
                     false,
                     false,
                     {}};
    out.sigma_known = keys.sigma_position.has_value();
    out.data.name = out.name;
    out.data.sigma_position = out.sigma_known ? *keys.sigma_position / out.length : 1.0;
    out.data.sigma_heading = keys.sigma_heading.value_or(1.0);
    out.data.bodies = bodies;
    out.data.free_headings = keys.free_headings;
    out.data.free_start = scene::fits_start(keys);
    if (keys.contact_distance)
        out.data.contact_distance = *keys.contact_distance / out.length;
    if (keys.contact_time)
        out.data.contact_time = *keys.contact_time / out.time;
    out.data.sigma_contact = keys.sigma_contact ? *keys.sigma_contact / out.time : 1.0;

    // Rows before t = 0 are skipped if the rods are held there, as tracks.csv of a bed has them; rows in
    // which a rod is unknown are left out.
    const auto& t = *table.find("t");
    const auto start = std::ranges::find_if(t, [](double time) { return time >= -1e-12; }) - t.begin();
    const bool held =
        start < std::ssize(t) && std::ranges::all_of(columns, [&](const auto* column) {
            return std::count(column->begin(), column->begin() + start, (*column)[start]) == start;
        });
    for (std::size_t i = held ? static_cast<std::size_t>(start) : 0; i < table.rows(); ++i) {
        if (std::ranges::any_of(columns, [&](const auto* column) { return std::isnan((*column)[i]); })) {
            ++out.left_out;
            continue;
        }
        out.data.times.push_back(t[i] / out.time);
        std::vector<double>& state = out.data.states.emplace_back();
        for (std::size_t k = 0; k < columns.size(); ++k)
            state.push_back((*columns[k])[i] / (k % 3 == 2 ? 1.0 : out.length));
        out.data.where.push_back(where(file, table.lines[i]));
    }
    if (out.data.times.size() < 2)
        throw InputError(
            file.string() + ": a trajectory needs at least two rows" +
            (out.left_out > 0 ? " in which all its rods are known; fit.trajectories.rods chooses some" : ""));
    settle_track(out, box ? std::optional(*box / out.length) : std::nullopt);
    if (keys.independent_time)
        out.data.independent = fitting::mean_worth(
            fitting::independent_worth(out.data.times, *keys.independent_time / out.time));
    return out;
}

Estimate read_drag_area(const fs::path& run_directory, const fitting::Map& map) {
    const fs::path file = run_directory / "measure.json";
    std::ifstream in(file);
    const auto json = nlohmann::json::parse(in, nullptr, false);
    const auto mechanics = [&](const char* name) {
        const auto at = nlohmann::json::json_pointer(fmt::format("/mechanics/{}", name));
        if (json.is_discarded() || !json.contains(at) || !json[at].is_object() ||
            !json[at]["value"].is_number())
            throw InputError(
                fmt::format("{}: has no mechanics.{}, which fit.measured_drag needs", file.string(), name));
        const auto& estimate = json[at];
        return Estimate{estimate["value"].get<double>(),
                        estimate["error"].is_number() ? estimate["error"].get<double>() : 0.0, 1};
    };
    const Estimate drift = mechanics("drift"), speed = mechanics("speed");
    const double area = map.lx * map.ly * drift.value / speed.value;
    if (!(area > 0.0) || !std::isfinite(area))
        throw InputError(
            fmt::format("{}: the bed drifts at {:.3g} a/s and the rod goes at {:.3g} a/s, which gives "
                        "no drag_area (fit.measured_drag): a longer run is needed",
                        file.string(), drift.value, speed.value));
    return {area, area * std::hypot(drift.error / drift.value, speed.error / speed.value), 1};
}

FitInputs read_fit_inputs(const scene::Scene& scene, const fs::path& run_directory, OwnFiles own) {
    const scene::Fit& keys = *scene.fit;
    const auto absent = [&](const std::string& file) {
        if (own == OwnFiles::required || !made_by_run(file, scene))
            return false;
        const auto candidates = data_file_places(file, scene, run_directory);
        return own == OwnFiles::left_out ||
               std::ranges::none_of(candidates, [](const fs::path& p) { return fs::is_regular_file(p); });
    };
    FitInputs inputs{std::vector<std::optional<FitProfileData>>(keys.profiles.size()),
                     std::vector<std::optional<FitTrackData>>(keys.trajectories.size())};
    for (std::size_t i = 0; i < keys.profiles.size(); ++i)
        if (const scene::FitProfile& p = keys.profiles[i]; !absent(p.file))
            inputs.profiles[i] =
                read_fit_profile(p, find_fit_file(p.file, scene, run_directory), keys.independent_spacing);
    for (std::size_t i = 0; i < keys.trajectories.size(); ++i)
        if (const scene::FitTrajectory& track = keys.trajectories[i]; !absent(track.file))
            inputs.tracks[i] = read_fit_track(track, find_fit_file(track.file, scene, run_directory),
                                              keys.box, scene.body ? bodies_of(scene) : rods::RodBodies{});
    for (std::size_t table = 0; table < keys.maps.size(); ++table)
        for (const std::string& name : keys.maps[table].files) {
            if (absent(name)) {
                inputs.maps.emplace_back();
                continue;
            }
            for (FitMapData& map :
                 read_fit_maps(keys.maps[table], find_fit_file(name, scene, run_directory),
                               keys.independent_spacing, needs_speed(keys), keys.length_unit)) {
                map.table = table;
                inputs.maps.emplace_back(std::move(map));
            }
        }
    if (inputs.complete() && keys.measured_drag)
        inputs.drag_area = read_drag_area(run_directory, inputs.maps.front()->data);
    return inputs;
}

} // namespace rodwake::app
