// Ways to run a bed: its time step, its duration, how often it is measured. Each is an ensemble of its own,
// with seeds of its own.

#include "bed/granular_summary.hpp"
#include "rodwake/app/run.hpp"
#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/core/estimate.hpp"
#include "rodwake/store/csv.hpp"
#include "target.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr long least_runs = 4, most_bed_runs = 200;
constexpr double of_reference = 4.0; ///< limits, as its error is in every bias
constexpr double behind = -8.0;      ///< a; where "wake" is taken, behind the ends of the rod
/// Of the scene's time step; the first is the reference. Twice the default trips the guard of a bed.
constexpr std::array steps{0.125, 0.25, 0.5, 1.0};
constexpr std::array durations{0.5, 0.25};
constexpr double rarer = 4.0; ///< between the frames that are measured

/// The bed and its measures alone, without files that nobody looks at.
scene::Scene bare(const scene::Scene& scene) {
    scene::Scene bed;
    bed.path = scene.path;
    bed.title = scene.title;
    bed.granular = scene.granular;
    bed.measure = scene.measure;
    const double frames = scene.granular->output.frames.value_or(scene.granular->duration / 100.0);
    bed.granular->output.frames = frames; // measures follow it, and the duration will change
    if (bed.measure && !bed.measure->interval)
        bed.measure->interval = frames;
    bed.granular->output.formats.clear();
    bed.granular->output.last_period = false;
    return bed;
}

struct BedWay {
    scene::Scene scene;
    std::vector<std::string> keys;
};

BedWay changed(const scene::Scene& bed, double step, double duration, double interval) {
    BedWay way{bed, {}};
    scene::Granular& g = *way.scene.granular;
    g.time_step = step * scene::time_step(g);
    g.duration *= duration;
    way.keys = {fmt::format("granular.time_step=\"{:.6g} s\"", *g.time_step),
                fmt::format("granular.duration=\"{:.6g} s\"", g.duration)};
    if (way.scene.measure) {
        *way.scene.measure->interval *= interval;
        way.keys.push_back(fmt::format("measure.interval=\"{:.6g} s\"", *way.scene.measure->interval));
    }
    return way;
}

/// Shorter runs must leave something to measure.
bool long_enough(const scene::Scene& bed, double part) {
    const double from = bed.measure ? bed.measure->from : 0.0, block = bed.measure ? bed.measure->block : 0.0;
    return part * bed.granular->duration >= from + 2.0 * block;
}

/// After the largest one comes 0.
long other_seed(long seed, std::size_t k) {
    return static_cast<long>((static_cast<std::uint64_t>(seed) + k) % (std::uint64_t{1} << 63));
}

std::vector<BedWay> all_ways(const scene::Scene& bed) {
    std::vector<BedWay> ways;
    ways.reserve(steps.size() + durations.size() + 1);
    for (const double step : steps)
        ways.push_back(changed(bed, step, 1.0, 1.0));
    for (const double part : durations)
        if (long_enough(bed, part))
            ways.push_back(changed(bed, 1.0, part, 1.0));
    if (bed.measure)
        ways.push_back(changed(bed, 1.0, 1.0, rarer));
    for (std::size_t k = 0; k < ways.size(); ++k)
        ways[k].scene.granular->seed = other_seed(ways[k].scene.granular->seed, k + 1);
    return ways;
}

Found found_of(std::string name, std::string unit, const Estimate& mean, double runs) {
    Found found{std::move(name), std::move(unit)};
    found.value = mean.value;
    found.error = mean.error;
    found.scatter = mean.error * std::sqrt(runs);
    return found;
}

/// Column by column sums over the rods whose speed is theirs.
std::vector<double> mean_speed(const store::Table& runs, const scene::Granular& bed) {
    std::vector<double> mean(runs.rows(), 0.0);
    double rods = 0.0;
    for (std::size_t k = 0; k < bed.rods.size(); ++k) {
        const auto* speed = runs.find(fmt::format("mean_speed{}", k));
        if (!speed || bed.rods[k].imposed_speed || bed.rods[k].shape.kind != granular::RodKind::motile)
            continue;
        ++rods;
        for (std::size_t run = 0; run < mean.size(); ++run)
            mean[run] += (*speed)[run];
    }
    for (double& value : mean)
        value /= rods;
    return rods > 0.0 ? mean : std::vector<double>{};
}

/// Of the bed as a whole: what scans tell of it under the same name, as means.
std::vector<SummaryNumber> bed_numbers() {
    std::vector<SummaryNumber> numbers = summary_numbers({}, false);
    std::erase_if(numbers, [](const SummaryNumber& n) {
        return n.column != n.scan_column || n.column.empty() || n.over_runs != OverRuns::mean;
    });
    return numbers;
}

/// From runs.csv: one value a run.
std::vector<Found> of_runs(const store::Table& runs, const scene::Granular& bed) {
    const double count = static_cast<double>(runs.rows());
    std::vector<Found> all;
    if (const std::vector<double> speed = mean_speed(runs, bed); !speed.empty())
        all.push_back(found_of("rod_speed", "m/s", mean_of(speed), count));
    for (const SummaryNumber& number : bed_numbers())
        all.push_back(
            found_of(number.column, std::string(number.unit), mean_of(*runs.find(number.column)), count));
    if (!bed.rods.empty() && bed.rods.front().imposed_speed)
        all.push_back(found_of("force", "N", mean_of(*runs.find("force0")), count));
    if (const auto* change = runs.find("separation_change"))
        all.push_back(found_of("separation_change", "m", mean_of(*change), count));
    return all;
}

/// Each {"value", "error"} of measure.json.
void add_estimates(const json& node, const std::string& name, double runs, std::vector<Found>& all) {
    if (!node.is_object())
        return;
    if (node.contains("value") && node.contains("error")) {
        if (node["value"].is_number() && node["error"].is_number())
            all.push_back(found_of(name, "of measure.json", {node["value"], node["error"]}, runs));
        return;
    }
    for (const auto& [key, value] : node.items())
        add_estimates(value, name.empty() ? key : fmt::format("{}.{}", name, key), runs, all);
}

/// U_x on the axis, where the profile has a place next to `behind`.
void add_wake(const fs::path& file, double runs, std::vector<Found>& all) {
    if (!fs::exists(file))
        return;
    const std::vector<std::string> names{"x", "value"}, sigma{"sigma"};
    const store::Table profile = store::read_csv(file, names, sigma);
    const auto &x = *profile.find("x"), &U = *profile.find("value");
    const auto at = std::ranges::min_element(x, {}, [](double place) { return std::abs(place - behind); });
    const auto k = static_cast<std::size_t>(at - x.begin());
    if (const auto* e = profile.find("sigma"); e && std::abs(x[k] - behind) <= 1.0 && std::isfinite((*e)[k]))
        all.push_back(found_of("wake", "a", {U[k], (*e)[k]}, runs));
}

std::vector<Found> found_in(const fs::path& folder, const store::Table& runs, const scene::Granular& bed) {
    std::vector<Found> all = of_runs(runs, bed);
    const auto count = static_cast<double>(runs.rows());
    add_wake(folder / "profile_Ux_x.csv", count, all);
    if (std::ifstream in(folder / "measure.json"); in)
        add_estimates(json::parse(in), "", count, all);
    std::erase_if(all, [](const Found& f) { return !std::isfinite(f.value) || !std::isfinite(f.error); });
    return all;
}

/// Fills in bias, its error and the scale; quantities that the reference lacks are left out.
void compare(std::vector<Found>& found, const std::vector<Found>& reference) {
    std::erase_if(found, [&](Found& one) {
        const auto same = std::ranges::find(reference, one.name, &Found::name);
        if (same == reference.end())
            return true;
        const bool itself = &*same == &one;
        one.bias = itself ? 0.0 : one.value - same->value;
        one.bias_error = itself ? one.error : std::hypot(one.error, same->error);
        one.scale = std::abs(same->value);
        return false;
    });
}

class BedTarget : public Target {
public:
    BedTarget(const scene::Scene& bed, fs::path folder, const RunContext& context)
        : ways_(all_ways(bed)), folder_(std::move(folder)), context_(context) {
        table.work = stage_key(bed, Stage::measure);
        table.reference = fmt::format("a time step of {:.3g} s", *ways_.front().scene.granular->time_step);
        for (const BedWay& way : ways_)
            table.ways.push_back({.keys = way.keys, .seconds = 0.0});
    }

    /// A few runs first, to know what one costs; then as many as the limit pays for. Those that an earlier
    /// command made count.
    bool attempt(std::size_t k) override {
        const fs::path folder = folder_ / fmt::format("{}", k);
        const scene::Granular& bed = *ways_[k].scene.granular;
        const double limit = (k == 0 ? of_reference : 1.0) * context_.tradeoff.limit;
        store::Table runs = run_status(folder) == "finished" ? table_of(folder, bed) : store::Table{};
        std::string failure;
        for (int round = 0; round < 2 && failure.empty(); ++round) {
            const long wanted = affordable(runs, limit);
            if (wanted <= static_cast<long>(runs.rows()))
                break;
            if (!run(ways_[k].scene, wanted, folder, failure))
                return false;
            runs = table_of(folder, bed);
        }
        fill(k, runs, folder, failure);
        return true;
    }

private:
    /// An ensemble, or the rest of it. False if it was stopped.
    bool run(scene::Scene scene, long count, const fs::path& folder, std::string& failure) const {
        scene.granular->runs = count;
        std::vector<Stage> stages{Stage::granular};
        if (scene.measure)
            stages.push_back(Stage::measure);
        RunContext quiet = context_;
        quiet.progress = nullptr;
        quiet.force = false; // what is there is of this measurement
        quiet.seed.reset();  // in the scene by now
        quiet.log = [&failure](Severity severity, const std::string& text) {
            if (severity == Severity::error)
                failure = text;
        };
        const StageEnd end = app::run(plan_run(scene, stages, folder, quiet), folder, quiet);
        if (end != StageEnd::failed || failure.starts_with("measure"))
            failure.clear(); // a measure that cannot be had is not found, and no more
        return end != StageEnd::interrupted;
    }

    static store::Table table_of(const fs::path& folder, const scene::Granular& bed) {
        const fs::path file = folder / "runs.csv";
        if (!fs::exists(file))
            return {};
        std::vector<std::string> names{"cpu_seconds"};
        for (const SummaryNumber& number : bed_numbers())
            names.push_back(number.column);
        std::vector<std::string> more{"separation_change"};
        for (std::size_t k = 0; k < bed.rods.size(); ++k)
            more.insert(more.end(), {fmt::format("mean_speed{}", k), fmt::format("force{}", k)});
        return store::read_csv(file, names, more);
    }

    /// How many runs the limit pays for.
    static long affordable(const store::Table& runs, double limit) {
        if (runs.rows() == 0)
            return least_runs;
        const double each = mean_of(*runs.find("cpu_seconds")).value;
        return std::lround(std::clamp(limit / each, double{least_runs}, double{most_bed_runs}));
    }

    void fill(std::size_t k, const store::Table& runs, const fs::path& folder, const std::string& failure) {
        Way& way = table.ways[k];
        way.runs = static_cast<long>(runs.rows());
        way.seconds = runs.rows() ? mean_of(*runs.find("cpu_seconds")).value : HUGE_VAL;
        if (runs.rows() < static_cast<std::size_t>(least_runs)) {
            way.status = failure.empty() ? "fewer than 4 runs came to their end" : failure;
            return;
        }
        way.found = found_in(folder, runs, *ways_[k].scene.granular);
        compare(way.found, table.ways.front().found);
    }

    std::vector<BedWay> ways_;
    fs::path folder_;
    const RunContext& context_;
};

} // namespace

std::unique_ptr<Target> bed_target(const scene::Scene& scene, const fs::path& results,
                                   const RunContext& context) {
    if (!scene.granular || (scene.measure && !scene.measure->trajectory.empty()))
        throw InputError(scene.path +
                         ": no [granular] table, so there is no bed whose cost and error could be "
                         "measured");
    return std::make_unique<BedTarget>(bare(scene), ways_folder(results, Part::bed) / "ways", context);
}

} // namespace rodwake::app
