#pragma once
// Speed against accuracy: what `rodwake tradeoff` measures of a scene, and which way to compute it it
// recommends.
//
// A way is a handful of settings of the scene. Each is run, timed and compared with a reference: the rods of
// a scene (of one with [scan] a thousand points), its bed, its fit, its field map. What a bed gives scatters
// from run to run, so the error of a quantity q after n runs has two parts, of which only one falls with n:
//
//   error(n)^2 = b^2 + s^2/n,    b^2 = max(0, (q - q_ref)^2 - e^2 - e_ref^2),
//
// s the standard deviation of one run, e and e_ref the standard errors of q and of the reference: the square
// of a measured difference exceeds that of the bias by e^2 + e_ref^2 in the mean. Rods, fits and field maps
// have s = e = 0, and q_ref is 0: their quantities are errors already.

#include "rodwake/core/record.hpp"

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::scene {
struct Scene;
}

namespace rodwake::app {

struct Plan;
struct RunContext;
enum class StageEnd;

/// Of a scene: rods are those of the theory, or of its scan.
enum class Part { rods, bed, fit, field };
std::string to_string(Part part);

/// A way to solve the rods of a scene, by the values of its keys.
struct Setting {
    std::string method = "auto"; ///< which takes pairs of a scan many at a time
    std::string form = "angle", field = "exact";
    double table_tolerance = 0.0; ///< of field "table"; else 0
    std::string precision = "full";
    double tolerance = 1e-8;

    bool operator==(const Setting&) const = default;

    static constexpr auto fields() {
        using R = Setting;
        return std::tuple{rodwake::field("method", &R::method, {"1", "rods_run.method"}),
                          rodwake::field("form", &R::form, {"1", "rods_run.form"}),
                          rodwake::field("field", &R::field, {"1", "medium.field"}),
                          rodwake::field("table_tolerance", &R::table_tolerance,
                                         {"1", "medium.table.tolerance; empty: no table"}),
                          rodwake::field("precision", &R::precision, {"1", "rods_run.precision"}),
                          rodwake::field("tolerance", &R::tolerance,
                                         {"1", "rods_run.rtol; rods_run.atol is a hundredth of it"})};
    }
};

/// A number that may be infinite ("inf" in JSON) or unknown (NaN: null, in tables empty).
struct Unbounded {
    double value = HUGE_VAL;

    operator double() const { return value; }
};

/// How far two runs of rods are apart. Lengths in f/mu, times in f/(mu v0), headings in rad; the state of a
/// point of a scan is its last separation and the turn of each rod. A run whose outcome is not that of the
/// reference is infinitely wrong in all but `outcome`. Of the points of a scan: what 95 % of them keep to.
struct RodErrors {
    Unbounded final_state, contact_time, outcome, path;

    static constexpr auto fields() {
        using R = RodErrors;
        return std::tuple{
            field("final_state", &R::final_state, {"1", "largest difference at the end, f/mu and rad"}),
            field("contact_time", &R::contact_time,
                  {"f/(mu v0)", "difference of the times of contact; empty: there is none"}),
            field("outcome", &R::outcome, {"1", "share of runs whose outcome differs"}),
            field("path", &R::path,
                  {"1", "largest difference at the output times, f/mu and rad; empty: a scan"})};
    }
};

/// A quantity as one way finds it.
struct Found {
    std::string name, unit;
    double value = HUGE_VAL;
    double error = 0.0;      ///< standard error of the value
    double scatter = 0.0;    ///< s; 0: the same in each run
    double bias = HUGE_VAL;  ///< against the reference
    double bias_error = 0.0; ///< standard error of the bias
    double scale = 1.0;      ///< what 100 % is: the size of the reference's value, or 1

    static constexpr auto fields() {
        using R = Found;
        return std::tuple{
            field("quantity", &R::name, {"1", "what was computed; empty: the way gave nothing"}),
            field("unit", &R::unit, {"1", "of this and the numbers that follow"}),
            field("value", &R::value, {"{unit}", "what was found"}),
            field("error", &R::error, {"{unit}", "standard error of the value"}),
            field("scatter", &R::scatter,
                  {"{unit}", "standard deviation of one run; 0: all runs give the same"}),
            field("bias", &R::bias, {"{unit}", "difference from the reference"}),
            field("bias_error", &R::bias_error, {"{unit}", "standard error of the bias"}),
            field("scale", &R::scale, {"{unit}", "what 100 % is"})};
    }
};

struct Way {
    std::vector<std::string> keys = {}; ///< as for -s: "granular.time_step=1e-05"; of rods see `setting`
    double seconds = HUGE_VAL;          ///< CPU time of one run on one thread; of rods the least of `runs`
    long runs = 0;                      ///< what was measured with
    std::vector<Found> found = {};
    std::string status = "ok"; ///< or why there is no result
    Setting setting = {};      ///< of rods
    long rhs_evaluations = 0;  ///< of rods, of a run

    bool tried() const { return runs > 0 || status != "ok"; }
    /// Null if it lacks the quantity, or has no result.
    const Found* find(const std::string& quantity) const;

    static constexpr auto fields() {
        using R = Way;
        return std::tuple{field("keys", &R::keys, {"1", "its keys"}),
                          field("seconds", &R::seconds, {"s", "CPU time of one run"}),
                          field("runs", &R::runs, {"1", "runs it was measured with"}),
                          field("found", &R::found, {"", "what it computed"}),
                          field("status", &R::status, {"1", "ok, or why there is no result"})};
    }
};

/// The two runs that agree on what the rods do.
struct RodReference {
    std::array<std::string, 2> methods;
    double tolerance = 0.0;
    RodErrors agreement; ///< of the two methods with each other
    RodErrors least;     ///< ten times that: smaller errors are quoted as this

    static constexpr auto fields() {
        using R = RodReference;
        return std::tuple{field("methods", &R::methods, {"", "which were compared"}),
                          field("tolerance", &R::tolerance, {"1", "rods_run.rtol of both"}),
                          field("agreement", &R::agreement, {"", "of the two with each other"}),
                          field("least_error_quoted", &R::least, {"", "ten times that"})};
    }
};

struct Tradeoff {
    Part part = Part::bed;
    std::string work = {};      ///< what the ways compute, as text; of a run of rods empty
    std::string reference = {}; ///< in words
    double limit = 0.0;         ///< s of CPU a way
    bool finished = false;
    std::vector<Way> ways = {};
    std::string unit = {}; ///< of rods, of work: "a run", "1000 points of the scan"
    std::string kind = {}; ///< of rods: the error that was asked for, a name of RodErrors
    RodReference rods = {};
};

/// A way, and how often it is to be run.
struct Choice {
    const Way* way;
    const Found* found;
    long runs;
    double bias, statistical; ///< b, and s/sqrt(runs)

    double error() const;
    double seconds() const { return static_cast<double>(runs) * way->seconds; }
};

/// The one that takes the least time to this error; nothing if all are biased by more, or lack the quantity.
std::optional<Choice> cheapest(const Tradeoff& table, const std::string& quantity, double error);
/// The one with the least error within this time; nothing if no run fits into it.
std::optional<Choice> most_accurate(const Tradeoff& table, const std::string& quantity, double seconds);
/// Ways that no other one beats in both time and error of one run, by time.
std::vector<const Way*> pareto_front(const Tradeoff& table, const std::string& quantity);

/// Names of what was found, in the order of the first way that has any.
std::vector<std::string> quantities_of(const Tradeoff& table);
/// What 100 % of it is, from the first way that has it. Throws InputError naming what there is.
Found reference_of(const Tradeoff& table, const std::string& quantity);

/// The scene, its rods solved this way.
scene::Scene with(scene::Scene scene, const Setting& setting);
/// The same as lines `table.key = value`, which -s takes and a scene file holds.
std::string scene_keys(const scene::Scene& scene, const Setting& setting);
/// All settings that the scene allows, from loose to tight. Throws InputError for a scene whose rods are not
/// known, or whose scan varies what a setting chooses.
std::vector<Setting> settings_of(const scene::Scene& scene);

/// What the verb is asked for beside its scene.
struct TradeoffRequest {
    Part part = Part::rods;
    std::string kind = "final_state"; ///< of rods
    double limit = 60.0;              ///< s; a way that takes longer is given up, or run less often
};

/// Where the ways of a part are kept, within the results of the scene; those of rods are a stage of the run.
std::filesystem::path ways_folder(const std::filesystem::path& results, Part part);
/// The ways to compute what context.tradeoff asks for, no rods, untried. Throws InputError for a scene
/// without such a part.
Tradeoff plan_ways(const scene::Scene& scene, const std::filesystem::path& results,
                   const RunContext& context);
/// Into ways_folder; what is there already of the same work is kept, and taken up where it was left. Throws
/// InputError for a folder that holds other work, unless `force`.
StageEnd measure_ways(const scene::Scene& scene, const std::filesystem::path& results,
                      const RunContext& context);
/// ways.json of a folder; nothing if there is none. Throws InputError for one that cannot be read.
std::optional<Tradeoff> read_ways(const std::filesystem::path& folder);

/// The points of a scan of which a sample is solved, as text; of a scene without one empty.
std::string work_of(const Plan& plan);
/// tradeoff.json of a folder. Throws InputError for one that cannot be read.
Tradeoff read_tradeoff(const std::filesystem::path& folder);

} // namespace rodwake::app
