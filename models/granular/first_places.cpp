#include "first_places.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rodwake::granular {

namespace {

constexpr double jitter = 0.01; // of the room's height: a layer that is exactly flat has nowhere to buckle
constexpr int most_attempts = 10000;

/// Depth to which a rod covers a bead here, m; negative if none does.
double cover(double x, double y, const Room& room) {
    return overlap({{x, y, room.radius}}, room.rods, room.box);
}

/// Sites in the order in which they are given up: covered ones by depth, the others at random.
std::vector<std::size_t> by_vacancy(const std::vector<Eigen::Vector2d>& sites, const GranularProblem& problem,
                                    const Room& room, std::uint32_t run) {
    std::vector<double> rank(sites.size());
    for (std::size_t k = 0; k < sites.size(); ++k) {
        const double depth =
            room.rods.empty() ? -1.0 : cover(sites[k].x(), sites[k].y(), room) / room.box.shorter();
        rank[k] = depth > 0.0 ? depth : -stream_for(Purpose::vacancy, problem.seed, run, k).uniform();
    }
    std::vector<std::size_t> order(sites.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rank[a] > rank[b]; });
    return order;
}

/// As dense between the rods as the beads are to be: sites for the beads, and for the area that the rods
/// take.
long sites_needed(const GranularProblem& problem, const Room& room) {
    double covered = 0.0;
    for (const RodSpec& rod : problem.rods)
        covered += make_clump(rod.shape).projected_area();
    const double free = room.box.area() - covered;
    const double sites = static_cast<double>(problem.beads) * room.box.x * room.box.y / free;
    const double rounding = room.box.square() ? 0.0 : 1e-9; // is no site; squares keep their starts of before
    return static_cast<long>(std::ceil(sites - rounding * sites));
}

} // namespace

RandomStream stream_for(Purpose purpose, std::uint64_t seed, std::uint32_t run, std::size_t index) {
    const std::uint64_t salt =
        static_cast<std::uint64_t>(purpose) * 0x9e3779b97f4a7c15ULL; // 2^64/golden ratio
    return RandomStream(seed ^ salt, run, static_cast<std::uint32_t>(index));
}

std::vector<std::size_t> kept_sites(const std::vector<Eigen::Vector2d>& sites, const GranularProblem& problem,
                                    const Room& room, std::uint32_t run) {
    const auto order = by_vacancy(sites, problem, room, run);
    std::vector<std::size_t> kept(order.end() - static_cast<std::ptrdiff_t>(problem.beads), order.end());
    std::sort(kept.begin(), kept.end());
    return kept;
}

Places flat_layer(const std::vector<Eigen::Vector2d>& sites, const std::vector<std::size_t>& kept,
                  const GranularProblem& problem, const Room& room, std::uint32_t run) {
    Places places;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        places.x.push_back(sites[kept[i]].x());
        places.y.push_back(sites[kept[i]].y());
        const double height = jitter * room.height;
        places.z.push_back(stream_for(Purpose::place, problem.seed, run, i).uniform(-height, height));
    }
    return places;
}

Places on_lattice(const GranularProblem& problem, const Room& room, std::uint32_t run) {
    const auto fit = fit_lattice(problem.box, sites_needed(problem, room), problem.orientation);
    const auto sites = lattice_sites(fit, problem.box);
    return flat_layer(sites, kept_sites(sites, problem, room, run), problem, room, run);
}

Places at_random(const GranularProblem& problem, const Room& room, std::uint32_t run) {
    Places places;
    for (std::size_t i = 0; i < problem.beads; ++i) {
        auto random = stream_for(Purpose::place, problem.seed, run, i);
        double x = 0.0, y = 0.0;
        for (int attempt = 0; attempt < most_attempts; ++attempt) {
            x = random.uniform(0.0, room.box.x);
            y = random.uniform(0.0, room.box.y);
            if (room.rods.empty() || cover(x, y, room) < 0.0)
                break;
        }
        places.x.push_back(x);
        places.y.push_back(y);
        places.z.push_back(random.uniform(-room.height, room.height));
    }
    return places;
}

} // namespace rodwake::granular
