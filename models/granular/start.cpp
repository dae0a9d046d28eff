#include "rodwake/granular/start.hpp"

#include "fixed_order.hpp"
#include "packing.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/periodic.hpp"
#include "wall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>

namespace rodwake::granular {

namespace {

constexpr double beads_per_tile = 64.0;
constexpr double rod_offset = 0.01; // of a rod's free height, up or down

/// Two independent normal numbers (Box and Muller).
Eigen::Vector2d normal_pair(RandomStream& random) {
    const double radius = std::sqrt(-2.0 * repeatable::log(random.uniform()));
    return radius * direction(2.0 * M_PI * random.uniform());
}

/// What tells the rods of one run from those of another, even where there are no beads.
struct RodStart {
    double height; ///< above the middle of the gap, m
    double speed;  ///< upwards, m/s
    /// About the horizontal across the rod and about its axis, rad/s. Without them a symmetric rod would hop
    /// on its middle for ever and a control experiment with it could not fail.
    double pitch_rate, roll_rate;
};

RodStart rod_start(const GranularProblem& problem, std::size_t rod, std::uint32_t run) {
    auto random = stream_for(Purpose::rod, problem.seed, run, rod);
    const Clump clump = make_clump(problem.rods[rod].shape);
    const double radius = std::ranges::max(clump.radius);
    const double most = rod_offset * (problem.plates.gap - 2.0 * radius);
    const double height = random.uniform(-most, most);
    const double speed = problem.start_speed * normal_pair(random).x();
    const Eigen::Vector2d turning = problem.start_speed * normal_pair(random);
    return {height, speed, turning.x() / clump.reach(), turning.y() / radius};
}

Room room_of(const GranularProblem& problem, std::uint32_t run) {
    Room room{problem.box, bead_mix(problem).smallest(), problem.plates.gap, {}, problem.container};
    for (std::size_t k = 0; k < problem.rods.size(); ++k)
        for (Disc disc : rod_discs(problem.rods[k], make_clump(problem.rods[k].shape))) {
            disc.height = rod_start(problem, k, run).height;
            room.rods.push_back(disc);
        }
    return room;
}

/// Middle of the gap at step 0; t = 0 comes after the equilibration.
double middle_height(const GranularProblem& problem) {
    const double time = -static_cast<double>(problem.equilibration_steps) * problem.time_step;
    const double phase = 2.0 * M_PI * std::remainder(problem.plates.frequency * time, 1.0);
    return problem.plates.amplitude(problem.gravity) * repeatable::cos(phase) + 0.5 * problem.plates.gap;
}

void set_velocities(Beads& beads, const GranularProblem& problem, std::uint32_t run) {
    for (std::size_t i = 0; i < beads.size(); ++i) {
        auto random = stream_for(Purpose::velocity, problem.seed, run, i);
        const Eigen::Vector2d in_plane = normal_pair(random), upwards = normal_pair(random);
        beads.vx[i] = problem.start_speed * in_plane.x();
        beads.vy[i] = problem.start_speed * in_plane.y();
        beads.vz[i] = problem.start_speed * upwards.x();
    }
    const bool alike =
        std::ranges::adjacent_find(beads.radius, std::ranges::not_equal_to()) == beads.radius.end();
    // The velocity of the centre of mass is taken away; masses go as the cubes of the radii.
    for (auto* velocity : {&beads.vx, &beads.vy, &beads.vz}) {
        double sum = 0.0, weights = 0.0;
        for (std::size_t i = 0; i < velocity->size(); ++i) {
            const double weight = alike ? 1.0 : beads.radius[i] * beads.radius[i] * beads.radius[i];
            sum += weight * (*velocity)[i];
            weights += weight;
        }
        for (double& v : *velocity)
            v -= sum / weights;
    }
}

void add_rods(State& state, const GranularProblem& problem, std::uint32_t run) {
    const double middle = middle_height(problem);
    for (std::size_t k = 0; k < problem.rods.size(); ++k) {
        const RodSpec& spec = problem.rods[k];
        const RodStart start = rod_start(problem, k, run);
        RodBody rod;
        rod.position = {spec.position.x(), spec.position.y(), middle + start.height};
        rod.velocity.z() = start.speed;
        rod.orientation = turn(std::remainder(spec.heading, 2.0 * M_PI), Eigen::Vector3d::UnitZ());
        const Clump clump = make_clump(spec.shape);
        const Eigen::Vector3d axis = rod.axis(), across(-axis.y(), axis.x(), 0.0);
        rod.angular_momentum = clump.transverse_inertia * start.pitch_rate * across +
                               clump.axial_inertia * start.roll_rate * axis;
        state.rods.push_back(rod);
    }
}

std::string no_packing(const GranularProblem& problem, const char* kind, const char* advice, double overlap) {
    return fmt::format(
        "found no {} of {} beads (phi_b = {:.4f}) {}that is free of overlaps: the best one still overlaps by "
        "{:.2g} bead radii; {}use fewer beads or a larger {}{}",
        kind, problem.beads, bead_area_fraction(problem),
        problem.rods.empty() ? "" : fmt::format("beside {} rods ", problem.rods.size()),
        overlap / problem.bead_radius, advice, problem.container ? "container" : "box",
        bead_mix(problem).equal() ? ""
                                  : ", or a wider plates.gap, in which beads of several sizes find room");
}

/// Places and sizes of the state's beads.
void put_places(State& state, const BeadPositions& places, const GranularProblem& problem) {
    const double middle = middle_height(problem);
    state.beads.resize(places.size());
    // One size and one kind are the problem's, and no numbers of the state.
    if (const BeadMix mix = bead_mix(problem); !mix.equal() || mix.smallest() != problem.bead_radius)
        state.beads.radius = places.radius;
    if (problem.bead_kinds.size() > 1)
        state.beads.kind = places.kind;
    for (std::size_t i = 0; i < places.size(); ++i) {
        state.beads.x[i] = into_box(places.x[i], problem.box.x);
        state.beads.y[i] = into_box(places.y[i], problem.box.y);
        state.beads.z[i] = middle + places.z[i];
    }
}

/// The same moved apart; returns what overlap is left.
double set_places(State& state, BeadPositions places, const GranularProblem& problem, const Room& room,
                  std::uint32_t run) {
    const double left = push_apart(places, room, stream_for(Purpose::shake, problem.seed, run));
    put_places(state, places, problem);
    return left;
}

/// Throws InputError for given beads that are in a plate, a wall, a rod or each other by more than
/// overlap_limit radii; what is less deep the run itself takes apart.
void check_places(const GranularProblem& problem, const BeadPositions& p, const Room& room) {
    constexpr double rounding = 1e-9;
    const double limit = problem.overlap_limit;
    const auto require = [&](double depth, double radius, std::size_t bead, const std::string& other) {
        if (depth > (limit + rounding) * radius)
            throw InputError(
                fmt::format("start_file: bead {} (of radius {:g} m, numbered from 0 by rows) is {:.3g} "
                            "radii deep in {}: must be at most overlap_limit = {:g}",
                            bead, p.radius[bead], depth / radius, other, limit));
    };
    for (std::size_t i = 0; i < p.size(); ++i) {
        require(std::abs(p.z[i]) + p.radius[i] - 0.5 * room.gap, p.radius[i], i,
                p.z[i] > 0.0 ? "the lid, which z is measured from the mean height of the floor to"
                             : "the floor");
        if (room.container)
            require(nearest_wall(*room.container, {p.x[i], p.y[i]}, p.radius[i]).depth, p.radius[i], i,
                    "the wall of the container");
    }
    const auto depth = [&](std::size_t i, double x, double y, double z, double radius) {
        const double dx = nearest_image_rounded(p.x[i] - x, room.box.x),
                     dy = nearest_image_rounded(p.y[i] - y, room.box.y), dz = p.z[i] - z;
        return p.radius[i] + radius - std::sqrt(dx * dx + dy * dy + dz * dz);
    };
    const NeighbourPairs near = neighbours(p, room, 0.0);
    for (const NearPair pair : near.beads) {
        const std::size_t i = near.order[pair.bead], j = near.order[pair.other];
        require(depth(i, p.x[j], p.y[j], p.z[j], p.radius[j]), std::min(p.radius[i], p.radius[j]), i,
                fmt::format("bead {}", j));
    }
    for (const NearPair pair : near.rods) {
        const Disc& disc = room.rods[pair.other];
        const std::size_t i = near.order[pair.bead];
        require(depth(i, disc.x, disc.y, disc.height, disc.radius), std::min(p.radius[i], disc.radius), i,
                "a rod");
    }
}

/// The given beads in their order. Where heights are given beads stay as they are, to the bit; a layer
/// without lies near mid gap, and is moved apart where beads overlap.
void place_given(State& state, const GranularProblem& problem, const Room& room, std::uint32_t run) {
    const GivenBeads& given = *problem.given;
    const BeadSizes sizes = bead_sizes(problem, run);
    std::vector<Eigen::Vector2d> sites;
    std::vector<std::size_t> all(problem.beads);
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (const std::size_t i : all)
        sites.emplace_back(into_box(given.x[i], problem.box.x), into_box(given.y[i], problem.box.y));
    BeadPositions places = flat_layer(sites, all, sizes, problem, room, run);
    if (given.z.empty()) {
        if (const double left = set_places(state, places, problem, room, run); left > 0.0)
            throw RunError(no_packing(problem, "packing from start_file", "", left));
    } else {
        const double middle = middle_height(problem);
        for (const std::size_t i : all)
            places.z[i] = given.z[i] - middle;
        check_places(problem, places, room);
        put_places(state, places, problem);
        state.beads.z = given.z;
    }
    set_velocities(state.beads, problem, run);
    for (const auto& [from, to] :
         {std::pair{&given.vx, &state.beads.vx}, {&given.vy, &state.beads.vy}, {&given.vz, &state.beads.vz}})
        if (!from->empty())
            *to = *from;
}

/// The low 16 bits with a zero after each.
std::uint32_t spread(std::uint32_t bits) {
    bits = (bits | bits << 8) & 0x00ff00ffu;
    bits = (bits | bits << 4) & 0x0f0f0f0fu;
    bits = (bits | bits << 2) & 0x33333333u;
    return (bits | bits << 1) & 0x55555555u;
}

/// The same beads in the order of tiles, square or nearly so, of about 64 beads, tiles along a Z curve
/// (Morton 1966), so that any 2048 successive beads fill one or two compact patches: what is near in the
/// plane is near in memory. Beads of a tile keep their order; as few as one tile's change nothing. Impulses
/// are given in the order of numbers (pair_contacts.hpp), so numbers belong to the start.
BeadPositions numbered_by_place(const BeadPositions& places, const PeriodicBox& box) {
    const double tiles = static_cast<double>(places.size()) / beads_per_tile,
                 columns = std::max(1.0, std::floor(std::sqrt(tiles * (box.x / box.y)))),
                 rows = std::max(1.0, std::floor(std::sqrt(tiles * (box.y / box.x))));
    const auto number = [](double coordinate, double side, double count) {
        return static_cast<std::uint32_t>(std::min(into_box(coordinate, side) / side * count, count - 1.0));
    };
    std::vector<std::uint32_t> tile(places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
        tile[i] = spread(number(places.x[i], box.x, columns)) | spread(number(places.y[i], box.y, rows)) << 1;
    std::vector<std::size_t> order(places.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return tile[i]; });
    BeadPositions sorted;
    for (const std::size_t i : order)
        sorted.add(places.x[i], places.y[i], places.z[i], places.radius[i], places.kind[i]);
    return sorted;
}

} // namespace

double settling_time(Start start, double phi_b) {
    if (start == Start::given) // as it is
        return 0.0;
    if (start == Start::lattice)
        return 0.5;
    struct Knot {
        double phi_b, time;
    };
    static constexpr std::array knots{Knot{0.60, 1.0}, Knot{0.70, 2.0}, Knot{0.72, 8.0}, Knot{0.76, 10.0},
                                      Knot{0.80, 24.0}};
    for (std::size_t i = 1; i < knots.size(); ++i)
        if (phi_b < knots[i].phi_b) {
            const Knot &a = knots[i - 1], &b = knots[i];
            const double part = std::max(0.0, (phi_b - a.phi_b) / (b.phi_b - a.phi_b));
            return a.time + part * (b.time - a.time);
        }
    return knots.back().time;
}

State make_start(const GranularProblem& problem, std::uint32_t run) {
    validate(problem);
    State state;
    if (problem.start == Start::given) {
        place_given(state, problem, room_of(problem, run), run);
    } else if (problem.beads > 0) {
        const bool lattice = problem.start == Start::lattice;
        if (lattice && !bead_mix(problem).one_size())
            throw InputError(
                "start = \"lattice\" puts equal beads on the sites of a triangular lattice, and these "
                "are of kinds of different radii: use start = \"random\"");
        const Room room = room_of(problem, run);
        const BeadPositions places = lattice ? on_lattice(problem, room, run) : at_random(problem, room, run);
        const double left =
            set_places(state, numbered_by_place(places, bed_sides(problem)), problem, room, run);
        if (left > 0.0)
            throw RunError(no_packing(
                problem, lattice ? "lattice packing" : "random packing",
                lattice || !bead_mix(problem).one_size() ? "" : "try start = \"lattice\", or ", left));
        set_velocities(state.beads, problem, run);
    }
    add_rods(state, problem, run);
    return state;
}

State restart_from(const GranularProblem& problem, const State& stored, std::uint32_t run) {
    validate(problem);
    const Beads& old = stored.beads;
    if (old.size() < problem.beads)
        throw InputError(
            fmt::format("the stored bed has {} beads and this scene {}: beads can be taken out but not "
                        "added; lower beads or phi_b, or restart from a denser bed",
                        old.size(), problem.beads));
    for (std::size_t i = 0; i < old.size(); ++i)
        for (const auto* column : {&old.x, &old.y, &old.vx, &old.vy, &old.vz, &old.wx, &old.wy, &old.wz})
            if (!std::isfinite((*column)[i]))
                throw InputError(
                    fmt::format("the stored bed is damaged: position or velocity of bead {} is {}; restart "
                                "from another one",
                                i, (*column)[i]));
    State state;
    if (problem.beads > 0) {
        const Room room = room_of(problem, run);
        std::vector<Eigen::Vector2d> sites;
        for (std::size_t i = 0; i < old.size(); ++i)
            sites.emplace_back(into_box(old.x[i], problem.box.x), into_box(old.y[i], problem.box.y));
        // The beads keep their sizes.
        BeadSizes sizes{old.radius, old.kind}, kept_sizes;
        if (old.radius.empty())
            sizes.radius.assign(old.size(), problem.bead_radius);
        if (old.kind.empty())
            sizes.kind.assign(old.size(), 0);
        require_sizes(bead_mix(problem), sizes, "the stored bed:");
        const auto kept = kept_sites(sites, sizes.radius, problem, room, run);
        for (const std::size_t i : kept) {
            kept_sizes.radius.push_back(sizes.radius[i]);
            kept_sizes.kind.push_back(sizes.kind[i]);
        }
        const double left =
            set_places(state, flat_layer(sites, kept, kept_sizes, problem, room, run), problem, room, run);
        if (left > 0.0)
            throw RunError(no_packing(problem, "packing from the stored bed",
                                      "restart from a bed in a box of the same size, ", left));
        using Column = std::vector<double> Beads::*;
        for (const Column column : {&Beads::vx, &Beads::vy, &Beads::vz, &Beads::wx, &Beads::wy, &Beads::wz})
            for (std::size_t i = 0; i < kept.size(); ++i)
                (state.beads.*column)[i] = (old.*column)[kept[i]];
    }
    add_rods(state, problem, run);
    return state;
}

} // namespace rodwake::granular
