#pragma once
// measure.json.

#include "measure_results.hpp"

namespace rodwake::cli {

/// Numbers with errors as {"value", "error", "samples"}; an error that is not known is null.
std::string measure_json(const CaseResults& results, const MeasureOrigin& origin);

} // namespace rodwake::cli
