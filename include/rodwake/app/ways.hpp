#pragma once
// Speed against accuracy of a bed, of a fit and of a field map: what `rodwake tradeoff --of` measures.
//
// A way to compute a part of a scene is a handful of its keys. Each way is run, timed and compared with a
// reference. What a bed gives scatters from run to run, so the error of a quantity q after n runs has two
// parts, of which only one falls with n:
//
//   error(n)^2 = b^2 + s^2/n,    b^2 = max(0, (q - q_ref)^2 - e^2 - e_ref^2),
//
// s the standard deviation of one run, e and e_ref the standard errors of q and of the reference: the square
// of a measured difference exceeds that of the bias by e^2 + e_ref^2 in the mean. Fits and field maps have
// s = e = 0, and q_ref is 0: their quantities are errors already.

#include "rodwake/app/run_context.hpp"
#include "rodwake/scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rodwake::app {

/// Of a scene: rods are those of the theory, or of its scan (rodwake/app/tradeoff.hpp).
enum class Part { rods, bed, fit, field };
std::string to_string(Part part);

/// A quantity as one way finds it.
struct Found {
    std::string name, unit;
    double value = 0.0;
    double error = 0.0;      ///< standard error of the value
    double scatter = 0.0;    ///< s; 0: the same in each run
    double bias = 0.0;       ///< against the reference
    double bias_error = 0.0; ///< standard error of the bias
    double scale = 1.0;      ///< what 100 % is: the size of the reference's value, or 1
};

struct Way {
    std::vector<std::string> keys; ///< as for -s: "granular.time_step=1e-05"
    double seconds = 0.0;          ///< CPU time of one run
    long runs = 0;                 ///< what was measured with
    std::vector<Found> found = {};
    std::string status = "ok"; ///< or why there is no result
};

struct Ways {
    Part part = Part::bed;
    std::string work;      ///< what they compute, as text
    std::string reference; ///< in words
    double limit = 0.0;    ///< s of CPU a way
    bool finished = false;
    std::vector<Way> ways;
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
std::optional<Choice> cheapest(const Ways& ways, const std::string& quantity, double error);
/// The one with the least error within this time; nothing if no run fits into it.
std::optional<Choice> most_accurate(const Ways& ways, const std::string& quantity, double seconds);

/// Names of what was found, in the order of the first way that has any.
std::vector<std::string> quantities_of(const Ways& ways);
/// What 100 % of it is, from the first way that has it. Throws InputError naming what there is.
Found reference_of(const Ways& ways, const std::string& quantity);

/// Where they are kept, within the results of the scene.
std::filesystem::path ways_folder(const std::filesystem::path& results, Part part);

/// What is asked of measure_ways.
struct WaysRequest {
    Part part = Part::bed;
    double limit = 60.0; ///< s of CPU a way
};

/// The ways, untried. Throws InputError for a scene without such a part.
Ways plan_ways(const scene::Scene& scene, const WaysRequest& request, const std::filesystem::path& results,
               const RunContext& context);
/// Into ways_folder; what is there already of the same work is kept, and taken up where it was left. Throws
/// InputError for a folder that holds other work, unless `force`.
StageEnd measure_ways(const scene::Scene& scene, const WaysRequest& request,
                      const std::filesystem::path& results, const RunContext& context);
/// ways.json of a folder; nothing if there is none. Throws InputError for one that cannot be read.
std::optional<Ways> read_ways(const std::filesystem::path& folder);

} // namespace rodwake::app
