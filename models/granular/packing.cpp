#include "packing.hpp"

#include "fixed_order.hpp"
#include "rodwake/core/cell_list.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"
#include "wall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rodwake::granular {

namespace {

constexpr double aim = 2e-4; // wanted free distance, of two radii: converges to `separation` in finite time
constexpr double skin_share = 0.6; // of a radius
constexpr double push = 0.55;      // share of the overlap that each of two beads gives way
constexpr double shaking = 0.1;    // of a radius
constexpr int sweeps_a_round = 2500, rounds = 4;

struct BeadSphere {
    double x, y, z, radius;
};

class PushApart {
public:
    PushApart(BeadPositions& places, const Room& room)
        : places_(places), room_(room), skin_(skin_share * room.radius) {
        for (const Disc& disc : room.rods)
            rods_.push_back({disc.x, disc.y, disc.height, disc.radius});
    }

    /// Largest overlap left.
    double settle(int sweeps) {
        p_.clear();
        double left = find_pairs();
        for (int k = 0; k < sweeps && left > 0.0; ++k) {
            left = sweep();
            double square = 0.0; // of the furthest move in plan view since the pairs were found
            for (std::size_t i = 0; i < p_.size(); ++i) {
                const double x = p_[i].x - found_at_[i].x, y = p_[i].y - found_at_[i].y;
                square = std::max(square, x * x + y * y);
            }
            if (std::sqrt(square) > 0.5 * skin_)
                left = find_pairs(); // pairs that are not listed may have met
            else if (left == 0.0)
                left = largest_overlap(); // later pairs may have pushed earlier ones
        }
        return find_pairs();
    }

private:
    struct Gap {
        double x, y, z, distance;
    };

    static Gap gap(const BeadSphere& a, const BeadSphere& b, const PeriodicBox& box) {
        const double x = nearest_image_rounded(a.x - b.x, box.x);
        const double y = nearest_image_rounded(a.y - b.y, box.y);
        const double z = a.z - b.z;
        return {x, y, z, std::sqrt(x * x + y * y + z * z)};
    }

    /// Hands the swept positions back, if there are any, and lists the pairs that are near each other now;
    /// returns the largest overlap.
    double find_pairs() {
        for (std::size_t k = 0; k < p_.size(); ++k) {
            const std::uint32_t i = near_.order[k];
            places_.x[i] = p_[k].x;
            places_.y[i] = p_[k].y;
            places_.z[i] = p_[k].z;
        }
        near_ = neighbours(places_, room_, skin_);
        p_.clear();
        for (const std::uint32_t i : near_.order)
            p_.push_back({places_.x[i], places_.y[i], places_.z[i], places_.radius[i]});
        found_at_ = p_;
        return largest_overlap();
    }

    double largest_overlap() const {
        double largest = 0.0;
        const auto include = [&](const BeadSphere& a, const BeadSphere& b) {
            largest =
                std::max(largest, (a.radius + b.radius) * (1.0 + separation) - gap(a, b, room_.box).distance);
        };
        for (const NearPair pair : near_.beads)
            include(p_[pair.bead], p_[pair.other]);
        for (const NearPair pair : near_.rods)
            include(p_[pair.bead], rods_[pair.other]);
        return largest;
    }

    /// Parts every pair once; returns the largest overlap met on the way.
    double sweep() {
        // Constants are local: the compiler could not know that positions are not among the members.
        const PeriodicBox box = room_.box;
        const double between_plates = room_.gap;
        const auto move = [between_plates](BeadSphere& at, double x, double y, double z) {
            const double top = free_height(between_plates, at.radius);
            at = {at.x + x, at.y + y, std::clamp(at.z + z, -top, top), at.radius};
        };
        double largest = 0.0;
        for (const NearPair pair : near_.beads) {
            BeadSphere &a = p_[pair.bead], &b = p_[pair.other];
            const Gap g = gap(a, b, box);
            const double reach = a.radius + b.radius, missing = reach * (1.0 + aim) - g.distance;
            if (missing <= 0.0)
                continue;
            if (g.distance > 0.0) {
                const double share = push * missing / g.distance;
                move(a, share * g.x, share * g.y, share * g.z);
                move(b, -share * g.x, -share * g.y, -share * g.z);
            } else { // the same position: any direction will do
                move(a, push * missing, 0.0, 0.0);
            }
            largest = std::max(largest, reach * (1.0 + separation) - g.distance);
        }
        // Beads leave rods in the plane only: none can leave a rod upwards.
        for (const NearPair pair : near_.rods) {
            BeadSphere& bead = p_[pair.bead];
            const Gap g = gap(bead, rods_[pair.other], box);
            const double reach = rods_[pair.other].radius + bead.radius, wanted = reach * (1.0 + aim);
            if (g.distance >= wanted)
                continue;
            const double in_plane = repeatable::length(g.x, g.y),
                         missing = std::sqrt(wanted * wanted - g.z * g.z) - in_plane;
            bead.x += in_plane > 0.0 ? missing * g.x / in_plane : missing;
            bead.y += in_plane > 0.0 ? missing * g.y / in_plane : 0.0;
            largest = std::max(largest, reach * (1.0 + separation) - g.distance);
        }
        if (!room_.container)
            return largest;
        // Overlaps that the wall makes are parted by the next sweep.
        for (BeadSphere& bead : p_) {
            const Eigen::Vector2d inside =
                put_inside(*room_.container, {bead.x, bead.y}, bead.radius * (1.0 + separation));
            bead.x = inside.x();
            bead.y = inside.y();
        }
        return largest;
    }

    BeadPositions& places_;
    const Room& room_;
    double skin_;
    std::vector<BeadSphere> rods_;
    NeighbourPairs near_;
    std::vector<BeadSphere> p_, found_at_; ///< cell by cell; now, and when the pairs were found
};

} // namespace

double push_apart(BeadPositions& places, const Room& room, RandomStream random) {
    PushApart work(places, room);
    double left = work.settle(sweeps_a_round);
    for (int round = 1; round < rounds && left > 0.0; ++round) {
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double angle = random.uniform(0.0, 2.0 * M_PI),
                         step = shaking * room.radius * random.uniform();
            const auto [sine, cosine] = repeatable::sin_cos(angle);
            places.x[i] += step * cosine;
            places.y[i] += step * sine;
            const double top = free_height(room.gap, places.radius[i]),
                         rise = shaking * room.radius * random.uniform(-1.0, 1.0);
            places.z[i] = std::clamp(places.z[i] + rise, -top, top);
        }
        left = work.settle(sweeps_a_round);
    }
    return left;
}

namespace {

constexpr double jitter = 0.01; // of the room's height: a layer that is exactly flat has nowhere to buckle
constexpr int most_attempts = 10000;

/// As dense between the rods as the beads are to be: sites for the beads, and for the area that the rods
/// take.
long sites_needed(const GranularProblem& problem, const Room& room) {
    double covered = 0.0;
    for (const RodSpec& rod : problem.rods)
        covered += make_clump(rod.shape).projected_area();
    if (room.container)
        return static_cast<long>(
            std::ceil(static_cast<double>(problem.beads) / (1.0 - covered / room.container->area())));
    const double free = room.box.area() - covered;
    const double sites = static_cast<double>(problem.beads) * room.box.x * room.box.y / free;
    const double rounding = room.box.square() ? 0.0 : 1e-9; // is no site; squares keep their starts of before
    return static_cast<long>(std::ceil(sites - rounding * sites));
}

/// Sites of a triangular lattice about the middle of the container whose beads are inside; the widest lattice
/// that has enough of them.
std::vector<Eigen::Vector2d> container_sites(const GranularProblem& problem, const Room& room) {
    constexpr double step = 0.998, closest = 1.6; // bead radii; beads give way upwards too
    const Container& container = *room.container;
    const auto needed = static_cast<std::size_t>(sites_needed(problem, room));
    const double widest = std::sqrt(2.0 / std::sqrt(3.0) * container.area() /
                                    static_cast<double>(std::max<std::size_t>(needed, 1)));
    const Eigen::Vector2d middle(0.5 * container.sides.x, 0.5 * container.sides.y);
    for (double spacing = std::min(1.1 * widest, container.sides.longer()); spacing > closest * room.radius;
         spacing *= step) {
        const Eigen::Vector2d along(spacing * direction(problem.orientation)),
            up(-std::sqrt(0.75) * along.y(), std::sqrt(0.75) * along.x());
        const int reach =
            static_cast<int>(std::ceil(repeatable::length(container.sides.x, container.sides.y) / spacing));
        std::vector<Eigen::Vector2d> sites;
        for (int j = -reach; j <= reach; ++j)
            for (int i = -reach; i <= reach; ++i) {
                const double shifted = i + (j % 2 != 0 ? 0.5 : 0.0);
                const Eigen::Vector2d site = middle + shifted * along + static_cast<double>(j) * up;
                if (nearest_wall(container, site, room.radius * (1.0 + separation)).depth <= 0.0)
                    sites.push_back(site);
            }
        if (sites.size() >= needed)
            return sites;
    }
    throw RunError(fmt::format(
        "found no lattice of {} sites in the container: use fewer beads or a larger one", needed));
}

} // namespace

RandomStream stream_for(Purpose purpose, std::uint64_t seed, std::uint32_t run, std::size_t index) {
    const std::uint64_t salt =
        static_cast<std::uint64_t>(purpose) * 0x9e3779b97f4a7c15ULL; // 2^64/golden ratio
    return RandomStream(seed ^ salt, run, static_cast<std::uint32_t>(index));
}

void BeadPositions::add(double to_x, double to_y, double to_z, double of_radius, std::uint8_t of_kind) {
    x.push_back(to_x);
    y.push_back(to_y);
    z.push_back(to_z);
    radius.push_back(of_radius);
    kind.push_back(of_kind);
}

std::vector<std::size_t> kept_sites(const std::vector<Eigen::Vector2d>& sites,
                                    const std::vector<double>& radius, const GranularProblem& problem,
                                    const Room& room, std::uint32_t run) {
    // Sites in the order in which they are given up: covered ones by depth, the others at random.
    std::vector<double> rank(sites.size());
    for (std::size_t k = 0; k < sites.size(); ++k) {
        const double bead = radius.empty() ? room.radius : radius[k],
                     depth = room.rods.empty()
                                 ? -1.0
                                 : overlap({{sites[k].x(), sites[k].y(), bead}}, room.rods, room.box) /
                                       room.box.shorter();
        rank[k] = depth > 0.0 ? depth : -stream_for(Purpose::vacancy, problem.seed, run, k).uniform();
    }
    std::vector<std::size_t> order(sites.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return rank[a] > rank[b]; });
    std::vector<std::size_t> kept(order.end() - static_cast<std::ptrdiff_t>(problem.beads), order.end());
    std::sort(kept.begin(), kept.end());
    return kept;
}

BeadPositions flat_layer(const std::vector<Eigen::Vector2d>& sites, const std::vector<std::size_t>& kept,
                         const BeadSizes& sizes, const GranularProblem& problem, const Room& room,
                         std::uint32_t run) {
    BeadPositions places;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        const double height = jitter * free_height(room.gap, sizes.radius[i]);
        places.add(sites[kept[i]].x(), sites[kept[i]].y(),
                   stream_for(Purpose::place, problem.seed, run, i).uniform(-height, height), sizes.radius[i],
                   sizes.kind[i]);
    }
    return places;
}

BeadPositions on_lattice(const GranularProblem& problem, const Room& room, std::uint32_t run) {
    const auto sites =
        room.container
            ? container_sites(problem, room)
            : lattice_sites(fit_lattice(problem.box, sites_needed(problem, room), problem.orientation),
                            problem.box);
    BeadPositions places = flat_layer(sites, kept_sites(sites, {}, problem, room, run),
                                      bead_sizes(problem, run), problem, room, run);
    if (room.container && problem.bead_spread > 0.0) // sites are those of the smallest beads
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Eigen::Vector2d inside = put_inside(*room.container, {places.x[i], places.y[i]},
                                                      places.radius[i] * (1.0 + separation));
            places.x[i] = inside.x();
            places.y[i] = inside.y();
        }
    return places;
}

BeadPositions at_random(const GranularProblem& problem, const Room& room, std::uint32_t run) {
    BeadPositions places;
    const PeriodicBox& sides = bed_sides(problem);
    const BeadSizes sizes = bead_sizes(problem, run);
    for (std::size_t i = 0; i < problem.beads; ++i) {
        auto random = stream_for(Purpose::place, problem.seed, run, i);
        double x = 0.0, y = 0.0;
        for (int attempt = 0; attempt < most_attempts; ++attempt) {
            x = random.uniform(0.0, sides.x);
            y = random.uniform(0.0, sides.y);
            if ((!room.container || nearest_wall(*room.container, {x, y}, sizes.radius[i]).depth <= 0.0) &&
                (room.rods.empty() || overlap({{x, y, sizes.radius[i]}}, room.rods, room.box) < 0.0))
                break;
        }
        const double height = free_height(room.gap, sizes.radius[i]);
        places.add(x, y, random.uniform(-height, height), sizes.radius[i], sizes.kind[i]);
    }
    return places;
}

namespace {

double square_in_plan(double dx, double dy, const PeriodicBox& box) {
    dx = nearest_image_rounded(dx, box.x);
    dy = nearest_image_rounded(dy, box.y);
    return dx * dx + dy * dy;
}

/// Cells along one side that a disc may reach into.
struct Span {
    std::ptrdiff_t first, count;
};

Span span_of(std::size_t at, std::size_t cells, double range_in_cells) {
    const auto all = static_cast<std::ptrdiff_t>(cells);
    const auto wide = std::min(static_cast<std::ptrdiff_t>(std::ceil(range_in_cells)), all);
    const std::ptrdiff_t count = std::min(2 * wide + 1, all);
    return {static_cast<std::ptrdiff_t>(at) - count / 2, count};
}

} // namespace

NeighbourPairs neighbours(const BeadPositions& places, const Room& room, double skin) {
    const double largest = places.radius.empty() ? room.radius : std::ranges::max(places.radius);
    const CellList cells(places.x, places.y, room.box, 2.0 * largest + skin);
    NeighbourPairs found;
    found.order = cells.member();
    std::vector<double> radius; // in the order of the cells
    for (const std::uint32_t i : found.order)
        radius.push_back(places.radius[i]);
    // In an order that decides how beads are moved apart: that of the cells.
    const auto &x = cells.x(), &y = cells.y();
    cells.pairs([&](std::size_t p, std::size_t q) {
        const double range = radius[p] + radius[q] + skin;
        if (square_in_plan(x[p] - x[q], y[p] - y[q], room.box) < range * range)
            found.beads.push_back({static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q)});
    });
    for (std::size_t k = 0; k < room.rods.size(); ++k) {
        const Disc& disc = room.rods[k];
        const double range = disc.radius + largest + skin;
        const Span columns = span_of(cells.column(disc.x), cells.columns(), range / cells.width()),
                   rows = span_of(cells.row(disc.y), cells.rows(), range / cells.height());
        for (std::ptrdiff_t i = 0; i < columns.count; ++i)
            for (std::ptrdiff_t j = 0; j < rows.count; ++j)
                cells.in_cell(columns.first + i, rows.first + j, [&](std::size_t p) {
                    const double near = disc.radius + radius[p] + skin;
                    if (square_in_plan(cells.x()[p] - disc.x, cells.y()[p] - disc.y, room.box) < near * near)
                        found.rods.push_back({static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(k)});
                });
    }
    return found;
}

std::vector<Disc> rod_discs(const RodSpec& rod, const Clump& clump) {
    const Eigen::Vector2d ahead = direction(rod.heading);
    std::vector<Disc> discs;
    for (std::size_t k = 0; k < clump.offset.size(); ++k)
        discs.push_back({rod.position.x() + ahead.x() * clump.offset[k],
                         rod.position.y() + ahead.y() * clump.offset[k], clump.radius[k]});
    return discs;
}

double overlap(const std::vector<Disc>& first, const std::vector<Disc>& second, const PeriodicBox& box) {
    double deepest = -std::numeric_limits<double>::infinity();
    for (const Disc& a : first)
        for (const Disc& b : second) {
            const double dx = nearest_image_rounded(a.x - b.x, box.x),
                         dy = nearest_image_rounded(a.y - b.y, box.y);
            deepest = std::max(deepest, a.radius + b.radius - repeatable::length(dx, dy));
        }
    return deepest;
}

} // namespace rodwake::granular
