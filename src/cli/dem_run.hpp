#pragma once
// One granular run from its start, or from its checkpoint, to its files. Runs of an ensemble know nothing of
// each other.

#include "dem_checkpoint.hpp"
#include "log.hpp"
#include "measure_plan.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <functional>
#include <string>

namespace rodwake::cli {

/// What all runs of a scene share.
struct DemPlan {
    granular::GranularProblem problem;
    double order_cutoff = 0.0;
    std::string scene_key; ///< DemCheckpoint::scene
    std::string command;
    std::int64_t row_every = 1, frame_every = 1; ///< steps
    double checkpoint_every = 30.0;              ///< s of wall clock
    double stop_at_travel = 0.0;                 ///< m; 0: goes on to the end
    DemFormats formats;
    std::optional<granular::State> restart; ///< start = "restart"
    std::optional<MeasurePlan> measures;    ///< taken while the run goes on
    bool force = false;                     ///< do not take up checkpoints
};

/// One run: its number and where it goes.
struct DemTask {
    std::uint32_t run = 0;
    std::filesystem::path folder;
};

enum class DemEnd { finished, interrupted, failed };

/// Of one rod; SI, + is thin end first.
struct RodSummary {
    std::string kind;
    double mean_speed = 0.0, net_turn = 0.0;
    double force = 0.0; ///< on the beads along the heading, mean, N
};

struct DemSummary {
    std::uint32_t run = 0;
    double simulated_time = 0.0, cpu_seconds = 0.0, wall_seconds = 0.0;
    double T_xy = 0.0, T_z = 0.0, max_overlap = 0.0, psi6 = 0.0;
    std::vector<RodSummary> rods;
    granular::PairProgress pair{};
    std::uint64_t state_hash = 0;
};

struct DemResult {
    DemEnd end = DemEnd::finished;
    std::string message; ///< of a failure
    DemSummary summary;
};

/// `on_progress`: called every few steps; with the row where one was just added to the table.
DemResult
run_dem(const DemPlan& plan, const DemTask& task, const Logger& log, std::size_t threads,
        const std::function<void(const granular::Simulation&, const granular::TableRow*)>& on_progress);

} // namespace rodwake::cli
