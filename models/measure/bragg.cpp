#include "rodwake/measure/bragg.hpp"

#include "rodwake/core/error.hpp"

#include "plane_waves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace rodwake::measure {

namespace {

constexpr double ring_width = 0.12;    // relative, on either side
constexpr std::size_t strongest = 200; // of the ring that may belong to the triple
constexpr std::size_t least_points = 12;

using Complex = std::complex<double>;
using Order = std::pair<int, int>;

struct Wave {
    Order order;
    double strength;
};

/// exp(2 pi i m place/box) for m = 0..most: [m][place].
std::vector<std::vector<Complex>> powers(std::span<const double> positions, double box, int most) {
    std::vector<std::vector<Complex>> rows(static_cast<std::size_t>(most) + 1,
                                           std::vector<Complex>(positions.size(), Complex{1.0, 0.0}));
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const Complex step = turn_by(2.0 * M_PI * positions[i] / box);
        for (std::size_t m = 1; m < rows.size(); ++m)
            rows[m][i] = times(rows[m - 1][i], step);
    }
    return rows;
}

/// Wave vector (m, n) in waves on the way along the mean side.
Vector2 waves_of(const Order& order, const PeriodicBox& box) {
    const double side = box.mean_side();
    return {order.first * (side / box.x), order.second * (side / box.y)};
}

/// Half of the ring (n > 0, or n = 0 and m > 0); the other half is its mirror image.
std::vector<Wave> ring_of(std::span<const double> x, std::span<const double> y, const PeriodicBox& box,
                          double sites) {
    // number of waves across the box: rows of a triangular lattice of so many sites
    const double middle = std::sqrt(2.0 * sites / std::sqrt(3.0));
    const auto most = [&](double side) {
        return static_cast<int>(std::ceil(middle * (1.0 + ring_width) * (side / box.mean_side())));
    };
    const int most_m = most(box.x), most_n = most(box.y);
    const auto along_x = powers(x, box.x, most_m), along_y = powers(y, box.y, most_n);
    std::vector<Wave> ring;
    for (int n = 0; n <= most_n; ++n)
        for (int m = n == 0 ? 1 : -most_m; m <= most_m; ++m) {
            const Vector2 k = waves_of({m, n}, box);
            if (!(std::abs(std::hypot(k.x, k.y) - middle) <= ring_width * middle))
                continue;

            // conj(sum) has the same size: the sign of m goes to n.
            const auto &by_x = along_x[static_cast<std::size_t>(std::abs(m))],
                       &by_y = along_y[static_cast<std::size_t>(n)];
            Complex sum = 0.0;
            for (std::size_t i = 0; i < x.size(); ++i)
                sum += times(by_x[i], m < 0 ? std::conj(by_y[i]) : by_y[i]);
            ring.push_back({{m, n}, std::norm(sum / static_cast<double>(x.size()))});
        }
    return ring;
}

/// Between 45 and 75 degrees apart.
bool sixty_degrees(const Vector2& a, const Vector2& b) {
    const double dot = a.x * b.x + a.y * b.y;
    const double cosine = dot / (std::hypot(a.x, a.y) * std::hypot(b.x, b.y));
    return cosine > 0.2588 && cosine < 0.7072;
}

struct Triple {
    std::array<Order, 3> order{};
    double product = -1.0;
};

/// The middle one of a triple is the sum of the other two, either sign of which may be in the half ring.
Triple best_triple(const std::vector<Wave>& waves, const PeriodicBox& box) {
    std::map<Order, double> strength;
    for (const Wave& wave : waves) {
        strength[wave.order] = wave.strength;
        strength[{-wave.order.first, -wave.order.second}] = wave.strength;
    }
    Triple best;
    for (const Wave& middle : waves)
        for (const auto& [side, of_side] : strength) {
            const Order other{middle.order.first - side.first, middle.order.second - side.second};
            const auto found = strength.find(other);
            if (found == strength.end() || !sixty_degrees(waves_of(middle.order, box), waves_of(side, box)) ||
                !sixty_degrees(waves_of(middle.order, box), waves_of(other, box)))
                continue;
            const double product = middle.strength * of_side * found->second;
            if (product > best.product * (1.0 + 1e-9)) // equal ones differ by rounding: the first
                best = {{side, middle.order, other}, product};
        }
    return best;
}

} // namespace

double BraggPeaks::contrast() const {
    const double peak = std::ranges::max(strength);
    return peak / std::max(liquid_strength, 1e-12); // a perfect lattice has nothing but its peaks
}

double BraggPeaks::row_angle() const {
    double sum = 0.0; // rows are perpendicular to a peak; peaks are 60 degrees apart
    for (std::size_t k = 0; k < 3; ++k)
        sum += std::atan2(G[k].y, G[k].x) - static_cast<double>(k) * M_PI / 3.0;
    const double angle = std::fmod(sum / 3.0 + M_PI / 2.0, M_PI / 3.0);
    return angle < 0.0 ? angle + M_PI / 3.0 : angle;
}

double BraggPeaks::lattice_spacing() const {
    const double cell = std::abs(G[0].x * G[2].y - G[0].y * G[2].x) / (4.0 * M_PI * M_PI);
    return cell > 0.0 ? std::sqrt(2.0 / (std::sqrt(3.0) * cell)) : 0.0;
}

BraggPeaks find_peaks(std::span<const double> x, std::span<const double> y, const PeriodicBox& box,
                      double sites) {
    if (x.size() < least_points || x.size() != y.size())
        throw InputError(
            fmt::format("measure: Bragg peaks of {} and {} coordinates: needs as many y as x, at "
                        "least {}",
                        x.size(), y.size(), least_points));
    const auto ring = ring_of(x, y, box, sites > 0.0 ? sites : static_cast<double>(x.size()));
    auto waves = ring;
    std::ranges::stable_sort(waves, std::greater{}, &Wave::strength);
    if (waves.size() > strongest)
        waves.resize(strongest);
    Triple best = best_triple(waves, box);
    if (best.product < 0.0)
        best = best_triple(ring, box);
    if (best.product < 0.0)
        throw RunError(
            fmt::format("measure: no three wave vectors of a lattice of {} beads fit the box", x.size()));
    // Angles rise within [0, pi): then the middle order is the sum of the others.
    for (Order& item : best.order)
        if (item.second < 0 || (item.second == 0 && item.first < 0))
            item = {-item.first, -item.second};
    std::ranges::sort(best.order, [](const Order& a, const Order& b) {
        return std::atan2(a.second, a.first) < std::atan2(b.second, b.first);
    });
    BraggPeaks peaks;
    double total = 0.0;
    for (const Wave& wave : ring)
        total += wave.strength;
    for (std::size_t k = 0; k < 3; ++k) {
        peaks.m[k] = best.order[k].first;
        peaks.n[k] = best.order[k].second;
        peaks.G[k] = {2.0 * M_PI * peaks.m[k] / box.x, 2.0 * M_PI * peaks.n[k] / box.y};
        peaks.strength[k] = std::ranges::find(ring, best.order[k], &Wave::order)->strength;
        total -= peaks.strength[k];
    }
    peaks.liquid_strength = std::max(total, 0.0) / static_cast<double>(ring.size() - 3);
    return peaks;
}

Vector2 displacement_of(const BraggPeaks& peaks, const std::array<double, 3>& phase) {
    double xx = 0.0, xy = 0.0, yy = 0.0, bx = 0.0, by = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vector2& g = peaks.G[k];
        xx += g.x * g.x;
        xy += g.x * g.y;
        yy += g.y * g.y;
        bx += g.x * phase[k];
        by += g.y * phase[k];
    }
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 0.0))
        throw InputError("measure: displacement from wave vectors that are parallel");
    return {(yy * bx - xy * by) / determinant, (xx * by - xy * bx) / determinant};
}

} // namespace rodwake::measure
