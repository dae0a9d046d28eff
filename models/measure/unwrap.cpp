#include "unwrap.hpp"

#include "rodwake/core/error.hpp"

#include <cmath>
#include <optional>
#include <queue>

namespace rodwake::measure {

namespace {

constexpr long reach = 2; // bins

struct Candidate {
    double quality;
    std::size_t bin;
    bool operator<(const Candidate& other) const { // equal quality: the lower bin first
        return quality != other.quality ? quality < other.quality : bin > other.bin;
    }
};

/// Calls visit(bin, distance^2 in bins) for the bins around one, not across the grid's edge.
template<class Visit>
void around(std::size_t bin, const RodGrid& grid, Visit visit) {
    const long columns = static_cast<long>(grid.columns), rows = static_cast<long>(grid.rows),
               column = static_cast<long>(bin) % columns, row = static_cast<long>(bin) / columns;
    for (long j = -reach; j <= reach; ++j)
        for (long i = -reach; i <= reach; ++i)
            if ((i != 0 || j != 0) && column + i >= 0 && column + i < columns && row + j >= 0 &&
                row + j < rows)
                visit(static_cast<std::size_t>((row + j) * columns + column + i),
                      static_cast<double>(i * i + j * j));
}

class Flood {
public:
    Flood(std::vector<Vector2>& u, const std::vector<double>& quality, const RodGrid& grid,
          const LatticeVectors& lattice)
        : u_(u), quality_(quality), grid_(grid), lattice_(lattice), done_(u.size()), waiting_(u.size()) {}

    void from(std::size_t start) {
        take(start, {});
        while (!queue_.empty()) {
            const std::size_t bin = queue_.top().bin;
            queue_.pop();
            take(bin, expected(bin));
        }
    }
    /// The best bin not done yet beyond this distance from the rod.
    std::optional<std::size_t> best(double beyond) const {
        std::optional<std::size_t> found;
        for (std::size_t j = 0; j < u_.size(); ++j)
            if (!done_[j] && quality_[j] > 0.0 && (!found || quality_[j] > quality_[*found]) &&
                std::hypot(grid_.x_of(j), grid_.y_of(j)) >= beyond)
                found = j;
        return found;
    }
    std::vector<bool> done() const { return done_; }

private:
    void take(std::size_t bin, const Vector2& near) {
        u_[bin] = lattice_.nearest_to(u_[bin], near);
        done_[bin] = true;
        around(bin, grid_, [&](std::size_t next, double) {
            if (done_[next] || waiting_[next] || !(quality_[next] > 0.0))
                return;
            waiting_[next] = true;
            queue_.push({quality_[next], next});
        });
    }
    Vector2 expected(std::size_t bin) const {
        Vector2 sum;
        double total = 0.0;
        around(bin, grid_, [&](std::size_t next, double distance2) {
            if (!done_[next])
                return;
            const double weight = quality_[next] / (distance2 * distance2);
            sum.x += weight * u_[next].x;
            sum.y += weight * u_[next].y;
            total += weight;
        });
        return {sum.x / total, sum.y / total};
    }

    std::vector<Vector2>& u_;
    const std::vector<double>& quality_;
    const RodGrid& grid_;
    const LatticeVectors& lattice_;
    std::vector<bool> done_, waiting_;
    std::priority_queue<Candidate> queue_;
};

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
    Flood flood(u, quality, grid, lattice);
    for (const double beyond : {far_from, 0.0})
        while (const auto start = flood.best(beyond))
            flood.from(*start);
    return flood.done();
}

} // namespace rodwake::measure
