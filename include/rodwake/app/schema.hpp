#pragma once
// What the program knows of its scenes and results, for other programs.

#include <string>

namespace rodwake::app {

/// The schema of scenes (scene/document.hpp) and "measures": [{"measure", "key", "title", "unit", "factor",
/// "meaning"}], a value of measure.json each. "title" heads its row in the report; without one it has none.
/// The value times "factor" is in "unit"; texts have neither. The plots read all of it
/// (plots/rodwake_plots/schema.json).
std::string schema_json();

} // namespace rodwake::app
