#pragma once
// What is known of a parameter before the data.

#include <optional>

namespace rodwake::fitting {

enum class PriorKind { uniform, log_uniform, normal };

/// Of a value within (low, high). A normal prior is cut there and normalised again. Whoever samples puts
/// the parameter's own bounds in the place of those that are not given.
struct Prior {
    PriorKind kind = PriorKind::uniform;
    std::optional<double> low, high;
    double mean = 0.0, sd = 0.0; ///< of normal

    bool operator==(const Prior&) const = default;
};

} // namespace rodwake::fitting
