#include "granular_run.hpp"

#include "granular_summary.hpp"
#include "measure_frames.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/granular/start.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/generations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

namespace rodwake::app {

namespace {

using granular::Simulation;

double cpu_now(bool own_thread_only) {
    timespec t{};
    clock_gettime(own_thread_only ? CLOCK_THREAD_CPUTIME_ID : CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::string build_name() {
    const BuildInfo build = build_info();
    return build.version + " " + build.git;
}

/// The next multiple of `every` after `step`; steps may be negative.
std::int64_t next_multiple(std::int64_t step, std::int64_t every) {
    const std::int64_t below = step >= 0 ? step / every : -((-step + every - 1) / every);
    return (below + 1) * every;
}

/// Steps counted from t = 0 at which a frame of the last plate period is due.
struct LastPeriod {
    std::int64_t from, every;

    LastPeriod(const granular::GranularProblem& p) {
        const auto period = std::max<std::int64_t>(1, std::llround(1.0 / (p.plates.frequency * p.time_step)));
        every = std::max<std::int64_t>(1, (period + period_frames / 2) / period_frames);
        from = std::max<std::int64_t>(0, p.steps - period);
    }
};

/// States of the archive up to this step of the simulation: the start, and each interval counted from t = 0.
std::size_t states_until(std::int64_t step, const BedPlan& bed) {
    const std::int64_t every = bed.schedule.archive_every, first = -bed.problem.equilibration_steps;
    if (every == 0)
        return 0;
    std::size_t count = 1;
    for (std::int64_t at = next_multiple(first, every); at <= step + first; at += every)
        ++count;
    return count;
}

class BedRun {
public:
    BedRun(const GranularPlan& plan, const GranularTask& task, const RunContext& context, const Logger& log,
           std::size_t threads, bool is_over = false)
        : context_(context), requests_seen_(requests()), plan_(plan), bed_(plan.bed), task_(task), log_(log),
          checkpoint_file_(task.folder / (is_over ? "final.rwc" : "checkpoint.rwc")),
          meter_(plan.bed.problem), one_thread_(threads == 1), loaded_(load()),
          simulation_(plan.bed.problem, first_state(), loaded_ ? loaded_->tallies : granular::Counters{},
                      granular::worthwhile_threads(plan.bed.problem, threads)),
          record_(plan.bed.schedule.order_cutoff, plan.bed.problem.rods.size()),
          files_(task.folder, plan.bed.problem, simulation_.state(), plan.bed.schedule,
                 loaded_ && !is_over ? loaded_->logs : LogLengths{},
                 loaded_ && !is_over ? states_until(loaded_->state.step, plan.bed) : 0),
          period_(plan.bed.problem), measures_(first_measures()), cpu_start_(cpu_now(one_thread_)),
          wall_start_(Clock::now()), saved_(wall_start_) {
        meter_.mark(&RunCost::start);
        if (loaded_)
            record_.restore(loaded_->sums, loaded_->pressure, loaded_->progress, loaded_->thrust,
                            loaded_->kinds);
        else
            observe(); // the start itself is the first sample, row and, without equilibration, frame
    }

    GranularResult go(const std::function<void(const Simulation&, const granular::TableRow*)>& on_progress) {
        on_progress_ = &on_progress;
        while (!simulation_.finished() && !travelled()) {
            // Up to the next step at which something is due.
            const GranularSchedule& due = bed_.schedule;
            const std::int64_t now = step();
            std::int64_t next = std::min(
                {next_multiple(now, sample_every), next_multiple(now, due.row_every), bed_.problem.steps});
            if (now < 0)
                next = std::min(next, std::int64_t{0});
            else
                next = std::min({next, next_multiple(now, due.frame_every),
                                 now < period_.from
                                     ? period_.from
                                     : period_.from + next_multiple(now - period_.from, period_.every)});
            if (measures_ && now >= 0)
                next = std::min(next, next_multiple(now, bed_.measures->every));
            if (due.archive_every > 0)
                next = std::min(next, next_multiple(now, due.archive_every));
            meter_.advance(simulation_, next - now);
            if (simulation_.failure()) {
                // what led there can be looked at; the last good checkpoint stays
                files_.sync();
                files_.write_tables();
                return {StageEnd::failed, simulation_.failure()->message, summary()};
            }
            observe();
            on_progress(simulation_, nullptr);
            if (context_.stopped()) {
                checkpoint();
                return {StageEnd::interrupted, {}, summary()};
            }
            if (requests() != requests_seen_ ||
                seconds_since(saved_) > bed_.of.scene.granular->output.checkpoint)
                checkpoint();
        }
        return finish();
    }

    /// Of a run that is over.
    GranularSummary restore_summary() {
        remove_progress(task_.folder);
        GranularSummary done = summary();
        write_summary(done);
        return done;
    }

private:
    using Clock = std::chrono::steady_clock;
    static double seconds_since(Clock::time_point t) {
        return std::chrono::duration<double>(Clock::now() - t).count();
    }

    int requests() const { return context_.checkpoint_requests ? context_.checkpoint_requests() : 0; }

    std::optional<GranularCheckpoint> load() const {
        if (context_.force) {
            store::remove_generations(checkpoint_file_);
            return std::nullopt;
        }
        auto loaded = load_checkpoint(checkpoint_file_);
        if (!loaded)
            return std::nullopt;
        const GranularCheckpoint& c = loaded->checkpoint;
        if (c.scene != plan_.scene_key || c.seed != bed_.problem.seed || c.run != task_.run)
            throw InputError(checkpoint_file_.string() + ": belongs to another scene, seed or run; choose "
                                                         "another folder with -o, or --force to start anew");
        require_end(c.state.step, bed_.problem, checkpoint_file_.string());
        if (!loaded->notice.empty())
            log_->warn("{}", loaded->notice);
        if (c.build != build_name())
            log_->warn("{}: written by rodwake {}; this is {}, and digits may differ",
                       checkpoint_file_.string(), c.build, build_name());
        log_->debug("run {}: resuming from step {}", task_.run, c.state.step);
        return std::move(loaded->checkpoint);
    }

    granular::State first_state() const {
        if (loaded_)
            return loaded_->state;
        return plan_.restart ? granular::restart_from(bed_.problem, *plan_.restart, task_.run)
                             : granular::make_start(bed_.problem, task_.run);
    }

    std::optional<measure::Measures> first_measures() const {
        if (!bed_.measures)
            return std::nullopt;
        measure::Measures measures = bed_.measures->sums;
        if (loaded_) {
            if (loaded_->measure_keys != bed_.measures->key_text)
                throw InputError(checkpoint_file_.string() +
                                 ": this run was begun with other [measure] keys; restore them to resume it, "
                                 "or --force to start again");
            measures.load(loaded_->measures, checkpoint_file_.string());
        }
        return measures;
    }

    /// From t = 0 on.
    std::int64_t step() const { return simulation_.step() - bed_.problem.equilibration_steps; }

    bool travelled() const {
        return bed_.schedule.stop_at_travel > 0.0 && record_.mean_advance() >= bed_.schedule.stop_at_travel;
    }

    void observe() {
        const std::int64_t now = step();
        const bool at_start = !loaded_ && simulation_.step() == 0;
        if (now % sample_every == 0 || now == 0 || now == bed_.problem.steps)
            record_.sample(simulation_);
        if (now % bed_.schedule.row_every == 0 || now == bed_.problem.steps || at_start)
            add_row();
        meter_.mark(&RunCost::records);
        if (now >= 0 && (now % bed_.schedule.frame_every == 0))
            files_.add_frame(simulation_.state(), simulation_.time());
        if (now >= period_.from && (now - period_.from) % period_.every == 0) // never before 0
            files_.add_period_frame(simulation_.state(), simulation_.time());
        if (bed_.schedule.archive_every > 0 && (now % bed_.schedule.archive_every == 0 || at_start))
            files_.keep(simulation_.state());
        meter_.mark(&RunCost::output);
        if (measures_ && now >= 0 && now % bed_.measures->every == 0) {
            fill_frame(frame_, simulation_.state(), simulation_.time(), bed_.problem.box,
                       measures_->layout());
            measures_->add(frame_);
            meter_.mark(&RunCost::measures);
        }
    }

    void add_row() {
        const std::vector<granular::TrackPoint> track = record_.track(simulation_);
        const granular::TableRow row = record_.row(simulation_);
        files_.add_row(row, track);
        if (on_progress_)
            (*on_progress_)(simulation_, &row);
    }

    double cpu_seconds() const {
        return cpu_now(one_thread_) - cpu_start_ + (loaded_ ? loaded_->cpu_seconds : 0.0);
    }
    double wall_seconds() const {
        return seconds_since(wall_start_) + (loaded_ ? loaded_->wall_seconds : 0.0);
    }

    /// Of this command and those before it.
    RunCost cost() const {
        RunCost all = meter_.cost();
        return loaded_ ? all += loaded_->cost : all;
    }

    void checkpoint() {
        requests_seen_ = requests();
        GranularCheckpoint c{plan_.scene_key,     build_name(),
                             bed_.problem.seed,   task_.run,
                             cpu_seconds(),       wall_seconds(),
                             simulation_.state(), simulation_.tallies(),
                             record_.sums(),      record_.pressure_sums(),
                             record_.rods(),      record_.thrust(),
                             record_.kinds(),     files_.sync()};
        if (measures_) {
            c.measure_keys = bed_.measures->key_text;
            c.measures = measures_->save();
        }
        c.cost = cost();
        write_checkpoint(checkpoint_file_, c);
        saved_ = Clock::now();
        meter_.mark(&RunCost::output);
    }

    GranularResult finish() {
        if (record_.sums().row_step !=
            simulation_.step()) // stopped by its travel: the tables have the end too
            add_row();
        GranularSummary done = summary();
        checkpoint();
        // until the last checkpoint goes, a crash costs nothing: the same command does this again
        files_.write_tables();
        files_.finish_frames(h5md_info(bed_, task_.run, done.beads_fraction, context_.command));
        if (bed_.schedule.archive_every > 0) {
            GranularArchive all{plan_.scene_key, build_name(), bed_.problem.seed, task_.run,
                                files_.kept_states()};
            if (all.states.empty() || all.states.back().step != simulation_.step())
                all.states.push_back(simulation_.state());
            write_archive(task_.folder / "archive.rwc", all);
        }
        if (measures_)
            write_records(task_.folder / "measure.rwc", *bed_.measures, *measures_);
        meter_.mark(&RunCost::output);
        done.cost = cost();
        write_summary(done);
        std::filesystem::rename(checkpoint_file_, task_.folder / "final.rwc");
        store::sync_folder_of(checkpoint_file_); // before anything that made it goes
        remove_progress(task_.folder);
        return {StageEnd::finished, {}, std::move(done)};
    }

    void write_summary(const GranularSummary& done) const {
        store::write_atomically(task_.folder / "summary.json", summary_json(bed_, done));
    }

    GranularSummary summary() const {
        const granular::RecordSums& sums = record_.sums();
        const double samples = static_cast<double>(std::max<std::int64_t>(sums.run.count, 1));
        GranularSummary s;
        s.run = task_.run;
        s.simulated_time = std::max(simulation_.time(), 0.0);
        s.cpu_seconds = cpu_seconds();
        s.wall_seconds = wall_seconds();
        s.T_xy = sums.run.T_xy / samples;
        s.T_z = sums.run.T_z / samples;
        s.max_overlap = simulation_.tallies().max_overlap;
        s.psi6 = sums.rows > 0 ? sums.psi6 / static_cast<double>(sums.rows) : 0.0;
        const granular::PlaneTensor pressure = record_.mean_pressure(simulation_);
        s.pressure = {granular::isotropic(pressure), pressure[0], pressure[1], pressure[2]};
        s.absorbing_state = granular::in_absorbing_state(simulation_.far_temperatures(), bed_.problem);
        const granular::State state = simulation_.state();
        for (std::size_t k = 0; k < record_.kinds().size(); ++k) {
            const granular::SampleSums& of_kind = record_.kinds()[k];
            const double count = static_cast<double>(std::max<std::int64_t>(of_kind.count, 1));
            const auto beads = std::ranges::count(state.beads.kind, k); // restarts take some out
            // one alone has no temperature about its own mean
            const bool still =
                beads > 1 && granular::in_absorbing_state(simulation_.far_temperatures(k), bed_.problem);
            s.kinds.push_back({bed_.problem.bead_kinds[k].radius, static_cast<double>(beads),
                               of_kind.T_xy / count, of_kind.T_z / count, still});
        }
        for (std::size_t i = 0; i < bed_.problem.rods.size(); ++i) {
            const granular::RodProgress& p = record_.rods()[i];
            RodSummary& rod = s.rods.emplace_back();
            rod.kind = bed_.problem.rods[i].shape.kind == granular::RodKind::motile ? "motile" : "apolar";
            if (!(s.simulated_time > 0.0))
                continue;
            rod.mean_speed = p.travelled / s.simulated_time;
            rod.net_turn = p.heading - p.heading0;
            rod.force = p.impulse_on_beads / s.simulated_time;
            rod.thrust = record_.thrust()[i].impulse / s.simulated_time;
        }
        if (s.rods.size() == 2) {
            s.pair.emplace().separation_change = sums.pair.change;
            if (sums.pair.half_box_time >= 0.0) {
                s.pair->half_box_time = sums.pair.half_box_time;
                s.pair->half_box_separation_change = sums.pair.half_box_change;
            }
        }
        s.state_hash = granular::state_hash(state);
        s.beads_fraction = granular::bead_area_fraction(bed_.problem, state.beads.radius);
        s.cost = cost();
        return s;
    }

    const RunContext& context_;
    int requests_seen_; // first: what is asked from now on counts
    const GranularPlan& plan_;
    const BedPlan& bed_;
    const GranularTask& task_;
    const Logger& log_;
    std::filesystem::path checkpoint_file_;
    CostMeter meter_; // before the parts that take time to make
    bool one_thread_;
    std::optional<GranularCheckpoint> loaded_;
    Simulation simulation_;
    granular::Record record_;
    GranularFiles files_;
    LastPeriod period_;
    std::optional<measure::Measures> measures_;
    measure::Frame frame_;
    double cpu_start_;
    Clock::time_point wall_start_, saved_;
    const std::function<void(const Simulation&, const granular::TableRow*)>* on_progress_ = nullptr;
};

} // namespace

store::H5mdInfo h5md_info(const BedPlan& bed, std::uint32_t run, double beads_fraction,
                          const std::string& command) {
    const granular::GranularProblem& p = bed.problem;
    const PeriodicBox& sides = granular::bed_sides(p);
    store::H5mdInfo info;
    info.author = "rodwake";
    info.version = build_info().version;
    info.command = command;
    info.seed = p.seed;
    info.parameters = {{"bead_radius", p.bead_radius},
                       {"box", sides.x},
                       {"gap", p.plates.gap},
                       {"frequency", p.plates.frequency},
                       {"gamma", p.plates.gamma},
                       {"amplitude", p.plates.amplitude(p.gravity)},
                       {"gravity", p.gravity},
                       {"time_step", p.time_step},
                       {"phi_b", phi_b(bed)},
                       {"beads_fraction", beads_fraction},
                       {"order_cutoff", bed.schedule.order_cutoff},
                       {"run", static_cast<double>(run + 1)}};
    if (!sides.square())
        info.parameters.emplace_back("box_y", sides.y);
    if (p.container && p.container->kind == granular::ContainerKind::circle)
        info.parameters.emplace_back("wall_radius", 0.5 * sides.x);
    return info;
}

GranularResult
run_granular(const GranularPlan& plan, const GranularTask& task, const RunContext& context, const Logger& log,
             std::size_t threads,
             const std::function<void(const Simulation&, const granular::TableRow*)>& on_progress) {
    return BedRun(plan, task, context, log, threads).go(on_progress);
}

GranularSummary restore_summary(const GranularPlan& plan, const GranularTask& task) {
    GranularPlan bare = plan;
    bare.bed.measures.reset(); // the keys may be others by now
    const RunContext context;
    const Logger log = make_silent_logger();
    return BedRun(bare, task, context, log, 1, true).restore_summary();
}

} // namespace rodwake::app
