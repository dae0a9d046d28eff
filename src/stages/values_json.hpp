#pragma once
// Named values as JSON.

#include "rodwake/assembly/measure_report.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace rodwake::stages {

/// JSON has no infinity and no NaN; null stands for them.
inline nlohmann::json finite_or_null(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

/// Where "rods.0.force" stands in a document: the text of a JSON pointer.
std::string pointer_to(const std::string& name);

/// An estimate is {"value", "error", "samples"}; what is not there or not known is null.
nlohmann::ordered_json values_json(const assembly::Values& values);

} // namespace rodwake::stages
