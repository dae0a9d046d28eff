#include "rods_checkpoint.hpp"

#include "rodwake/app/run_folder.hpp"
#include "rodwake/core/build_info.hpp"
#include "rodwake/core/error.hpp"
#include "rodwake/medium/simulate.hpp"
#include "rodwake/rods/form.hpp"
#include "rodwake/store/csv.hpp"
#include "rodwake/store/journal.hpp"

#include <algorithm>
#include <cmath>

namespace rodwake::store {

using namespace rods;
using integrate::Statistics;

template<>
inline constexpr auto parts<Separation> = parts_of("first second distance", &Separation::first,
                                                   &Separation::second, &Separation::distance);
template<>
inline constexpr auto parts<TailWindow> = parts_of("min_separation max_separation max_turning",
                                                   &TailWindow::min_separation, &TailWindow::max_separation,
                                                   &TailWindow::max_turning);
template<>
inline constexpr auto parts<BodyRecord> = parts_of("smallest_gap smallest_gap_time tail_start touching",
                                                   &BodyRecord::smallest_gap, &BodyRecord::smallest_gap_time,
                                                   &BodyRecord::tail_start, &BodyRecord::touching);
template<>
inline constexpr auto parts<SeparationRecord> = parts_of("smallest smallest_time tail_start late bodies",
                                                         &SeparationRecord::smallest,
                                                         &SeparationRecord::smallest_time,
                                                         &SeparationRecord::tail_start,
                                                         &SeparationRecord::late, &SeparationRecord::bodies);
template<>
inline constexpr auto parts<Statistics> =
    parts_of("steps rhs_evaluations jacobian_evaluations error_test_failures convergence_failures "
             "event_evaluations drift",
             &Statistics::steps, &Statistics::rhs_evaluations, &Statistics::jacobian_evaluations,
             &Statistics::error_test_failures, &Statistics::convergence_failures,
             &Statistics::event_evaluations, &Statistics::drift);
template<>
inline constexpr auto parts<RodCheckpoint> = parts_of("time state headings times outputs record statistics",
                                                      &RodCheckpoint::time, &RodCheckpoint::state,
                                                      &RodCheckpoint::headings, &RodCheckpoint::times,
                                                      &RodCheckpoint::outputs, &RodCheckpoint::record,
                                                      &RodCheckpoint::statistics);

} // namespace rodwake::store

namespace rodwake::app {

namespace {

/// A run resumes from a checkpoint of the same version, git id, scene and data of the field only.
std::string key_of(const scene::Scene& scene, const std::string& field) {
    const BuildInfo build = build_info();
    return "rods by rodwake " + build.version + " " + build.git + "\n\n" + stage_key(scene, Stage::rods) +
           "\n" + field;
}

/// The number that is `value` in output units.
double reduced(double value, double unit) {
    const double near = value / unit;
    for (const double number : {near, std::nextafter(near, -HUGE_VAL), std::nextafter(near, HUGE_VAL)})
        if (number * unit == value)
            return number;
    return near;
}

} // namespace

std::string checkpoint_bytes(const rods::RodCheckpoint& checkpoint, const scene::Scene& scene,
                             const std::string& field) {
    return store::journal_of(key_of(scene, field), checkpoint);
}

std::optional<rods::RodCheckpoint> read_checkpoint(const std::filesystem::path& file,
                                                   const scene::Scene& scene, const std::string& field) try {
    store::Journal journal(file);
    if (journal.key() != key_of(scene, field))
        return std::nullopt;
    rods::RodCheckpoint checkpoint = journal.value<rods::RodCheckpoint>();
    const std::size_t rods = scene.rods.size(), size = 3 * rods;
    const bool dynamic = scene.medium && scene.medium->is_dynamic();
    bool good = checkpoint.state.size() == (dynamic ? medium::state_size(scene.medium->memory(), rods)
                                                    : rods::state_size(scene.rods_run->form, rods)) &&
                checkpoint.headings.size() == rods && checkpoint.outputs.size() == checkpoint.times.size() &&
                checkpoint.time >= 0.0 &&
                std::max(checkpoint.record.smallest.first, checkpoint.record.smallest.second) <
                    std::max<std::size_t>(rods, 1);
    for (const auto& output : checkpoint.outputs)
        good = good && output.size() == size;
    return good ? std::optional(std::move(checkpoint)) : std::nullopt;
} catch (const InputError&) {
    return std::nullopt;
}

bool take_rows(const std::filesystem::path& table, const OutputUnits& units, rods::RodCheckpoint& end) try {
    const store::Table rows = store::read_csv(table, store::csv_names(table));
    const std::vector<double> last = std::move(end.outputs.back());
    if (rows.columns.size() != 1 + last.size())
        return false;
    end.times.clear();
    end.outputs.clear();
    bool ends_so = false;
    for (std::size_t row = 0; row < rows.rows() && rows.columns[0][row] <= end.time * units.time; ++row) {
        ends_so = true;
        std::vector<double> poses(last.size());
        for (std::size_t k = 0; k < last.size(); ++k) {
            const double unit = k % 3 == 2 ? 1.0 : units.length, value = rows.columns[1 + k][row];
            poses[k] = reduced(value, unit);
            ends_so = ends_so && value == last[k] * unit;
        }
        end.times.push_back(reduced(rows.columns[0][row], units.time));
        end.outputs.push_back(std::move(poses));
    }
    return ends_so;
} catch (const InputError&) {
    return false;
}

} // namespace rodwake::app
