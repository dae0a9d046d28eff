#include "rodwake/app/fit_design.hpp"

#include "fit_records.hpp"
#include "rodwake/app/fit.hpp"
#include "rodwake/app/rods.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/core/parallel.hpp"
#include "rodwake/core/rng.hpp"
#include "rodwake/fitting/posterior.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/atomic_file.hpp"
#include "rodwake/store/csv.hpp"
#include "run/log.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace rodwake::app {

namespace {

using nlohmann::ordered_json;
using Settings = std::vector<std::string>;

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> parts;
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t to = std::min(text.find(at, from), text.size());
        parts.push_back(text.substr(from, to - from));
        from = to + 1;
    }
    return parts;
}

std::vector<Settings> all_combinations(const std::vector<std::string>& vary) {
    std::vector<Settings> all = {{}};
    for (const std::string& one : vary) {
        const auto equals = one.find('=');
        if (equals == std::string::npos || equals == 0 || equals + 1 == one.size())
            throw InputError(
                fmt::format("--vary {}: expected key=values, for example rods.1.position.1=1.5,2,3", one));
        std::vector<Settings> longer;
        for (const Settings& before : all)
            for (const std::string& value : split(one.substr(equals + 1), ',')) {
                longer.push_back(before);
                longer.back().push_back(one.substr(0, equals + 1) + value);
            }
        all = std::move(longer);
    }
    return all;
}

std::vector<Settings> rows_of_list(const std::filesystem::path& file) {
    const store::Table table = store::read_csv(file, store::csv_names(file));
    std::vector<Settings> all(table.rows());
    for (std::size_t row = 0; row < table.rows(); ++row)
        for (std::size_t k = 0; k < table.names.size(); ++k)
            all[row].push_back(fmt::format("{}={}", table.names[k], table.columns[k][row]));
    if (all.empty())
        throw InputError(file.string() + ": holds no design");
    return all;
}

bool diffuses(const scene::Fit& fit) { return scene::fit_has(fit, "D_r") || scene::fit_has(fit, "D_t"); }

/// One model of a design; its data are put in by `with`.
struct Maker {
    scene::Fit keys;
    FitTrackData track; ///< the first row is the start
    std::size_t tracks = 1;

    FitPlan with(const std::vector<std::vector<std::vector<double>>>& states) const {
        FitInputs inputs;
        for (std::size_t k = 0; k < tracks; ++k) {
            inputs.tracks.emplace_back(track);
            inputs.tracks.back()->data.states = states[k % states.size()];
        }
        scene::Fit all = keys;
        all.trajectories.resize(tracks, keys.trajectories.front());
        return fit_plan(all, std::move(inputs));
    }
};

FitTrackData track_of(const scene::Scene& scene, long runs) {
    const scene::FitTrajectory& keys = scene.fit->trajectories.front();
    const rods::RodProblem rods = rod_problem(scene);
    FitTrackData track;
    track.name = "design", track.file = "design";
    track.rods = rods.rods.size();
    track.sigma_known = true;
    fitting::Trajectory& data = track.data;
    data.name = "design";
    data.times = rods.output_times;
    if (data.times.empty() || data.times.back() < rods.t_end)
        data.times.push_back(rods.t_end);
    if (data.times.front() > 0.0)
        data.times.insert(data.times.begin(), 0.0);
    data.states.assign(data.times.size(), rods::to_state(rods.rods));
    const double smaller = diffuses(*scene.fit) ? 1.0 : std::sqrt(static_cast<double>(runs));
    data.sigma_position = *keys.sigma_position / smaller;
    data.sigma_heading = *keys.sigma_heading / smaller;
    data.free_start = keys.start_poses != scene::StartPoses::exact;
    data.box = rods.box;
    return track;
}

/// The fit as written and its rivals.
std::vector<Maker> makers_of(const scene::Scene& scene, long runs) {
    std::vector<Maker> makers;
    const auto add = [&](const scene::Scene& model) {
        scene::Fit keys = *model.fit;
        keys.models.clear();
        makers.push_back({keys, track_of(model, runs), diffuses(keys) ? static_cast<std::size_t>(runs) : 1});
    };
    add(scene);
    for (const scene::FitModel& model : scene.fit->models)
        add(scene::apply_model(scene, model));
    if (std::ranges::any_of(
            makers, [&](const Maker& m) { return diffuses(m.keys) != diffuses(makers.front().keys); }))
        throw InputError(
            "design: rivals with D_r or D_t and rivals without cannot be weighed: hold it at 0 in "
            "fit.fixed of those without");
    return makers;
}

/// What the models find in tracks that one of them made: the logarithms of their evidence.
std::vector<double> evidence_of_set(const std::vector<Maker>& makers, std::size_t by, std::uint64_t seed,
                                    std::uint32_t set) {
    const Maker& maker = makers[by];
    RandomStream random(seed, set, static_cast<std::uint32_t>(1 + by));
    const std::vector<std::vector<double>> still = maker.track.data.states;
    const FitPlan plan = maker.with({still});
    const fitting::Density density(plan.problem, fit_priors(plan));
    Eigen::VectorXd z(density.size());
    for (double& one : z)
        one = random.normal();
    std::vector<double> free = density.values(z);
    for (std::size_t k = 0; k < free.size(); ++k) {
        const fitting::Parameter& p = plan.problem.parameters[fitting::free_parameters(plan.problem)[k]];
        if (fitting::is_start_pose(p.name))
            free[k] = p.start;
    }
    const FitPart part = track_part(plan.problem);
    const std::vector<double> truth = part.values(fitting::all_values(plan.problem, free));
    std::vector<std::vector<std::vector<double>>> states(maker.tracks);
    for (std::size_t k = 0; k < maker.tracks; ++k) {
        const fitting::Trajectory& data = maker.track.data;
        states[k] = fitting::drawn_states(plan.track_model, data, k, part.parameters, truth, seed + 1 + by,
                                          set * 1000 + static_cast<std::uint32_t>(k));
        for (std::size_t row = data.free_start ? 0 : 1; row < states[k].size(); ++row)
            for (std::size_t i = 0; i < states[k][row].size(); ++i)
                states[k][row][i] +=
                    (i % 3 == 2 ? data.sigma_heading : data.sigma_position) * random.normal();
    }
    std::vector<double> out;
    for (const Maker& model : makers) {
        const FitPlan own = model.with(states);
        std::vector<double> from;
        for (const fitting::Parameter& p : own.problem.parameters)
            from.push_back(p.start);
        double best = fitting::curvature_evidence(own.problem, fit_priors(own), from);
        if (&model == &maker && own.problem.parameters.size() == plan.problem.parameters.size())
            best = std::max(best, fitting::curvature_evidence(own.problem, fit_priors(own),
                                                              fitting::all_values(own.problem, free)));
        out.push_back(best);
    }
    return out;
}

/// Sums of the sets so far.
void sum_up(const std::vector<std::vector<std::vector<double>>>& by_maker, WeighedDesign& out) {
    const std::size_t models = by_maker.size();
    out.log_bayes.assign(models, std::vector<double>(models, 0.0));
    double count = 0.0, sum = 0.0, squares = 0.0;
    for (std::size_t by = 0; by < models; ++by)
        for (const std::vector<double>& logs : by_maker[by]) {
            const double most = std::ranges::max(logs);
            double all = 0.0;
            for (const double one : logs)
                all += std::exp(one - most);
            const double bits =
                std::log2(static_cast<double>(models)) + (logs[by] - most - std::log(all)) / std::log(2.0);
            count += 1.0, sum += bits, squares += bits * bits;
            out.right += logs[by] == most ? 1.0 : 0.0;
            for (std::size_t other = 0; other < models; ++other)
                out.log_bayes[by][other] +=
                    (logs[by] - logs[other]) / static_cast<double>(by_maker[by].size());
        }
    out.information = sum / count;
    out.error = std::sqrt(std::max(0.0, squares / count - out.information * out.information) / (count - 1.0));
    out.right /= count;
}

void require(const scene::Scene& scene) {
    const auto need = [](bool there, const char* what) {
        if (!there)
            throw InputError(fmt::format("design: {}", what));
    };
    need(!scene.rods.empty() && scene.rods_run, "the scene has no [[rods]] and [rods_run], whose start and "
                                                "output times would be the experiment's");
    need(scene.fit && scene.fit->trajectories.size() == 1 && scene.fit->profiles.empty() &&
             scene.fit->maps.empty(),
         "[fit] must have one of [[fit.trajectories]], whose errors would be the experiment's, and no other "
         "data; its file need not be there");
    const scene::FitTrajectory& track = scene.fit->trajectories.front();
    need(track.sigma_position && track.sigma_heading,
         "give sigma_position and sigma_heading in [[fit.trajectories]]: how well rods would be seen");
    need(!track.contact_time, "a contact_time is no datum before the experiment: leave it out");
    need(!scene.fit->models.empty(), "there are no rivals, [[fit.models]], to tell apart");
    need(scene.fit->posterior.has_value(),
         "[fit.posterior] is missing: its priors say which values of the parameters are tried");
}

} // namespace

double WeighedDesign::least_log_bayes() const {
    double least = HUGE_VAL;
    for (std::size_t by = 0; by < log_bayes.size(); ++by)
        for (std::size_t other = 0; other < log_bayes.size(); ++other)
            if (other != by)
                least = std::min(least, log_bayes[by][other]);
    return least;
}

std::size_t WeighedDesigns::best() const {
    return static_cast<std::size_t>(std::ranges::max_element(designs, {}, &WeighedDesign::information) -
                                    designs.begin());
}

WeighedDesigns weigh_designs(const scene::Scene& scene, const DesignRequest& request,
                             const RunContext& context) {
    require(scene);
    const std::vector<Settings> all =
        request.list.empty() ? all_combinations(request.vary) : rows_of_list(request.list);
    WeighedDesigns out;
    std::vector<std::vector<Maker>> makers;
    for (const Settings& settings : all) {
        scene::Scene one = scene::apply_variant(scene, {.name = "design", .label = "", .set = settings});
        require(one);
        for (const long runs : request.runs) {
            out.designs.push_back({.settings = settings, .runs = runs, .log_bayes = {}});
            makers.push_back(makers_of(one, runs));
            makers.back().front().with(
                {makers.back().front().track.data.states}); // refused before all the work
        }
    }
    out.models = {scene.fit->name};
    for (const scene::FitModel& model : scene.fit->models)
        out.models.push_back(model.name);
    const std::size_t models = out.models.size(), sets = static_cast<std::size_t>(request.sets),
                      each = models * sets;
    std::vector found(all.size() * request.runs.size(),
                      std::vector(models, std::vector<std::vector<double>>(sets)));
    Progress progress(context, "design", static_cast<double>(found.size() * each), "sets");
    std::atomic<std::size_t> done = 0;
    std::atomic<bool> stopped = false;
    const std::uint64_t seed = context.seed.value_or(scene.fit->search.seed);
    for (std::size_t d = 0; d < found.size() && !stopped; ++d) {
        parallel_for(each, context.thread_count(), [&](std::size_t i) {
            stopped = stopped || context.stopped();
            if (!stopped)
                found[d][i / sets][i % sets] =
                    evidence_of_set(makers[d], i / sets, seed, static_cast<std::uint32_t>(i % sets));
            ++done;
        });
        if (!stopped)
            sum_up(found[d], out.designs[d]);
        progress.update(static_cast<double>(done));
    }
    out.finished = !stopped;
    return out;
}

void write_designs(const WeighedDesigns& found, const DesignRequest& request,
                   const std::filesystem::path& folder, const std::string& command) {
    std::vector<DesignRow> rows;
    std::vector<std::string> varied = {""}; // in front of the header and of each row
    for (const std::string& setting : found.designs.front().settings)
        varied.front() += setting.substr(0, setting.find('=')) + ",";
    ordered_json designs = ordered_json::array();
    for (const WeighedDesign& one : found.designs) {
        varied.emplace_back();
        ordered_json settings = ordered_json::object(), pairs = ordered_json::object();
        for (const std::string& setting : one.settings) {
            const auto equals = setting.find('=');
            settings[setting.substr(0, equals)] = setting.substr(equals + 1);
            varied.back() += setting.substr(equals + 1) + ",";
        }
        rows.push_back(
            {static_cast<double>(one.runs), one.information, one.error, one.right, one.least_log_bayes()});
        for (std::size_t by = 0; by < found.models.size(); ++by)
            for (std::size_t other = 0; other < found.models.size(); ++other)
                if (other != by)
                    pairs[found.models[by]][found.models[other]] = finite_or_null(one.log_bayes[by][other]);
        ordered_json member = {{"settings", settings}};
        member.update(record_json(rows.back()));
        member["log_bayes"] = pairs;
        designs.push_back(std::move(member));
    }
    const ordered_json out = {
        {"models", found.models},
        {"sets", request.sets},
        {"designs", designs},
        {"best", found.best()},
        {"provenance", {{"command", command}, {"version", build_info().version}, {"git", build_info().git}}}};
    std::string csv;
    std::size_t line = 0;
    for (std::string& one : split(csv_of(rows), '\n'))
        csv += one.empty() ? "" : varied[line++] + one + "\n";
    std::filesystem::create_directories(folder);
    store::write_atomically(folder / "design.csv", csv);
    store::write_atomically(folder / "design.json", json_text(out, 2) + "\n");
}

} // namespace rodwake::app
