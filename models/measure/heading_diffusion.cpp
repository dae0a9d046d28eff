#include "rodwake/measure/heading_diffusion.hpp"

#include "heading_tracks.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/statistics.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

void check_tracks(std::span<const HeadingTrack> runs, std::string_view measure) {
    if (runs.empty())
        throw InputError(fmt::format("measure: {}: no runs", measure));
    for (const HeadingTrack& run : runs) {
        const std::size_t rows = run.time.size();
        if (rows < 2 || run.heading.size() != rows || run.x.size() != rows || run.y.size() != rows)
            throw InputError(fmt::format("measure: {}: a run has {} rows: start sooner (measure.from, "
                                         "measure.from_travel) or run longer",
                                         measure, rows));
        if (std::ranges::count_if(run.heading, [](double h) { return !std::isnan(h); }) < 2)
            throw InputError(
                fmt::format("measure: {}: position and heading of the rod are known in fewer than "
                            "two frames",
                            measure));
    }
}

double common_step(std::span<const HeadingTrack> runs) {
    const std::vector<double>& time = runs[0].time;
    double step = time[1] - time[0];
    for (std::size_t i = 1; i + 1 < time.size(); ++i) // the last row of a run may be nearer
        if (time[i] - time[i - 1] < step * (1.0 - 1e-6))
            step = time[i] - time[i - 1];
    return step;
}

std::optional<HeadingTrack> even_track(const HeadingTrack& run, double step) {
    constexpr double sparsest = 4.0; // of all rows those that are there
    const std::size_t n = run.time.size();
    const double count = (run.time.back() - run.time.front()) / step;
    if (!(count < sparsest * static_cast<double>(n)))
        return std::nullopt;
    HeadingTrack even;
    for (std::size_t i = 0; i < n; ++i) {
        const double since = i == 0 ? 0.0 : (run.time[i] - run.time[i - 1]) / step;
        if (i > 0 && std::abs(since - std::max(1.0, std::round(since))) > 1e-6 * since) {
            if (i + 1 == n && since < 1.0)
                break;
            return std::nullopt;
        }
        for (double missing = 1.0; missing < std::round(since); missing += 1.0) {
            even.time.push_back(run.time[i - 1] + missing * step);
            for (auto part : {&HeadingTrack::x, &HeadingTrack::y, &HeadingTrack::heading})
                (even.*part).push_back(std::nan(""));
        }
        for (auto part : {&HeadingTrack::time, &HeadingTrack::x, &HeadingTrack::y, &HeadingTrack::heading})
            (even.*part).push_back((run.*part)[i]);
    }
    return even;
}

double advance(const HeadingTrack& run, std::size_t from, std::size_t to) {
    const double heading = 0.5 * (run.heading[from] + run.heading[to]);
    return (run.x[to] - run.x[from]) * std::cos(heading) + (run.y[to] - run.y[from]) * std::sin(heading);
}

namespace {

using Row = std::vector<double>;
constexpr std::size_t enough_runs = 8; // for errors from runs alone
constexpr double lowest_cosine = 0.2;

/// Of a block, of several, or of all but some.
struct DiffusionSums {
    Row origins, square, cosine; // by lag
    Row off;                     // s, of the lags, where times are uneven
    double turn = 0.0, advance = 0.0, time = 0.0;

    explicit DiffusionSums(std::size_t lags = 0) : origins(lags), square(lags), cosine(lags), off(lags) {}
};

/// Of the rows from `first` to `last`, both of them in the block. `step`: 0 of even rows; of others what lags
/// are multiples of: that of two rows is the one it is nearest to.
DiffusionSums sums_of(const HeadingTrack& run, std::size_t first, std::size_t last, double step,
                      std::span<const std::size_t> lags) {
    DiffusionSums sums(lags.size());
    const auto add = [&](std::size_t k, std::size_t i, std::size_t j) {
        if (!run.known(i) || !run.known(j))
            return;
        const double change = run.heading[j] - run.heading[i];
        sums.origins[k] += 1.0;
        sums.square[k] += change * change;
        sums.cosine[k] += std::cos(change);
    };
    for (std::size_t k = 0; k < lags.size() && step == 0.0; ++k)
        for (std::size_t i = first; i + lags[k] <= last; ++i)
            add(k, i, i + lags[k]);
    for (std::size_t i = first; i <= last && step > 0.0; ++i)
        for (std::size_t j = i + 1; j <= last; ++j) {
            const double steps = (run.time[j] - run.time[i]) / step;
            std::size_t k = static_cast<std::size_t>(std::ranges::lower_bound(lags, steps) - lags.begin());
            if (k > 0 && (k == lags.size() ||
                          steps - static_cast<double>(lags[k - 1]) < static_cast<double>(lags[k]) - steps))
                --k;
            if (steps > 1.05 * static_cast<double>(lags.back()))
                break;
            add(k, i, j);
            if (run.known(i) && run.known(j))
                sums.off[k] += (steps - static_cast<double>(lags[k])) * step;
        }
    while (first < last && !run.known(first))
        ++first;
    std::size_t before = first;
    for (std::size_t i = first + 1; i <= last; ++i)
        if (run.known(i)) {
            sums.advance += advance(run, before, i);
            before = i;
        }
    if (before > first)
        sums.turn = run.heading[before] - run.heading[first];
    sums.time = run.time[before] - run.time[first];
    return sums;
}

/// Blocks of a run; neighbours share the row between them.
std::vector<DiffusionSums> blocks_of(const HeadingTrack& run, double step, const HeadingOptions& options,
                                     std::span<const std::size_t> lags) {
    const std::optional<HeadingTrack> even = even_track(run, step);
    const HeadingTrack& rows = even ? *even : run;
    const std::size_t steps = rows.time.size() - 1;
    const double length = even ? static_cast<double>(steps) * step : rows.time.back() - rows.time.front();
    if (length < 2.0 * options.lag_high * (1.0 - 1e-9))
        throw InputError(fmt::format("measure: heading_diffusion: a track of {:.4g} s: lags up to {:g} s "
                                     "need twice as much; shorten measure.heading_lag_high or run longer",
                                     length, options.lag_high));
    const auto count =
        std::max<std::size_t>(1, static_cast<std::size_t>(length / options.block * (1.0 + 1e-9)));
    std::vector<DiffusionSums> blocks;
    const auto from = [&](std::size_t b) { // first row of a block
        const double time = rows.time.front() + length * static_cast<double>(b) / static_cast<double>(count);
        return even ? b * steps / count
                    : static_cast<std::size_t>(std::ranges::lower_bound(rows.time, time - 1e-9 * step) -
                                               rows.time.begin());
    };
    for (std::size_t b = 0; b < count; ++b)
        if (const std::size_t first = from(b), last = std::min(from(b + 1), steps); first < last)
            blocks.push_back(sums_of(rows, first, last, even ? 0.0 : step, lags));
    return blocks;
}

DiffusionSums sum_of(std::span<const DiffusionSums> all, std::size_t without) {
    DiffusionSums sums(all[0].square.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (i == without)
            continue;
        for (auto row :
             {&DiffusionSums::origins, &DiffusionSums::square, &DiffusionSums::cosine, &DiffusionSums::off})
            for (std::size_t k = 0; k < sums.square.size(); ++k)
                (sums.*row)[k] += (all[i].*row)[k];
        sums.turn += all[i].turn;
        sums.advance += all[i].advance;
        sums.time += all[i].time;
    }
    return sums;
}

/// What is fitted, the same for all parts and for all but one.
struct FitWindow {
    Row lag;                     // s, all lags
    std::size_t first = 0;       // of the fits, the last is that of all
    std::size_t middle = 0;      // first of the upper half
    std::size_t cosine_last = 0; // one behind the last of the fit of <cos d>
};

/// Straight line through values at the lags from `first` up to `last`, weights 1/lag^2.
LineFit line(const Row& lag, const Row& value, std::size_t first, std::size_t last) {
    const auto part = [&](const Row& row) { return std::span(row).subspan(first, last - first); };
    return fit_line(part(lag), part(value), part(lag));
}

FitWindow window_of(const DiffusionSums& all, double step, std::span<const std::size_t> lags,
                    const HeadingOptions& options) {
    FitWindow w;
    for (std::size_t k = 0; k < lags.size(); ++k)
        w.lag.push_back(static_cast<double>(lags[k]) * step + all.off[k] / all.origins[k]);
    const auto at = [&](double lag) {
        return static_cast<std::size_t>(std::ranges::lower_bound(w.lag, lag * (1.0 - 1e-9)) - w.lag.begin());
    };
    w.first = at(options.lag_low);
    if (w.lag.size() - w.first < 4)
        throw InputError(
            fmt::format("measure: heading_diffusion: rows of tracks are {:g} s apart: fewer than 4 lags from "
                        "{:g} s to {:g} s; shorten granular.output.table or widen the window",
                        step, options.lag_low, options.lag_high));
    w.middle = std::clamp(at(std::sqrt(options.lag_low * options.lag_high)), w.first + 1, w.lag.size() - 2);
    w.cosine_last = w.first;
    while (w.cosine_last < w.lag.size() &&
           all.cosine[w.cosine_last] / all.origins[w.cosine_last] >= lowest_cosine)
        ++w.cosine_last;
    return w;
}

/// Order of the numbers of a row, before those by lag.
enum Number : std::size_t { D, D_cosine, early, late, turn_rate, speed, per_length, numbers };

/// Line through ln <cos d>; nothing without 3 lags. NaN where a mean is not positive.
LineFit cosine_line(const Row& cosine, const FitWindow& w) {
    Row logs;
    for (std::size_t k = 0; k < w.cosine_last; ++k)
        logs.push_back(k < w.first ? 0.0 : std::log(cosine[k]));
    const auto used = std::span(logs).subspan(w.first);
    if (used.size() < 3 || !std::ranges::all_of(used, [](double v) { return std::isfinite(v); }))
        return {{unknown_error, unknown_error, 0}, {unknown_error, unknown_error, 0}};
    return line(w.lag, logs, w.first, w.cosine_last);
}

/// The numbers, then <d^2>, then <cos d>.
Row row_of(const DiffusionSums& s, const FitWindow& w) {
    Row square, cosine;
    for (std::size_t k = 0; k < s.square.size(); ++k) {
        square.push_back(s.square[k] / s.origins[k]);
        cosine.push_back(s.cosine[k] / s.origins[k]);
    }
    const std::size_t end = w.lag.size();
    Row row(numbers);
    row[D] = 0.5 * line(w.lag, square, w.first, end).slope.value;
    row[D_cosine] = -cosine_line(cosine, w).slope.value;
    row[early] = 0.5 * line(w.lag, square, w.first, w.middle + 1).slope.value;
    row[late] = 0.5 * line(w.lag, square, w.middle, end).slope.value;
    row[turn_rate] = s.turn / s.time;
    row[speed] = s.advance / s.time;
    row[per_length] = row[D] / row[speed];
    row.insert(row.end(), square.begin(), square.end());
    row.insert(row.end(), cosine.begin(), cosine.end());
    return row;
}

/// Jackknife; unknown for one part.
Row errors_of(std::span<const DiffusionSums> parts, const FitWindow& w) {
    const std::size_t n = parts.size();
    if (n < 2)
        return Row(numbers + 2 * w.lag.size(), unknown_error);
    std::vector<Row> rows;
    for (std::size_t i = 0; i < n; ++i)
        rows.push_back(row_of(sum_of(parts, i), w));
    Row errors;
    for (std::size_t k = 0; k < rows[0].size(); ++k) {
        double middle = 0.0, scatter = 0.0;
        for (const Row& row : rows)
            middle += row[k] / static_cast<double>(n);
        for (const Row& row : rows)
            scatter += (row[k] - middle) * (row[k] - middle);
        errors.push_back(std::sqrt(scatter * static_cast<double>(n - 1) / static_cast<double>(n)));
    }
    return errors;
}

HeadingDiffusion result_of(const DiffusionSums& all, std::span<const DiffusionSums> parts,
                           const FitWindow& w) {
    const Row row = row_of(all, w), errors = errors_of(parts, w);
    const auto estimate = [&](Number i) {
        return std::isfinite(row[i]) ? Estimate{row[i], errors[i], parts.size()} : Estimate{};
    };
    const std::size_t lags = w.lag.size();
    const auto part = [lags](const Row& from, std::size_t which) {
        const auto begin = from.begin() + static_cast<std::ptrdiff_t>(numbers + which * lags);
        return Row(begin, begin + static_cast<std::ptrdiff_t>(lags));
    };
    HeadingDiffusion r;
    r.diffusion = estimate(D);
    r.diffusion_cosine = estimate(D_cosine);
    r.early = estimate(early);
    r.late = estimate(late);
    r.turn_rate = estimate(turn_rate);
    r.speed = estimate(speed);
    r.diffusion_per_length = estimate(per_length);
    r.lag = w.lag;
    r.square = part(row, 0);
    r.square_error = part(errors, 0);
    r.cosine = part(row, 1);
    r.cosine_error = part(errors, 1);
    r.origins = all.origins;
    r.jitter = std::sqrt(0.5 * std::max(0.0, line(w.lag, r.square, w.first, lags).intercept.value));
    r.cosine_amplitude = std::exp(cosine_line(r.cosine, w).intercept.value);
    r.lag_low = w.lag[w.first];
    r.lag_high = w.lag.back();
    return r;
}

} // namespace

HeadingDiffusion heading_diffusion(std::span<const HeadingTrack> runs, const HeadingOptions& options) {
    if (!(options.block > 0.0 && options.lag_low > 0.0 && options.lag_low < options.lag_high &&
          std::isfinite(options.block + options.lag_high)))
        throw InputError(
            fmt::format("measure: heading_diffusion: lags from {:g} s to {:g} s in blocks of {:g} s: must be "
                        "positive and rise",
                        options.lag_low, options.lag_high, options.block));
    if (2.0 * options.lag_high > options.block * (1.0 + 1e-9))
        throw InputError(fmt::format("measure: heading_diffusion: lags up to {:g} s need blocks of twice as "
                                     "much, not {:g} s",
                                     options.lag_high, options.block));
    check_tracks(runs, "heading_diffusion");
    const double step = common_step(runs);
    if (!(step > 0.0) || options.lag_high < step)
        throw InputError(fmt::format("measure: heading_diffusion: tracks with rows {:g} s apart have no lag "
                                     "up to {:g} s; shorten granular.output.table",
                                     step, options.lag_high));
    // Each lag is about a seventh above the one before; the last one is lag_high.
    const auto most = static_cast<std::size_t>(std::min(1e15, options.lag_high / step * (1.0 + 1e-9)));
    std::vector<std::size_t> lags;
    for (std::size_t k = 1; k < most; k = std::max(k + 1, k + k / 7))
        lags.push_back(k);
    lags.push_back(most);
    std::vector<DiffusionSums> blocks, of_runs;
    for (const HeadingTrack& run : runs) {
        const std::vector<DiffusionSums> own = blocks_of(run, step, options, lags);
        if (own.empty())
            throw InputError("measure: heading_diffusion: no block of time has two rows; lengthen "
                             "measure.block");
        of_runs.push_back(sum_of(own, own.size()));
        blocks.insert(blocks.end(), own.begin(), own.end());
    }
    // Lags go that no two rows have in all blocks or, for the errors, in all but one.
    for (std::size_t k = lags.size(); k-- > 0;) {
        double all = 0.0, largest = 0.0;
        for (const DiffusionSums& part : blocks) {
            all += part.origins[k];
            largest = std::max(largest, blocks.size() > 1 ? part.origins[k] : 0.0);
        }
        if (all > largest)
            continue;
        const auto at = static_cast<std::ptrdiff_t>(k);
        lags.erase(lags.begin() + at);
        for (std::vector<DiffusionSums>* sums : {&blocks, &of_runs})
            for (DiffusionSums& part : *sums)
                for (auto row : {&DiffusionSums::origins, &DiffusionSums::square, &DiffusionSums::cosine,
                                 &DiffusionSums::off})
                    (part.*row).erase((part.*row).begin() + at);
    }
    const DiffusionSums all = sum_of(blocks, blocks.size());
    const std::vector<DiffusionSums>& parts = runs.size() >= enough_runs ? of_runs : blocks;
    HeadingDiffusion r = result_of(all, parts, window_of(all, step, lags, options));
    r.blocks = blocks.size();
    r.parts = parts.size();
    r.low = r.high = unknown_error;
    if (r.parts > 1) {
        const boost::math::students_t law(static_cast<double>(r.parts - 1));
        const double reach = boost::math::quantile(law, 0.975) * r.diffusion.error;
        r.low = r.diffusion.value - reach;
        r.high = r.diffusion.value + reach;
    }
    return r;
}

} // namespace rodwake::measure
