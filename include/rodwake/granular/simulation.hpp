#pragma once
// A granular run, step by step.
//
// One step of length dt: every body flies freely (exactly: parabola, symmetric top); beads and rods that
// reach a plate bounce at the instant they touch it, as often as they do; pairs that overlap at the end of
// the step and approach get one impulse each, at the instant they touched, of several contacts of one rod
// with the same partner only the first. Impulses follow impact.hpp. A contact whose hop would be far shorter
// than a step rests on the plate. Order of the pairs, rules of rest and what the step costs:
// docs/numerics.md, section 5.
//
// Results do not depend on the number of threads, nor on interruptions: advancing by n and then by m steps
// equals advancing by n + m, and a simulation made from state() goes on with the same bits.

#include "rodwake/granular/observe.hpp"
#include "rodwake/granular/problem.hpp"
#include "rodwake/granular/state.hpp"

#include <memory>
#include <optional>
#include <string>

namespace rodwake::granular {

/// Sums over a run. All of them grow from zero at the start of the equilibration.
struct Counters {
    double floor_impulse = 0.0, lid_impulse = 0.0; ///< upward momentum the plates gave, N s (lid: negative)
    std::int64_t bead_bead = 0, bead_plate = 0, bead_rod = 0, rod_plate = 0, rod_rod = 0; ///< impulses given
    double wall_impulse = 0.0; ///< towards the inside, from the wall of a container to all bodies, N s
    std::int64_t bead_wall = 0, rod_wall = 0; ///< impulses given there
    std::int64_t overlaps = 0;                ///< pairs found overlapping, summed over steps
    double max_overlap = 0.0; ///< of a pair or a rod and a plate, in radii of the smaller sphere
    PlaneTensor virial{};     ///< sum over impulses between bodies, J: pressure() has the definition
    std::vector<Eigen::Vector3d> impulse_on_beads;    ///< momentum each rod gave to the beads, N s
    std::vector<Eigen::Vector3d> impulse_from_plates; ///< momentum each rod got from the plates, N s
};
using Tallies [[deprecated("it is Counters")]] = Counters;

/// Why a run cannot go on.
struct Failure {
    std::int64_t step = 0;
    std::string message; ///< which particles, how deep, the likely cause
};

/// How the work was done, for benchmarks and tests.
struct SimulationCost {
    std::size_t list_rebuilds = 0, list_refreshes = 0, outer_pairs = 0, inner_pairs = 0;
    double skin = 0.0; ///< m
};

/// What the parts of some steps took, s of wall time.
struct StepTimes {
    double flight = 0.0;   ///< beads fly and bounce off the plates
    double rods = 0.0;     ///< rods move, hit the plates, and take their spheres along
    double search = 0.0;   ///< which spheres overlap
    double impulses = 0.0; ///< between those
    std::int64_t steps = 0;

    StepTimes& operator+=(const StepTimes& other);
};

/// As many of `threads` as repay what they cost one run.
std::size_t worthwhile_threads(const GranularProblem& problem, std::size_t threads);

/// Name of the vector instructions in use, "AVX3".
const char* vector_target();

class Simulation {
public:
    /// From a start or a stored state. Throws InputError if the state does not fit the problem.
    Simulation(const GranularProblem& problem, const State& state, const Counters& tallies = {},
               std::size_t threads = 1);
    ~Simulation();
    Simulation(Simulation&&) noexcept;
    Simulation& operator=(Simulation&&) noexcept;

    /// Up to `steps` steps; ends early only by a failure.
    void advance(std::int64_t steps);
    /// The same steps to the bit, with their parts timed; reading the clock takes some per cent more.
    StepTimes advance_timed(std::int64_t steps);

    std::int64_t step() const;
    /// From t = 0 on, s; negative during the equilibration.
    double time() const;
    bool finished() const; ///< all steps of the problem are done
    const std::optional<Failure>& failure() const;

    const GranularProblem& problem() const;
    const Counters& tallies() const;
    State state() const;
    const RodBody& rod(std::size_t i) const;
    Agitation agitation() const;
    Temperatures temperatures() const { return agitation().temperatures; }
    /// The same of the quarter of the beads that is farthest from any rod; of all where there is no rod. Of
    /// the beads of one kind, if it is named.
    Temperatures far_temperatures(std::optional<std::size_t> kind = {}) const;
    Energy energy() const;
    /// |mean of psi_6| of the beads, neighbours nearer in the plane than the cut-off (core/bond_order.hpp).
    /// In a container of the beads further than that from the wall, which have all their neighbours; 0: none
    /// is.
    double psi6(double cutoff) const;
    SimulationCost cost() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace rodwake::granular
