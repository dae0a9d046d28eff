#pragma once
// What `rodwake check` says of a plan: what will be modelled, what will not and why, and what is stored.

#include "rodwake/app/plan.hpp"

#include <string>
#include <vector>

namespace rodwake::app {

/// One part of the physics and why it is in or out.
struct PlanLine {
    bool modelled;
    std::string text;
};

/// Every part of the physics, of a plan that has all stages its scene names.
std::vector<PlanLine> describe(const Plan& plan);

/// What is legal and yet hardly meant, a sentence each: scene/advice.hpp, rods that start in contact, a scan
/// whose rods can run into each other.
std::vector<std::string> doubts(const Plan& plan);

/// What a granular run stores: "100 frames of 1561 spheres (h5md), at most 9.4 MB; a table of 1001 rows".
std::string describe_output(const BedPlan& bed);
/// How large that is, where frames take more than 1 GB, and which keys make it less; else empty.
std::string output_advice(const BedPlan& bed);

// What the program knows of its scenes and results, for other programs.

/// The schema of scenes (scene/document.hpp) and "measures": [{"measure", "key", "title", "unit", "factor",
/// "meaning"}], a value of measure.json each. "title" heads its row in the report; without one it has none.
/// The value times "factor" is in "unit"; texts have neither. The plots read all of it
/// (plots/rodwake_plots/schema.json).
std::string schema_json();

} // namespace rodwake::app
