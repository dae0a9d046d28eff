#include "rodwake/granular/simulation.hpp"

#include "bodies.hpp"
#include "bounces.hpp"
#include "pair_contacts.hpp"
#include "pair_finder.hpp"
#include "rodwake/core/bond_order.hpp"
#include "rodwake/core/error.hpp"
#include "wall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>

namespace rodwake::granular {

namespace {

// How far a bead may fly into a plate in a step, of overlap_limit. Measured at phi_b = 0.80, Gamma = 7 (limit
// 0.06 radii): temperatures are right to their errors at 1e-4 s (0.035 radii), off by 2 % at 2e-4 s (0.072),
// by 6 % at 4e-4 s (0.144) and by 20 % at 5e-4 s (0.18).
constexpr double flight_limit = 0.6;

// Overlap of a pair, in radii, that stops a run before t = 0: beads of a dense random start are jammed at
// first and push each other 0.14 to 0.19 deep at phi_b = 0.80 and 1e-4 s, for half a second.
constexpr double settling_limit = 0.5;

/// What one task of the flight phase leaves behind; sums are taken block by block, so threads do not change
/// them.
struct BlockResult {
    std::vector<std::uint32_t> hits; ///< beads that left the space between the plates
    BodyRange velocities = BodyRange::empty();
    PlateTally tally;
};

constexpr double top_speed = 1e6;      // m/s
constexpr double furthest_image = 1e6; // boxes; beyond, wrapping loses digits

bool sound(const Vector3& position, const Vector3& velocity, const Vector3& spin, const PeriodicBox& box) {
    return position.allFinite() && velocity.allFinite() && spin.allFinite() &&
           std::abs(position.x()) <= furthest_image * box.x &&
           std::abs(position.y()) <= furthest_image * box.y;
}

} // namespace

struct Simulation::Impl {
    GranularProblem problem;
    Bodies bodies;
    PairFinder finder;
    PairContacts contacts;
    std::optional<Wall> wall;
    ThreadPool team;
    Counters tallies;
    std::int64_t step;
    std::optional<Failure> failure;
    std::vector<BlockResult> blocks;
    std::vector<std::atomic<std::uint8_t>> flights; ///< of the blocks in this step
    std::vector<double> fastest;                    ///< of the blocks in this step
    double shifted = 0.0;                           ///< how far the step before moved spheres apart, m

    Impl(const GranularProblem& p, const State& state, const Counters& t, std::size_t threads)
        : problem(p), bodies(make_bodies(p, state)), finder(bodies, p.box),
          contacts({p.contacts, p.box, p.time_step, p.gravity}), team(threads), tallies(t), step(state.step),
          blocks((bodies.beads + beads_per_block - 1) / beads_per_block), flights(blocks.size()) {
        for (auto* sums : {&tallies.impulse_on_beads, &tallies.impulse_from_plates})
            sums->resize(problem.rods.size(), Vector3::Zero());
        if (p.container)
            wall.emplace(*p.container, p.time_step, p.gravity);
        hold_rods();
    }

    bool equilibrating() const { return step < problem.equilibration_steps; }

    /// Held still during the equilibration, as the scene says afterwards.
    void hold_rods() {
        for (std::size_t i = 0; i < bodies.rods.size(); ++i)
            bodies.rods[i].hold(equilibrating() ? std::optional(0.0) : problem.rods[i].imposed_speed);
    }

    void fly_block(std::size_t b, const PlateStep& plate) {
        const double floor = plate.floor.position(), a = bodies.equal_beads ? bodies.bead_radius : 0.0;
        BlockResult& mine = blocks[b];
        mine.hits.clear();
        mine.velocities = BodyRange::empty();
        mine.tally = {};
        const std::size_t begin = b * beads_per_block, end = std::min(bodies.beads, begin + beads_per_block);
        drift(bodies.position.data(), bodies.velocity.data(), begin, end,
              {problem.time_step, problem.gravity, floor + a, floor + plate.gap - a, !bodies.equal_beads},
              mine.velocities, mine.hits);
        bounce_beads(bodies, mine.hits, plate, problem.contacts.bead_plate, mine.velocities, mine.tally);
        for (const std::uint32_t bead : mine.hits)
            if (!row(bodies.position, bead).allFinite()) // minima and maxima pass over NaN, hits do not
                mine.velocities.high[0] = std::numeric_limits<double>::infinity();
    }

    /// Once a step, by whoever needs the block first; the others wait for it.
    void fly_once(std::size_t b, const PlateStep& plate) {
        enum : std::uint8_t { lies, flies, has_flown };
        std::uint8_t was = lies;
        if (flights[b].compare_exchange_strong(was, flies)) {
            try {
                fly_block(b, plate);
            } catch (...) { // nobody waits for ever
                flights[b].store(has_flown, std::memory_order_release);
                throw;
            }
            flights[b].store(has_flown, std::memory_order_release);
        }
        while (flights[b].load(std::memory_order_acquire) != has_flown)
            std::this_thread::yield();
    }

    /// Pairs are tested as soon as their beads have flown.
    void fly_and_test(const PlateStep& plate) {
        for (auto& flight : flights)
            flight.store(0, std::memory_order_relaxed);
        team.run(std::max(finder.parts(), blocks.size()), [&](std::size_t part) {
            if (part < blocks.size())
                fly_once(part, plate);
            if (part >= finder.parts())
                return;
            for (const std::uint32_t block : finder.blocks_of(part))
                fly_once(block, plate);
            finder.test(part, bodies);
        });
    }

    /// Half of what a body force gives the beads in a step; t = `time`.
    void half_kick(double time) {
        kick(bodies, *problem.body_force, problem.box, time, 0.5 * problem.time_step, team);
    }

    /// Rod ends move fastest; the spheres between them no faster. They go round: within a step their
    /// velocities change by rate^2 arm dt.
    void include_ends(const MovingRod& rod, BodyRange& velocities) const {
        for (const double end : {rod.clump().offset.front(), rod.clump().offset.back()}) {
            const Vector3 turning = rod.velocity_at(end * rod.axis()) - rod.body().velocity;
            const double change =
                end == 0.0 ? 0.0 : turning.squaredNorm() / std::abs(end) * problem.time_step;
            for (const double margin : {-change, change}) {
                const Vector3 v = rod.body().velocity + turning + Vector3::Constant(margin);
                velocities.include(v.data());
            }
        }
    }

    /// In the plane; others: what may be faster than a block's own beads.
    std::span<const double> fastest_of_blocks(const BodyRange& others) {
        fastest.resize(std::max<std::size_t>(blocks.size(), 1));
        for (std::size_t b = 0; b < fastest.size(); ++b) {
            BodyRange all = others;
            if (b < blocks.size())
                all.include(blocks[b].velocities);
            include_shift(all, shifted);
            fastest[b] = all.fastest_in_plane();
        }
        return fastest;
    }

    /// As if spheres that were put elsewhere had flown there.
    void include_shift(BodyRange& velocities, double shift) const {
        for (int axis = 0; axis < 2; ++axis) {
            velocities.low[axis] -= shift / problem.time_step;
            velocities.high[axis] += shift / problem.time_step;
        }
    }

    WallTally hit_wall(BodyRange& velocities) {
        const WallTally tally =
            wall->act(bodies, velocities.fastest_in_plane(), velocities, shifted, equilibrating());
        for (const MovingRod& rod : bodies.rods)
            include_ends(rod, velocities);
        include_shift(velocities, tally.shift);
        tallies.wall_impulse += tally.impulse;
        tallies.bead_wall += tally.beads;
        tallies.rod_wall += tally.rods;
        tallies.max_overlap = std::max(tallies.max_overlap, tally.worst);
        return tally;
    }

    void add(const PlateTally& tally, std::int64_t& impulses) {
        tallies.floor_impulse += tally.floor_impulse;
        tallies.lid_impulse += tally.lid_impulse;
        impulses += tally.impulses;
        tallies.max_overlap = std::max(tallies.max_overlap, tally.max_overlap);
    }

    std::string name(std::size_t sphere) const {
        if (bodies.is_bead(sphere))
            return fmt::format("bead {}", sphere);
        return fmt::format("rod {}", bodies.rod_of[sphere - bodies.beads]);
    }

    void fail(std::string what) {
        failure = Failure{
            step,
            fmt::format("step {} (t = {:.6g} s): {}. The likely cause is a time_step that is too large; "
                        "{:g} s was used, try {:g} s in a new folder",
                        step, time(), what, problem.time_step, problem.time_step / 5.0)};
    }

    double time() const {
        return static_cast<double>(step - problem.equilibration_steps) * problem.time_step;
    }

    /// Before anything is compared with it: NaN would hide.
    void guard_speeds(const BodyRange& velocities) {
        bool sane = std::ranges::all_of(bodies.rods, [](const MovingRod& rod) {
            return rod.body().position.allFinite() && rod.body().velocity.allFinite() &&
                   rod.axis().allFinite();
        });
        for (std::size_t axis = 0; axis < 3; ++axis)
            sane = sane && velocities.low[axis] > -top_speed && velocities.high[axis] < top_speed;
        if (sane || (bodies.beads == 0 && bodies.rods.empty()))
            return;
        std::string runaway; // the first body that explains it
        for (std::size_t i = 0; i < bodies.beads && runaway.empty(); ++i)
            if (!(row(bodies.position, i).allFinite() && row(bodies.velocity, i).allFinite() &&
                  row(bodies.velocity, i).cwiseAbs().maxCoeff() < top_speed))
                runaway = name(i);
        for (std::size_t i = 0; i < bodies.rods.size() && runaway.empty(); ++i)
            if (!(bodies.rods[i].body().velocity.norm() < top_speed))
                runaway = fmt::format("rod {}", i);
        fail(fmt::format("{} moves at a speed that is not a number or above {:g} m/s",
                         runaway.empty() ? "a rod" : runaway, top_speed));
    }

    void guard_depths(const WorstOverlap& worst, const PlateTally& rods, const PlateTally& beads,
                      const WallTally& at_wall) {
        const double limit =
            equilibrating() ? std::max(problem.overlap_limit, settling_limit) : problem.overlap_limit;
        if (at_wall.worst > limit)
            return fail(fmt::format("{} is {:.3g} of its radius deep in the wall, more than {:g}",
                                    name(at_wall.deepest), at_wall.worst, limit));
        if (worst.radii > limit)
            return fail(fmt::format("{} and {} overlap by {:.3g} of the smaller radius, more than {:g}",
                                    name(worst.pair.first), name(worst.pair.second), worst.radii, limit));
        if (rods.max_overlap > problem.overlap_limit)
            return fail(fmt::format("rod {} is {:.3g} of its radius deep in a plate, more than {:g}",
                                    rods.deepest, rods.max_overlap, problem.overlap_limit));
        if (beads.deepest_flight > flight_limit * problem.overlap_limit)
            return fail(fmt::format("{} flew {:.3g} radii into a plate within one step, more than {:g}",
                                    name(beads.deepest), beads.deepest_flight,
                                    flight_limit * problem.overlap_limit));
    }

    /// Calls mark with each of StepTimes when it is done. Flight and search go together if the parts may, on
    /// which nothing depends but the time they take.
    template<class Mark>
    void one_step(bool apart, const Mark& mark) {
        // Counted from t = 0, so that the phase of a run does not depend on its equilibration.
        const double step_end =
            static_cast<double>(step + 1 - problem.equilibration_steps) * problem.time_step;
        const PlateStep plate{floor_path(problem.plates, problem.gravity, step_end), problem.plates.gap,
                              problem.time_step, problem.gravity};
        const bool pushed = problem.body_force && !equilibrating();
        if (pushed)
            half_kick(time());
        // Rods, with the largest velocities of their ends at the start, after each impulse and at the end.
        PlateTally rods;
        BodyRange of_rods = BodyRange::empty();
        const auto include = [&](const MovingRod& rod) { include_ends(rod, of_rods); };
        std::ranges::for_each(bodies.rods, include);
        fly_rods(bodies.rods, plate, problem.contacts.rod_plate, rods, tallies.impulse_from_plates, include);
        std::ranges::for_each(bodies.rods, include);
        bodies.place_rod_spheres();
        mark(&StepTimes::rods);
        const bool together = !apart && !wall && finder.likely_to_hold(problem.time_step);
        if (together)
            fly_and_test(plate);
        else
            team.run(blocks.size(), [&](std::size_t b) { fly_block(b, plate); });
        BodyRange velocities = of_rods;
        PlateTally beads; // of the deepest flight, which the guard looks at
        for (const BlockResult& block : blocks) {
            velocities.include(block.velocities);
            add(block.tally, tallies.bead_plate);
            if (block.tally.deepest_flight > beads.deepest_flight)
                beads = block.tally;
        }
        add(rods, tallies.rod_plate);
        mark(&StepTimes::flight);
        const WallTally at_wall = wall ? hit_wall(velocities) : WallTally{};
        mark(&StepTimes::rods);
        ++step;
        guard_speeds(velocities);
        if (failure)
            return;
        const std::span<const Pair> overlapping = finder.find(
            bodies, fastest_of_blocks(wall ? velocities : of_rods), problem.time_step, team, together);
        mark(&StepTimes::search);
        const WorstOverlap worst = contacts.resolve(bodies, overlapping, tallies, team, equilibrating());
        shifted = worst.shift;
        if (pushed)
            half_kick(time());
        mark(&StepTimes::impulses);
        guard_depths(worst, rods, beads, at_wall);
        if (step == problem.equilibration_steps)
            hold_rods();
    }
};

std::size_t worthwhile_threads(const GranularProblem& problem, std::size_t threads) {
    // Two cores with a busy process and other work, in turns, medians of five stretches of 0.3 s: two threads
    // took 0.9 to 1.1 times as long as one for 24 440 beads, 0.9 to 1.0 times for 50 000 and 100 000
    // (bench/threads.py times whole runs)
    constexpr std::size_t beads_per_thread = 15'000;
    return threads_for(problem.beads, beads_per_thread, threads);
}

Simulation::Simulation(const GranularProblem& problem, const State& state, const Counters& tallies,
                       std::size_t threads) {
    validate(problem);
    if (state.beads.size() != problem.beads || state.rods.size() != problem.rods.size())
        throw InputError(fmt::format("the stored state has {} beads and {} rods, the scene {} and {}",
                                     state.beads.size(), state.rods.size(), problem.beads,
                                     problem.rods.size()));
    const Beads& b = state.beads;
    const std::size_t kinds = std::max<std::size_t>(problem.bead_kinds.size(), 1);
    const bool radii = (b.radius.empty() || b.radius.size() == b.size()) &&
                       std::ranges::all_of(b.radius, [&](double radius) {
                           return radius > 0.0 && 2.0 * radius < problem.plates.gap;
                       });
    if (!radii || !(b.kind.empty() || b.kind.size() == b.size()) ||
        std::ranges::any_of(b.kind, [&](std::uint8_t kind) { return kind >= kinds; }))
        throw InputError(
            "the stored state is damaged or of another scene: its beads have radii that do not fit "
            "between the plates, or kinds that the scene does not have; start again or from an "
            "older checkpoint");
    constexpr auto wrong =
        "the stored state is damaged: {} has a position or motion that is not a number, or is more than {:g} "
        "boxes away; start again or from an older checkpoint";
    for (std::size_t i = 0; i < b.size(); ++i)
        if (!sound({b.x[i], b.y[i], b.z[i]}, {b.vx[i], b.vy[i], b.vz[i]}, {b.wx[i], b.wy[i], b.wz[i]},
                   problem.box))
            throw InputError(fmt::format(wrong, fmt::format("bead {}", i), furthest_image));
    for (std::size_t i = 0; i < state.rods.size(); ++i) {
        const RodBody& rod = state.rods[i];
        if (!sound(rod.position, rod.velocity, rod.angular_momentum, problem.box) ||
            !(std::abs(rod.orientation.norm() - 1.0) < 1e-6))
            throw InputError(fmt::format(wrong, fmt::format("rod {}", i), furthest_image));
    }
    if (problem.container) {
        // In a container: a state of another one.
        for (std::size_t i = 0; i < b.size(); ++i)
            if (const double radius = b.radius.empty() ? problem.bead_radius : b.radius[i];
                nearest_wall(*problem.container, {b.x[i], b.y[i]}, radius).depth > radius)
                throw InputError(
                    fmt::format("the stored state is damaged or of another container: bead {} is "
                                "outside the wall; start again or from an older checkpoint",
                                i));
    }
    impl_ = std::make_unique<Impl>(problem, state, tallies, threads);
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

void Simulation::advance(std::int64_t steps) {
    for (std::int64_t i = 0; i < steps && !impl_->failure; ++i)
        impl_->one_step(false, [](double StepTimes::*) {});
}

StepTimes& StepTimes::operator+=(const StepTimes& other) {
    for (const auto part : {&StepTimes::flight, &StepTimes::rods, &StepTimes::search, &StepTimes::impulses})
        this->*part += other.*part;
    steps += other.steps;
    return *this;
}

StepTimes Simulation::advance_timed(std::int64_t steps) {
    using Clock = std::chrono::steady_clock;
    StepTimes times;
    for (; times.steps < steps && !impl_->failure; ++times.steps) {
        auto before = Clock::now();
        impl_->one_step(true, [&](double StepTimes::*part) {
            const auto now = Clock::now();
            times.*part += std::chrono::duration<double>(now - before).count();
            before = now;
        });
    }
    return times;
}

std::int64_t Simulation::step() const { return impl_->step; }
double Simulation::time() const { return impl_->time(); }
bool Simulation::finished() const {
    return impl_->step >= impl_->problem.equilibration_steps + impl_->problem.steps;
}
const std::optional<Failure>& Simulation::failure() const { return impl_->failure; }
const GranularProblem& Simulation::problem() const { return impl_->problem; }
const Counters& Simulation::tallies() const { return impl_->tallies; }
const RodBody& Simulation::rod(std::size_t i) const { return impl_->bodies.rods[i].body(); }
Agitation Simulation::agitation() const { return agitation_of(impl_->bodies); }

Temperatures Simulation::far_temperatures(std::optional<std::size_t> kind) const {
    const Bodies& b = impl_->bodies;
    const PeriodicBox& box = impl_->problem.box;
    std::vector<std::pair<double, std::size_t>> far; // squared distance from the nearest rod, bead
    for (std::size_t i = 0; i < b.beads; ++i) {
        if (kind && (b.kind.empty() ? 0u : b.kind[i]) != *kind)
            continue;
        double nearest = HUGE_VAL;
        for (const MovingRod& rod : b.rods) {
            const Vector3 apart = row(b.position, i) - rod.body().position;
            nearest = std::min(nearest, std::pow(std::remainder(apart.x(), box.x), 2) +
                                            std::pow(std::remainder(apart.y(), box.y), 2));
        }
        far.emplace_back(nearest, i);
    }
    if (!b.rods.empty()) {
        std::ranges::sort(far, std::ranges::greater());
        far.resize(std::min(far.size(), std::max<std::size_t>(2, far.size() / 4)));
    }
    const double count = std::max(static_cast<double>(far.size()), 1.0);
    Vector3 mean = Vector3::Zero(), squares = Vector3::Zero();
    for (const auto& [distance, i] : far)
        mean += row(b.velocity, i) / count;
    for (const auto& [distance, i] : far)
        squares += (row(b.velocity, i) - mean).cwiseAbs2() / count;
    return {(squares.x() + squares.y()) / 2.0, squares.z()};
}

Energy Simulation::energy() const { return total_energy(impl_->bodies, impl_->problem.gravity); }

double Simulation::psi6(double cutoff) const {
    const Bodies& b = impl_->bodies;
    std::vector<double> x(b.beads), y(b.beads);
    for (std::size_t i = 0; i < b.beads; ++i) {
        x[i] = b.position[4 * i];
        y[i] = b.position[4 * i + 1];
    }
    LocalOrder order = bond_order(b.beads, bonds_within(x, y, impl_->problem.box, cutoff));
    if (const auto& container = impl_->problem.container) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < b.beads; ++i)
            if (nearest_wall(*container, {x[i], y[i]}, cutoff).depth <= 0.0)
                order.psi[kept++] = order.psi[i];
        order.psi.resize(kept);
    }
    return order.global();
}

State Simulation::state() const { return to_state(impl_->bodies, impl_->step); }

SimulationCost Simulation::cost() const { return impl_->finder.cost(); }

} // namespace rodwake::granular
