
#include "rods_ensemble.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/estimate.hpp"
#include "rodwake/core/json_text.hpp"
#include "run/log.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <fstream>

namespace rodwake::app {

namespace {

using nlohmann::json;
using rods::NoiseSums;

/// What must be the same for the runs so far to count.
std::string runs_key_of(const scene::Scene& scene, const std::string& field) {
    const BuildInfo build = build_info();
    // max_steps is no part of the stage's key, but of what makes a run fail
    return build.version + " " + build.git + "\n" + stage_key(scene, Stage::rods) + "\n" + field +
           fmt::format("\nmax_steps {}", scene.rods_run->max_steps);
}

json to_json(const NoiseSums& sums) {
    json ends = json::array();
    for (const rods::NoisyEnd& end : sums.ends)
        ends.push_back({end.failed, static_cast<int>(end.ending), end.time,
                        finite_or_null(end.min_separation), end.first, end.second});
    return {{"ends", ends},
            {"failure", sums.failure},
            {"reached", sums.reached},
            {"square", sums.square},
            {"square_squares", sums.square_squares},
            {"cosine", sums.cosine},
            {"cosine_squares", sums.cosine_squares}};
}

NoiseSums sums_of(const json& value) {
    NoiseSums sums;
    for (const json& end : value.at("ends"))
        sums.ends.push_back({end.at(0).get<bool>(), static_cast<Ending>(end.at(1).get<int>()),
                             end.at(2).get<double>(),
                             end.at(3).is_null() ? HUGE_VAL : end.at(3).get<double>(),
                             end.at(4).get<std::size_t>(), end.at(5).get<std::size_t>()});
    value.at("failure").get_to(sums.failure);
    value.at("reached").get_to(sums.reached);
    value.at("square").get_to(sums.square);
    value.at("square_squares").get_to(sums.square_squares);
    value.at("cosine").get_to(sums.cosine);
    value.at("cosine_squares").get_to(sums.cosine_squares);
    return sums;
}

bool same_shape(const NoiseSums& one, const NoiseSums& other) {
    return one.reached.size() == other.reached.size() && one.square.size() == other.square.size() &&
           one.square_squares.size() == other.square_squares.size() &&
           one.cosine.size() == other.cosine.size() &&
           one.cosine_squares.size() == other.cosine_squares.size();
}

/// The sums in a file; nothing if there is none, it is damaged, or of something else.
std::optional<NoiseSums> read(const std::filesystem::path& file, const std::string& key, std::size_t runs,
                              const NoiseSums& none) try {
    std::ifstream in(file);
    if (!in)
        return std::nullopt;
    const json value = json::parse(in);
    if (value.at("key") != key)
        return std::nullopt;
    NoiseSums sums = sums_of(value.at("sums"));
    const bool fits = same_shape(sums, none) && sums.ends.size() <= runs;
    return fits ? std::optional(std::move(sums)) : std::nullopt;
} catch (const json::exception&) {
    return std::nullopt;
}

/// Saves what is done so far: at first, then every few seconds, and seldom enough to cost little.
class Saver {
public:
    Saver(const Session& session, std::string file, std::string key)
        : session_(session), file_(std::move(file)), key_(std::move(key)) {}

    void offer(const NoiseSums& sums) {
        if (Clock::now() >= next_)
            save(sums);
    }
    void save(const NoiseSums& sums) {
        const auto start = Clock::now();
        session_.directory.write(file_, json_text(json{{"key", key_}, {"sums", to_json(sums)}}));
        constexpr int share = 20; // of the time between
        next_ = Clock::now() + std::max<Clock::duration>(interval, share * (Clock::now() - start));
    }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds interval{3};
    const Session& session_;
    std::string file_, key_;
    Clock::time_point next_ = Clock::now();
};

} // namespace

bool run_noise(const Session& session, const RodsPlan& plan, const rods::RodProblem& problem,
               const std::string& field, NoiseSums& sums) {
    const std::string name = plan.of.folder + "noise_progress.json", key = runs_key_of(plan.of.scene, field);
    const NoisePlan& of = *plan.noise;
    sums = rods::no_runs(problem);
    const auto file = session.directory.file(name);
    const std::uint32_t most = of.capture_error ? std::max(of.runs, of.most_runs) : of.runs;
    if (auto found = session.context.force ? std::nullopt : read(file, key, most, sums)) {
        sums = std::move(*found);
        session.log->info("noise{}: going on from run {}", plan.of.suffix(), sums.ends.size());
    } else if (std::filesystem::exists(file))
        session.log->warn("{}: damaged, or of another scene, field or version; starting from the beginning",
                          file.string());
    rods::RodOptions options = plan.options;
    options.ode.stop_requested = [&] { return session.context.stopped(); };
    Saver saver(session, name, key);
    Progress progress(session.context, "noise", most, "runs");
    const auto added = [&](const NoiseSums& now) {
        progress.update(static_cast<double>(now.ends.size()));
        saver.offer(now);
    };
    const bool all = run_wanted(problem, options, of, session.context.thread_count(), sums, added);
    if (all)
        std::filesystem::remove(file);
    else
        saver.save(sums);
    return all;
}

// What an ensemble of rods that diffuse leaves: noise.json and ensemble.csv.

namespace {
using rods::NoisyEnd;

EndingCounts endings_of(const NoiseSums& sums) {
    EndingCounts counts;
    for (const NoisyEnd& end : sums.ends)
        if (end.failed)
            ++counts.failed;
        else
            counts.add(end.ending);
    return counts;
}

FirstContact first_contact(const NoiseSums& sums, const OutputUnits& units) {
    std::vector<double> times;
    for (const NoisyEnd& end : sums.ends)
        if (!end.failed && end.ending == Ending::contact)
            times.push_back(end.time * units.time);
    const Estimate mean = mean_of(times);
    FirstContact contact;
    contact.error = mean.error;
    contact.runs = times.size();
    if (!times.empty())
        contact.mean = mean.value;
    return contact;
}

void add_capture(NoiseReport& report, const NoiseSums& sums, std::size_t rods) {
    const scan::Proportion of = captured(sums, rods);
    if (of.of == 0) // a single rod captures none
        return;
    const auto [low, high] = of.wilson(capture_quantile);
    report.capture_probability = of.value();
    report.capture_low = low;
    report.capture_high = high;
}

std::vector<double> in_units_of(double unit, std::vector<double> values) {
    for (double& value : values)
        value *= unit;
    return values;
}

} // namespace

/// A list of rows.
static nlohmann::ordered_json member_json(const RodTable& table) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < table.values.size(); ++k) {
        if (k % table.rods == 0)
            rows.push_back(nlohmann::ordered_json::array());
        rows.back().push_back(finite_or_null(table.values[k]));
    }
    return rows;
}

scan::Proportion captured(const NoiseSums& sums, std::size_t rods) {
    const rods::CaptureCount counted = rods::count_captures(sums.ends, rods);
    return {counted.count, counted.of};
}

std::string noise_json(const NoiseSums& sums, const NoisePlan& plan, const rods::RodProblem& problem,
                       const OutputUnits& units) {
    const std::size_t rods = problem.rods.size();
    const double area = units.length * units.length;
    const rods::NoiseMeans square = rods::mean_square_displacement(sums),
                           cosine = rods::heading_correlation(sums);
    NoiseReport report;
    report.runs = sums.ends.size();
    add_capture(report, sums, rods);
    report.endings = endings_of(sums);
    report.first_contact_time = first_contact(sums, units);
    if (!sums.failure.empty())
        report.failure = sums.failure;
    report.rotational_diffusion = plan.noise.rotational / units.time;
    report.translational_diffusion = plan.noise.translational * units.length * units.length / units.time;
    report.speed = units.length / units.time;
    report.time_step = plan.noise.time_step * units.time;
    report.seed = plan.noise.seed;
    report.times = in_units_of(units.time, rods::stored_times(problem));
    report.runs_at_time = sums.reached;
    report.mean_square_displacement = {in_units_of(area, square.values), rods};
    report.mean_square_displacement_error = {in_units_of(area, square.errors), rods};
    report.heading_correlation = {cosine.values, rods};
    report.heading_correlation_error = {cosine.errors, rods};
    report.units = {units.length_name, units.time_name, {}};
    return json_text(record_json(report), 1) + "\n";
}

std::string noise_csv(const NoiseSums& sums, std::size_t rods, const OutputUnits& units) {
    const auto of_pair = [&](double value) { return rods > 1 ? value : std::nan(""); };
    std::vector<NoisyRow> rows;
    for (std::size_t i = 0; i < sums.ends.size(); ++i) {
        const NoisyEnd& end = sums.ends[i];
        rows.push_back({static_cast<double>(i), end.failed ? std::nan("") : ending_code(end.ending),
                        end.time * units.time, of_pair(end.min_separation * units.length),
                        of_pair(static_cast<double>(end.first)), of_pair(static_cast<double>(end.second))});
    }
    return csv_of(rows);
}

} // namespace rodwake::app
