#include "fit_files.hpp"

#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"

#include <fmt/format.h>

namespace rodwake::stages {

namespace {

namespace fs = std::filesystem;
using Column = std::vector<double>;

void write_profile(const fs::path& folder, std::size_t i, const assembly::FitProfileData& data,
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
                const assembly::FitTrackData& track, const std::vector<std::vector<double>>& states) {
    for (std::size_t k = 0; k < 3 * track.rods; ++k) {
        static constexpr const char* letters[] = {"x", "y", "theta"};
        names.push_back(fmt::format("{}{}{}", prefix, letters[k % 3], k / 3));
        columns.emplace_back();
        for (const auto& state : states)
            columns.back().push_back(state[k] * (k % 3 == 2 ? 1.0 : track.length));
    }
}

void write_track(const fs::path& folder, std::size_t i, const assembly::FitTrackData& track,
                 const FitTrackResult& r) {
    std::vector<std::string> names = {"t"};
    std::vector<Column> columns = {{}};
    for (const double t : track.data.times)
        columns[0].push_back(t * track.time);
    add_states(names, columns, "", track, track.data.states);
    add_states(names, columns, "model_", track, r.model);
    store::write_atomically(folder / fmt::format("fit_trajectory_{}.csv", i), store::to_csv(names, columns));
}

} // namespace

void write_fit(const fs::path& folder, const assembly::FitPlan& plan, const FitResults& results,
               const FitOrigin& origin) {
    for (std::size_t i = 0; i < results.profiles.size(); ++i) {
        write_profile(folder, i, plan.profiles[i], results.profiles[i]);
        write_curve(folder, i, results.profiles[i]);
    }
    for (std::size_t i = 0; i < results.tracks.size(); ++i)
        write_track(folder, i, plan.tracks[i], results.tracks[i]);
    store::write_atomically(folder / "fit.txt", fitting::to_text(plan.problem, results.fit, results.report));
    store::write_atomically(folder / "fit.json", fit_json(plan, results, origin));
}

} // namespace rodwake::stages
