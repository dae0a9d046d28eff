#include "rodwake/app/replay.hpp"

#include "granular_jobs.hpp"
#include "measure_frames.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/granular/start.hpp"
#include "rodwake/scene/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using granular::Simulation, granular::State;

/// Of a folder, or of the file itself; a run without an archive has its last state alone.
GranularArchive archive_of(const fs::path& run) {
    if (fs::is_regular_file(run))
        return load_archive(run);
    if (!fs::is_directory(run))
        throw InputError(run.string() + ": no such run directory; rodwake dem SCENE makes one");
    if (fs::exists(run / "archive.rwc"))
        return load_archive(run / "archive.rwc");
    if (fs::is_directory(run / "runs"))
        throw InputError(fmt::format("{}: holds several runs; name one of them, {} for example", run.string(),
                                     run_folder(run, 0).string()));
    auto last = load_checkpoint(run / "final.rwc");
    if (!last)
        throw InputError(run.string() + ": holds no finished granular run (archive.rwc or final.rwc)");
    GranularCheckpoint& c = last->checkpoint;
    return {c.scene, c.build, c.seed, c.run, {std::move(c.state)}};
}

/// A run, and where it can be taken up.
struct ArchivedRun {
    GranularArchive archive;
    BedPlan bed;

    explicit ArchivedRun(const fs::path& run)
        : archive(archive_of(run)), bed{{"scene", "", "", scene::parse_scene(archive.scene, run.string())},
                                        {},
                                        {},
                                        {}} {
        const std::string& file = bed.of.scene.granular->start_file;
        if (!file.empty() && granular_key(bed.of.scene) != archive.scene)
            throw InputError(
                fmt::format("{}: granular.start_file = \"{}\" is not the file that the run began from; "
                            "put that one back",
                            run.string(), file));
        bed.problem = granular_problem(bed.of.scene);
        bed.problem.seed = archive.seed;
        bed.schedule = granular_schedule(*bed.of.scene.granular, bed.problem);
        require_end(end(), bed.problem, run.string());
        const State& last = archive.states.back();
        if (last.beads.size() != bed.problem.beads || last.rods.size() != bed.problem.rods.size())
            throw InputError(fmt::format("{}: is damaged: {} beads and {} rods, and its scene has {} and {}",
                                         run.string(), last.beads.size(), last.rods.size(), bed.problem.beads,
                                         bed.problem.rods.size()));
    }

    std::int64_t end() const { return archive.states.back().step; }
    double time(std::int64_t step) const {
        return static_cast<double>(step - bed.problem.equilibration_steps) * bed.problem.time_step;
    }
    /// The start; nothing for one that went on from another run's last state.
    std::optional<State> start() const {
        if (bed.of.scene.granular->start == scene::GranularStart::restart)
            return std::nullopt;
        return granular::make_start(bed.problem, archive.run);
    }
    /// The last state at or before the step.
    State state(std::int64_t step) const {
        if (const State* kept = archive.before(step))
            return *kept;
        if (auto first = start())
            return std::move(*first);
        throw InputError(
            "this run went on from another one (granular.start = \"restart\") and kept no states; "
            "run it again with granular.output.archive");
    }
};

/// Throws RunError for a run that fails on the way; false if it was stopped.
bool advance(Simulation& simulation, std::int64_t step, const RunContext& context) {
    constexpr std::int64_t at_once = 1000;
    while (simulation.step() < step) {
        if (context.stopped())
            return false;
        simulation.advance(std::min(at_once, step - simulation.step()));
        if (simulation.failure())
            throw RunError(fmt::format("replay: {}; the run itself went on here: other bits",
                                       simulation.failure()->message));
    }
    return true;
}

} // namespace

Replayed replay(const fs::path& run, const ReplayRequest& request, const fs::path& folder,
                const RunContext& context) {
    const ArchivedRun kept(run);
    const granular::GranularProblem& p = kept.bed.problem;
    const auto step_at = [&](double time) {
        return p.equilibration_steps + std::llround(time / p.time_step);
    };
    const double last = kept.time(kept.end()), to = request.to.value_or(last);
    if (!(request.from >= 0.0 && request.from <= to && to <= last + 0.5 * p.time_step))
        throw InputError(fmt::format("replay: from {:g} s to {:g} s: the run goes from 0 to {:g} s",
                                     request.from, to, last));
    const double interval = request.interval.value_or(frame_interval(*kept.bed.of.scene.granular));
    if (!(interval >= p.time_step && std::isfinite(interval)))
        throw InputError(
            fmt::format("replay: frames {:g} s apart: at least a step, {:g} s", interval, p.time_step));
    const std::int64_t first = step_at(request.from), end = step_at(to),
                       every = std::llround(interval / p.time_step);
    Simulation simulation(p, kept.state(first), {}, granular::worthwhile_threads(p, context.thread_count()));
    Replayed done;
    done.begun_at = kept.time(simulation.step());
    done.file = folder / "trajectory.h5md";
    GranularSchedule schedule = kept.bed.schedule;
    schedule.h5md = true;
    schedule.xyz = schedule.last_period = false;
    schedule.archive_every = 0;
    GranularFiles files(folder, p, simulation.state(), schedule, {});
    Progress progress(context, "replay", kept.time(end) - done.begun_at, "s");
    done.from = kept.time(first);
    for (std::int64_t step = first; step <= end; step += every) {
        if (!advance(simulation, step, context)) {
            remove_progress(folder);
            done.interrupted = true;
            return done;
        }
        files.add_frame(simulation.state(), simulation.time());
        ++done.frames;
        done.to = simulation.time();
        progress.update(done.to - done.begun_at);
    }
    done.state_hash = granular::state_hash(simulation.state());
    const double share = granular::bead_area_fraction(kept.bed.problem, simulation.state().beads.radius);
    files.finish_frames(h5md_info(kept.bed, kept.archive.run, share, context.command));
    remove_progress(folder);
    return done;
}

namespace {

/// Nothing if both are the same bits.
std::string difference(const State& made, const State& stored) {
    if (granular::state_hash(made) == granular::state_hash(stored))
        return "";
    const granular::Beads &a = made.beads, &b = stored.beads;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a.x[i] != b.x[i] || a.y[i] != b.y[i] || a.z[i] != b.z[i] || a.vx[i] != b.vx[i] ||
            a.vy[i] != b.vy[i])
            return fmt::format("bead {} is at ({:.17g}, {:.17g}) m, and was at ({:.17g}, {:.17g}) m", i,
                               a.x[i], a.y[i], b.x[i], b.y[i]);
    return "spins or rods differ";
}

} // namespace

Verified verify(const fs::path& run, const RunContext& context) {
    const ArchivedRun kept(run);
    std::vector<State> from = kept.archive.states;
    if (auto first = kept.start(); first && first->step < from.front().step)
        from.insert(from.begin(), std::move(*first));
    Verified result{false, from.size() - 1, {}};
    std::vector<std::string> found(result.stretches);
    SharedProgress progress(context, "replay", result.stretches, static_cast<double>(result.stretches),
                            "stretches");
    std::atomic<bool> stopped = false;
    parallel_for(result.stretches, context.thread_count(), [&](std::size_t i) {
        Simulation simulation(kept.bed.problem, from[i]);
        if (!advance(simulation, from[i + 1].step, context)) {
            stopped = true;
            return;
        }
        if (const std::string what = difference(simulation.state(), from[i + 1]); !what.empty())
            found[i] = fmt::format("between t = {:g} s and {:g} s: {}", kept.time(from[i].step),
                                   kept.time(from[i + 1].step), what);
        progress.update(i, 1.0);
    });
    result.interrupted = stopped;
    if (const auto first = std::ranges::find_if(found, [](const std::string& text) { return !text.empty(); });
        first != found.end())
        result.differs = *first;
    return result;
}

std::optional<measure::Measures> measure_archive(const fs::path& file, const MeasurePlan& plan,
                                                 const std::function<bool(double)>& on_progress) {
    const ArchivedRun kept(file);
    const granular::GranularProblem& p = kept.bed.problem;
    RunContext context;
    bool stopped = false;
    context.stop = [&] { return stopped; };
    Simulation simulation(p, kept.state(p.equilibration_steps));
    measure::Measures measures = plan.sums;
    measure::Frame frame;
    for (std::int64_t step = p.equilibration_steps; step <= kept.end() && !stopped; step += plan.every) {
        advance(simulation, step, context);
        fill_frame(frame, simulation.state(), simulation.time(), p.box, measures.layout());
        measures.add(frame);
        stopped =
            !on_progress(static_cast<double>(step - p.equilibration_steps) /
                         static_cast<double>(std::max<std::int64_t>(1, kept.end() - p.equilibration_steps)));
    }
    return stopped ? std::nullopt : std::optional(std::move(measures));
}

} // namespace rodwake::app
