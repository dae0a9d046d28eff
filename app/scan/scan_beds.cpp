#include "scan_parts.hpp"

#include "bed/run_tables.hpp"
#include "rodwake/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>

#include <cmath>

namespace rodwake::app {

namespace {

namespace fs = std::filesystem;

/// Makes the run of a point, or resumes it.
void evaluate_bed(const ScanPlan& plan, const fs::path& folder, const RunContext& context, const Logger& log,
                  const scan::Point& point, scan::Result& result) {
    using Clock = std::chrono::steady_clock;
    const auto seconds = [start = Clock::now()] {
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    result.point = point;
    try {
        const BedPlan bed = scanned_bed(plan, point);
        const GranularPlan granular{bed, granular_key(bed.of.scene), {}};
        const GranularTask task{static_cast<std::uint32_t>(scan::run_of(point.id)),
                                bed_folder(folder, point.id)};
        if (!context.force)
            require_same_run(task, granular.scene_key);
        RunContext limited = context;
        if (plan.time_limit)
            limited.stop = [&] { return context.stopped() || seconds() > *plan.time_limit; };
        const GranularResult end = execute_task(granular, task, limited, log, 1, [](auto&&...) {});
        if (end.end == StageEnd::finished) {
            const BedObservables yield = observables_of(bed.of.scene, run_tables(task.folder));
            result.status = scan::Status::ok;
            result.outcome = yield.outcome;
            std::ranges::copy(yield.values, result.values.begin());
            for (std::size_t k = 0; k < yield.values.size(); ++k)
                if (std::isinf(yield.values[k])) {
                    result.status = scan::Status::not_finite;
                    result.set_cause(plan.columns.observables[k] + " is not finite");
                }
        } else {
            result.status = end.end == StageEnd::failed ? scan::Status::failed
                            : context.stopped()         ? scan::Status::stopped
                                                        : scan::Status::time_limit;
            result.set_cause(result.status == scan::Status::time_limit
                                 ? fmt::format("more than {:g} s", *plan.time_limit)
                                 : end.message);
        }
    } catch (const RunError&) {
        throw; // nothing can be written: what runs are left would fail alike
    } catch (const std::exception& error) {
        result.status = scan::Status::exception;
        result.set_cause(rodwake::describe(error));
    }
    result.seconds = seconds();
}

/// None of a folder that somebody else made.
std::optional<long> number_of(const std::string& text) {
    long number = 0;
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    return error == std::errc() && rest == end && number > 0 ? std::optional(number) : std::nullopt;
}

} // namespace

fs::path bed_folder(const fs::path& scan, std::int64_t id) {
    return run_folder(scan / fmt::format("points/{:04}", scan::place_of_run(id) + 1), scan::run_of(id));
}

std::optional<std::int64_t> bed_of(const fs::path& file) {
    const std::vector<fs::path> parts(file.begin(), file.end());
    if (parts.size() != 5 || parts[0] != "points" || parts[2] != "runs")
        return std::nullopt;
    const auto position = number_of(parts[1].string()), run = number_of(parts[3].string());
    return position && run ? std::optional(scan::id_of_run(*position - 1, *run - 1)) : std::nullopt;
}

scan::Evaluate evaluate_beds(const ScanPlan& plan, fs::path folder, RunContext context, Logger log) {
    return [&plan, folder = std::move(folder), context = std::move(context),
            log = std::move(log)](std::span<const scan::Point> points, std::span<scan::Result> results) {
        for (std::size_t i = 0; i < points.size(); ++i)
            evaluate_bed(plan, folder, context, log, points[i], results[i]);
    };
}

} // namespace rodwake::app
