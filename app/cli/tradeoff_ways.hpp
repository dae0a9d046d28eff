#pragma once
// What `rodwake tradeoff` is asked and how it answers, in words.

#include "options.hpp"

#include <optional>
#include <string>

namespace rodwake::cli {

/// --for: "1e-6", "2%", "rod_speed 2%".
struct WantedError {
    std::string quantity; ///< empty: that of --error
    double error = 0.0;
    bool relative = false; ///< in parts of the quantity itself: 2 % is 0.02
};
/// Nothing without --for. Throws InputError for what is no error.
std::optional<WantedError> wanted_error(const Options& options);

std::string time_text(double seconds);

/// rodwake tradeoff of a bed, a fit or a field map.
int tradeoff_of_ways(const Options& options, const scene::Scene& scene, app::Part part);

} // namespace rodwake::cli
