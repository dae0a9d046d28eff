#pragma once
// What a name means that stands in a scene or in a result file: from the field lists of scenes, the
// catalogue of files and the kinds of measures.

#include <optional>
#include <string>
#include <vector>

namespace rodwake::stages {

/// A table of scenes ("scan", "[scan]"), a key ("coupling.kappa", "rods.0.position", "kappa"), a file
/// ("scan.csv"), a column of a CSV file or a key of a JSON file ("mean_speed0", "psi6"): all that is known of
/// it, in lines. Nothing for a name that is none of these.
std::optional<std::string> explain(const std::string& name);

/// Names near this one, the nearest first; then those whose meaning has the word. At most eight.
std::vector<std::string> similar_names(const std::string& name);

} // namespace rodwake::stages
