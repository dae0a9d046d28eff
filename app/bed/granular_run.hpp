#pragma once
// One granular run from its start, or from its checkpoint, to its files. Runs of an ensemble know nothing of
// each other.

#include "granular_checkpoint.hpp"
#include "rodwake/app/plan.hpp"
#include "rodwake/core/estimate.hpp"
#include "rodwake/core/record.hpp"
#include "run/log.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

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

/// Of one rod; + is thin end first.
struct RodSummary {
    std::string kind;
    double mean_speed = 0.0, net_turn = 0.0, force = 0.0, thrust = 0.0;

    static constexpr auto fields() {
        using R = RodSummary;
        return std::tuple{
            field("kind", &R::kind, {"", "motile or apolar", OverRuns::same}),
            field("mean_speed", &R::mean_speed,
                  {"m/s", "of the rod along its heading, thin end first positive", OverRuns::mean, "=", "="}),
            field("net_turn", &R::net_turn, {"rad", "of the rod from t = 0 to the end"}),
            field("force", &R::force,
                  {"N", "of the rod on the beads along its heading, mean from t = 0", OverRuns::mean, "=",
                   "="}),
            field("thrust", &R::thrust,
                  {"N", "of the plates on the rod along its heading, mean from t = 0"})};
    }
};

/// What the beads of one kind did: temperatures in m^2/s^2, radius in m.
struct KindSummary {
    double radius = 0.0, beads = 0.0, T_xy = 0.0, T_z = 0.0;
    bool absorbing_state = false; ///< at the end

    static constexpr auto fields() {
        using R = KindSummary;
        return std::tuple{
            field("radius", &R::radius, {"m", "of the beads of the kind, in the scene", OverRuns::same, ""}),
            field("beads", &R::beads, {"1", "number of the beads of the kind", OverRuns::same, ""}),
            field("T_xy", &R::T_xy,
                  {"m^2/s^2", "(var vx + var vy)/2 of the beads of the kind, mean from t = 0", OverRuns::mean,
                   "T_xy_kind"}),
            field(
                "T_z", &R::T_z,
                {"m^2/s^2", "var vz of the beads of the kind, mean from t = 0", OverRuns::mean, "T_z_kind"}),
            field("absorbing_state", &R::absorbing_state,
                  {"", "whether the beads of the kind ended in step with the plates", OverRuns::left_out})};
    }
};

/// In the plane, mean from t = 0.
struct PressureSummary {
    double mean = unknown_error, xx = unknown_error, xy = unknown_error, yy = unknown_error;

    static constexpr auto fields() {
        using R = PressureSummary;
        return std::tuple{
            field("mean", &R::mean,
                  {"N/m", "of the bed in the plane, mean over directions and from t = 0", OverRuns::mean, "",
                   "pressure"}),
            field("xx", &R::xx,
                  {"N/m", "pressure along x in the plane, mean from t = 0", OverRuns::mean, "p_xx"}),
            field("xy", &R::xy,
                  {"N/m", "shear part of the pressure tensor, mean from t = 0", OverRuns::mean, "p_xy"}),
            field("yy", &R::yy, {"N/m", "pressure along y, mean from t = 0", OverRuns::mean, "p_yy"})};
    }
};

/// Of two rods; NaN: they have not come half a box.
struct PairSummary {
    double separation_change = 0.0, half_box_time = unknown_error, half_box_separation_change = unknown_error;

    static constexpr auto fields() {
        using R = PairSummary;
        return std::tuple{field("separation_change", &R::separation_change,
                                {"m", "of two rods across their mean first heading, outwards positive"}),
                          field("half_box_time", &R::half_box_time,
                                {.unit = "s",
                                 .meaning = "when the rods had come half a box (empty: they have not)",
                                 .over_runs = OverRuns::mean_of_known,
                                 .known_runs = "half_box_runs"}),
                          field("half_box_separation_change", &R::half_box_separation_change,
                                {"m", "separation change then", OverRuns::mean_of_known})};
    }
};

/// The summary of a run. A number is added here, and where it is computed (BedRun::summary); summary.json,
/// runs.csv, means over runs, scans of beds, catalogue and manifest follow.
struct GranularSummary {
    double simulated_time = 0.0, cpu_seconds = 0.0, wall_seconds = 0.0;
    double T_xy = 0.0, T_z = 0.0, max_overlap = 0.0, psi6 = 0.0;
    PressureSummary pressure;
    bool absorbing_state = false; ///< at the end
    std::vector<RodSummary> rods;
    std::optional<PairSummary> pair; ///< of two rods
    std::uint32_t run = 0;
    std::uint64_t state_hash = 0;
    double beads_fraction = 0.0; ///< of the beads that there are; written with what is the same of all runs
    RunCost cost{};
    std::vector<KindSummary> kinds{}; ///< empty if there is one kind; the files then have none

    static constexpr auto fields() {
        using R = GranularSummary;
        return std::tuple{
            field("simulated_time", &R::simulated_time,
                  {"s", "time simulated from t = 0", OverRuns::mean, "=", "time"}),
            field("cpu_seconds", &R::cpu_seconds, {"s", "processor time", OverRuns::sum}),
            field("wall_seconds", &R::wall_seconds,
                  {"s", "of the commands that worked on it", OverRuns::sum, ""}),
            field("T_xy", &R::T_xy,
                  {"m^2/s^2", "(var vx + var vy)/2 of the beads, mean from t = 0", OverRuns::mean, "=", "="}),
            field("T_z", &R::T_z,
                  {"m^2/s^2", "var vz of the beads, mean from t = 0", OverRuns::mean, "=", "="}),
            field("max_overlap", &R::max_overlap,
                  {"a", "largest overlap of two bodies, of the smaller radius", OverRuns::largest, "=", "="}),
            field("psi6", &R::psi6,
                  {"1", "mean from t = 0 of the column psi6 of table.csv", OverRuns::mean, "=", "="}),
            field("pressure", &R::pressure, {"N/m", "in the plane, mean from t = 0"}),
            field("absorbing_state", &R::absorbing_state,
                  {"", "whether the beads ended in step with the plates", OverRuns::left_out}),
            field("rods", &R::rods, {"", "of each rod", OverRuns::left_out}),
            field("pair", &R::pair, {"", "of two rods", OverRuns::left_out})};
    }
};
static_assert(undescribed_members<RodSummary>() == 0 && undescribed_members<KindSummary>() == 0 &&
                  undescribed_members<PressureSummary>() == 0 && undescribed_members<PairSummary>() == 0,
              "a number of a bed has its line in fields()");
static_assert(undescribed_members<GranularSummary>() == 5,
              "run, state_hash, beads_fraction, cost and kinds are written elsewhere; every other member of "
              "the summary has its line in fields()");

struct GranularResult {
    StageEnd end = StageEnd::finished;
    std::string message; ///< of a failure
    GranularSummary summary;
};

/// What trajectory.h5md says of itself.
store::H5mdInfo h5md_info(const BedPlan& bed, std::uint32_t run, double beads_fraction,
                          const std::string& command);

/// Writes summary.json of a run that is over once more, from its last state.
GranularSummary restore_summary(const GranularPlan& plan, const GranularTask& task);

/// `on_progress`: called every few steps; with the row where one was just added to the table.
GranularResult
run_granular(const GranularPlan& plan, const GranularTask& task, const RunContext& context, const Logger& log,
             std::size_t threads,
             const std::function<void(const granular::Simulation&, const granular::TableRow*)>& on_progress);

} // namespace rodwake::app
