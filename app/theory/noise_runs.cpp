
#include "rods_ensemble.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/estimate.hpp"
#include "rodwake/core/json_text.hpp"
#include "rodwake/rods/classify_outcome.hpp"
#include "rodwake/scene/read.hpp"
#include "rodwake/store/journal.hpp"
#include "run/log.hpp"
#include "run/record_json.hpp"
#include "run/record_table.hpp"
#include "run/stage_kind.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>

namespace rodwake::store {

using rods::NoiseSums;
using rods::NoisyEnd;

template<>
inline constexpr auto parts<NoisyEnd> = parts_of("failed ending time min_separation first second",
                                                 &NoisyEnd::failed, &NoisyEnd::ending, &NoisyEnd::time,
                                                 &NoisyEnd::min_separation, &NoisyEnd::first,
                                                 &NoisyEnd::second);
template<>
inline constexpr auto
    parts<NoiseSums> = parts_of("ends failure reached square square_squares cosine cosine_squares",
                                &NoiseSums::ends, &NoiseSums::failure, &NoiseSums::reached,
                                &NoiseSums::square, &NoiseSums::square_squares, &NoiseSums::cosine,
                                &NoiseSums::cosine_squares);

} // namespace rodwake::store

namespace rodwake::app {

using rods::NoiseSums;

bool run_noise(const Session& session, const RodsPlan& plan, const rods::RodProblem& problem,
               const std::string& field, NoiseSums& sums) {
    const std::filesystem::path file = session.directory.file(plan.of.folder + "noise.log");
    const NoisePlan& of = *plan.noise;
    if (session.context.force)
        std::filesystem::remove(file);
    std::filesystem::create_directories(file.parent_path()); // of a variant
    // Runs count only while program, scene and field are the same.
    const BuildInfo build = build_info();
    // max_steps is no part of the stage's key, but of what makes a run fail
    store::Journal journal(file,
                           build.version + " " + build.git + "\n" +
                               scene::to_plain_toml(key_of_rods(plan.of.scene)) + "\n" + field +
                               fmt::format("\nmax_steps {}", plan.of.scene.rods_run->max_steps),
                           store::Journal::OfAnother::replace);
    // The journal of this problem has the ends of all runs, and the sums in its last record.
    sums = rods::no_runs(problem);
    std::size_t whole = 0;
    for (; whole < journal.size(); ++whole) {
        std::optional<NoiseSums> record = journal.get<NoiseSums>(whole);
        if (!record)
            break;
        sums.ends.insert(sums.ends.end(), record->ends.begin(), record->ends.end());
        record->ends = std::move(sums.ends);
        sums = std::move(*record);
    }
    journal.keep(whole); // what follows counts on what is damaged
    if (!sums.ends.empty())
        session.log->info("noise{}: resuming from run {}", plan.of.suffix(), sums.ends.size());
    else if (journal.replaced())
        session.log->warn("{}: damaged, or of another scene, field or version; starting from the beginning",
                          file.string());

    // A record holds the ends since the last one, and the sums over all runs.
    auto saved = static_cast<std::ptrdiff_t>(sums.ends.size());
    const auto save = [&](const NoiseSums& now) {
        NoiseSums record = {{now.ends.begin() + saved, now.ends.end()},
                            now.failure,
                            now.reached,
                            now.square,
                            now.square_squares,
                            now.cosine,
                            now.cosine_squares};
        journal.add(record);
        saved = static_cast<std::ptrdiff_t>(now.ends.size());
    };
    rods::RodOptions options = plan.options;
    options.ode.stop_requested = [&] { return session.context.stopped(); };
    const std::uint32_t most = of.capture_error ? std::max(of.runs, of.most_runs) : of.runs;
    Progress progress(session.context, "noise", most, "runs");
    using Clock = std::chrono::steady_clock;
    auto next_save = Clock::now();
    const auto added = [&](const NoiseSums& now) {
        progress.update(static_cast<double>(now.ends.size()));
        if (Clock::now() >= next_save) {
            save(now);
            next_save = Clock::now() + std::chrono::seconds(3);
        }
    };
    const bool all = run_wanted(problem, options, of, session.context.thread_count(), sums, added);
    if (all)
        std::filesystem::remove(file);
    else
        save(sums);
    return all;
}

// What an ensemble of rods that diffuse leaves: noise.json and ensemble.csv.

namespace {
using rods::NoisyEnd;

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
    if (const scan::Proportion captures = captured(sums, rods);
        captures.of > 0) { // a single rod captures none
        const auto [low, high] = captures.wilson(capture_quantile);
        report.capture_probability = captures.value();
        report.capture_low = low;
        report.capture_high = high;
    }
    for (const NoisyEnd& end : sums.ends)
        if (end.failed)
            ++report.endings.failed;
        else
            report.endings.add(end.ending);
    std::vector<double> times;
    for (const NoisyEnd& end : sums.ends)
        if (!end.failed && end.ending == Ending::contact)
            times.push_back(end.time * units.time);
    const Estimate mean = mean_of(times);
    FirstContact& contact = report.first_contact_time;
    contact.error = mean.error;
    contact.runs = times.size();
    if (!times.empty())
        contact.mean = mean.value;
    if (!sums.failure.empty())
        report.failure = sums.failure;
    report.rotational_diffusion = plan.noise.rotational / units.time;
    report.translational_diffusion = plan.noise.translational * units.length * units.length / units.time;
    report.speed = units.length / units.time;
    report.time_step = plan.noise.time_step * units.time;
    report.seed = plan.noise.seed;
    report.times = in_units_of(units.time, rods::output_times(problem));
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
