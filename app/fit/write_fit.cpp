#include "fit_json.hpp"
#include "fit_records.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

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

} // namespace

Named<FitParameterEntry> FitJson::parameters() const {
    Named<FitParameterEntry> named;
    for (std::size_t i = 0; i < report().estimates.size(); ++i) {
        const fitting::ParameterEstimate& e = report().estimates[i];
        named.emplace_back(e.name, FitParameterEntry{e, plan.problem.parameters[i], error_of(report(), e),
                                                     fit_unit(plan.keys, e.name)});
    }
    return named;
}

Named<FitDerivedEntry> FitJson::derived() const {
    Named<FitDerivedEntry> named;
    for (const auto& [name, d] : results.derived)
        named.emplace_back(name, FitDerivedEntry{d.value, d.error, fit_unit(plan.keys, name)});
    return named;
}

std::vector<std::vector<double>> FitJson::correlation() const {
    const auto known = [&](Eigen::Index k) { // an infinite error is none
        return std::isfinite(
            error_of(report(), report().estimates[report().free[static_cast<std::size_t>(k)]]));
    };
    const Eigen::MatrixXd& m = report().correlation;
    std::vector<std::vector<double>> rows;
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
        std::vector<double>& row = rows.emplace_back();
        for (Eigen::Index j = 0; j < m.cols(); ++j)
            row.push_back(i == j || (known(i) && known(j)) ? m(i, j) : std::nan(""));
    }
    return rows;
}

OrNull<FitSystematicsEntry> FitJson::systematics() const {
    const FitSystematics& s = results.systematics;
    if (s.total.empty())
        return {};
    FitSystematicsEntry entry;

    // The lists of numbers have the parameters first, the derived quantities behind them.
    const auto add_errors = [&](const std::string& name, std::size_t i, double value, double curvature) {
        const auto part = [&](const std::vector<double>& list) {
            return list.empty() ? std::nan("") : list[i];
        };
        entry.errors.emplace_back(name, FitErrorEntry{value, curvature, part(s.held_error),
                                                      part(s.mask_spread), part(s.jackknife), part(s.total)});
    };
    for (const std::size_t i : report().free)
        add_errors(report().estimates[i].name, i, report().estimates[i].value,
                   error_of(report(), report().estimates[i]));
    std::size_t index = report().estimates.size();
    for (const auto& [name, d] : results.derived)
        add_errors(name, index++, d.value, d.error);

    for (const FitSystematics::Held& held : s.held)
        entry.held.push_back({held.name, held.error, values_of_parameters(report(), held.change, true)});
    for (const FitSystematics::MaskFit& choice : s.masks)
        entry.masks.push_back({{choice.mask}, choice.residuals, choice.report});
    for (const FitSystematics::LeftOut& run : s.runs)
        entry.runs.push_back({plan.maps[run.map].label(), values_of_parameters(report(), run.values, true)});
    return entry;
}

void write_fit(const fs::path& folder, const FitPlan& plan, const FitResults& results,
               const std::string& command) {
    for (std::size_t i = 0; i < results.profiles.size(); ++i) {
        // The points of a profile, and the curve of the model with those of the comparisons.
        const fitting::Profile& data = plan.profiles[i].data;
        const FitProfileResult& r = results.profiles[i];
        std::vector<FitProfileRow> rows;
        for (std::size_t k = 0; k < data.place.size(); ++k)
            rows.push_back({data.place[k], data.value[k], r.sigma[k], r.model[k], r.band[k], r.residual[k],
                            r.used[k] ? 1.0 : 0.0});
        store::write_atomically(folder / fmt::format("fit_profile_{}.csv", i), csv_of(rows));
        std::vector<FitCurveRow> curve;
        for (std::size_t k = 0; k < r.curve[0].size(); ++k)
            curve.push_back({r.curve[0][k], r.curve[1][k], r.curve[2][k]});
        RecordTable table;
        table.add(curve);
        for (std::size_t k = 3; k < r.curve.size(); ++k) {
            std::vector<FitComparison> compared;
            for (const double value : r.curve[k])
                compared.push_back({value});
            table.add(compared, std::to_string(k - 3));
        }
        store::write_atomically(folder / fmt::format("fit_curve_{}.csv", i), table.csv());
    }
    for (std::size_t i = 0; i < results.tracks.size(); ++i) {
        std::vector<FitTimeRow> times;
        for (const double t : plan.tracks[i].data.times)
            times.push_back({t * plan.tracks[i].time});
        RecordTable table;
        table.add(times);
        add_states<MeasuredPose>(table, plan.tracks[i], plan.tracks[i].data.states);
        add_states<FittedPose>(table, plan.tracks[i], results.tracks[i].model);
        store::write_atomically(folder / fmt::format("fit_trajectory_{}.csv", i), table.csv());
    }
    for (std::size_t i = 0; i < results.maps.size(); ++i) {
        // All bins are written row by row; what is not known is empty.
        const fitting::Map& map = plan.maps[i].data;
        constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
        const double enlarged = 1.0 / std::sqrt(map.independent);
        std::vector<FitMapRow> rows;
        for (std::size_t bin = 0; bin < map.bins(); ++bin) {
            const bool known = map.known[bin], sigma = known && !map.sigma_x.empty();
            rows.push_back({map.place_x(bin), map.place_y(bin), known ? map.Ux[bin] : unknown,
                            known ? map.Uy[bin] : unknown, sigma ? enlarged * map.sigma_x[bin] : unknown,
                            sigma ? enlarged * map.sigma_y[bin] : unknown, results.maps[i].model.Ux[bin],
                            results.maps[i].model.Uy[bin], known ? 1.0 : 0.0,
                            results.maps[i].used[bin] ? 1.0 : 0.0});
        }
        store::write_atomically(folder / fmt::format("fit_map_{}.csv", i), csv_of(rows));
    }
    store::write_atomically(folder / "fit.json",
                            json_text(record_json(FitJson{plan, results, command}), 2) + "\n");
}

} // namespace rodwake::app
