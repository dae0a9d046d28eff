// What the samples of a posterior predict, with and without the noise of the data.

#include "fit_files.hpp"

#include "fit_records.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rodwake::app {

namespace {

constexpr std::size_t most_draws = 200, predicted_places = 201;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Values of all parameters at draws that are spread evenly over the chains.
std::vector<std::vector<double>> some_draws(const FitPlan& plan, const fitting::Posterior& found) {
    const std::size_t length = found.log_likelihood.front().size(),
                      all = length * found.log_likelihood.size(), count = std::min(most_draws, all);
    std::vector<std::vector<double>> out;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = i * all / count;
        std::vector<double> free;
        for (const auto& values : found.values)
            free.push_back(values[at / length][at % length]);
        out.push_back(fitting::all_values(plan.problem, free));
    }
    return out;
}

struct Band {
    double median, low, high, noise_low, noise_high;
};

double quantile(const std::vector<double>& sorted, double p) {
    const double at = p * static_cast<double>(sorted.size() - 1);
    const auto i = static_cast<std::size_t>(at);
    return std::lerp(sorted[i], sorted[std::min(i + 1, sorted.size() - 1)], at - static_cast<double>(i));
}

/// Of the values with normal noise added: the mixture's distribution function, inverted by bisection.
double noisy_quantile(const std::vector<double>& sorted, double sigma, double p) {
    double low = sorted.front() - 6.0 * sigma, high = sorted.back() + 6.0 * sigma;
    for (int round = 0; round < 50; ++round) {
        const double middle = 0.5 * (low + high);
        double below = 0.0;
        for (const double value : sorted)
            below += 0.5 * std::erfc((value - middle) / (sigma * std::numbers::sqrt2));
        (below < p * static_cast<double>(sorted.size()) ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// Those that are not finite do not count.
Band band_of(std::vector<double> values, double sigma) {
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty())
        return {unknown, unknown, unknown, unknown, unknown};
    std::ranges::sort(values);
    const bool noisy = sigma > 0.0;
    return {quantile(values, 0.5), quantile(values, 0.025), quantile(values, 0.975),
            noisy ? noisy_quantile(values, sigma, 0.025) : unknown,
            noisy ? noisy_quantile(values, sigma, 0.975) : unknown};
}

/// Standard error of a datum anywhere along the line, between those of the points beside it.
double sigma_at(const fitting::Profile& data, double place) {
    if (data.sigma.empty())
        return 0.0;
    double below = -HUGE_VAL, above = HUGE_VAL, low = 0.0, high = 0.0;
    for (std::size_t i = 0; i < data.place.size(); ++i) {
        if (data.place[i] <= place && data.place[i] > below)
            below = data.place[i], low = data.sigma[i];
        if (data.place[i] >= place && data.place[i] < above)
            above = data.place[i], high = data.sigma[i];
    }
    if (!std::isfinite(below) || !std::isfinite(above) || above == below)
        return std::isfinite(below) ? low : high;
    return std::lerp(low, high, (place - below) / (above - below));
}

void write_curve(const std::filesystem::path& folder, const FitPlan& plan, std::size_t index,
                 const std::vector<std::vector<double>>& draws, std::size_t threads) {
    const fitting::Profile& data = plan.profiles[index].data;
    const auto [from, to] = std::ranges::minmax(data.place);
    std::vector<double> places(predicted_places);
    for (std::size_t i = 0; i < predicted_places; ++i)
        places[i] = std::lerp(from, to, static_cast<double>(i) / static_cast<double>(predicted_places - 1));
    std::vector<std::vector<double>> models(draws.size());
    parallel_for(draws.size(), threads,
                 [&](std::size_t i) { models[i] = predicted_line(plan, data, places, draws[i]).value; });
    std::vector<PredictedRow> rows(predicted_places);
    parallel_for(predicted_places, threads, [&](std::size_t i) {
        std::vector<double> values;
        for (const auto& model : models)
            values.push_back(model[i]);
        const Band b = band_of(std::move(values), sigma_at(data, places[i]));
        rows[i] = {places[i], b.median, b.low, b.high, b.noise_low, b.noise_high};
    });
    store::write_atomically(folder / fmt::format("posterior_curve_{}.csv", index), csv_of(rows));
}

void write_track(const std::filesystem::path& folder, const FitPlan& plan, std::size_t index,
                 const std::vector<std::vector<double>>& draws, std::size_t threads) {
    const FitTrackData& track = plan.tracks[index];
    const FitPart part = track_part(plan.problem);
    std::vector<std::vector<std::vector<double>>> models(draws.size());
    parallel_for(draws.size(), threads, [&](std::size_t i) {
        models[i] =
            fitting::predict(plan.track_model, track.data, index, part.parameters, part.values(draws[i]));
    });
    std::vector<PredictedPoseRow> rows;
    for (std::size_t row = 0; row < track.data.times.size(); ++row)
        for (std::size_t i = 0; i < track.data.states[row].size(); ++i) {
            const bool heading = i % 3 == 2;
            const double unit = heading ? 1.0 : track.length;
            std::vector<double> values;
            for (const auto& model : models)
                values.push_back(unit * model[row][i]);
            const Band b = band_of(std::move(values),
                                   unit * (heading ? track.data.sigma_heading : track.data.sigma_position));
            rows.push_back({track.time * track.data.times[row], static_cast<double>(i / 3),
                            static_cast<double>(i % 3), unit * track.data.states[row][i], b.median, b.low,
                            b.high, b.noise_low, b.noise_high});
        }
    store::write_atomically(folder / fmt::format("posterior_trajectory_{}.csv", index), csv_of(rows));
}

} // namespace

void write_predictions(const std::filesystem::path& folder, const FitPlan& plan,
                       const fitting::Posterior& found, std::size_t threads) {
    const std::vector<std::vector<double>> draws = some_draws(plan, found);
    for (std::size_t i = 0; i < plan.profiles.size(); ++i)
        write_curve(folder, plan, i, draws, threads);
    for (std::size_t i = 0; i < plan.tracks.size(); ++i)
        write_track(folder, plan, i, draws, threads);
}

} // namespace rodwake::app
