#include "measure_stage.hpp"

#include "granular_problem.hpp"
#include "measure_frames.hpp"
#include "measure_records.hpp"
#include "progress.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/store/csv.hpp"
#include "signals.hpp"
#include "stages.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <fstream>
#include <mutex>

namespace rodwake::cli {

namespace {

namespace fs = std::filesystem;

/// The files of one run; of a foreign trajectory only that.
struct RunFiles {
    fs::path folder, trajectory;
    bool own = true; ///< made by this scene's granular run
};

std::vector<RunFiles> finished_runs(const DemCase& one, const fs::path& folder, const Logger& log) {
    const std::string foreign = one.scene.measure->trajectory;
    if (!foreign.empty())
        return {{fs::path(foreign).parent_path(), foreign, false}};
    std::vector<RunFiles> found;
    const std::vector<DemTask> tasks = dem_tasks(one, folder);
    for (const DemTask& task : tasks)
        if (fs::exists(task.folder / "summary.json"))
            found.push_back({task.folder, task.folder / "trajectory.h5md", true});
    if (found.empty())
        throw InputError(
            (folder / one.folder).string() +
            ": holds no finished granular run to measure; rodwake dem SCENE -o DIR makes one, rodwake run "
            "does both; or name a file in measure.trajectory");
    if (found.size() < tasks.size())
        log->warn("measure: {} of {} runs are finished; the others are left out", found.size(), tasks.size());
    return found;
}

/// Progress of several files at once.
class SharedProgress {
public:
    SharedProgress(const Logger& log, bool quiet, std::size_t files)
        : done_(files, 0.0), progress_(log, quiet, "measure", static_cast<double>(files), "runs") {}

    /// False: stop.
    bool update(std::size_t file, double part) {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (lock) {
            sum_ += part - done_[file];
            done_[file] = part;
            progress_.update(sum_);
        }
        return stop_signal() == 0;
    }

private:
    std::vector<double> done_;
    double sum_ = 0.0;
    Progress progress_;
    std::mutex mutex_;
};

/// What the run recorded on its way if it is of these keys, else its trajectory measured now.
std::optional<measure::Measures> measures_of(const RunFiles& run, const MeasurePlan& plan,
                                             const std::function<bool(double)>& on_progress) {
    if (run.own)
        if (auto recorded = read_records(run.folder / "measure.rwc", plan))
            return recorded;
    if (run.own && !fs::exists(run.trajectory))
        throw InputError(run.folder.string() +
                         ": this run recorded nothing for these [measure] keys, and it stored no "
                         "trajectory (granular.output.formats without \"h5md\"); run it again");
    return measure_trajectory(run.trajectory, plan, on_progress);
}

template<class Record>
std::vector<Record> records(std::vector<measure::Measures>& all,
                            std::optional<Record>& (measure::Measures::*part)()) {
    std::vector<Record> out;
    for (measure::Measures& one : all)
        out.push_back(std::move(*(one.*part)()));
    return out;
}

/// One measure that cannot be had does not take the others with it: its reason is kept.
template<class Make>
void attempt(CaseResults& results, const char* name, const Make& make) {
    try {
        make();
    } catch (const InputError& error) {
        results.not_measured.emplace_back(name, error.what());
    } catch (const RunError& error) {
        results.not_measured.emplace_back(name, error.what());
    }
}

/// False if a signal stopped it.
bool reduce_frames(const std::vector<RunFiles>& runs, const MeasurePlan& plan, const Options& options,
                   const Logger& log, CaseResults& out) {
    SharedProgress progress(log, options.quiet, runs.size());
    std::vector<std::optional<measure::Measures>> found(runs.size());
    parallel_for(runs.size(), options.threads, [&](std::size_t i) {
        found[i] = measures_of(runs[i], plan, [&](double part) { return progress.update(i, part); });
    });
    std::vector<measure::Measures> all;
    for (auto& one : found)
        if (one)
            all.push_back(std::move(*one));
    if (all.size() < found.size())
        return false;
    using measure::Measures;
    if (plan.keys.structure)
        attempt(out, "order", [&] { out.structure = measure::reduce(records(all, &Measures::structure)); });
    if (plan.keys.microrheology)
        attempt(out, "microrheology",
                [&] { out.microrheology = measure::reduce(records(all, &Measures::microrheology)); });
    if (plan.keys.flow)
        attempt(out, "flow", [&] { out.flow = measure::reduce(records(all, &Measures::flow)); });
    if (plan.keys.displacement)
        attempt(out, "displacement",
                [&] { out.displacement = measure::reduce(records(all, &Measures::displacement)); });
    return true;
}

measure::PairTrack pair_track(const fs::path& folder) {
    static const std::vector<std::string> names = {"t", "x0", "y0", "theta0", "x1", "y1", "theta1"};
    const store::Table table = store::read_csv(folder / "tracks.csv", names);
    const auto column = [&](std::size_t k) { return *table.find(names[k]); };
    measure::PairTrack track;
    const std::vector<double> t = column(0);
    for (std::size_t i = 0; i < t.size(); ++i)
        if (t[i] >= -1e-12)
            track.t.push_back(t[i]);
    const std::size_t skipped = t.size() - track.t.size();
    const auto kept = [&](std::size_t k) {
        const std::vector<double> all = column(k);
        return std::vector<double>(all.begin() + static_cast<std::ptrdiff_t>(skipped), all.end());
    };
    for (std::size_t rod : {0, 1}) {
        track.x[rod] = kept(1 + 3 * rod);
        track.y[rod] = kept(2 + 3 * rod);
        track.heading[rod] = kept(3 + 3 * rod);
    }
    return track;
}

measure::PairResult pairs_of(const std::vector<RunFiles>& runs, const scene::Scene& scene) {
    measure::PairKeys keys;
    keys.box = scene.granular->box;
    keys.contact_distance = contact_distance(scene);
    std::vector<measure::PairRun> followed;
    for (const RunFiles& run : runs)
        followed.push_back(measure::follow_pair(pair_track(run.folder), keys));
    return measure::reduce(followed);
}

/// A number of each run's summary.
template<class Find>
std::vector<double> of_summaries(const std::vector<RunFiles>& runs, const char* what, const Find& find) {
    std::vector<double> values;
    for (const RunFiles& run : runs) {
        const fs::path file = run.folder / "summary.json";
        std::ifstream in(file);
        try {
            values.push_back(find(nlohmann::json::parse(in, nullptr, false)));
        } catch (const nlohmann::json::exception&) {
            throw InputError(fmt::format("{}: no {}; make the granular run again", file.string(), what));
        }
    }
    return values;
}

ForceResult force_of(const std::vector<RunFiles>& runs, std::size_t rod) {
    const auto of_rod = [&](const char* name) {
        return measure::mean_of_blocks(
            of_summaries(runs, "rod with its force", [&](const nlohmann::json& json) {
                return json.at("rods").at(rod).at(name).get<double>();
            }));
    };
    return {of_rod("force"), of_rod("mean_speed")};
}

/// Frames may all lie at one phase of the plates; a run's own mean of T_xy is over all phases.
void use_temperature(const std::vector<RunFiles>& runs, measure::MicrorheologyResult& result) {
    const measure::Estimate T = measure::mean_of_blocks(
        of_summaries(runs, "T_xy", [](const nlohmann::json& json) { return json.at("T_xy").get<double>(); }));
    const double scale = T.value / result.temperature;
    result.temperature = T.value;
    result.spring.value *= scale;
    result.spring.error *= result.spring.known() ? scale : 1.0;
}

CaseResults facts_of(const DemCase& one, const granular::GranularProblem& problem) {
    const scene::Granular& bed = *one.scene.granular;
    CaseResults r;
    r.name = one.name;
    r.label = one.label;
    r.folder = one.folder;
    r.bead_radius = bed.bead_radius;
    // what the scene asks for: beads that rods displace are counted in
    r.phi_b = bed.phi_b.value_or(granular::bead_area_fraction(problem));
    r.profile_offset = profile_offset(one.scene);
    if (bed.rods.size() == 2) {
        const auto &p = bed.rods[0].position, &q = bed.rods[1].position;
        r.separation =
            std::hypot(measure::nearest(p[0] - q[0], bed.box), measure::nearest(p[1] - q[1], bed.box));
    }
    if (!bed.rods.empty())
        r.imposed_speed = bed.rods[static_cast<std::size_t>(one.scene.measure->rod)].imposed_speed;
    return r;
}

/// Nothing if a signal stopped it.
std::optional<CaseResults> measure_case(const DemCase& one, const Options& options, const fs::path& folder,
                                        const Logger& log) {
    const granular::GranularProblem problem = granular_problem(one.scene, options.seed);
    const std::vector<RunFiles> runs = finished_runs(one, folder, log);
    const scene::Measure& m = *one.scene.measure;
    CaseResults results = facts_of(one, problem);
    results.runs = runs.size();
    if (const auto plan = measure_plan(one.scene, problem))
        if (!reduce_frames(runs, *plan, options, log, results))
            return std::nullopt;
    if (!m.trajectory.empty()) {
        if (m.pairs || m.force)
            log->warn("measure: pairs and force come from a run's own tables; with measure.trajectory they "
                      "are left "
                      "out");
        return results;
    }
    if (results.microrheology)
        use_temperature(runs, *results.microrheology);
    if (m.pairs)
        attempt(results, "pairs", [&] { results.pairs = pairs_of(runs, one.scene); });
    if (m.force)
        attempt(results, "force", [&] { results.force = force_of(runs, static_cast<std::size_t>(m.rod)); });
    return results;
}

} // namespace

void require_trajectory(const scene::Scene& scene, const Options& options) {
    const auto plan = measure_plan(scene, granular_problem(scene, options.seed));
    if (!plan)
        throw InputError(scene.path +
                         ": measure.trajectory is given, but nothing that is measured in frames: order, "
                         "microrheology, flow, displacement");
    check_trajectory(scene.measure->trajectory, *plan);
}

StageEnd measure_folder(const scene::Scene& scene, const Options& options, const fs::path& folder,
                        const Logger& log) {
    const MeasureOrigin origin{options.command,
                               options.seed.value_or(static_cast<std::uint64_t>(scene.granular->seed))};
    std::vector<CaseResults> all;
    StageEnd end = StageEnd::finished;
    for (const DemCase& one : dem_cases(scene)) {
        auto results = measure_case(one, options, folder, log);
        if (!results)
            return StageEnd::interrupted;
        fs::create_directories(folder / one.folder);
        write_measures(folder / one.folder, *results, origin);
        for (const auto& [name, reason] : results->not_measured) {
            log->error("measure{}: {}: {}", one.label.empty() ? "" : " (" + one.label + ")", name, reason);
            end = StageEnd::failed;
        }
        for (const std::string& line : describe(*results))
            log->info("{}", line);
        all.push_back(std::move(*results));
    }
    if (all.size() > 1)
        write_series(folder, all);
    return end;
}

StageEnd run_measure_stage(Session& session) {
    return measure_folder(session.scene, session.options, session.directory.path(), session.log);
}

} // namespace rodwake::cli
