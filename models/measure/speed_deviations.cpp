#include "rodwake/measure/speed_deviations.hpp"

#include "heading_tracks.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/measure/statistics.hpp"

#include <Eigen/QR>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace rodwake::measure {

namespace {

constexpr const char* this_measure = "speed_deviations";
constexpr std::size_t enough_runs = 8; // for errors from runs alone
constexpr double bins_per_deviation = 3.0, least_count = 20.0, least_elsewhere = 5.0;
constexpr double most_bins = 200.0; // of a rod so steady that it never goes back
constexpr int halvings = 5;

void check(std::span<const HeadingTrack> runs, const DeviationOptions& o) {
    if (!(o.block > 0.0 && o.lag > 0.0 && std::isfinite(o.block) && 2.0 * o.lag <= o.block * (1.0 + 1e-9)))
        throw InputError(
            fmt::format("measure: {}: lags up to {:g} s in blocks of {:g} s: must be positive, and "
                        "blocks twice as long as lags",
                        this_measure, o.lag, o.block));
    check_tracks(runs, this_measure);
}

/// Way along the momentary heading at the rows of a block, m; NaN where the rod is not known.
struct Way {
    std::vector<double> at;
    double gone = 0.0;     ///< at the last row that is known
    std::size_t steps = 0; ///< from the first of them to the last
};

struct Blocks {
    std::vector<Way> ways;
    std::vector<std::size_t> part; ///< to which each belongs, whose scatter gives the errors
    std::size_t parts = 0;
    double step = 0.0; ///< s
};

Way way_of(const HeadingTrack& run, std::size_t first, std::size_t last) {
    Way way;
    std::optional<std::size_t> begin, before;
    for (std::size_t i = first; i <= last; ++i) {
        if (!run.known(i)) {
            way.at.push_back(std::nan(""));
            continue;
        }
        if (before)
            way.gone += advance(run, *before, i);
        begin = begin.value_or(i);
        before = i;
        way.at.push_back(way.gone);
        way.steps = i - *begin;
    }
    return way;
}

Blocks blocks_of(std::span<const HeadingTrack> runs, const DeviationOptions& options) {
    Blocks blocks;
    blocks.step = common_step(runs);
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const std::optional<HeadingTrack> even = even_track(runs[r], blocks.step);
        if (!even)
            throw InputError(
                fmt::format("measure: {}: rows of a track are not {:g} s apart throughout: it goes "
                            "by even steps of time; leave measure.speed_deviations out, or film "
                            "at an even rate",
                            this_measure, blocks.step));
        const std::size_t steps = even->time.size() - 1;
        const double length = static_cast<double>(steps) * blocks.step;
        if (length < 2.0 * options.lag * (1.0 - 1e-9))
            throw InputError(fmt::format("measure: {}: a track of {:.4g} s: lags up to {:g} s need twice as "
                                         "much; shorten measure.deviation_lag or run longer",
                                         this_measure, length, options.lag));
        const std::size_t count =
            std::max<std::size_t>(1, static_cast<std::size_t>(length / options.block * (1.0 + 1e-9)));
        for (std::size_t b = 0; b < count; ++b) {
            Way way = way_of(*even, b * steps / count, (b + 1) * steps / count);
            if (way.steps == 0)
                continue;
            blocks.ways.push_back(std::move(way));
            blocks.part.push_back(runs.size() >= enough_runs ? r : blocks.part.size());
        }
    }
    if (blocks.ways.empty())
        throw InputError(
            fmt::format("measure: {}: in no block of time is the rod known twice", this_measure));
    blocks.parts = blocks.part.back() + 1;
    return blocks;
}

/// Numbers of steps of the longest lag, of its half ..., from the shortest up.
std::vector<std::size_t> lags_of(double step, double lag) {
    std::vector<std::size_t> lags;
    for (int k = halvings; k >= 0; --k) {
        const auto steps =
            static_cast<std::size_t>(std::llround(lag * std::pow(0.5, k) / step * (1.0 + 1e-9)));
        if (steps > 0 && (lags.empty() || steps > lags.back()))
            lags.push_back(steps);
    }
    if (lags.empty())
        throw InputError(fmt::format("measure: {}: rows of tracks are {:g} s apart: no lag up to {:g} s; "
                                     "shorten granular.output.table or lengthen measure.deviation_lag",
                                     this_measure, step, lag));
    return lags;
}

template<class F>
void for_each_displacement(const Blocks& blocks, std::size_t lag, const F& f) {
    for (std::size_t b = 0; b < blocks.ways.size(); ++b)
        for (std::size_t i = 0; i + lag < blocks.ways[b].at.size(); ++i)
            if (const double way = blocks.ways[b].at[i + lag] - blocks.ways[b].at[i]; !std::isnan(way))
                f(blocks.part[b], way);
}

Estimate speed_of(const Blocks& blocks) {
    std::vector<double> way(blocks.parts), time(blocks.parts), speed;
    for (std::size_t b = 0; b < blocks.ways.size(); ++b) {
        way[blocks.part[b]] += blocks.ways[b].gone;
        time[blocks.part[b]] += static_cast<double>(blocks.ways[b].steps) * blocks.step;
    }
    std::ranges::transform(way, time, std::back_inserter(speed), std::divides{});
    return mean_of_blocks(speed, time);
}

/// Displacements by pair of bins: of all parts, and of each.
struct Counts {
    using Row = Eigen::ArrayXd;
    Row plus, minus;
    double all = 0.0;

    explicit Counts(std::size_t bins)
        : plus(Row::Zero(static_cast<long>(bins))), minus(Row::Zero(static_cast<long>(bins))) {}
    void add(const Counts& other, double sign) {
        plus += sign * other.plus;
        minus += sign * other.minus;
        all += sign * other.all;
    }
};

struct Histogram {
    double tau, width; ///< s; of bins in W
    Counts all;
    std::vector<Counts> parts;

    Counts without(std::size_t part) const {
        Counts left = all;
        left.add(parts[part], -1.0);
        return left;
    }
};

/// Fills mean, variance and share of the lag too.
Histogram histogram(const Blocks& blocks, std::size_t steps, double speed, DeviationLag& lag) {
    const double tau = static_cast<double>(steps) * blocks.step, unit = speed * tau;
    double n = 0.0, sum = 0.0, square = 0.0, back = 0.0, furthest = 0.0;
    for_each_displacement(blocks, steps, [&](std::size_t, double X) {
        const double off = X / unit - 1.0; // small numbers: no digits are lost in the square
        n += 1.0;
        sum += off;
        square += off * off;
        back += X < 0.0;
        furthest = std::max(furthest, std::abs(off + 1.0));
    });
    lag.lag = tau;
    lag.mean = 1.0 + sum / n;
    lag.variance = square / n - std::pow(sum / n, 2);
    lag.backwards = back / n;
    if (!(lag.variance > 1e-24))
        throw InputError(
            fmt::format("measure: {}: the rod has come equally far in each lag of {:g} s: its speed "
                        "does not deviate",
                        this_measure, tau));
    const double bin_width = std::sqrt(lag.variance) / bins_per_deviation;
    const auto bins = static_cast<std::size_t>(std::min(furthest / bin_width, most_bins)) + 1;
    Histogram h{tau, bin_width, Counts(bins), std::vector<Counts>(blocks.parts, Counts(bins))};
    for_each_displacement(blocks, steps, [&](std::size_t part, double X) {
        const double W = X / unit;
        const auto bin = static_cast<long>(std::min(std::abs(W) / bin_width, 2.0 * most_bins));
        h.parts[part].all += 1.0;
        if (bin < static_cast<long>(bins))
            (W < 0.0 ? h.parts[part].minus : h.parts[part].plus)(bin) += 1.0;
    });
    for (const Counts& part : h.parts)
        h.all.add(part, 1.0);
    return h;
}

/// Enough displacements in bin k, and not all but a few from one part.
bool enough(const Histogram& h, Counts::Row Counts::*side, long k) {
    const double all = (h.all.*side)(k);
    return all >= least_count &&
           (h.parts.size() == 1 || std::ranges::all_of(h.parts, [&](const Counts& part) {
                return all - (part.*side)(k) >= least_elsewhere;
            }));
}

/// Root of the sum of squared changes when a part is left out, times (n - 1)/n: unknown for one part.
template<class F>
Estimate jackknife(const Histogram& h, const F& f) {
    const auto n = static_cast<double>(h.parts.size());
    if (h.parts.size() < 2)
        return {f(h.all), unknown_error, 1};
    double sum = 0.0, square = 0.0;
    const double value = f(h.all);
    for (std::size_t part = 0; part < h.parts.size(); ++part) {
        const double change = f(h.without(part)) - value;
        sum += change;
        square += change * change;
    }
    return {value, std::sqrt((n - 1.0) / n * std::max(0.0, square - sum * sum / n)), h.parts.size()};
}

std::vector<DeviationBin> bins_of(const Histogram& h) {
    std::vector<DeviationBin> bins;
    for (long k = 0; k < h.all.plus.size(); ++k) {
        DeviationBin bin{(static_cast<double>(k) + 0.5) * h.width, h.all.plus(k), h.all.minus(k), {}, {}, {}};
        const auto rate = [&](Counts::Row Counts::*side) {
            return enough(h, side, k)
                       ? jackknife(h,
                                   [&](const Counts& c) {
                                       return -std::log((c.*side)(k) / (c.all * h.width)) / h.tau;
                                   })
                       : Estimate{};
        };
        bin.plus_rate = rate(&Counts::plus);
        bin.minus_rate = rate(&Counts::minus);
        if (bin.plus_rate.count > 0 && bin.minus_rate.count > 0)
            bin.antisymmetric =
                jackknife(h, [&](const Counts& c) { return std::log(c.minus(k) / c.plus(k)) / h.tau; });
        bins.push_back(bin);
    }
    return bins;
}

/// Least squares over the pairs of bins in which A is known; weights from the counts of all parts.
class PairFit {
public:
    PairFit(const Histogram& h, const std::vector<DeviationBin>& bins) : h_(h) {
        for (std::size_t k = 0; k < bins.size(); ++k)
            if (bins[k].antisymmetric.count > 0) {
                pairs_.push_back(static_cast<long>(k));
                W_.push_back(bins[k].W);
                weight_.push_back(1.0 / std::sqrt(1.0 / bins[k].plus + 1.0 / bins[k].minus));
            }
    }

    std::size_t pairs() const { return pairs_.size(); }

    /// Coefficient `which` of the terms, functions of W; `sign`: +1 of the mean of F(W) and F(-W), -1 of
    /// their difference.
    template<class... Terms>
    Estimate coefficient(int which, double sign, const Terms&... terms) const {
        const auto rows = static_cast<long>(pairs_.size());
        Eigen::MatrixXd matrix(rows, static_cast<long>(sizeof...(terms)));
        for (long i = 0; i < rows; ++i) {
            const auto place = static_cast<std::size_t>(i);
            long column = 0;
            ((matrix(i, column++) = weight_[place] * terms(W_[place])), ...);
        }
        const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(matrix);
        return jackknife(h_, [&](const Counts& c) { return solver.solve(data(c, sign))(which); });
    }

private:
    Eigen::VectorXd data(const Counts& c, double sign) const {
        Eigen::VectorXd values(static_cast<long>(pairs_.size()));
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            const double plus = std::log(c.plus(pairs_[i]) / (c.all * h_.width)),
                         minus = std::log(c.minus(pairs_[i]) / (c.all * h_.width));
            values(static_cast<long>(i)) =
                weight_[i] * (sign > 0.0 ? -0.5 * (plus + minus) : minus - plus) / h_.tau;
        }
        return values;
    }

    const Histogram& h_;
    std::vector<long> pairs_;
    std::vector<double> W_, weight_;
};

DeviationLag lag_of(const Blocks& blocks, std::size_t steps, double speed) {
    const auto one = [](double) { return 1.0; };
    const auto first = [](double W) { return W; };
    DeviationLag lag;
    const Histogram h = histogram(blocks, steps, speed, lag);
    lag.bins = bins_of(h);
    lag.gaussian_slope = -2.0 / (lag.lag * lag.variance);
    const PairFit fit(h, lag.bins);
    lag.pairs = fit.pairs();
    if (lag.pairs >= 1)
        lag.slope = fit.coefficient(0, -1.0, first);
    if (lag.pairs >= 3) {
        const auto third = [](double W) { return W * W * W; };
        lag.linear = fit.coefficient(0, -1.0, first, third);
        lag.cubic = fit.coefficient(1, -1.0, first, third);
    }
    if (lag.pairs >= 4)
        lag.kink = fit.coefficient(
                          2, 1.0, one, [](double W) { return W * W; }, first)
                       .scaled(2.0);
    return lag;
}

} // namespace

SpeedDeviations speed_deviations(std::span<const HeadingTrack> runs, const DeviationOptions& options) {
    check(runs, options);
    const Blocks blocks = blocks_of(runs, options);
    SpeedDeviations r;
    r.blocks = blocks.ways.size();
    r.parts = blocks.parts;
    r.speed = speed_of(blocks);
    if (!(r.speed.value > 0.0) || r.speed.value < 3.0 * r.speed.error)
        throw InputError(
            fmt::format("measure: {}: the rod's mean speed along its heading, {:.3g} +- {:.2g} m/s, is "
                        "not above 0 by three errors: displacements have no unit",
                        this_measure, r.speed.value, r.speed.error));
    for (const std::size_t steps : lags_of(blocks.step, options.lag))
        r.lags.push_back(lag_of(blocks, steps, r.speed.value));
    r.told = r.lags.size();
    for (std::size_t k = 0; k < r.lags.size(); ++k)
        if (r.lags[k].kink.count > 0)
            r.told = k;
    return r;
}

} // namespace rodwake::measure
