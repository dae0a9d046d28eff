#pragma once
// What `rodwake check` says of [fit].

#include "check_bed.hpp"
#include "options.hpp"

namespace rodwake::cli {

/// What is fitted to what, which terms take part and which do not, and what that will cost: empty for a scene
/// without [fit]. Throws InputError for files that are wrong; those the run makes itself need not be there
/// yet.
struct FitCheck {
    std::vector<CheckLine> lines;
    std::string cost;
};
FitCheck check_fit(const scene::Scene& scene, const Options& options);

} // namespace rodwake::cli
