#pragma once
// One granular run from its start, or from its checkpoint, to its files. Runs of an ensemble know nothing of
// each other.

#include "granular_checkpoint.hpp"
#include "rodwake/app/plan.hpp"
#include "run/log.hpp"

#include <filesystem>
#include <functional>
#include <string>

namespace rodwake::app {

/// Steps from one sample of temperatures and rods to the next. No divisor of the usual numbers of steps a
/// period (50, 100, 250, 500): samples then pass through every phase of the plates.
inline constexpr std::int64_t sample_every = 7;

/// What all runs of a bed share.
struct GranularPlan {
    BedPlan bed;
    std::string scene_key;                  ///< GranularCheckpoint::scene
    std::optional<granular::State> restart; ///< start = "restart"
};

/// One run: its number and where it goes.
struct GranularTask {
    std::uint32_t run = 0;
    std::filesystem::path folder;
};

/// Of one rod; SI, + is thin end first.
struct RodSummary {
    std::string kind;
    double mean_speed = 0.0, net_turn = 0.0;
    double force = 0.0;  ///< on the beads along the heading, mean, N
    double thrust = 0.0; ///< of the plates on the rod along the heading, mean, N
};

struct GranularSummary {
    std::uint32_t run = 0;
    double simulated_time = 0.0, cpu_seconds = 0.0, wall_seconds = 0.0;
    double T_xy = 0.0, T_z = 0.0, max_overlap = 0.0, psi6 = 0.0;
    granular::PlaneTensor pressure{}; ///< mean from t = 0, N/m; NaN: of an earlier version
    bool absorbing_state = false;     ///< at the end
    std::vector<RodSummary> rods;
    granular::PairProgress pair{};
    std::uint64_t state_hash = 0;
    RunCost cost{};
};

struct GranularResult {
    StageEnd end = StageEnd::finished;
    std::string message; ///< of a failure
    GranularSummary summary;
};

/// Writes summary.json of a run that is over once more, from its last state.
GranularSummary restore_summary(const GranularPlan& plan, const GranularTask& task);

/// `on_progress`: called every few steps; with the row where one was just added to the table.
GranularResult
run_granular(const GranularPlan& plan, const GranularTask& task, const RunContext& context, const Logger& log,
             std::size_t threads,
             const std::function<void(const granular::Simulation&, const granular::TableRow*)>& on_progress);

} // namespace rodwake::app
