#include "rodwake/measure/order.hpp"

#include "rodwake/core/error.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::measure {

namespace {

constexpr double width = 0.15;      // a: standard deviation of the smoothing
constexpr double window = 0.3;      // a: half the range of the parabola
constexpr double farthest = 8.0;    // a: past the first shell of any bed worth the name
constexpr double least_step = 0.02; // what a rise or fall of g must exceed, besides noise

std::vector<double> smoothed(std::span<const double> r, std::span<const double> g, double sigma) {
    std::vector<double> result(g.size());
    for (std::size_t k = 0; k < g.size(); ++k) {
        double sum = 0.0, weights = 0.0;
        for (std::size_t j = 0; j < g.size(); ++j) {
            const double d = (r[j] - r[k]) / sigma;
            if (std::abs(d) > 4.0)
                continue;
            const double weight = std::exp(-0.5 * d * d);
            sum += weight * g[j];
            weights += weight;
        }
        result[k] = sum / weights;
    }
    return result;
}

/// Rise or fall from each bin that cannot be noise: 6 standard deviations of the smoothed curve, because many
/// bins compete to be highest or lowest.
std::vector<double> clear_steps(std::span<const double> r, std::span<const double> g, double sigma) {
    const double together = std::max(1.0, 2.0 * std::sqrt(M_PI) * sigma / (r[1] - r[0]));

    // Standard deviation of a bin at distance 1, from the median of second differences: blind to slopes, and
    // to the few bins in which the curve bends. Numbers of pairs grow as r, so noise falls as 1/sqrt(r).
    std::vector<double> bends;
    for (std::size_t k = 1; k + 1 < g.size(); ++k)
        if (g[k - 1] > 0.0 || g[k] > 0.0 || g[k + 1] > 0.0)
            bends.push_back(std::abs(g[k - 1] - 2.0 * g[k] + g[k + 1]) * std::sqrt(r[k]));
    double noise = 0.0;
    if (!bends.empty()) {
        const auto middle = bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2);
        std::nth_element(bends.begin(), middle, bends.end());
        noise = *middle / (0.6745 * std::sqrt(6.0));
    }
    std::vector<double> steps;
    for (const double at : r) // towards r = 0 smoothing has half as many bins
        steps.push_back(
            std::max(least_step, 6.0 * noise / std::sqrt(at * together * (at < sigma ? 0.5 : 1.0))));
    return steps;
}

/// Bin of the smallest value after the first peak, before the curve rises clearly again; of equal ones (a
/// cold crystal has g = 0 there) the middle.
std::optional<std::size_t> valley(const std::vector<double>& g, const std::vector<double>& step) {
    std::size_t top = 0, first = 0, last = 0;
    bool fallen = false;
    for (std::size_t k = 0; k < g.size(); ++k) {
        if (!fallen) {
            top = g[k] > g[top] ? k : top;
            fallen = g[k] < g[top] - step[top];
            first = last = k;
            continue;
        }
        if (g[k] < g[first])
            first = k;
        if (g[k] <= g[first])
            last = k;
        if (g[k] > g[first] + step[first])
            return (first + last) / 2;
    }
    return std::nullopt;
}

/// Vertex of the least-squares parabola through the points within `half` of r0; r0 itself if it is none.
double vertex(std::span<const double> r, std::span<const double> g, double r0, double half) {
    double s0 = 0.0, s2 = 0.0, s4 = 0.0, b0 = 0.0, b1 = 0.0, b2 = 0.0;
    for (std::size_t k = 0; k < r.size(); ++k) {
        const double u = (r[k] - r0) / half, u2 = u * u;
        if (u2 > 1.0 + 1e-9)
            continue;
        s0 += 1.0;
        s2 += u2;
        s4 += u2 * u2;
        b0 += g[k];
        b1 += g[k] * u;
        b2 += g[k] * u2;
    }
    // bins lie evenly on both sides of r0: odd sums vanish
    const double bend = (s0 * b2 - s2 * b0) / (s0 * s4 - s2 * s2), slope = b1 / s2;
    const double at = -0.5 * slope / bend;
    return bend > 0.0 && std::abs(at) <= 1.0 ? r0 + half * at : r0;
}

} // namespace

std::optional<double> first_minimum(std::span<const double> r, std::span<const double> g,
                                    double bead_radius) {
    if (r.size() != g.size())
        throw InputError("measure: g(r) of different numbers of distances and values");
    const auto end = std::ranges::upper_bound(r, farthest * bead_radius) - r.begin();
    if (end < 5)
        return std::nullopt;
    r = r.first(static_cast<std::size_t>(end));
    g = g.first(r.size());
    const double bin = r[1] - r[0], sigma = std::max(width * bead_radius, 0.5 * bin);
    const std::vector<double> smooth = smoothed(r, g, sigma);
    const auto bottom = valley(smooth, clear_steps(r, g, sigma));
    if (!bottom)
        return std::nullopt;
    return vertex(r, g, r[*bottom], std::max(window * bead_radius, 1.0 * bin));
}

} // namespace rodwake::measure
