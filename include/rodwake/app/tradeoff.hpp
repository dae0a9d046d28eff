#pragma once
// Speed against accuracy: what `rodwake tradeoff` measures of a scene, and which setting it recommends.
//
// Every way to solve the rods of a scene (method, form, field, precision, tolerance) is run and timed, and
// its result compared with a reference on which two independent methods agree. Of a scene with [scan] the
// work is not one run but a thousand random points of the scan.

#include "rodwake/elastic/accuracy.hpp"
#include "rodwake/integrate/method.hpp"
#include "rodwake/rods/form.hpp"
#include "rodwake/scene/scene.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::app {
struct Plan;
}

namespace rodwake::app {

/// What the error of a setting is. Lengths in f/mu, times in f/(mu v0), headings in rad; the state of a point
/// of a scan is its last separation and the turn of each rod. A run whose outcome is not that of the
/// reference is infinitely wrong in all but `outcome`. Of the points of a scan: what 95 % of them keep to.
enum class ErrorKind {
    final_state,  ///< largest difference of any component at the end
    contact_time, ///< difference of the times of contact; NaN where the reference has none
    outcome,      ///< share of the runs whose outcome differs
    path          ///< largest difference of any component at any output time; NaN for scans
};
inline constexpr std::size_t error_kinds = 4;
std::string to_string(ErrorKind kind);

/// One number for each ErrorKind.
using Errors = std::array<double, error_kinds>;

/// One way to solve the rods of a scene.
struct Setting {
    std::optional<integrate::Method> method; ///< absent: "auto", which takes pairs of a scan many at a time
    rods::Form form = rods::Form::angle;
    scene::FieldBackend field = scene::FieldBackend::exact;
    double table_tolerance = 0.0; ///< of field "table"; else 0
    elastic::Accuracy precision = elastic::Accuracy::full;
    double tolerance = 1e-8; ///< rods_run.rtol; rods_run.atol is a hundredth of it

    bool operator==(const Setting&) const = default;
};

// Their values in scenes.
std::string method_name(const Setting& setting);
std::string name_of(scene::FieldBackend field);
std::string name_of(elastic::Accuracy precision);

/// The scene, solved this way.
scene::Scene with(scene::Scene scene, const Setting& setting);
/// The same as lines `table.key = value`, which -s takes and a scene file holds.
std::string scene_keys(const scene::Scene& scene, const Setting& setting);

/// All settings that the scene allows, from loose to tight. Throws InputError for a scene whose rods are not
/// known, or whose scan varies what a setting chooses.
std::vector<Setting> settings_of(const scene::Scene& scene);

/// A setting that was tried.
struct Trial {
    Setting setting;
    Errors error{};       ///< infinite if it failed; none is quoted below Tradeoff::least
    double seconds = 0.0; ///< CPU time of a run on one thread, the least of `repeats`
    long repeats = 0;
    long rhs_evaluations = 0;  ///< of a run
    std::string status = "ok"; ///< or why there is no result
};

struct Tradeoff {
    std::string unit;                        ///< of work: "a run", "1000 points of the scan"
    std::string work;                        ///< the sample of a scan, as text (work_of); of a run empty
    double limit = 0.0;                      ///< s; settings that took longer were given up
    ErrorKind kind = ErrorKind::final_state; ///< what is meant by "error"
    std::array<std::string, 2> methods;      ///< those of the reference
    double tolerance = 0.0;                  ///< of the reference
    Errors agreement{};                      ///< of the two methods with each other
    Errors least{};                          ///< ten times that: smaller errors are quoted as this
    std::vector<Trial> trials;
};

/// What the verb is asked for beside its scene.
struct TradeoffRequest {
    ErrorKind kind = ErrorKind::final_state;
    double limit = 60.0; ///< s; a setting that takes longer is given up
};

/// The points of a scan of which a sample is solved, as text; of a scene without one empty.
std::string work_of(const Plan& plan);
/// tradeoff.json of a folder. Throws InputError for one that cannot be read.
Tradeoff read_tradeoff(const std::filesystem::path& folder);

/// Of the trials whose error is at most this the one that takes the least time; null: none.
const Trial* cheapest(const Tradeoff& table, ErrorKind kind, double error);
/// Of the trials that take at most this time the most accurate one, of equals the cheapest; null: none.
const Trial* most_accurate(const Tradeoff& table, ErrorKind kind, double seconds);
/// Trials that no other one beats in both time and error, by time.
std::vector<const Trial*> pareto_front(const Tradeoff& table, ErrorKind kind);

} // namespace rodwake::app
