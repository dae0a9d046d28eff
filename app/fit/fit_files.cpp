#include "fit_files.hpp"

#include "fit_records.hpp"
#include "fit_systematics.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

void write_profile(const fs::path& folder, std::size_t i, const FitProfileData& data,
                   const FitProfileResult& r) {
    std::vector<FitProfileRow> rows;
    for (std::size_t k = 0; k < data.data.place.size(); ++k)
        rows.push_back({data.data.place[k], data.data.value[k], r.sigma[k], r.model[k], r.band[k],
                        r.residual[k], r.used[k] ? 1.0 : 0.0});
    store::write_atomically(folder / fmt::format("fit_profile_{}.csv", i), csv_of(rows));
}

void write_curve(const fs::path& folder, std::size_t i, const FitProfileResult& r) {
    std::vector<FitCurveRow> rows;
    for (std::size_t k = 0; k < r.curve[0].size(); ++k)
        rows.push_back({r.curve[0][k], r.curve[1][k], r.curve[2][k]});
    RecordTable table;
    table.add(rows);
    for (std::size_t k = 3; k < r.curve.size(); ++k) {
        std::vector<FitComparison> compared;
        for (const double value : r.curve[k])
            compared.push_back({value});
        table.add(compared, std::to_string(k - 3));
    }
    store::write_atomically(folder / fmt::format("fit_curve_{}.csv", i), table.csv());
}

/// Poses of each rod from reduced states, in the file's unit.
template<class Pose>
void add_states(RecordTable& table, const FitTrackData& track,
                const std::vector<std::vector<double>>& states) {
    for (std::size_t rod = 0; rod < track.rods; ++rod) {
        std::vector<Pose> poses;
        poses.reserve(states.size());
        for (const auto& state : states)
            poses.push_back(
                {state[3 * rod] * track.length, state[3 * rod + 1] * track.length, state[3 * rod + 2]});
        table.add(poses, std::to_string(rod));
    }
}

void write_track(const fs::path& folder, std::size_t i, const FitTrackData& track, const FitTrackResult& r) {
    std::vector<FitTimeRow> times;
    for (const double t : track.data.times)
        times.push_back({t * track.time});
    RecordTable table;
    table.add(times);
    add_states<MeasuredPose>(table, track, track.data.states);
    add_states<FittedPose>(table, track, r.model);
    store::write_atomically(folder / fmt::format("fit_trajectory_{}.csv", i), table.csv());
}

/// All bins, row by row; what is not known is empty.
void write_map(const fs::path& folder, std::size_t i, const fitting::Map& map, const FitMapResult& r) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    const double enlarged = 1.0 / std::sqrt(map.independent);
    std::vector<FitMapRow> rows;
    for (std::size_t bin = 0; bin < map.bins(); ++bin) {
        const bool known = map.known[bin], sigma = known && !map.sigma_x.empty();
        rows.push_back({map.place_x(bin), map.place_y(bin), known ? map.Ux[bin] : unknown,
                        known ? map.Uy[bin] : unknown, sigma ? enlarged * map.sigma_x[bin] : unknown,
                        sigma ? enlarged * map.sigma_y[bin] : unknown, r.model.Ux[bin], r.model.Uy[bin],
                        known ? 1.0 : 0.0, r.used[bin] ? 1.0 : 0.0});
    }
    store::write_atomically(folder / fmt::format("fit_map_{}.csv", i), csv_of(rows));
}

std::string findings_text(const FitPlan& plan, const FitResults& results) {
    std::string text;
    for (const std::string& line : findings(plan, results))
        text += (text.empty() ? "\nLikelihood and predictions\n  - " : "  - ") + line + "\n";
    return text;
}

/// Which medium the numbers belong to.
std::string media(const FitPlan& plan) {
    std::string text;
    if (!plan.profiles.empty())
        text += "Profiles: steady field of an isotropic medium, along lines\n";
    if (!plan.maps.empty())
        text += "Maps: steady field of an orthotropic medium, outside the mask\n";
    return text.empty() ? text : text + "\n";
}

} // namespace

void write_fit(const fs::path& folder, const FitPlan& plan, const FitResults& results,
               const FitOrigin& origin) {
    for (std::size_t i = 0; i < results.profiles.size(); ++i) {
        write_profile(folder, i, plan.profiles[i], results.profiles[i]);
        write_curve(folder, i, results.profiles[i]);
    }
    for (std::size_t i = 0; i < results.tracks.size(); ++i)
        write_track(folder, i, plan.tracks[i], results.tracks[i]);
    for (std::size_t i = 0; i < results.maps.size(); ++i)
        write_map(folder, i, plan.maps[i].data, results.maps[i]);
    store::write_atomically(folder / "fit.txt",
                            media(plan) + fitting::to_text(plan.problem, results.fit, results.report) +
                                findings_text(plan, results) + to_text(plan, results));
    store::write_atomically(folder / "fit.json", fit_json(plan, results, origin));
}

} // namespace rodwake::app
