#pragma once
// The stages of a run: each computes what the session's plan says and stores its results.

#include "rodwake/scan/mpi.hpp"
#include "session.hpp"

#include <string>

namespace rodwake::app {

/// [field]: grid and cuts into result.h5 (/field) and field_cut_<i>.csv.
StageEnd run_field_stage(Session& session);

/// [[rods]] and [[variants]]: rods.csv, outcome.json, variants/<name>/..., and /rods in result.h5.
StageEnd run_rods_stage(Session& session);

/// [rods_order]: rods_order.csv, clusters.csv, rods_order.json of the rods stage's rods.csv, or of the frames
/// of the bed.
StageEnd run_order_stage(Session& session);
/// Throws InputError if the order is that of rods of the theory and the folder holds no finished run of them.
void require_rods(const Plan& plan, const std::filesystem::path& folder);

/// The rods of the scene, or a sample of its scan, by every setting: tradeoff.csv, tradeoff.json. Goes on
/// with what it had tried when it was interrupted.
StageEnd run_tradeoff_stage(Session& session);

/// [granular]: summary.json, table.csv, tracks.csv, trajectory.h5md, ...; with runs > 1 one folder a run in
/// runs/.
StageEnd run_granular_stage(Session& session);
/// Throws InputError for beds that cannot be run, before anything is written or removed.
void require_granular(const Plan& plan, const std::filesystem::path& folder, const RunContext& context);
/// Throws InputError if the folder holds granular runs of another scene.
void require_same_beds(const scene::Scene& scene, const std::filesystem::path& folder);

/// [measure]: measure.json, measure.h5, profile_*.csv, ... of what [granular] ran, and of its variants.
StageEnd run_measure_stage(Session& session);

/// [fit]: fit.json, fit.txt, fit_profile_<i>.csv, ...; medium.json and the medium of the later stages with
/// medium.fitted.
StageEnd run_fit_stage(Session& session);

/// [scan]: ledger.sqlite, scan.csv, scan.h5, scan.json, cells.csv, boundary.csv; of beds scan_runs.csv, and
/// the runs in points/.
StageEnd run_scan_stage(Session& session);
/// On a rank of an MPI job but the first: evaluates points of the plan's scan.
void serve_scan(const Plan& plan, const std::filesystem::path& folder, const RunContext& context,
                scan::MpiJob& job);

} // namespace rodwake::app
