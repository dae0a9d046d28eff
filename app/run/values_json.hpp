#pragma once
// Named values as JSON.

#include "rodwake/app/measure_report.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <optional>

namespace rodwake::app {

/// JSON has no infinity and no NaN; null stands for them.
inline nlohmann::ordered_json finite_or_null(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

inline nlohmann::ordered_json finite_or_null(const std::optional<double>& value) {
    return value ? finite_or_null(*value) : nlohmann::ordered_json(nullptr);
}

/// {"value", "error", "samples"}.
nlohmann::ordered_json estimate_json(const Estimate& estimate);

/// Where "rods.0.force" stands in a document: the text of a JSON pointer.
std::string pointer_to(const std::string& name);

/// What is not there or not known is null.
nlohmann::ordered_json values_json(const Values& values);

} // namespace rodwake::app
