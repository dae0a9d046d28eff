#pragma once
// What the making of scans shares.

#include "bed/granular_jobs.hpp"
#include "rodwake/app/rods.hpp"
#include "rodwake/app/run_context.hpp"
#include "rodwake/app/scan.hpp"
#include "rodwake/app/scan_problem.hpp"
#include "rodwake/scan/ledger.hpp"
#include "rodwake/scan/run.hpp"

#include <array>
#include <filesystem>
#include <functional>
#include <vector>

namespace rodwake::app {

/// Points are not asked for their way, only for its end.
void leave_out_outputs(std::optional<scene::RodsRun>& run);

/// What points do not need is left out: they are copied for each thread, and validated never.
scene::Scene scan_base(const scene::Scene& scene);

scan::Columns columns_of_rods(const scene::Scene& scene);

// Of a scan of beds.
scan::Columns columns_of_beds(const scene::Scene& scene);
/// Cost of a run at each point, in steps of a sphere; 0 if the point is invalid: its evaluation reports the
/// error.
std::vector<double> costs_of_beds(const ScanPlan& plan);

// Points of a scan of beds: each is one granular run in a folder of its own, from which a run that was
// stopped goes on.

/// The folder of a run, below that of the scan: points/<point>/runs/<run>, both from 1.
std::filesystem::path bed_folder(const std::filesystem::path& scan, std::int64_t id);

/// The run whose file it is, seen from the folder of the scan; nothing for other files.
std::optional<std::int64_t> bed_of(const std::filesystem::path& file);

/// Runs points of a plan, which must outlive it, below this folder. What fails is not tried again with other
/// settings: a smaller step is another bed. One whose time is up keeps its checkpoint, and so goes on when it
/// is evaluated again.
scan::Evaluate evaluate_beds(const ScanPlan& plan, std::filesystem::path folder, RunContext context,
                             Logger log);

// Points of a scan of rods: each is one encounter.

/// Evaluates points of a plan, which must outlive it. A point whose rods start within the contact distance
/// is a contact at time 0. One that fails is tried again: with ten times the steps, with a
/// tenth of the tolerance, with the other kind of method; what was tried is in its cause. Times and lengths
/// in output units. With noise a point is an ensemble.
scan::Evaluate evaluate_rods(const ScanPlan& plan, std::function<bool()> stop);

/// One run, in the batch where the pair suits it and is not handed over: the end, its numbers and the final
/// state; on_step is given where steps end, also before a pair is handed over. `critical`: after more steps.
rods::RodResult run_rods(const scene::RodsRun& run, const rods::RodProblem& problem,
                         const rods::RodOptions& options, bool critical);

/// Design::side of two rods of an undecided end: the angle between their headings, signed. A pursuit so
/// narrow that it lies within a cell has rods that turn one way on its one side and the other way on the
/// other. The plan must outlive it; empty where nothing is known.
std::function<double(const scan::Result&)> side_of_pursuit(const ScanPlan& plan);

/// The encounter of a point with `times` output times spread over [0, end], as run for its result; with
/// noise another run of its ensemble's law.
rods::RodResult trajectory_of(const ScanPlan& plan, const scan::Result& result, std::size_t times);

// What a scan is asked for beside its scene, and what is there already: seen before anything is written.

scan::LedgerHead ledger_head(const ScanPlan& plan);

/// The ledgers of the shares below the folder of a scan.
std::vector<std::filesystem::path> shares_in(const std::filesystem::path& folder);

/// Throws InputError for shares of an adaptive scan, for a merge without shares, and for ledgers in the
/// folder or of its shares that are of another scan, of a newer version, or damaged.
void require_scan(const ScanPlan& plan, const std::filesystem::path& folder, const RunContext& context);

/// The rows of scan.file, beside the scene or where the program runs; nothing for other designs. Throws
/// InputError with file:line for what is missing or wrong.
std::optional<ScanList> read_scan_list(const scene::Scene& scene);

// The files of a scan, made from its ledger at the end and when it is interrupted. Memory: one column of
// doubles at a time, and what summary holds; a table of any length goes through row by row.

inline bool of_beds(const ScanPlan& plan) { return plan.subject == scene::ScanSubject::beds; }

/// Of the points that did not fail how many are known how well, by the number of the Certificate. Of an
/// adaptive scan its cells, as Summary::leaves, and their shares of the area: verified if no pair within ends
/// otherwise, checked if the corners agree and are verified or checked, else open.
struct ScanCertificates {
    std::array<std::int64_t, 3> points{};
    std::array<double, 3> area{};
    std::vector<Certificate> cells;
};
ScanCertificates certificates_of(const ScanPlan& plan, const scan::Ledger& ledger,
                                 const scan::Summary& summary, std::size_t threads);
/// "120 points verified, 3 checked, 0 open; of the area ..."
std::string certificates_text(const ScanCertificates& certificates);

/// scan.csv, scan.h5 (with the sample of trajectories), scan.json; cells.csv and boundary.csv where there are
/// cells and boundaries; of beds what scan_bed_results.hpp says. Throws RunError.
void write_scan(const std::filesystem::path& folder, const ScanPlan& plan, const scene::Scan& keys,
                const scan::Ledger& ledger, const scan::Counts& counts, const scan::Summary& summary,
                const ScanCertificates& certificates, double wall_seconds, std::size_t threads);

/// scan.csv, scan_runs.csv and scan.h5 with the same columns. Throws RunError.
void write_bed_results(const std::filesystem::path& folder, const ScanPlan& plan, const scan::Ledger& ledger);

} // namespace rodwake::app
