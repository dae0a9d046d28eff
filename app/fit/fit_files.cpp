#include "fit_files.hpp"

#include "fit_systematics.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using Column = std::vector<double>;

void write_profile(const fs::path& folder, std::size_t i, const FitProfileData& data,
                   const FitProfileResult& r) {
    static const std::vector<std::string> names = {"x",    "value",    "sigma", "model",
                                                   "band", "residual", "used"};
    const std::vector<Column> columns = {data.data.place,
                                         data.data.value,
                                         r.sigma,
                                         r.model,
                                         r.band,
                                         r.residual,
                                         Column(r.used.begin(), r.used.end())};
    store::write_atomically(folder / fmt::format("fit_profile_{}.csv", i), store::to_csv(names, columns));
}

void write_curve(const fs::path& folder, std::size_t i, const FitProfileResult& r) {
    std::vector<std::string> names = {"x", "model", "band"};
    for (std::size_t k = 3; k < r.curve.size(); ++k)
        names.push_back(fmt::format("compare_{}", k - 3));
    store::write_atomically(folder / fmt::format("fit_curve_{}.csv", i), store::to_csv(names, r.curve));
}

/// Columns of x, y, theta of each rod from reduced states, in the file's unit.
void add_states(std::vector<std::string>& names, std::vector<Column>& columns, const std::string& prefix,
                const FitTrackData& track, const std::vector<std::vector<double>>& states) {
    for (std::size_t k = 0; k < 3 * track.rods; ++k) {
        static constexpr const char* letters[] = {"x", "y", "theta"};
        names.push_back(fmt::format("{}{}{}", prefix, letters[k % 3], k / 3));
        columns.emplace_back();
        for (const auto& state : states)
            columns.back().push_back(state[k] * (k % 3 == 2 ? 1.0 : track.length));
    }
}

void write_track(const fs::path& folder, std::size_t i, const FitTrackData& track, const FitTrackResult& r) {
    std::vector<std::string> names = {"t"};
    std::vector<Column> columns = {{}};
    for (const double t : track.data.times)
        columns[0].push_back(t * track.time);
    add_states(names, columns, "", track, track.data.states);
    add_states(names, columns, "model_", track, r.model);
    store::write_atomically(folder / fmt::format("fit_trajectory_{}.csv", i), store::to_csv(names, columns));
}

/// All bins, row by row; what is not known is empty.
void write_map(const fs::path& folder, std::size_t i, const fitting::Map& map, const FitMapResult& r) {
    static const std::vector<std::string> names = {"x",       "y",        "Ux",       "Uy",    "sigma_x",
                                                   "sigma_y", "model_Ux", "model_Uy", "known", "used"};
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    std::vector<Column> columns(names.size());
    for (std::size_t bin = 0; bin < map.bins(); ++bin) {
        const bool known = map.known[bin], sigma = known && !map.sigma_x.empty();
        const double enlarged = 1.0 / std::sqrt(map.independent);
        const double row[] = {map.place_x(bin),
                              map.place_y(bin),
                              known ? map.Ux[bin] : unknown,
                              known ? map.Uy[bin] : unknown,
                              sigma ? enlarged * map.sigma_x[bin] : unknown,
                              sigma ? enlarged * map.sigma_y[bin] : unknown,
                              r.model.Ux[bin],
                              r.model.Uy[bin],
                              known ? 1.0 : 0.0,
                              r.used[bin] ? 1.0 : 0.0};
        for (std::size_t k = 0; k < columns.size(); ++k)
            columns[k].push_back(row[k]);
    }
    store::write_atomically(folder / fmt::format("fit_map_{}.csv", i), store::to_csv(names, columns));
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
