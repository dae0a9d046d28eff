#include "granular_jobs.hpp"
#include "granular_summary.hpp"
#include "rodwake/app/describe.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/granular/start.hpp"
#include "rodwake/scene/read.hpp"
#include "run/cost_parts.hpp"
#include "run/log.hpp"
#include "run/record_table.hpp"
#include "run/stage_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rodwake::app {

namespace {

double simulated_seconds(const std::vector<GranularJob>& jobs) {
    double sum = 0.0;
    for (const GranularJob& job : jobs)
        sum += simulated_seconds(job.of->plan);
    return sum;
}

/// Progress of all runs together, in simulated seconds, and of a single one a table of twenty rows.
class ProgressPrinter {
public:
    ProgressPrinter(const Session& session, const std::vector<GranularJob>& jobs)
        : log_(session.log), single_(jobs.size() == 1), of_one_(simulated_seconds(jobs.front().of->plan)),
          progress_(session.context, "dem", jobs.size(), simulated_seconds(jobs), "s") {}

    /// `simulation`: null of a run that another rank has finished.
    void update(std::size_t job, const granular::Simulation* simulation, const granular::TableRow* row,
                double whole) {
        if (!simulation) {
            progress_.update(job, whole);
            return;
        }
        const granular::Simulation& s = *simulation;
        const double time = static_cast<double>(s.step()) * s.problem().time_step;
        const bool due = progress_.update(job, time);
        if (!single_) // lines of several runs mix, and what follows belongs to one run
            return;
        if (!begun_ && s.step() > sample_every) // goes on from a checkpoint: rows as if it had not stopped
            pass(time);
        begun_ = true;
        if (due && row && time >= next_line_) {
            if (!headed_)
                log_->info("      t/s    energy/J       T_xy        T_z   psi6 contacts  floor/N s  overlap");
            log_->info("{:9.3f} {:11.4e} {:10.3e} {:10.3e} {:6.3f} {:8.1f} {:10.3e} {:8.4f}", row->t,
                       row->energy, row->T_xy, row->T_z, row->psi6, row->contacts, row->floor_impulse,
                       row->max_overlap);
            headed_ = true;
            pass(time);
        }
    }

private:
    void pass(double time) {
        while (next_line_ <= time)
            next_line_ += of_one_ / 20.0;
    }

    Logger log_;
    bool single_, begun_ = false, headed_ = false;
    double of_one_, next_line_ = 0.0;
    SharedProgress progress_;
};

StageEnd classify_outcome(const Session& session, const BedWork& work) {
    std::vector<GranularSummary> finished;
    StageEnd end = StageEnd::finished;
    const std::string name = work.of().suffix();
    for (std::size_t i = 0; i < work.results.size(); ++i) {
        const GranularResult& result = work.results[i];
        if (result.end == StageEnd::finished)
            finished.push_back(result.summary);
        if (result.end == StageEnd::failed)
            session.log->error("dem{}: run {}: {}", name, work.tasks[i].run + 1, result.message);
        if (result.end == StageEnd::interrupted && end == StageEnd::finished)
            end = StageEnd::interrupted;
        if (result.end == StageEnd::failed)
            end = StageEnd::failed;
    }
    const granular::Plates& plates = work.plan.bed.problem.plates;
    if (const auto count = std::ranges::count(finished, true, &GranularSummary::absorbing_state))
        session.log->warn(
            "dem{}: {} of {} runs ended in an absorbing state: the beads move in step with the plates and no "
            "longer move sideways, so T_xy falls to 0 and nothing is measured of a bed. Change "
            "granular.plates.frequency ({:g} Hz) or gamma ({:g}), or raise phi_b",
            name, count, finished.size(), plates.frequency, plates.gamma);
    for (std::size_t k = 0; !finished.empty() && k < finished[0].kinds.size(); ++k)
        if (const auto count = std::ranges::count_if(finished, [k](const GranularSummary& run) {
                return run.kinds[k].absorbing_state && !run.absorbing_state;
            }))
            session.log->warn("dem{}: in {} of {} runs the beads of kind {} (radius {:g} mm) ended in an "
                              "absorbing state: they "
                              "move in step with the plates and no longer sideways. Beads that nearly fill "
                              "the gap do so: widen "
                              "granular.plates.gap ({:g} mm), or change frequency ({:g} Hz) or gamma ({:g})",
                              name, count, finished.size(), k, 1e3 * finished[0].kinds[k].radius,
                              1e3 * plates.gap, plates.frequency, plates.gamma);
    if (work.results.size() == 1 && !finished.empty() && work.of().label.empty()) {
        const GranularSummary& s = finished[0];
        session.log->info("dem: {:.4g} s simulated in {:.3g} s of CPU; T_xy {:.4g}, T_z {:.4g} m^2/s^2, psi6 "
                          "{:.3f}, pressure "
                          "{:.4g} mN/m, largest overlap {:.4f} a",
                          s.simulated_time, s.cpu_seconds, s.T_xy, s.T_z, s.psi6, 1e3 * s.pressure.mean,
                          s.max_overlap);
        for (std::size_t i = 0; i < s.rods.size(); ++i)
            session.log->info("dem: rod {} ({}): {:.4g} mm/s thin end first, turned by {:.4g} rad", i,
                              s.rods[i].kind, 1e3 * s.rods[i].mean_speed, s.rods[i].net_turn);
    }
    if (work.results.size() > 1 && !finished.empty()) {
        session.directory.write(work.of().folder + "summary.json",
                                ensemble_json(work.plan.bed, finished, work.results.size()));
        session.directory.write(work.of().folder + "runs.csv", ensemble_csv(work.plan.bed.problem, finished));
        session.log->debug("dem{}: {} of {} runs finished; runs.csv and summary.json have the means", name,
                           finished.size(), work.results.size());
    }
    return end;
}

std::string text_of(const PeriodicBox& box) { return fmt::format("{:.10g} x {:.10g} m", box.x, box.y); }

std::string text_of(const granular::RodShape& s) {
    return fmt::format("{:.10g} m long, {:.10g} and {:.10g} m thick, of {} spheres and {:g} kg/m^3", s.length,
                       s.thick_diameter, s.thin_diameter, s.spheres, s.density);
}

std::string text_of(const granular::BeadMix& mix) {
    std::string text = mix.kinds.empty() ? fmt::format("{:.10g} m", mix.radius) : std::string();
    for (const granular::BeadKind& kind : mix.kinds)
        text += fmt::format("{}{:.10g} m (share {:g})", text.empty() ? "" : ", ", kind.radius, kind.share);
    return mix.spread > 0.0 ? fmt::format("{} with a spread of {:g}", text, mix.spread) : text;
}

/// A stored bed goes on in its own box only, and where its rods were it has holes of their shape.
void require_like(const std::string& file, const granular::GranularProblem& stored,
                  const granular::GranularProblem& wanted) {
    const auto require = [&](bool alike, const char* what, const auto& stands, const auto& asked) {
        if (!alike)
            throw InputError(fmt::format(
                "{}: granular.start = \"restart\": {} {} there and {} in the scene: make the scene like "
                "the stored bed, or take another one or start = \"lattice\" or \"random\"",
                file, what, stands, asked));
    };
    const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); };
    const PeriodicBox &there = granular::bed_sides(stored), &here = granular::bed_sides(wanted);
    require(near(there.x, here.x) && near(there.y, here.y), "the box is", text_of(there), text_of(here));
    const auto room = [](const granular::GranularProblem& p) {
        return !p.container                                           ? "a periodic box"
               : p.container->kind == granular::ContainerKind::circle ? "a circle"
                                                                      : "a rectangle";
    };
    require(std::string_view(room(stored)) == room(wanted), "the bed is in", room(stored), room(wanted));
    require(near(stored.bead_radius, wanted.bead_radius), "bead_radius is",
            fmt::format("{:.10g} m", stored.bead_radius), fmt::format("{:.10g} m", wanted.bead_radius));
    const granular::BeadMix sizes = granular::bead_mix(stored), asked = granular::bead_mix(wanted);
    require(sizes.kinds == asked.kinds && sizes.spread == asked.spread, "radii of the beads are",
            text_of(sizes), text_of(asked));
    const std::size_t rods = stored.rods.size();
    require(rods == 0 || rods == wanted.rods.size(), "the number of rods is", rods, wanted.rods.size());
    for (std::size_t i = 0; i < rods; ++i)
        require(stored.rods[i].shape == wanted.rods[i].shape, "a rod is", text_of(stored.rods[i].shape),
                text_of(wanted.rods[i].shape));
    require(stored.beads >= wanted.beads, "beads can be taken out but not added; their number is",
            stored.beads, wanted.beads);
}

} // namespace

void require_same_beds(const scene::Scene& scene, const std::filesystem::path& folder) {
    for (const Case& case_ : bed_cases(scene))
        for (const GranularTask& task : granular_tasks(case_, folder))
            require_same_run(task, granular_key(case_.scene));
}

namespace {

/// Beds that can be run, over nothing that is to be kept.
void require_granular(const Plan& plan, const std::filesystem::path& folder, const RunContext& context) {
    if (!context.force)
        require_same_beds(plan.scene, folder);
    for (const BedPlan& item : plan.beds) {
        const scene::Granular& bed = *item.of.scene.granular;
        if (bed.start == scene::GranularStart::file)
            granular::make_start(item.problem, 0); // refuses beads that overlap
        if (bed.start != scene::GranularStart::restart)
            continue;
        const std::string stored = stored_checkpoint(bed.restart_from).checkpoint.scene;
        require_like(bed.restart_from, granular_problem(scene::parse_scene(stored, bed.restart_from)),
                     item.problem);
        const auto below = std::filesystem::weakly_canonical(bed.restart_from)
                               .lexically_relative(std::filesystem::weakly_canonical(folder));
        if (!below.empty() && *below.begin() != "..")
            throw InputError(bed.restart_from + ": granular.restart_from lies in " + folder.string() +
                             ", where this run would replace it; choose another folder with -o");
    }
}

StageEnd run_granular(Session& session) {
    std::vector<BedWork> all = beds_of(session.plan, session.directory.path(), session.log);
    const std::vector<GranularJob> jobs = jobs_of(all);
    for (const BedWork& work : all) {
        const granular::GranularProblem& p = work.plan.bed.problem;
        session.log->info("dem{}: beads {}, which cover {:.4f} of the box, rods {}, phi_b = {:.4g}, runs {}, "
                          "steps {} + {} of "
                          "{:g} s; {} instructions",
                          work.of().suffix(), p.beads, granular::bead_area_fraction(p), p.rods.size(),
                          phi_b(work.plan.bed), work.tasks.size(), p.equilibration_steps, p.steps,
                          p.time_step, granular::vector_target());
        if (const std::string advice = output_advice(work.plan.bed); !advice.empty())
            session.log->warn("dem{}: {}", work.of().suffix(), advice);
    }
    if (session.context.executor && jobs.size() == 1)
        session.log->warn("dem: there is one run, so one rank computes it on one thread and the others wait");
    ProgressPrinter progress(session, jobs);
    execute_jobs(jobs, session.context, session.log,
                 [&](std::size_t job, const granular::Simulation* s, const granular::TableRow* row) {
                     progress.update(job, s, row, simulated_seconds(jobs[job].of->plan));
                 });
    StageEnd end = StageEnd::finished;
    for (const BedWork& work : all)
        if (const StageEnd of_bed = classify_outcome(session, work); of_bed != StageEnd::finished)
            end = of_bed == StageEnd::failed || end == StageEnd::finished ? of_bed
                                                                          : end; // a failure weighs more
    // The cost is that of all finished runs, whichever command made them.
    RunCost sum;
    std::size_t runs = 0;
    for (const BedWork& bed : all)
        for (const GranularResult& result : bed.results)
            if (result.end == StageEnd::finished) {
                sum += result.summary.cost;
                ++runs;
            }
    if (sum.particle_steps > 0.0)
        for (const std::string& line : cost_lines(sum, runs))
            session.log->debug("{}{}", line.starts_with(' ') ? "" : "dem: cost ", line);
    return end;
}

std::vector<FileKind> granular_files() {
    using enum Lifetime;
    static const std::vector<ColumnInfo> runs = runs_columns(), summary = summary_values();
    return {{"table.csv", kept, "energy, temperatures, order, contacts against time",
             columns_of<granular::TableRow>()},
            {"tracks.csv", kept, "rods of the bed against time",
             columns_of<granular::RowTime, Each<granular::TrackPoint>>()},
            {"trajectory.h5md", kept, "positions and velocities of all spheres in every stored frame"},
            {"trajectory.xyz", kept, "the same as extended XYZ"},
            {"last_period.h5md", kept, "frames of the last period of the plates"},
            {"final.rwc", kept, "last state, for granular.restart_from"},
            {"archive.rwc", kept, "states at even intervals, for rodwake replay"},
            {"measure.rwc", kept, "sums of the measures over the frames of the run"},
            {"checkpoint.rwc", progress, "state to resume from"},
            {"checkpoint.rwc.previous", progress, "the state before, in case that one is damaged"},
            {"rows.log", progress, "rows of the tables so far"},
            {"frames.log", progress, "frames so far"},
            {"archive.log", progress, "states for the archive so far"},
            {"last_period.log", progress, "frames of the last period so far"},
            {"runs.csv", kept, "one row per run of the ensemble", runs},
            {"summary.json", kept,
             "means of the run, of an ensemble with their errors; SI; cost by part in seconds of wall clock; "
             "seconds of an ensemble are sums over its runs",
             summary}};
}

} // namespace

StageKind granular_stage() {
    return {.stage = Stage::granular,
            .has_table = [](const scene::Scene& s) { return s.granular.has_value(); },
            .wanted =
                [](const scene::Scene& s) { // frames from elsewhere need no run, a scan makes its own
                    const bool foreign = s.measure && !s.measure->trajectory.empty();
                    return s.granular && !foreign && scan_subject(s) != scene::ScanSubject::beds;
                },
            .key = [](const scene::Scene& s) { return key_of_beds(s); },
            .files = granular_files,
            .run = run_granular,
            .serve = serve_beds,
            .require = require_granular,
            .cost = [](const Plan& plan, const std::filesystem::path&,
                       const RunContext&) { return bed_cost(plan); },
            .grows = wants_more_runs};
}

} // namespace rodwake::app
