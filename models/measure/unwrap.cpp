#include "unwrap.hpp"

#include "rodwake/core/error.hpp"

#include <cmath>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

namespace rodwake::measure {

namespace {

struct NearBin {
    std::size_t bin;
    double distance2; ///< in bins
};

/// The bins around one, not across the grid's edge.
std::vector<NearBin> bins_around(std::size_t bin, const RodGrid& grid) {
    constexpr long reach = 2; // bins
    const long columns = static_cast<long>(grid.columns), rows = static_cast<long>(grid.rows),
               column = static_cast<long>(bin) % columns, row = static_cast<long>(bin) / columns;
    std::vector<NearBin> near;
    for (long j = -reach; j <= reach; ++j)
        for (long i = -reach; i <= reach; ++i)
            if ((i != 0 || j != 0) && column + i >= 0 && column + i < columns && row + j >= 0 &&
                row + j < rows)
                near.push_back({static_cast<std::size_t>((row + j) * columns + column + i),
                                static_cast<double>(i * i + j * j)});
    return near;
}

} // namespace

LatticeVectors::LatticeVectors(const std::array<Vector2, 3>& G) : G_(G) {
    const double determinant = G[0].x * G[2].y - G[0].y * G[2].x;
    if (determinant == 0.0)
        throw InputError("measure: wave vectors that are parallel span no lattice");
    const double scale = 2.0 * M_PI / determinant;
    a1_ = {scale * G[2].y, -scale * G[2].x};
    a2_ = {-scale * G[0].y, scale * G[0].x};
}

Vector2 LatticeVectors::nearest_to(const Vector2& u, const Vector2& v) const {
    const Vector2 apart{v.x - u.x, v.y - u.y};
    const double i0 = std::round((G_[0].x * apart.x + G_[0].y * apart.y) / (2.0 * M_PI));
    const double j0 = std::round((G_[2].x * apart.x + G_[2].y * apart.y) / (2.0 * M_PI));
    Vector2 best = u;
    double least = HUGE_VAL;
    for (double i = i0 - 1.0; i <= i0 + 1.0; ++i)
        for (double j = j0 - 1.0; j <= j0 + 1.0; ++j) {
            const Vector2 tried{u.x + i * a1_.x + j * a2_.x, u.y + i * a1_.y + j * a2_.y};
            const double distance = std::hypot(tried.x - v.x, tried.y - v.y);
            if (distance < least) {
                least = distance;
                best = tried;
            }
        }
    return best;
}

std::vector<bool> unwrap(std::vector<Vector2>& u, const std::vector<double>& quality, const RodGrid& grid,
                         const LatticeVectors& lattice, double far_from) {
    std::vector<bool> done(u.size()), waiting(u.size());
    std::priority_queue<std::pair<double, long>>
        queue; // quality and -bin: of equal quality the lower bin first
    const auto take = [&](std::size_t bin, const Vector2& near) {
        u[bin] = lattice.nearest_to(u[bin], near);
        done[bin] = true;
        for (const NearBin& next : bins_around(bin, grid))
            if (!done[next.bin] && !waiting[next.bin] && quality[next.bin] > 0.0) {
                waiting[next.bin] = true;
                queue.emplace(quality[next.bin], -static_cast<long>(next.bin));
            }
    };
    for (const double beyond : {far_from, 0.0})
        while (true) {
            // A flood starts at the best bin that is not done yet beyond this distance from the rod.
            std::optional<std::size_t> start;
            for (std::size_t j = 0; j < u.size(); ++j)
                if (!done[j] && quality[j] > 0.0 && (!start || quality[j] > quality[*start]) &&
                    std::hypot(grid.x_of(j), grid.y_of(j)) >= beyond)
                    start = j;
            if (!start)
                break;
            take(*start, {});

            // It goes on to the best bin at its edge, near the mean of those around it.
            while (!queue.empty()) {
                const auto bin = static_cast<std::size_t>(-queue.top().second);
                queue.pop();
                Vector2 sum;
                double total = 0.0;
                for (const NearBin& next : bins_around(bin, grid)) {
                    if (!done[next.bin])
                        continue;
                    const double weight = quality[next.bin] / (next.distance2 * next.distance2);
                    sum.x += weight * u[next.bin].x;
                    sum.y += weight * u[next.bin].y;
                    total += weight;
                }
                take(bin, {sum.x / total, sum.y / total});
            }
        }
    return done;
}

} // namespace rodwake::measure
